// What ends a run: walls, capsules and bonds that cannot go on, and loads that are not finite.
#include <fmt/format.h>

#include <string>

#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What walls have done in the step. The run ends if it cannot go on with them.
void Simulation::close_walls(double dt) {
  const double work = walls_.close(dt);
  if (leads()) state_.books.work_supports += work;  // all parts know of it
  const auto found = walls_.fault();
  if (!found) return;
  const std::string particle = "particle " + std::to_string(found->p.value),
                    wall = "wall \"" + model_.walls[found->wall].name + '"';
  const auto stop = [&](const std::string& who, const std::string& what, const std::string& way_out) {
    diverge(found->p.value, who, what, way_out);
  };
  switch (found->fault) {
    case Walls::Fault::passed:
      stop(particle, "its centre has passed through " + wall,
           "use a stiffer contact, lower velocities and loads, or a smaller time.step");
      break;
    case Walls::Fault::fast:
      stop(particle,
           fmt::format("it moves by {:.3g} of its radius in a step near {}, which it could pass unseen",
                       found->is / found->limit, wall),
           fmt::format("use a time.step below {:.3g}, or lower velocities", dt * found->limit / found->is));
      break;
    case Walls::Fault::too_wide:
      stop(particle, "it is not smaller than the hollow " + wall + " that it touches",
           "use a larger radius of the wall, or keep the particle out of it");
      break;
    case Walls::Fault::light:
      stop(wall,
           fmt::format("its servo has the mass {:.4g}: too little for the time step and what it touches",
                       found->is),
           fmt::format("give it at least {:.3g}, better four times that, or a smaller time.step",
                       found->limit));
      break;
  }
}

/// The run ends if capsules have passed through each other: their contact would push them on.
void Simulation::look_at_capsules() const {
  if (!capsules_.passed()) return;
  const DeepCapsules& p = *capsules_.passed();
  diverge(p.i.value, p.first + " and " + p.second,
          "the axes of their capsules have passed through one another",
          "use a stiffer contact, lower velocities and loads, or a smaller time.step");
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
  for (const ParticleId p : bodies_.order.row.ids()) {
    const LoadRow& load = bodies_.load[bodies_.order.row[p].value];
    if (!bodies_.order.has(p) || (is_finite(load.F) && is_finite(load.M))) continue;
    if (bonds_.remembers()) bonds_.collect(state_.bond_history);
    for (const BondIndex::Entry& e : bond_index_.of(p)) {
      const Bond& b = state_.bonds[e.bond];
      if (!bodies_.order.has(b.i)) continue;
      const std::string bond = "bond " + std::to_string(e.bond.value) + " (particles " +
                               std::to_string(b.i.value) + ", " + std::to_string(b.j.value) + ")";
      if (b.law->remembers() && has_lost_its_flow(state_.bond_history[e.bond]))
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
  const PoseRow &i = pose_of(b.i), &j = pose_of(b.j);
  const BondAxis<double> axis = bond_axis(bond_pose(b, i.r, i.q, j.r, j.q), b.R_i, b.R_j);
  return !(std::abs(axis.D - b.a) < b.rules->stretch.largest);
}

}  // namespace vbond
