#include "vbond/dynamics/team.hpp"

#include <algorithm>
#include <numeric>

#include "vbond/core/crew.hpp"

namespace vbond {

Team::Team(std::size_t rows, const std::vector<std::size_t>& work, int threads)
    : rows_(filled_up(rows)), blocks_(work.size()) {
  const std::size_t all = std::accumulate(work.begin(), work.end(), std::size_t{0});
  const std::size_t parts =
      std::clamp<std::size_t>(all / least_part, 1, static_cast<std::size_t>(std::max(1, threads)));
  std::size_t block = 0, done = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    Part part{p, block, block, {}};
    const std::size_t goal = all * (p + 1) / parts;
    while (block < blocks_ && (p + 1 == parts || done + work[block] / 2 < goal)) done += work[block++];
    part.last_block = block;
    part.rows = {std::min(rows_, part.first_block * block_rows), std::min(rows_, block * block_rows)};
    parts_.push_back(part);
  }
  if (parts_.size() > 1) crew_ = std::make_shared<Crew>(parts_.size());
}

Team::Team(const Team& of_fewer_rows, std::size_t rows)
    : rows_(filled_up(rows)),
      blocks_((rows_ + block_rows - 1) / block_rows),
      parts_(of_fewer_rows.parts_),
      crew_(of_fewer_rows.crew_) {
  parts_.back().last_block = blocks_;
  parts_.back().rows.last = rows_;
}

Team::~Team() = default;

void Team::run(void (*call)(void* work, const Part&), void* work) const {
  crew_->for_each([&](std::size_t k) { call(work, parts_[k]); });
}

const Part& Team::part_of_row(std::size_t row) const {
  for (const Part& p : parts_)
    if (p.rows.contains(row)) return p;
  return parts_.back();
}

}  // namespace vbond
