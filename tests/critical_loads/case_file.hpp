#pragma once
#include <string>

namespace vbond::campaign {

/// The reference of the first static stage of a case file, printed.
int print_reference_of(const std::string& file, int count);

}  // namespace vbond::campaign
