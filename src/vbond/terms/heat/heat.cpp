#include "vbond/terms/heat/heat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace vbond {
namespace {

/// Temperatures between which each particle stays.
struct Temperatures {
  explicit Temperatures(const State& s) : least(s.temperature), largest(least) {
    least.resize(s.r.size()), largest.resize(s.r.size());
  }
  PerParticle<double> least, largest;
};

std::vector<GrowthRange> growth_between(const State& s, const Temperatures& T) {
  std::vector<GrowthRange> all;
  for (const WarmBond& w : s.warm_bonds) {
    const Bond& b = s.bonds[w.bond];
    const double low = w.expansion * 0.5 * (T.least[b.i] + T.least[b.j]),
                 high = w.expansion * 0.5 * (T.largest[b.i] + T.largest[b.j]);
    all.push_back({std::min(low, high), std::max(low, high)});
  }
  return all;
}

}  // namespace

Bond with_growth(const State& s, const WarmBond& w, double growth) {
  Bond b = s.bonds[w.bond];
  const double factor = 1.0 + growth;
  b.a = factor * w.a, b.R_i = factor * w.R_i, b.R_j = factor * w.R_j;
  return b;
}

void take_lengths(State& s) {
  for (const WarmBond& w : s.warm_bonds)
    if (Bond& b = s.bonds[w.bond]; !b.broken) b = with_growth(s, w, growth_of(s, w));
}

double power_of_growth(const Bond& b, const WarmBond& w, const BondPose<double>& pose,
                       const BondHistory& history) {
  const BondAxis<double> axis = bond_axis(b, pose);
  const Vec3d F = b.law->loads(b, pose, history).F;
  return -w.a * dot(F, axis.d) - dot(F, w.R_i * pose.n_i[0] - w.R_j * pose.n_j[0]);
}

std::vector<GrowthRange> growth_in(const State& s, const Stage& stage) {
  Temperatures T(s);
  for (const Heating& h : stage.heating) {
    double least = h.temperature * h.factor(0.0), largest = least;
    for (const TimeFunction::Point& p : h.factor.points)
      if (p.t > 0.0 && p.t <= stage.stops.duration) {
        least = std::min(least, h.temperature * p.factor);
        largest = std::max(largest, h.temperature * p.factor);
      }
    const double last = h.temperature * h.factor(stage.stops.duration);
    for (const ParticleId p : h.particles)
      T.least[p] = std::min(least, last), T.largest[p] = std::max(largest, last);
  }
  return growth_between(s, T);
}

std::vector<GrowthRange> growth_in(const State& s, const StaticStage& stage) {
  Temperatures T(s);
  PerParticle<double> change(s.r.size());
  for (const Heating& h : stage.heating)
    for (const ParticleId p : h.particles) change[p] += h.temperature;
  const double end = stage.kind == StageKind::fracture ? stage.fracture.end : 1.0;
  for (const ParticleId p : change.ids()) {
    T.least[p] += std::min(0.0, end * change[p]);
    T.largest[p] += std::max(0.0, end * change[p]);
  }
  return growth_between(s, T);
}

std::optional<std::string> bond_without_length(const State& s, const std::vector<GrowthRange>& growth) {
  for (std::size_t k = 0; k < growth.size(); ++k) {
    const WarmBond& w = s.warm_bonds[k];
    const Bond& b = s.bonds[w.bond];
    if (!b.broken && !(1.0 + growth[k].least > 0.0))
      return fmt::format(
          "bond {} (particles {}, {}) would have no length left: temperature takes {:.3g} of it",
          w.bond.value, b.i.value, b.j.value, -growth[k].least);
  }
  return std::nullopt;
}

void keep_bonds(State& s, std::size_t n) {
  s.bonds.resize(n);
  std::erase_if(s.warm_bonds, [n](const WarmBond& w) { return w.bond.value >= n; });
}

void HeatTerm::for_extremes(const State& state, const Stage& stage,
                            const std::function<void(const State&)>& visit) {
  if (stage.heating.empty() || state.warm_bonds.empty()) return;
  const std::vector<GrowthRange> growth = growth_in(state, stage);
  for (const auto end : {&GrowthRange::least, &GrowthRange::largest}) {
    State grown = state;
    for (std::size_t k = 0; k < growth.size(); ++k) {
      const WarmBond& w = state.warm_bonds[k];
      if (!state.bonds[w.bond].broken) grown.bonds[w.bond] = with_growth(state, w, growth[k].*end);
    }
    visit(grown);
  }
}

}  // namespace vbond
