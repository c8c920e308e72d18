// A run that goes on without particles that are lost.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/capsules.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/run/run.hpp"

namespace vbond {

/// Goes on as from a checkpoint of the same moment in which these particles were dropped already; returns
/// false, and has done nothing, if that cannot be. As a stage begins nothing has happened yet that it would
/// mend.
bool Run::drop(const ParticlesLost& found) {
  const auto& stage = std::get<Stage>(*stage_);
  if (stage.on_unphysical != OnUnphysical::drop || partition_ != nullptr || clock().stage_step == 0)
    return false;
  State rest = simulation_->state();
  const auto lost = to_be_dropped(stage, found.lost);
  if (!lost || lost->size() == present(rest) || any_capsules(model_.contact, rest.bonds) ||
      !std::isfinite(simulation_->energies().total()))
    return false;
  std::vector<ParticleId> particles;
  for (const auto& [p, why] : *lost) particles.push_back(p);
  const Passage gone{.changed = true, .events = vbond::drop(particles, rest), .any_gone = true, .lost = true};
  auto without = std::make_unique<Simulation>(model_, stage, &rest, threads_);
  without->take_over(*simulation_, gone);
  const double energy = simulation_->energies().total() - without->energies().total();
  simulation_ = std::move(without);
  tell_of_dropped(*lost, gone.events, energy);
  return true;
}

/// The first ones in full, the others at the end of the stage as a number.
void Run::tell_of_dropped(const std::vector<std::pair<ParticleId, std::string>>& lost,
                          const std::vector<BondEvent>& broken, double energy) {
  constexpr std::size_t told_in_full = 10;
  const State& s = simulation_->state();
  std::size_t count = s.dropped.size() - s.taken.size() - lost.size();
  for (std::size_t k = 0; k < lost.size(); ++k) {
    if (++count > told_in_full) {
      ++drops_untold_;
      continue;
    }
    const auto& [p, why] = lost[k];
    const Vec3d& r = s.r[p];
    const auto bonds = std::count_if(broken.begin(), broken.end(),
                                     [p = p](const BondEvent& e) { return e.i == p || e.j == p; });
    if (hooks_.tell)
      hooks_.tell(
          fmt::format("t = {:.6g}: step {}: particle {} is dropped at ({:.6g}, {:.6g}, {:.6g}): {}; "
                      "{} bond{} broke, and {}energy {:.6g} is gone",
                      s.clock.time(), s.clock.step, p.value, r.x, r.y, r.z, why, bonds, bonds == 1 ? "" : "s",
                      lost.size() == 1 ? std::string() : fmt::format("with all {} ", lost.size()), energy));
  }
}

void Run::sum_up_dropped() {
  if (const std::size_t untold = std::exchange(drops_untold_, 0); untold > 0 && hooks_.tell)
    hooks_.tell(fmt::format("{} more particles were dropped: {} in all so far", untold,
                            simulation_->dropped().size() - simulation_->taken().size()));
}

}  // namespace vbond
