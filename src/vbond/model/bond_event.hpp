#pragma once
#include <cstdint>

#include "vbond/core/column.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/physics/section.hpp"

namespace vbond {

/// What happened to a bond, with all that is told of it: who reads this needs no bond.
struct BondEvent {
  enum class Kind : std::uint8_t { made, broken };
  Kind kind;
  BondId bond;        ///< its number in the whole body
  std::int64_t step;  ///< at the end of which it happened
  ParticleId i{}, j{};
  std::uint32_t set = 0;                  ///< which bond set of the case made it
  Criterion criterion = Criterion::none;  ///< of its strength; none: its law has its own
  // broken only, as the bond was when it broke
  double energy = 0;             ///< above rest  [energy]
  Failure<double> failure{};     ///< what used up its strength
  BreakCause cause{};            ///< what governed
  SectionLoads<double> loads{};  ///< elastic
  Vec3d middle{}, direction{};   ///< between its bonded points: place [length] and unit vector from i to j
};

/// What happened to this bond, all else left out.
inline BondEvent event_of(BondEvent::Kind kind, const Bond& b, BondId k, std::int64_t step) {
  const Criterion criterion = b.law->has_rules ? b.rules->strength.criterion : Criterion::none;
  return {.kind = kind, .bond = k, .step = step, .i = b.i, .j = b.j, .set = b.set, .criterion = criterion};
}

/// By what a bond has broken, from its shares of strength and its axial force.
inline BreakCause break_cause_of(const Bond& b, const Failure<double>& f, double N) {
  const Strength strength = b.law->has_rules ? b.rules->strength : Strength{};
  const double per_N = strength.own_section ? stress_per_load(b.law->stiffness(b)).force : 1.0;
  return break_cause(strength, f, per_N * N, strength_factor(b));
}

/// What is to be told of a bond that breaks as it stands: particle i at r_i.
inline BondEvent breaking_event(const Bond& b, BondId k, std::int64_t step, const Vec3d& r_i,
                                const BondPose<double>& pose, const BondHistory& history) {
  BondEvent e = event_of(BondEvent::Kind::broken, b, k, step);
  const BondAxis<double> axis = bond_axis(b, pose);
  const BondLoads<double> loads = b.law->loads(b, pose, history);
  const BondEnergy<double> U = b.law->energy(b, pose, history);
  e.energy = U.U_L + U.U_B + U.U_T;
  e.failure = b.law->failure(b, pose, history);
  e.loads = section_loads(b, pose, loads);
  e.cause = break_cause_of(b, e.failure, e.loads.N);
  e.middle = r_i + arm_of_i(b, pose) + 0.5 * axis.D * axis.d;
  e.direction = axis.d;
  return e;
}

}  // namespace vbond
