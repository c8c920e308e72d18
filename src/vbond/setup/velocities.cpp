#include "vbond/setup/velocities.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "vbond/core/random.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/setup/groups.hpp"

namespace vbond {
namespace {

Vec3d draw(const VelocitySpec& spec, Random& random) {
  switch (spec.kind) {
    case VelocityKind::given:
    case VelocityKind::rigid: return spec.velocity;
    case VelocityKind::circle: {
      const Vec3d n = normalised(spec.normal), e_1 = bond_n_2(n, std::nullopt), e_2 = cross(n, e_1);
      const Vec3d p = random.in_disc();
      return spec.magnitude * (p.x * e_1 + p.y * e_2);
    }
    case VelocityKind::ball: return spec.magnitude * random.in_ball();
    case VelocityKind::gaussian: {
      const double x = random.gaussian(), y = random.gaussian(), z = random.gaussian();
      return spec.magnitude * Vec3d{x, y, z};
    }
  }
  return {};
}

Vec3d centre_of_mass(const Group& group, const Model& model, const State& state) {
  double total = 0.0;
  Vec3d sum;
  for (const ParticleId p : group.particles)
    if (!is_waiting(state, p)) total += model.mass[p], sum += model.mass[p] * state.r[p];
  return total > 0.0 ? sum / total : sum;
}

}  // namespace

void add_velocities(const Case& c, const Model& model, State& state, Problems& problems) {
  constexpr std::uint64_t apart = 0x9e3779b97f4a7c15;  // so that entries with one seed draw different numbers
  std::uint64_t entry = 0;
  for (const VelocitySpec& spec : c.velocities) {
    Random random(spec.seed + apart * entry++);
    const Group* group = look_up_group(spec.group, model, problems);
    const bool flat = spec.kind == VelocityKind::circle && !(norm(spec.normal) > 0.0);
    if (flat)
      problems.add(spec.place, "the normal of the circle of velocities is zero",
                   "it says how the circle lies", "use for instance normal = [1, 0, 0]");
    if (group == nullptr || flat) continue;
    const bool rigid = spec.kind == VelocityKind::rigid;
    const Vec3d centre = rigid ? centre_of_mass(*group, model, state) : Vec3d{};
    if (!group->particles.empty() && std::all_of(group->particles.begin(), group->particles.end(),
                                                 [&](ParticleId p) { return is_waiting(state, p); }))
      problems.add(spec.place,
                   fmt::format("velocities of group \"{}\", all of which comes in later", group->name),
                   "bodies come in with the velocities of their source", "give velocity to the source");
    for (const ParticleId p : group->particles) {
      if (is_waiting(state, p)) continue;
      const Vec3d drawn = draw(spec, random);  // whoever has it: the next one draws on
      if (!state.v.holds(p)) continue;
      Vec3d& v = state.v[p];
      v += drawn;
      if (rigid) v += cross(spec.angular_velocity, state.r[p] - centre);
      v = {spec.zero[0] ? 0.0 : v.x, spec.zero[1] ? 0.0 : v.y, spec.zero[2] ? 0.0 : v.z};
      if (rigid || spec.kind == VelocityKind::given) state.omega[p] += spec.angular_velocity;
    }
  }
}

}  // namespace vbond
