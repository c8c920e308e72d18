#include "vbond/statics/statics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/rigid_bodies.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {
namespace {

StaticOutcome run_kind(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
                       const FractureUnderWay* then) {
  switch (stage.kind) {
    case StageKind::dynamics: break;
    case StageKind::equilibrium: return find_equilibrium(model, stage, std::move(state), hooks);
    case StageKind::path: return follow_path(model, stage, std::move(state), hooks);
    case StageKind::buckling: return find_critical_loads(model, stage, std::move(state), hooks);
    case StageKind::modes: return find_modes(model, stage, std::move(state), hooks);
    case StageKind::fracture: return break_at_rest(model, stage, std::move(state), hooks, then);
  }
  throw std::invalid_argument("run_static_stage: a dynamic stage is run by a Simulation");
}

/// Loads that depend on the way there in a manner that statics does not know have no balance that follows
/// from positions. Bonds that yield, soften or rub do, by increments; a path does not go by increments, and a
/// critical load is one of a potential. Creep takes time, of which a balance has none: it stays as it is.
void refuse_bonds_that_remember(const StaticStage& stage, const State& state) {
  for (const BondId k : state.bonds.ids()) {
    const Bond& b = state.bonds[k];
    if (b.broken || !b.law->remembers()) continue;
    const std::string bond = fmt::format("bond {} (particles {}, {})", k.value, b.i.value, b.j.value);
    if (!b.law->has_rules)
      throw NoEquilibrium(
          stage.name,
          fmt::format("{} is of the law \"{}\", which remembers its past: its loads have no potential", bond,
                      b.law->name),
          "bring the body to rest in a stage of dynamics, with damping");
    if (b.law->crack != nullptr && b.rules->rubbing.friction == 0.0)
      throw NoEquilibrium(
          stage.name,
          fmt::format("{} has no friction once it has cracked: its grains slide freely then, and "
                      "no balance could be told from none",
                      bond),
          "use friction > 0, or a stage of dynamics");
    if (yields_or_softens(b) && (stage.kind == StageKind::path || stage.kind == StageKind::buckling))
      throw NoEquilibrium(stage.name,
                          fmt::format("{} {}: a {} goes back and forth, which such a bond does not", bond,
                                      is_cracked(b) ? "has cracked and rubs" : "yields or softens",
                                      stage.kind == StageKind::path ? "path" : "search for critical loads"),
                          "kind = \"equilibrium\" and \"fracture\" take such bonds, load step by load step");
  }
}

/// What bonds and contacts do in motion, and not at rest.
void tell_what_rests(const Model& model, const StaticStage& stage, const State& state,
                     const StaticHooks& hooks) {
  const auto creeping = std::count_if(state.bonds.begin(), state.bonds.end(),
                                      [](const Bond& b) { return !b.broken && creeps(b); });
  if (creeping > 0)
    tell(stage, hooks,
         fmt::format("a balance takes no time: {} bonds that creep keep the length that they have crept to",
                     creeping));
  if (has_friction(model.contact))
    tell(stage, hooks,
         fmt::format("contacts have no friction and no resistance to rolling at rest; what {} touches had of "
                     "them fades as the load factor grows",
                     state.contact_history.size() + state.wall_history.size()));
}

/// Particles of which supports hold one rotation of three. That is a rule on how a particle turns, and none
/// on where it may be: it has no balance apart from the way there, of which load steps are chords.
class HeldAboutOneAxis {
 public:
  HeldAboutOneAxis(const Model& model, const StaticStage& stage, const State& state) {
    PerParticle<std::ptrdiff_t> held(model.particles());
    for (const Support& s : stage.supports)
      for (const ParticleId p : s.particles)
        held[p] += s.rigid ? 3 : std::count(s.held.begin() + 3, s.held.end(), true);
    for (const Support& s : stage.supports)
      for (const ParticleId p : s.particles)
        if (held[p] == 1) at_start_.push_back({s.group, p, state.q[p]});
  }
  std::vector<Quatd> at_start() const {
    std::vector<Quatd> turned;
    for (const Held& h : at_start_) turned.push_back(h.turned);
    return turned;
  }
  /// Of a stage that goes on: as it began.
  void set_start(const std::vector<Quatd>& turned) {
    for (std::size_t k = 0; k < std::min(turned.size(), at_start_.size()); ++k)
      at_start_[k].turned = turned[k];
  }
  /// Once the stage has ended: the error of its steps is of the second order in how far they turn.
  void tell_of_steps(const StaticStage& stage, const State& end, const StaticHooks& hooks) const {
    constexpr double far = 1e-3;  // of 1: an error in the sixth digit
    for (const Held& h : at_start_) {
      if (!(norm(rotation_vector(end.q[h.particle] * conjugate(h.turned))) > far)) continue;
      return tell(
          stage, hooks,
          fmt::format("particle {} of \"{}\" is held about one axis and has turned about the others: its "
                      "balance depends on the way there, and so on the load steps; with twice as many its "
                      "distance from that of loads that grow without steps falls to a quarter",
                      h.particle.value, h.group));
    }
  }

