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
  const Vec3d D =
      (s.r[b.j] + b.R_j * rotate(s.q[b.j], b.n_j1)) - (s.r[b.i] + b.R_i * rotate(s.q[b.i], b.n_i1));
  return b.B1 * (norm(D) - b.a);
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

void BondLoadsEvaluator::add(const State& state, const BondIndex& index, int threads, Loads& loads) {
  of_bond_.resize(state.bonds.size());
  for_each_index(state.bonds.size(), threads,
                 [&](std::size_t b) { of_bond_[b] = loads_of(state.bonds[BondId{b}], state); });
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
