#include "vbond/report/stage_holds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vbond::page {
namespace {

float clamped_float(double x) {
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -most, most));
}

const IdList<ParticleId>& particles_of(const Placed<std::string>& group, const Model& model) {
  static const IdList<ParticleId> none;
  const Group* found = model.find_group(group.value);
  return found != nullptr ? found->particles : none;
}

/// The degree of freedom of the world that this one is nearest to: the page knows no others.
std::size_t nearest_of_world(const HeldDirections& d, std::size_t dof) {
  const Vec3d& a = axis_of(d.axes ? &*d.axes : nullptr, dof);
  const double x = std::abs(a.x), y = std::abs(a.y), z = std::abs(a.z);
  return (dof < 3 ? 0 : 3) + (x >= y && x >= z ? 0u : y >= z ? 1u : 2u);
}

void add_held(const StageSpec& stage, const Model& model, StageHolds& holds) {
  std::vector<std::uint32_t> how(model.particles());
  for (const SupportSpec& s : stage.supports) {
    const HeldDirections d = directions_of(s);
    for (const ParticleId p : particles_of(s.group, model))
      for (std::size_t dof = 0; dof < d.held.size(); ++dof)
        if (d.held[dof]) how[p.value] |= std::uint32_t{1} << nearest_of_world(d, dof);
  }
  for (std::size_t p = 0; p < how.size(); ++p)
    if (how[p] != 0) {
      holds.held.push_back(static_cast<std::uint32_t>(p));
      holds.how.push_back(how[p]);
    }
}

void add_loads(const StageSpec& stage, const Model& model, StageHolds& holds) {
  std::vector<Vec3d> force(model.particles()), moment(model.particles());
  for (const LoadSpec& l : stage.loads) {
    const IdList<ParticleId>& group = particles_of(l.group, model);
    double mass = 0.0;
    for (const ParticleId p : group) mass += model.mass[p];
    for (const ParticleId p : group) {
      const double part = model.mass[p] / mass;
      force[p.value] += l.force + part * l.total_force;
      moment[p.value] += l.moment + part * l.total_moment;
    }
  }
  for (std::size_t p = 0; p < force.size(); ++p) {
    const auto& F = force[p];
    const auto& M = moment[p];
    if (F == Vec3d{} && M == Vec3d{}) continue;
    holds.loaded.push_back(static_cast<std::uint32_t>(p));
    for (const double x : {F.x, F.y, F.z, M.x, M.y, M.z}) holds.loads.push_back(clamped_float(x));
  }
}

}  // namespace

std::vector<StageHolds> holds_of(const Case& c, const Model& model) {
  std::vector<StageHolds> all;
  for (const StageSpec& stage : c.stages) {
    StageHolds holds{.name = stage.name, .held = {}, .how = {}, .loaded = {}, .loads = {}};
    add_held(stage, model, holds);
    add_loads(stage, model, holds);
    if (!holds.held.empty() || !holds.loaded.empty()) all.push_back(std::move(holds));
  }
  return all;
}

}  // namespace vbond::page
