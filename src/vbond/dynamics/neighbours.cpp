#include "vbond/dynamics/neighbours.hpp"

#include <algorithm>
#include <utility>

namespace vbond {

NeighbourList::NeighbourList(PerRow<double> radius, double skin, Keep keep)
    : radius_(std::move(radius)), skin_(skin), keep_(std::move(keep)) {
  const auto [min, max] = std::minmax_element(radius_.begin(), radius_.end());
  max_radius_ = radius_.empty() ? 0.0 : *max;
  equal_radii_ = radius_.empty() || *min == *max;
}

bool NeighbourList::refresh(std::span<const PoseRow> pose) {
  if (!stale(pose)) return false;
  rebuild(pose);
  return true;
}

bool NeighbourList::stale(std::span<const PoseRow> pose) const {
  if (start_.empty()) return true;
  const double limit = sq(0.5 * skin_);
  for (std::size_t first = 0; first < pose.size(); first += block_rows) {
    bool moved = false;  // no branch per row; a place that is no number counts as moved
    for (std::size_t k = first; k < std::min(pose.size(), first + block_rows); ++k)
      moved |= !(norm2(pose[k].r - r_built_[k]) <= limit);
    if (moved) return true;
  }
  return false;
}

void NeighbourList::rebuild(std::span<const PoseRow> pose) {
  ++rebuilds_;
  r_built_.clear();
  for (const PoseRow& p : pose) r_built_.push_back(p.r);
  start_.assign(pose.size() + 1, 0);
  // No cell for a point at infinity: the load check refuses the step that made it.
  if (!std::all_of(r_built_.begin(), r_built_.end(), is_finite)) return;
  const double largest_reach = 2.0 * max_radius_ + skin_;
  grid_.sort(r_built_, largest_reach);
  find_near(largest_reach);
  sort_found();
}

/// Fills found_ row by row, in no order, from found_start_[i] on for row i.
void NeighbourList::find_near(double largest_reach) {
  const double limit = sq(largest_reach);
  found_start_.assign(r_built_.size() + 1, 0);
  std::size_t end = 0;
  for (std::size_t i = 0; i < r_built_.size(); ++i) {
    const Vec3d r_i = r_built_[i];
    const std::size_t begin = end;
    grid_.scan_near(i, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
      const std::size_t most = end + static_cast<std::size_t>(last - first);
      if (found_.size() < most) found_.resize(2 * most);
      Row* const found = found_.data();
      for (; first != last; ++first) {  // written always, kept if near: no branch that cannot be foretold
        found[end] = Row{first->i};
        end += static_cast<std::size_t>((norm2(first->r - r_i) < limit) & (first->i != i));
      }
    });
    Row* const from = found_.data() + begin;
    Row* to = found_.data() + end;
    if (!equal_radii_)
      to = std::remove_if(from, to, [&](Row j) {
        return !(norm2(r_built_[j.value] - r_i) < sq(radius_[Row{i}] + radius_[j] + skin_));
      });
    if (keep_) to = keep_(Row{i}, from, to);
    end = static_cast<std::size_t>(to - found_.data());
    found_start_[i + 1] = end;
  }
}

/// Every pair was found from both sides, so the list is its own transpose: giving each row to its neighbours,
/// the last row first, sorts all of them at once.
void NeighbourList::sort_found() {
  const std::size_t n = r_built_.size();
  neighbours_.resize(found_start_[n]);
  for (std::size_t i = 0; i < n; ++i)
    start_[i] = found_start_[i + 1];  // ends, to be counted down to beginnings
  start_[n] = found_start_[n];
  for (std::size_t j = n; j-- > 0;)
    for (std::size_t k = found_start_[j]; k < found_start_[j + 1]; ++k)
      neighbours_[--start_[found_[k].value]] = Row{j};
}

}  // namespace vbond
