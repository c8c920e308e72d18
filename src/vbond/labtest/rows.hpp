#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "vbond/labtest/result.hpp"

namespace vbond::labtest {

/// One row of the history.
struct Row {
  std::int64_t step = 0;
  int stage = 0;  ///< of a test at rest, from 0
  CurvePoint at;
  double off_balance = 0;     ///< sum of the forces on both ends  [force]
  std::vector<double> gauge;  ///< strains of the gauge, as the test names them; empty: none
  double kinetic = 0, work = 0;
  std::int64_t broken = 0;
  std::optional<double> fragments, largest_fragment;
};

/// Rows of a run of the made case: at least one. Throws IoError if there are none, or the table is damaged.
std::vector<Row> read_rows(const MadeTest& test, const std::filesystem::path& file);

/// The first row of the test itself: at rest and under pressure the last one of the stage before it.
std::size_t begin_of(const MadeTest& test, const std::vector<Row>& rows);

/// The part of the breaks before the peak that there are by this row. 0 without breaks.
double share_broken(const std::vector<Row>& rows, const Row& row, std::size_t peak);
/// So many of them, long before it, are more than a few bonds that are weaker than the others.
inline constexpr double many_early = 0.05;

}  // namespace vbond::labtest
