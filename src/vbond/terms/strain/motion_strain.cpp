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
  on_.books.work_loads += work_applied;
  on_.books.work_supports += on_.host.potential_energy() - U_before - work_applied;
}

std::unique_ptr<MotionTerm> StrainTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionStrain>(on);
}

}  // namespace vbond
