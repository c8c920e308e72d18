#include "vbond/dynamics/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vbond {
namespace {

/// The threads of a team, as CellGrid asks for them.
struct Workers {
  const Team& team;
  std::size_t count() const { return team.parts().size(); }
  template <class Work>
  void for_each(Work work) const {
    team.for_parts([&](const Part& part) { work(part.index); });
  }
};

}  // namespace

NeighbourList::NeighbourList(PerRow<double> radius, double skin, Keep keep)
    : radius_(std::move(radius)), skin_(skin), keep_(std::move(keep)) {
  const auto [min, max] = std::minmax_element(radius_.begin(), radius_.end());
  max_radius_ = radius_.empty() ? 0.0 : *max;
  equal_radii_ = radius_.empty() || *min == *max;
  grid_ = SizedPoints(radius_.values(), skin);
}

bool NeighbourList::refresh(std::span<const PoseRow> pose, const Team& team, double way,
                            const std::function<void()>& before_rebuild) {
  room_ -= 2.0 * way;  // as far as a small step may take a particle that is far from the origin: r rounds
  if (valid_ && room_ > 0.0) return false;
  if (!stale(pose, team)) return false;
  if (before_rebuild) before_rebuild();
  rebuild(pose, team);
  return true;
}

/// Rows that are particles.
RowRange NeighbourList::rows_of(const Part& part) const {
  return {std::min(part.rows.first, radius_.size()), std::min(part.rows.last, radius_.size())};
}

bool NeighbourList::stale(std::span<const PoseRow> pose, const Team& team) {
  if (!valid_) return true;
  team.for_parts([&](const Part& part) {
    double farthest2 = 0.0;
    bool nowhere = false;  // also what was nowhere at the rebuild
    const RowRange rows = rows_of(part);
    for (std::size_t k = rows.first; k < rows.last; ++k) {
      const double way2 = norm2(pose[k].r - r_built_[k]);
      farthest2 = std::max(farthest2, way2);
      nowhere |= !std::isfinite(way2);
    }
    of_part_[part.index].moved2 = farthest2;
    of_part_[part.index].nowhere = nowhere;
  });
  double farthest2 = 0.0;
  for (const OfPart& part : of_part_) {
    if (part.nowhere) return true;
    farthest2 = std::max(farthest2, part.moved2);
  }
  room_ = 0.5 * skin_ - std::sqrt(farthest2);
  return farthest2 > sq(0.5 * skin_);
}

void NeighbourList::rebuild(std::span<const PoseRow> pose, const Team& team) {
  ++rebuilds_;
  valid_ = false;  // should memory run out
  const std::size_t n = radius_.size();
  r_built_.resize(n);
  start_.resize(n);
  end_.resize(n);
  near_end_.resize(n);
  of_part_.resize(team.parts().size());
  team.for_parts([&](const Part& part) {
    bool nowhere = false;
    const RowRange rows = rows_of(part);
    for (std::size_t k = rows.first; k < rows.last; ++k) {
      r_built_[k] = pose[k].r;
      nowhere |= !is_finite(pose[k].r);
    }
    of_part_[part.index].nowhere = nowhere;
  });
  // No cell for a point at infinity: the load check refuses the step that made it.
  if (std::any_of(of_part_.begin(), of_part_.end(), [](const OfPart& p) { return p.nowhere; })) {
    std::fill(start_.begin(), start_.end(), std::size_t{0});
    end_ = start_;
    valid_ = true;
    room_ = 0.0;
    return;
  }
  grid_.sort(r_built_, Workers{team});
  team.for_parts([&](const Part& part) { find_near(rows_of(part), of_part_[part.index].near); });
  std::size_t all = 0;
  for (const Part& part : team.parts()) {
    of_part_[part.index].before = all;
    const RowRange rows = rows_of(part);
    if (rows.first < rows.last) all += near_end_[rows.last - 1];
  }
  neighbours_.resize(all + rows_at_once);  // any rows, to be read and not used
  team.for_parts([&](const Part& part) { sort_found(team, part); });
  valid_ = true;
  room_ = 0.5 * skin_;
}

