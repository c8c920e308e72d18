#pragma once
#include <functional>
#include <vector>

#include "body_plan.hpp"

/// What generators of bodies share.
namespace vbond::campaign {

using testing::Dice;

/// A rod of which bonds are cut: EI = 1.
struct Rod {
  const BondLaw* law = &bond_law<VModel>;
  double EA = 1e4, GJ = 0.8;
  double shear = 0;  ///< 24 (1 + nu) / kappa of Timoshenko's rod; 0: Bernoulli and Euler's
  BondStiffness<double> stiffness(double a) const {
    return {EA / a, 12.0 / (a * a * a) / (1.0 + shear / (EA * a * a)), 1.0 / a, GJ / a};
  }
};

/// EA between these for a body of size 1.
inline Rod random_rod(Dice& dice, double EA_least, double EA_most) {
  Rod rod;
  rod.law = dice.chance(0.35) ? &bond_law<Evm> : &bond_law<VModel>;
  rod.EA = dice.ratio(EA_least, EA_most);
  rod.GJ = dice.ratio(0.3, 1.2);
  if (dice.chance(0.25)) rod.shear = 24.0 * 1.2 / 0.85;
  return rod;
}

inline std::string words(const Rod& rod) {
  return std::string(rod.law == &bond_law<Evm> ? "EVM" : "V-model") + (rod.shear > 0 ? ", Timoshenko" : "");
}

inline constexpr HeldDofs plane_only{false, false, true, true, true, false};
inline constexpr HeldDofs hinge_in_plane{true, true, false, false, false, false};
inline constexpr HeldDofs clamp_in_plane{true, true, false, false, false, true};

/// Bonds of a rod along a chain of particles.
inline BondSet chain_of(const BodyPlan& plan, const Particles& chain, const Rod& rod) {
  BondSet set{rod.law, rod.stiffness(norm(plan.r[chain[1]] - plan.r[chain[0]])), {}, {}};
  for (std::size_t k = 0; k + 1 < chain.size(); ++k) set.pairs.push_back({chain[k], chain[k + 1]});
  return set;
}

/// No degree of freedom is held twice: case files refuse supports that move one differently.
inline void hold(BodyPlan& plan, Particles particles, HeldDofs held, const Vec3d& displacement = {}) {
  for (std::size_t k = 0; plan.in_plane && k < 6; ++k) held[k] = held[k] && !plane_only[k];
  if (held != HeldDofs{}) plan.supports.push_back({std::move(particles), held, displacement, {}});
}
inline void keep_in_plane(BodyPlan& plan) {
  hold(plan, everybody(plan), plane_only);
  plan.in_plane = true;
}
inline void load(BodyPlan& plan, Particles particles, const Vec3d& force) {
  plan.loads.push_back({std::move(particles), force, {}, false});
}

/// A random body of a kind.
using Drawing = std::function<BodyPlan(Dice&)>;

BodyPlan column(Dice& dice);
BodyPlan arch(Dice& dice);
BodyPlan shallow_arch(Dice& dice);
BodyPlan portal(Dice& dice);
BodyPlan lees_frame(Dice& dice);
BodyPlan ring(Dice& dice);
BodyPlan helix(Dice& dice);
BodyPlan bent_cantilever(Dice& dice);
BodyPlan ribbon(Dice& dice);
BodyPlan lattice(Dice& dice);
BodyPlan dome(Dice& dice);
BodyPlan plane_truss(Dice& dice);
BodyPlan star(Dice& dice);

}  // namespace vbond::campaign
