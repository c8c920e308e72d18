#include "vbond/statics/detail/followed.hpp"

#include <algorithm>
#include <bit>

namespace vbond {
namespace {

bool any_turns_by_way(const PerParticle<Turns>& turns) {
  return std::any_of(turns.begin(), turns.end(), [](const Turns& t) { return t.by_way; });
}

}  // namespace

PerParticle<Turns> turns_in(const Model& model, const StaticStage& stage) {
  PerParticle<Turns> all(model.particles());
  const auto add = [](Turns& t, unsigned held, bool turned) {
    const int count = std::popcount(held);
    t.by_way = t.by_way || count == 1 || (count == 2 && turned);
    t.about_one = t.about_one || count == 2;
  };
  for (const Support& s : stage.supports) {
    unsigned held = 0;
    for (unsigned k = 0; k < 3; ++k) held |= s.held[3 + k] ? 1u << k : 0u;
    const bool turned = s.angular_velocity != Vec3d{};
    for (const ParticleId p : s.particles)
      if (s.rigid || s.axes)
        add(all[p], held, turned);
      else
        all[p].held |= held, all[p].turned = all[p].turned || turned;
  }
  for (const ParticleId p : all.ids()) add(all[p], all[p].held, all[p].turned);
  return all;
}

std::string cannot_follow(const Model& model, const StaticStage& stage, const State& state) {
  if (stage.kind != StageKind::equilibrium && stage.kind != StageKind::path)
    return "it is neither an equilibrium nor a path";
  if (!stage.heating.empty() || !state.warm_bonds.empty()) return "temperatures change in it";
  if (!stage.walls.empty()) return "walls move in it";
  if (any_turns_by_way(turns_in(model, stage)))
    return "a support holds or turns a part of a rotation, so that balances depend on the way to them";
  if (stage.kind == StageKind::path && stage.cell.any_stress())
    return "its path is that of a cell under stress";
  for (const Bond& b : state.bonds) {
    if (b.law->remembers()) return "its bonds remember their past";
    if (b.broken) return "some of its bonds are broken";
  }
  if (!state.dropped.empty() || !state.waiting.empty()) return "not all particles take part";
  return {};
}

std::string cannot_follow_after(const Model& model, const StaticStage& stage, bool after_path) {
  if (after_path) return "it follows a path, whose end is where it is ended";
  if (model.cell.any()) return "it is a further stage of a periodic body";
  for (const Support& s : stage.supports) {
    if (is_free_grip(s)) return "it is a further stage, with rigid groups that are free in part";
    if (s.angular_velocity != Vec3d{}) return "it is a further stage, with supports that turn";
  }
  return {};
}

}  // namespace vbond
