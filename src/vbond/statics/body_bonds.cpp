// What the bonds of a body at rest add to its loads and to its tangent, several at a time and by several
// threads.
#include <vector>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/in_lanes.hpp"

namespace vbond {

/// What a pair does to each other.
void StaticBody::push(ParticleId i, ParticleId j, const Image& of_j, const Vec3d& F, Loaded& l) const {
  l.loads.F[i] += F, l.loads.F[j] -= F;
  if (!l.inside.empty() && of_j.is_itself() && unknowns_.carrier(i) == unknowns_.carrier(j))
    l.inside[i] += F, l.inside[j] -= F;
  if (!of_j.is_itself()) add_image(of_j, F, l);
  l.largest = larger(l.largest, norm(F));
}

/// Parts side by side, each to its own particles; then bonds with an image.
void StaticBody::add_bonds(Loaded& l) const {
  const auto for_loads_of = [this](const std::vector<BondId>& bonds, const auto& add) {
    for_bonds_in_lanes(
        state_, bonds, [](BondId) { return true; },
        [](const BondLaneLoops& loops, BondLanes& lanes) { loops.loads(lanes); },
        [&](BondId k, const BondLanes& lanes, std::size_t lane) {
          const auto vec = [lane](const BondLanes::Lane(&x)[3]) {
            return Vec3d{x[0][lane], x[1][lane], x[2][lane]};
          };
          add(state_.bonds[k], BondLoads<double>{vec(lanes.F), vec(lanes.M_ij), vec(lanes.M_ji)});
        },
        [&](BondId k) { add(state_.bonds[k], bond_loads(state_, k)); });
  };
  const auto larger_moment = [this](const BondLoads<double>& f) {
    return larger(norm(f.M_ij), norm(f.M_ji)) / unknowns_.length();
  };
  std::vector<double> largest(shares_.parts(), 0.0);
  shares_.for_parts([&](std::size_t part) {
    double most = 0.0;
    for_loads_of(shares_.bonds(part), [&](const Bond& b, const BondLoads<double>& f) {
      const bool inside = !l.inside.empty() && unknowns_.carrier(b.i) == unknowns_.carrier(b.j);
      const auto add_to = [&](ParticleId p, const Vec3d& F, const Vec3d& M) {
        if (!shares_.owns(part, p)) return;
        l.loads.F[p] += F, l.loads.M[p] += M;
        if (inside) l.inside[p] += F;
      };
      add_to(b.i, f.F, f.M_ij);
      add_to(b.j, -f.F, f.M_ji);
      most = larger(most, larger(norm(f.F), larger_moment(f)));
    });
    largest[part] = most;
  });
  for (const double most : largest) l.largest = larger(l.largest, most);
  for_loads_of(shares_.with_images(), [&](const Bond& b, const BondLoads<double>& f) {
    push(b.i, b.j, image_of_j(b), f.F, l);
    l.loads.M[b.i] += f.M_ij, l.loads.M[b.j] += f.M_ji;
    l.largest = larger(l.largest, larger_moment(f));
  });
}

/// Parts side by side, each to the columns of its own particles.
void StaticBody::add_bonds_in_lanes(Stiffness& s) const {
  shares_.for_parts([&](std::size_t part) {
    for_bonds_in_lanes(
        state_, shares_.bonds(part), [this](BondId k) { return place_in_tangent_[k].is_there(); },
        [this](const BondLaneLoops& loops, BondLanes& lanes) { loops.tangent(lanes, unknowns_.length()); },
        [&](BondId k, const BondLanes& lanes, std::size_t lane) {
          double K[12][12];
          for (int c = 0; c < 12; ++c)
            for (int r = 0; r < 12; ++r) K[c][r] = lanes.block[c][r][lane];
          const Bond& b = state_.bonds[k];
          s.assembly.add_symmetric(place_in_tangent_[k], K,
                                   {shares_.owns(part, b.i), shares_.owns(part, b.j)});
        },
        [](BondId) {});
  });
}

/// Whether a particle that bonds act on moves along and about the world's axes, by itself, and does not move
/// with the load factor: add_pair() then has no more to do than to add the block.
bool StaticBody::is_plain(ParticleId p) const {
  const Movement& held = held_rate_[p];
  return unknowns_.axes(p) == nullptr && unknowns_.carrier(p) == p && unknowns_.arm(p) == nullptr &&
         held.shift == Vec3d{} && held.turn == Vec3d{};
}

/// Where the blocks of bonds go that need no more than that, and may go together with others.
void StaticBody::find_places() const {
  if (flows()) {
    place_in_tangent_.assign(state_.bonds.size(), {});
    places_of_ = 0;
    return;
  }
  if (places_of_ == stiffness_.assembly.version() && place_in_tangent_.size() == state_.bonds.size()) return;
  places_of_ = stiffness_.assembly.version();
  place_in_tangent_.assign(state_.bonds.size(), {});
  for (const BondId k : state_.bonds.ids()) {
    const Bond& b = state_.bonds[k];
    if (!b.broken && image_of_j(b).is_itself() && is_plain(b.i) && is_plain(b.j) &&
        lane_loops(bond_lane_kernel(), *b.law, *b.rules) != nullptr)
      place_in_tangent_[k] = stiffness_.assembly.place_of(b.i, b.j);
  }
}

}  // namespace vbond
