#pragma once
#include "vbond/dynamics/team.hpp"

namespace vbond::testing {

/// A team of exactly so many threads, however little there is for them to do.
inline Team team_of(int threads, std::size_t rows) {
  const std::size_t blocks = (filled_up(rows) + block_rows - 1) / block_rows;
  return Team(rows, std::vector<std::size_t>(blocks, static_cast<std::size_t>(threads) * least_part),
              threads);
}

}  // namespace vbond::testing
