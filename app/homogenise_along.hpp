#pragma once
#include <optional>
#include <string>

#include "vbond/case/case.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/statics/elastic_constants.hpp"

namespace vbond::app {

/// Nothing where some strain has no stiffness, or stress has left C without symmetry; `why` says so.
std::optional<ElasticConstants> constants_of(const Constants& C, std::string& why);

/// Runs the case, whose cell repeats in all directions, and prints a line of CSV with the constants of the
/// cell at each balance of its static stages. Returns the exit status; CaseError if no stage is static.
int homogenise_along(const Case& c, Built built, int threads);

}  // namespace vbond::app
