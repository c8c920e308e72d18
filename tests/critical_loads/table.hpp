#pragma once
#include <vector>

#include "judge.hpp"

namespace vbond::campaign {

/// Prints verdicts by kind of body, every case that is not right, the most expensive ones. Returns 1 if
/// anything was missed, wrong or aborted, more than 0.5 % gave up or stopped short, or more than 2 % had no
/// reference; else 0.
int print_table(std::vector<CaseRecord> records);
void print_case(const CaseRecord& r);

}  // namespace vbond::campaign
