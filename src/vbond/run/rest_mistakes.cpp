#include "vbond/run/rest_mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "vbond/model/capsules.hpp"
#include "vbond/model/two_slopes.hpp"

namespace vbond {
namespace {

bool has_capsules(const Model& model, const State& state, bool now) {
  if (!any_capsules(model.contact, state.bonds)) return false;
  return now || std::any_of(state.bonds.begin(), state.bonds.end(),
                            [](const Bond& b) { return capsule_of(b) > 0.0 && !can_break(b); });
}

/// Whether supports leave a translation of a particle free. Of those that are rigid or turned they hold all.
bool may_move(const std::vector<Support>& supports, ParticleId p) {
  std::array<bool, 3> held{};
  for (const Support& s : supports) {
    if (std::find(s.particles.begin(), s.particles.end(), p) == s.particles.end()) continue;
    for (std::size_t k = 0; k < 3; ++k) held[k] |= s.rigid || s.axes || s.held[k];
  }
  return !(held[0] && held[1] && held[2]);
}

/// Nothing strains the body before modes are looked for.
bool stays_at_rest(const Model& model, const State& state, const StaticStage& stage) {
  if (norm2(stage.gravity) > 0.0 || !stage.loads.empty() || !stage.heating.empty() ||
      !stage.pressures.empty() || model.contact.law != ContactLaw::none)
    return false;
  for (const BondId k : state.bonds.ids())
    if (!state.bonds[k].broken && !is_unstrained(state, k)) return false;
  return true;
}

std::optional<BondId> bond_between_slopes(const Model& model, const State& state, const StaticStage& stage) {
  if (stage.kind != StageKind::modes ||
      std::none_of(state.bonds.begin(), state.bonds.end(), has_two_slopes) ||
      !stays_at_rest(model, state, stage))
    return std::nullopt;
  for (const BondId k : state.bonds.ids())
    if (const Bond& b = state.bonds[k];
        has_two_slopes(b) && (may_move(stage.supports, b.i) || may_move(stage.supports, b.j)))
      return k;
  return std::nullopt;
}

}  // namespace

std::optional<Problem> mistake_at_rest(const Model& model, const State& state, const StaticStage& stage,
                                       bool now, const SourcePlace& place) {
  if (has_capsules(model, state, now))
    return Problem{place, fmt::format("stage \"{}\": bonds touch as capsules", stage.name),
                   "static stages take the contacts of spheres only",
                   "leave capsule_radius out, or bring the body to rest in a stage of dynamics"};
  const auto bond = now ? bond_between_slopes(model, state, stage) : std::nullopt;
  if (!bond) return std::nullopt;
  const Bond& b = state.bonds[*bond];
  return Problem{place,
                 fmt::format("stage \"{}\": modes of a body whose bond {} (particles {}, {}) is at rest, "
                             "where its slopes in tension and compression meet",
                             stage.name, bond->value, b.i.value, b.j.value),
                 "the body has no single stiffness there",
                 "strain it to either side in a stage of equilibrium before, or take one slope"};
}

}  // namespace vbond
