#pragma once
#include <string_view>
#include <variant>

#include "vbond/case/dimension.hpp"

namespace vbond::labtest {

/// A fracture toughness with its unit, in N/m^1.5 = Pa m^0.5: a stress times the root of a length, as "1.5
/// MPa m^0.5", "1.5 MPa*sqrt(m)" or "47 MPa mm^(1/2)", or a force over m^1.5, as "1.5e6 N/m^1.5". Units of
/// case files have whole powers, this one is that of a command line. A bare number is in N/m^1.5, or that of
/// reduced units. The sign is not looked at.
std::variant<double, keys::UnitMistake> parse_toughness(std::string_view text);

}  // namespace vbond::labtest
