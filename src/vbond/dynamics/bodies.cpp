#include "vbond/dynamics/bodies.hpp"

#include <utility>

namespace vbond {

Bodies::Bodies(const Model& model) : Bodies(model, spatial_order(model.r_0)) {}

Bodies::Bodies(const Model& model, Order rows_of) : order(std::move(rows_of)), tops(model, order) {
  const std::size_t rows = filled_up(order.particle.size());
  pose.resize(rows);
  motion.resize(rows);
  load.resize(rows);
  inverse.resize(rows);
  mass.resize(rows);
  inertia.resize(rows);
  for (const Row k : order.particle.ids()) {
    const ParticleId p = order.particle[k];
    if (!model.r_0.holds(p)) continue;  // in the row of all others, at which nobody looks
    pose[k.value].r = model.r_0[p];
    if (k.value >= order.own) continue;  // without mass: no loop moves it, or counts its energy
    mass[k.value] = model.mass[p];
    inertia[k.value] = model.inertia[p];
    inverse[k.value] = {1.0 / model.mass[p], tops.has(k.value) ? 0.0 : 1.0 / model.inertia[p]};
  }
}

void Bodies::read(const State& s) {
  for (const Row k : order.particle.ids()) {
    const ParticleId p = order.particle[k];
    if (!s.r.holds(p)) continue;  // in the row of all others, at which nobody looks
    pose[k.value].r = s.r[p];
    pose[k.value].q = s.q[p];
    motion[k.value].v = s.v[p];
    motion[k.value].omega = s.omega[p];
  }
  tops.read(s, order);
}

void Bodies::write(State& s) const {
  for (Row k{0}; k.value < order.known; ++k.value) {
    if (order.is_empty(k)) continue;
    const ParticleId p = order.particle[k];
    const Image n = order.image(k);
    if (!n.is_itself() && order.knows(p)) continue;  // itself is known
    s.r[p] = n.is_itself() ? pose[k.value].r : pose[k.value].r - to_image(s.cell, n);
    s.q[p] = pose[k.value].q;
    if (k.value >= order.own) continue;
    s.v[p] = motion[k.value].v;
    s.omega[p] = motion[k.value].omega;
  }
  tops.write(s, order);
}

Loads Bodies::collect(const LargeArray<LoadRow>& from) const {
  Loads l{order.column<Vec3d>(), order.column<Vec3d>()};
  for (Row k{0}; k.value < order.own; ++k.value) {
    l.F[order.particle[k]] = from[k.value].F;
    l.M[order.particle[k]] = from[k.value].M;
  }
  return l;
}

void Bodies::spread(const Loads& l, LargeArray<LoadRow>& to) const {
  for (Row k{0}; k.value < order.own; ++k.value) {
    const Vec3d &F = l.F[order.particle[k]], &M = l.M[order.particle[k]];
    if (!is_finite(F)) continue;  // of what has just come in
    to[k.value].F = F;
    to[k.value].M = M;
  }
}

Energies Bodies::kinetic_energy(const Team& team, const Tensor* flow) const {
  std::vector<Energies> of_block(team.blocks());
  team.for_blocks([&](const Block& b) {
    Energies& e = of_block[b.index];
    for (std::size_t k = b.rows.first; k < b.rows.last; ++k) {
      const Vec3d v = flow == nullptr ? motion[k].v : motion[k].v - times(*flow, pose[k].r);
      e.kinetic_translation += 0.5 * mass[k] * norm2(v);
      e.kinetic_rotation += rotation_energy(k, motion[k].omega);
    }
  });
  Energies sum;
  for (const Energies& e : of_block) {
    sum.kinetic_translation += e.kinetic_translation;
    sum.kinetic_rotation += e.kinetic_rotation;
  }
  return sum;
}

}  // namespace vbond
