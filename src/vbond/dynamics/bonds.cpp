#include "vbond/dynamics/bonds.hpp"

#include "vbond/dynamics/parallel.hpp"

namespace vbond {
namespace {

BondLoads<double> loads_of(const Bond& b, const State& s) {
  const BondPose<double> pose = bond_pose(b, s);
  return visit_law(b, [&pose](const auto& law) { return bond_loads(law, pose); });
}

}  // namespace

double axial_force(const Bond& b, const State& s) {
  return b.B1 * (norm(bonded_points(bond_pose(b, s), b.R_i, b.R_j)) - b.a);
}

void add_bond_loads(const State& state, Loads& loads) {
  for (const Bond& b : state.bonds) {
    const BondLoads<double> l = loads_of(b, state);
    loads.F[b.i] += l.F;
    loads.F[b.j] -= l.F;
    loads.M[b.i] += l.M_ij;
    loads.M[b.j] += l.M_ji;
  }
}

void BondLoadsEvaluator::prepare(const PerBond<Bond>& bonds) {
  packs_.clear();
  for (const BondLaw law : {BondLaw::v_model, BondLaw::evm}) {
    std::uint32_t lane = pack_width;
    for (const BondId b : bonds.ids()) {
      if (bonds[b].law != law) continue;
      if (lane == pack_width) {
        packs_.push_back({});
        lane = 0;
      }
      fill_lane(packs_.back(), lane++, b, bonds[b]);
    }
  }
  of_bond_.resize(bonds.size());
}

void BondLoadsEvaluator::add(const State& state, const BondIndex& index, int threads, Loads& loads) {
  constexpr std::size_t chunk = 64;  // packs: 512 bonds a piece of work
  const PackKernel kernel = pack_kernel();
  for_each_chunk(packs_.size(), pack_width, chunk, threads, [&](std::size_t first, std::size_t count) {
    kernel(packs_.data() + first, count, state.r.data(), state.q.data(), of_bond_.data());
  });
  for_each_index(state.r.size(), threads, [&](std::size_t k) {
    const ParticleId p{k};
    for (const BondIndex::Entry& e : index.of(p)) {
      const BondLoads<double>& l = of_bond_[e.bond.value];
      if (e.is_i) {
        loads.F[p] += l.F;
        loads.M[p] += l.M_ij;
      } else {
        loads.F[p] -= l.F;
        loads.M[p] += l.M_ji;
      }
    }
  });
}

}  // namespace vbond
