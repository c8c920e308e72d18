#include "vbond/terms/strain/motion_strain.hpp"

namespace vbond {

void MotionStrain::begin_step() {
  const StrainProgram& strain = *on_.stage.strain;
  if (on_.state.clock.stage_step % steps_in(strain.every, on_.stage.dt) != 0) return;

  const double U_before = on_.host.potential_energy();
  on_.host.apply_loads_alone();
  double work_applied = 0.0;
  for (const ParticleId p : strain.particles) {
    if (!on_.bodies.order.has(p)) continue;
    const std::size_t row = on_.bodies.order.row[p].value;
    Vec3d& r = on_.bodies.pose[row].r;
    const Vec3d dr = strain.increment * dot(strain.direction, r - strain.centre) * strain.direction;
    r += dr;
    work_applied += dot(on_.bodies.load[row].F, dr);
  }
  on_.host.particles_jumped();
  const double flowed = on_.bonds.remembers() ? let_bonds_flow() : 0.0;
  on_.books.work_loads += work_applied;
  on_.books.dissipated += flowed;
  on_.books.work_supports += on_.host.potential_energy() - U_before + flowed - work_applied;
}

/// What the jump has brought beyond their limits flows at once: what they store then is what the jump has
/// done. Returns what those of this part have lost.  [energy]
double MotionStrain::let_bonds_flow() {
  State& s = on_.state;
  on_.bonds.collect(s.bond_history);
  double flowed = 0.0;
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    const bool known = on_.bodies.order.has(b.i) || on_.bodies.order.has(b.j);
    if (!known || b.broken || !b.law->has_rules || !b.law->remembers()) continue;
    BondHistory& history = s.bond_history[k];
    const double before = history[b.law->dissipated_at];
    history = b.law->advance(b, on_.bodies.bond_pose(b), {}, 0.0, history);
    if (on_.bodies.order.has(b.i)) flowed += history[b.law->dissipated_at] - before;
  }
  on_.host.arrange_bonds();
  on_.host.evaluate_loads();
  return flowed;
}

std::unique_ptr<MotionTerm> StrainTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionStrain>(on);
}

}  // namespace vbond
