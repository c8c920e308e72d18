// What ends a run: capsules and bonds that cannot go on, loads that are not finite, and particles that are
// lost.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/state.hpp"

namespace vbond {
namespace {

std::string name_of(ParticleId p) {
  return "particle " + std::to_string(p.value);
}

}  // namespace

void Simulation::tell_of_lost() {
  const std::vector<LostParticle> lost = std::exchange(lost_particles_, {});
  throw ParticlesLost(Diverged(state_.clock.step, state_.clock.time(), name_of(lost.front().p),
                               lost.front().why, gentler_contact),
                      lost);
}

/// The run ends if capsules have passed through each other: their contact would push them on.
void Simulation::look_at_capsules() const {
  if (!capsules_.passed()) return;
  const DeepCapsules& p = *capsules_.passed();
  diverge(p.i.value, p.first + " and " + p.second,
          "the axes of their capsules have passed through one another", gentler_contact);
}

void Simulation::look_at_deep_contacts() {
  for (std::size_t b = 0; b < books_.size(); ++b)
    if (books_[b].deep) {
      encounters_.add_deep(bodies_,
                           contacts_.deep_pairs(particles_of(all_known().block(b)), bodies_.poses()));
    }
}

/// Throws for the first bond whose own force is not finite, or else the first particle.
void Simulation::check_finite() const {
  const auto is_sound = [](const LoadRow& load) { return is_finite(load.F) && is_finite(load.M); };
  const auto first = bodies_.load.begin();
  if (std::all_of(first, first + static_cast<std::ptrdiff_t>(bodies_.order.own), is_sound)) return;
  for (const ParticleId p : bodies_.order.row.ids()) {
    const LoadRow& load = bodies_.load[bodies_.order.row[p].value];
    if (!bodies_.order.has(p) || is_sound(load)) continue;
    if (bonds_.remembers()) bonds_.collect(state_.bond_history);
    for (const BondIndex::Entry e : bond_index_.of(p)) {
      const std::optional<BondId> k = part_bonds_.find(e.bond);
      if (!k || !bodies_.order.has(state_.bonds[*k].i)) continue;
      const Bond& b = state_.bonds[*k];
      const std::string bond = "bond " + std::to_string(e.bond.value) + " (particles " +
                               std::to_string(b.i.value) + ", " + std::to_string(b.j.value) + ")";
      if (b.law->remembers() && has_lost_its_flow(state_.bond_history[*k]))
        return diverge(p.value, bond,
                       "its flow does not bring its loads to their limits, which they are far beyond",
                       "reduce time.step (or time.fraction), or load more slowly");
      if (b.rules->stretch.form == StretchForm::fene && past_largest(b))
        return diverge(
            p.value, bond, "it is stretched past its largest elongation (fene), where its force has no limit",
            "reduce time.step (or time.fraction), pull more slowly, or give a larger stretching.largest");
    }
    return diverge(p.value, "particle " + std::to_string(p.value),
                   "its force or moment is not a finite number",
                   "reduce time.step (or time.fraction); look at the last frame for bonds that closed up");
  }
}

bool Simulation::past_largest(const Bond& b) const {
  const BondAxis<double> axis = bond_axis(b, bodies_.bond_pose(b));
  return !(std::abs(axis.D - b.a) < b.rules->stretch.largest);
}

}  // namespace vbond
