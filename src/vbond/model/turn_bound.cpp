#include "vbond/model/turn_bound.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vbond {
namespace {

double largest_factor(const TimeFunction& f) {
  double largest = f.points.empty() ? 1.0 : 0.0;
  for (const TimeFunction::Point& p : f.points) largest = std::max(largest, std::abs(p.factor));
  return largest;
}

/// Of each particle, whether its orientation is felt: by bonds, present or to come, by its own inertia, or by
/// its group.
std::vector<char> feel_turns(const Model& model, const BodyPart& body, const Stage& stage) {
  std::vector<char> feels(model.particles(), 0);
  const PerParticle<std::uint32_t> bonds = body.bonds_of_each();
  for (const ParticleId p : model.mass.ids()) {
    if (bonds[p] > 0 || model.is_top(p)) feels[p.value] = 1;
    for (const BondingRule& rule : stage.bonding)
      if (rule.in_a[p.value] || rule.in_b[p.value]) feels[p.value] = 1;
  }
  for (const Support& s : stage.supports)  // arms of a group that turns as one
    if (turns_freely(s))
      for (const ParticleId p : s.particles) feels[p.value] = 1;
  return feels;
}

struct Spinning {
  ParticleId p;
  double rate = 0;  // [rad/time]
};

/// Of those that feel it, the first of the fastest, of all processes where they share the velocities.
Spinning fastest_spin(const BodyPart& body, const std::vector<char>& feels) {
  const PerParticle<Vec3d>& omega = body.state.omega;
  Spinning fastest;
  const auto is_told_here = [&](ParticleId p) {  // of others it may be that of another time
    return omega.holds_all() || body.has_pair_of(p);
  };
  for (const ParticleId p : omega.ids()) {
    if (feels[p.value] == 0 || !omega.holds(p) || !is_told_here(p)) continue;
    const double rate = norm(omega[p]);
    if (rate > fastest.rate) fastest = {p, rate};
  }
  if (omega.holds_all()) return fastest;
  for (const Spinning& s : body.all.gather(std::vector<Spinning>{fastest}))
    if (s.rate > fastest.rate || (s.rate == fastest.rate && s.p < fastest.p)) fastest = s;
  return fastest;
}

}  // namespace

FastestTurn fastest_turn(const Model& model, const BodyPart& body, const Stage& stage, Spins spins) {
  FastestTurn fastest;
  const auto look = [&](double rate, const auto& name) {
    if (rate > fastest.rate) fastest = {rate, "the turning of " + name()};
  };
  if (spins == Spins::counted) {
    const std::vector<char> feels = feel_turns(model, body, stage);
    const Spinning s = fastest_spin(body, feels);
    look(s.rate, [&s] { return "particle " + std::to_string(s.p.value); });
  }
  for (const Support& s : stage.supports)
    look(norm(s.angular_velocity) * largest_factor(s.factor),
         [&s] { return "the support of group \"" + s.group + '"'; });
  for (const WallDrive& w : stage.walls)
    look(norm(w.angular_velocity) * largest_factor(w.factor), [&w] { return "wall \"" + w.wall + '"'; });
  return fastest;
}

}  // namespace vbond
