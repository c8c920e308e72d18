#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "vbond/labtest/result.hpp"

namespace vbond::labtest {

/// The bonds that broke in a run, in their order. Throws IoError if the table is not there or damaged.
std::vector<FirstBreak> breaks_of(const std::filesystem::path& folder);

/// A note if the first break is not one of bending: at the outer fibre, opposite of the load.
void tell_break_of_beam(const MadeTest& test, TestResult& result);

/// Absent without a break.
std::optional<Splitting> splitting_of(const MadeTest& test, const std::vector<FirstBreak>& breaks);

}  // namespace vbond::labtest