 private:
  struct Held {
    std::string group;
    ParticleId particle;
    Quatd turned;
  };
  std::vector<Held> at_start_;
};

/// Turns that are no unknowns have the eigenvalue zero all the same.
void count_free_turns(const StaticStage& stage, StaticResult& r) {
  if (r.free_turns == 0) return;
  if (r.smallest_eigenvalue) r.smallest_eigenvalue = std::min(*r.smallest_eigenvalue, 0.0);
  if (stage.kind == StageKind::equilibrium && r.unstable == 0) r.neutral = true;
}

void refuse_contacts(const Model& model, const StaticStage& stage, const State& state) {
  if (any_capsules(model.contact, state.bonds))
    throw NoEquilibrium(stage.name,
                        "bonds touch as capsules: static stages take the contacts of spheres only",
                        "leave capsule_radius out, or bring the body to rest in a stage of dynamics");
  const std::string beyond = key_without_balance(model.contact);
  if (beyond.empty()) return;
  throw NoEquilibrium(stage.name,
                      fmt::format("contacts do more than repel along the normal, {}: {}", beyond,
                                  "what that adds depends on the way by which an equilibrium is reached"),
                      "leave adhesion and overlap_at_break out of [contact] for static stages, or bring the "
                      "body to rest in a stage of dynamics");
}

void refuse_bonds_without_length(const StaticStage& stage, const State& state) {
  if (const auto bond = bond_without_length(state, growth_in(state, stage)))
    throw NoEquilibrium(
        stage.name, *bond + ", with what earlier stages have left",
        "changes of temperature add up from stage to stage: look for a missing power of ten, or "
        "a change that should go back");
}

/// Before anything is worked out: at load factor 0 only constant pressures are there. Placements that come
/// later are looked at as they are found.
void refuse_pressure_without_energy(const Model& model, const StaticStage& stage, const State& state) {
  if (!stage.pressures.empty() && (stage.kind == StageKind::buckling || stage.kind == StageKind::fracture))
    refuse_pressure_without_energy(StaticBody(model, stage, state, 1.0));
}

}  // namespace

StaticOutcome run_static_stage(const Model& model, const StaticStage& stage, State state,
                               const StaticHooks& hooks, const FractureUnderWay* then) {
  require_consistent("run_static_stage", model, stage, state);
  const OneBlasThread alone;
  const Pulse pulse(stage, hooks);
  StaticOutcome until_then{{}, state};  // for a stage that ends within an eigenvalue search
  StaticHooks keeping = hooks;
  keeping.point = [&](const StaticPoint& p) {
    ++until_then.result.points;
    until_then.result.load_factor = p.load_factor;
    until_then.state = p.state;
    if (hooks.point) hooks.point(p);
  };
  try {
    if (!then) {
      begin_anew(state, Anew::any_stage);
      take_hold(model, stage.supports, state);
      Terms::for_each([&]<class T>(T) { T::begin_at_rest(stage, state); });
      refuse_bonds_that_remember(stage, state);
      refuse_contacts(model, stage, state);
      refuse_bonds_without_length(stage, state);
      refuse_pressure_without_energy(model, stage, state);
      tell_what_rests(model, stage, state, hooks);
    }
    HeldAboutOneAxis one_axis(model, stage, state);
    if (then) one_axis.set_start(then->turned_at_start);
    const bool floats = model.cell.any() && stage.kind != StageKind::modes;
    const StaticStage held = then     ? with_held(stage, then->held)
                             : floats ? with_floating_held(model, stage, state, hooks)
                                      : stage;
    if (hooks.under_way)
      keeping.under_way = [&](FractureUnderWay now) {
        now.turned_at_start = one_axis.at_start();
        hooks.under_way(std::move(now));
      };
    StaticOutcome outcome = run_kind(model, held, std::move(state), keeping, then);
    one_axis.tell_of_steps(stage, outcome.state, hooks);
    count_free_turns(stage, outcome.result);
    return outcome;
  } catch (const NoEquilibrium&) {
    throw;
  } catch (const Interrupted&) {
    return interrupted_outcome(std::move(until_then.result), std::move(until_then.state));
  } catch (...) {
    throw current_failure(stage);
  }
}

void refuse_free_bodies(const Model& model, const StaticStage& stage, const State& state) {
  require_consistent("refuse_free_bodies", model, stage, state);
  refuse_bonds_that_remember(stage, state);
  refuse_contacts(model, stage, state);
  refuse_bonds_without_length(stage, state);
  const bool floats = model.cell.any() && stage.kind != StageKind::modes;
  const StaticStage held = floats ? with_floating_held(model, stage, state, {}) : stage;
  const StaticBody body(model, held, state);
  if (stage.kind != StageKind::equilibrium && stage.kind != StageKind::fracture) refuse_nothing_free(body);
  if (stage.kind != StageKind::modes) refuse_rigid_motions(body);
  refuse_pressure_without_energy(model, held, state);
}

SolverChoice choose_solver(const Model& model, const StaticStage& stage, const State& state) {
  require_consistent("choose_solver", model, stage, state);
  const StaticBody body(model, stage, state);
  TangentSolver solver(stage.newton.solver);
  const TangentSolver::Choice choice = solver.choose(body);
  return {choice == TangentSolver::Choice::direct, choice == TangentSolver::Choice::multigrid,
          solver.last_factor().bytes(),
          choice == TangentSolver::Choice::direct && solver.would_be_quicker_by_multigrid(body)};
}

}  // namespace vbond
