#include "vbond/statics/detail/bond_shares.hpp"

#include <algorithm>
#include <utility>

#include "vbond/core/bounding_box.hpp"

namespace vbond {

BondShares::BondShares(const State& s) : BondShares(s, nullptr, 1) {}

BondShares::BondShares(const State& s, std::shared_ptr<Crew> crew) : BondShares(s, crew, crew->count()) {}

BondShares::BondShares(const State& s, std::shared_ptr<Crew> crew, std::size_t parts)
    : crew_(std::move(crew)), part_of_(s.r.size(), 0), bonds_(parts) {
  const auto counts = [&s](BondId k) { return !s.bonds[k].broken && image_of_j(s.bonds[k]).is_itself(); };
  if (parts > 1) {
    PerParticle<std::size_t> ends(s.r.size(), 0);
    std::size_t all = 0;
    for (const BondId k : s.bonds.ids())
      if (counts(k)) ++ends[s.bonds[k].i], ++ends[s.bonds[k].j], all += 2;
    std::vector<ParticleId> along;
    for (const ParticleId p : s.r.ids()) along.push_back(p);
    const int axis = box_around(s.r).axes_by_length()[0];
    std::stable_sort(along.begin(), along.end(), [&](ParticleId p, ParticleId q) {
      return component(s.r[p], axis) < component(s.r[q], axis);
    });
    std::size_t passed = 0;
    for (const ParticleId p : along) {
      part_of_[p] =
          static_cast<std::uint16_t>(std::min(passed * parts / std::max<std::size_t>(all, 1), parts - 1));
      passed += ends[p];
    }
  }
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (!b.broken && !image_of_j(b).is_itself()) with_images_.push_back(k);
    if (!counts(k)) continue;
    bonds_[part_of_[b.i]].push_back(k);
    if (part_of_[b.j] != part_of_[b.i]) bonds_[part_of_[b.j]].push_back(k);
  }
}

}  // namespace vbond