/// Fills `near` row by row, in no order, up to near_end_[i] for row i.
void NeighbourList::find_near(RowRange rows, std::vector<Row>& near) {
  std::size_t end = 0;
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    const Vec3d r_i = r_built_[i];
    const double limit = sq(radius_[Row{i}] + max_radius_ + skin_);  // the own reach of each pair comes below
    const std::size_t begin = end;
    grid_.scan_near(i, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
      const std::size_t most = end + static_cast<std::size_t>(last - first);
      if (near.size() < most) near.resize(2 * most);
      Row* const found = near.data();
      for (; first != last; ++first) {  // written always, kept if near: no branch that cannot be foretold
        found[end] = Row{first->i};
        end += static_cast<std::size_t>((norm2(between(r_i, first->r)) < limit) & (first->i != i));
      }
    });
    Row* const from = near.data() + begin;
    Row* to = near.data() + end;
    if (!equal_radii_)
      to = std::remove_if(from, to, [&](Row j) {
        return !(norm2(between(r_i, r_built_[j.value])) < sq(radius_[Row{i}] + radius_[j] + skin_));
      });
    if (keep_) to = keep_(Row{i}, from, to);
    end = static_cast<std::size_t>(to - near.data());
    near_end_[i] = end;
  }
}

/// Every pair was found from both sides, so the list is its own transpose: giving each row to its neighbours,
/// the last row first, sorts all of them at once. Each thread does so for its rows, with all rows near them.
void NeighbourList::sort_found(const Team& team, const Part& part) {
  const OfPart& own = of_part_[part.index];
  const RowRange rows = rows_of(part);
  if (rows.first == rows.last) return;
  for (std::size_t i = rows.first; i < rows.last; ++i)
    start_[i] = end_[i] = own.before + near_end_[i];  // starts are to be counted down
  const std::size_t count = team.parts().size() > 1 ? near_end_[rows.last - 1] : 0;
  Row low{rows.first}, high{rows.last - 1};  // all rows that this part has neighbours in, and its own
  for (std::size_t k = 0; k < count; ++k)
    low = std::min(low, own.near[k]), high = std::max(high, own.near[k]);
  for (std::size_t p = team.parts().size(); p-- > 0;) {
    const RowRange others = rows_of(team.parts()[p]);
    const std::vector<Row>& near = of_part_[p].near;
    const std::size_t first = std::max(others.first, std::size_t{low.value});
    for (std::size_t j = std::min(others.last, high.value + std::size_t{1}); j-- > first;)
      for (std::size_t k = j == others.first ? 0 : near_end_[j - 1]; k < near_end_[j]; ++k)
        if (rows.contains(near[k].value)) neighbours_[--start_[near[k].value]] = Row{j};
  }
}

std::optional<std::size_t> NeighbourList::place_of(Row i, Row j) const {
  const std::span<const Row> near = of(i);
  const auto at = std::lower_bound(near.begin(), near.end(), j);
  if (at == near.end() || *at != j) return std::nullopt;
  return start_[i.value] + static_cast<std::size_t>(at - near.begin());
}

void NeighbourList::add(Row i, Row j) {
  if (!valid_) return;
  if (!(norm2(between(r_built_[i.value], r_built_[j.value])) < sq(radius_[i] + radius_[j] + skin_))) return;
  add_to(i, j);
  add_to(j, i);
}

/// The row's neighbours move to the end of all, with room for one more; their old place is lost until the
/// next rebuild.
void NeighbourList::add_to(Row i, Row j) {
  const std::span<const Row> near = of(i);
  if (std::binary_search(near.begin(), near.end(), j)) return;
  const std::size_t from = start_[i.value], count = near.size(), to = neighbours_.size() - rows_at_once;
  neighbours_.resize(to + count + 1 + rows_at_once);
  Row* const old = neighbours_.data() + from;
  Row* const now = neighbours_.data() + to;
  Row* const at = std::upper_bound(old, old + count, j);
  Row* const place = std::copy(old, at, now);
  *place = j;
  std::copy(at, old + count, place + 1);
  start_[i.value] = to;
  end_[i.value] = to + count + 1;
}

}  // namespace vbond
