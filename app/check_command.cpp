#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "output_size.hpp"
#include "prepare.hpp"
#include "print_contacts.hpp"
#include "remarks.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/dynamics/step_memory.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/contact_bound.hpp"
#include "vbond/model/fibre_rings.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/observe/table_text.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/run.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/times.hpp"

namespace vbond::app {
namespace {

constexpr std::int64_t few_steps = 10;

void print_memory(const Case& c, const Model& model, const State& state, int ranks) {
  const MemoryUse use = memory_use(model, state);
  const double total = use.per_particle * static_cast<double>(model.particles()) +
                       use.per_bond * static_cast<double>(state.bonds.size());
  fmt::print("memory           {}: {:.0f} bytes per particle, {:.0f} per bond; neighbour lists are extra\n",
             bytes_in_units(total), use.per_particle, use.per_bond);
  if (ranks == 0) return;
  const RanksKeep keep = ranks_keep(c);
  fmt::print(
      "on {} ranks       {} each: {} (docs/ranks.md)\n", ranks,
      bytes_in_units(memory_of_each_rank(model, state, static_cast<double>(state.bonds.size()), ranks, keep)),
      keep == RanksKeep::all_bonds ? "each has the whole body until a stage begins"
                                   : "each makes all particles, and steps its own");
}

/// Bonds that may be made in the run, which no memory is told for above.
void print_bonds_to_come(const Case& c, const Run& run) {
  const double of_a_bond = memory_use(run.model(), run.current()).per_bond;
  const char* unit = run.model().units == UnitSystem::si ? " m" : "";
  for (const BondsToCome& b : bonds_to_come(c, run))
    fmt::print("bonds to come    \"{}\": {:.0f} pairs are within {:.6g}{} now, {}; all {:.0f} would be {}\n",
               printable(b.name), b.pairs_now, b.distance, unit, bytes_in_units(b.pairs_now * of_a_bond),
               b.pairs_ever, bytes_in_units(b.pairs_ever * of_a_bond));
}

/// The stage needs a factor that does not fit.
bool will_be_refused(const SolverChoice& choice) {
  return choice.direct ? std::isinf(choice.factor_bytes) : !choice.multigrid;
}

bool any_later_static(const Stages& stages) {
  for (std::size_t k = 1; k < stages.size(); ++k)
    if (is_static(stages.kind(k))) return true;
  return false;
}

std::string solver_in_words(const StaticStage& stage, const SolverChoice& choice) {
  const std::string factor = bytes_in_units(choice.factor_bytes);
  if (will_be_refused(choice))
    return fmt::format("none: stage {} will be refused, its factor of {} does not fit", stage.name, factor);
  if (choice.direct)
    return fmt::format(
        "direct, with a factor of {} in stage {}{}", factor, stage.name,
        choice.quicker_by_multigrid ? "; multigrid is much quicker here: vbond-petsc, docs/install.md" : "");
  if (choice.multigrid && choice.factor_bytes > 0.0)
    return fmt::format("multigrid: a factor would take {} in stage {}", factor, stage.name);
  return "multigrid";
}

/// Wall time of one step, measured on the case itself for a quarter of a second, or the steps of the stage.
/// Throws Diverged.
double seconds_per_step(const Run& run, const Stage& stage, int threads) {
  using WallClock = std::chrono::steady_clock;
  constexpr double long_time = 1e300;
  Stage endless = stage;
  endless.insist = true;  // known to be what its author wants
  endless.stops.duration = long_time;
  endless.stops.distance.reset();
  endless.stops.breaks.reset();
  if (endless.stops.peak)
    endless.stops.peak->average_over = long_time;  // what they look at is part of a step
  if (endless.stops.rest) endless.stops.rest->during = long_time;
  const double duration = stage.stops.duration;
  const std::int64_t most =
      duration < 10000 * stage.dt ? std::max<std::int64_t>(1, steps_in(duration, stage.dt) - 1) : 10000;
  Run trial(run.model(), run.current(), {endless}, threads);
  trial.step();  // neighbour lists and threads are set up
  const auto start = WallClock::now();
  double seconds = 0.0;
  std::int64_t steps = 0;
  while (seconds < 0.25 && steps < most) {
    steps += trial.step();
    seconds = std::chrono::duration<double>(WallClock::now() - start).count();
  }
  return seconds / static_cast<double>(steps);
}

/// The stiffness of the bonds while particles follow the cell is what a servo of the cell must allow for.
void print_cell(const Model& model, const State& state) {
  const bool si = model.units == UnitSystem::si;
  std::string along;
  for (std::size_t k = 0; k < 3; ++k)
    if (model.cell.periodic[k]) along += (along.empty() ? "" : ", ") + std::string(1, "abc"[k]);
  const double V = volume(state.cell), m = std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
  fmt::print("cell             repeats along {}; volume {:.6g}{}, density {:.6g}{}\n", along, V,
             si ? " m^3" : "", m / V, si ? " kg/m^3" : "");
  if (!state.bonds.empty())
    fmt::print("                 stiffness of its bonds while particles follow the cell: at most {:.4g}{}\n",
               affine_modulus(model.cell, state), si ? " Pa" : "");
}

/// What a wrong unit or a misplaced specimen would show in first.
void print_body(const Model& model, const State& state) {
  const bool si = model.units == UnitSystem::si;
  const char *metre = si ? " m" : "", *kilogram = si ? " kg" : "";
  if (model.particles() == 0) return;
  const BoundingBox box = box_around(state.r);
  fmt::print("extent           x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}{} (centres)\n",
             box.low.x, box.high.x, box.low.y, box.high.y, box.low.z, box.high.z, metre);
  fmt::print("total mass       {:.6g}{}\n", std::accumulate(model.mass.begin(), model.mass.end(), 0.0),
             kilogram);
  const auto tops = std::count_if(model.principal.begin(), model.principal.end(),
                                  [](const PrincipalInertia& I) { return !all_equal(I.moments); });
  if (tops > 0)
    fmt::print("inertia          {} of {} particles have unequal moments\n", tops, model.particles());
  if (model.cell.any()) print_cell(model, state);
  if (state.bonds.empty()) return;
  const auto [shortest, longest] =
      std::minmax_element(state.bonds.begin(), state.bonds.end(),
                          [](const Bond& one, const Bond& other) { return one.a < other.a; });
  fmt::print("bond lengths     {:.6g} to {:.6g}{}\n", shortest->a, longest->a, metre);
}

/// What the bonds of each set break by, and what compression does to them.
void print_strengths(const Case& c) {
  using enum Criterion;
  const auto words = [](Criterion criterion) -> const char* {
    switch (criterion) {
      case none: return "";
      case stress: return "stresses of the section, moments at the middle of the bond";
      case fibre: return "the stress of the outermost fibre, larger moment of the two ends";
      case mohr_coulomb: return "Mohr-Coulomb's shear stress with a tension cut-off";
      case linear: return "the sum of loads over their limits";
      case quadratic: return "the sum of squares of loads over their limits";
      case energy: return "elastic energies";
      case elongation: return "elongation";
    }
    return "";
  };
  for (const BondSpec& set : c.bonds) {
    const Strength& s = set.recipe.rules.strength;
    if (s.criterion == none) continue;
    const char* compression = s.criterion == mohr_coulomb ? "compression adds to the shear strength"
                              : s.signed_axial > 0.0      ? "compression relieves, and can hide shear"
                              : s.compression > 0.0       ? "compression has a strength of its own"
                                                          : "compression alone breaks nothing";
    fmt::print("strength         bonds \"{}\" break by {}; {}\n", printable(set.name), words(s.criterion),
               compression);
  }
}

/// Overlaps that the case starts with: their energy flies the body apart if they were not meant.
void print_overlaps(const Model& model, const State& state) {
  double U = 0.0;
  std::int64_t pairs = 0;
  for_touching_pairs(model, state, [&](ParticleId i, ParticleId j, const Image&, double overlap) {
    const double R = model.radius[i] * model.radius[j] / (model.radius[i] + model.radius[j]);
    U += normal_energy(touch_forms(model.contact), touch_numbers(model, i, j), R, overlap);
    ++pairs;
  });
  for (const FibreContact& contact : fibre_contacts(model, state)) pairs += contact.body ? 1 : 0;
  U += fibre_energy(model, state);
  if (pairs > 0)
    fmt::print("contact energy   at the start {:.6g}{} from {} overlapping pairs\n", U,
               model.units == UnitSystem::si ? " J" : "", pairs);
  if (const auto ring = ring_of_contact(model, state))
    fmt::print(
        "note             {} and {} touch all along a closed way, as fibres do that have no ends: such a "
        "contact is not felt, see docs/contacts.md\n",
        ring->first, ring->second);
}

/// Degrees of freedom that a static stage leaves free.
std::int64_t unknowns_of(const StageSpec& stage, const Model& model) {
  std::vector<Support> supports;
  for (const SupportSpec& s : stage.supports) {
    const HeldDirections d = directions_of(s);
    Support& support = supports.emplace_back();
    support.particles = resolve_groups({s.group}, model).front().particles;
    support.held = d.held, support.axes = d.axes;
    support.rigid = s.rigid, support.pivot = s.pivot;
  }
  auto free = 6 * static_cast<std::int64_t>(model.particles());
  for (const Hold& h : holds_of(supports))
    if (!is_free_grip(supports[h.support])) free -= std::count(h.held.begin(), h.held.end(), true);
  for (const Support& s : supports)
    if (is_free_grip(s) && !s.particles.empty())
      free -= 6 * (std::ssize(s.particles) - 1) + std::count(s.held.begin(), s.held.end(), true);
  return free;
}

/// Steps of each stage, as the body stands and as it might come to be.
struct StepsOfStages {
  std::vector<std::int64_t> now, crowded;
};

/// Where particles come to touch on all sides, stages after the first take shorter steps.
StepsOfStages expected_steps(const Case& c, const Run& run, double dt) {
  const Model& model = run.model();
  std::vector<StepAhead> ahead = steps_ahead(c, run);
  StepsOfStages steps{steps_of_stages(c, model, ahead, run.stage_index(), dt), {}};
  if (!c.time.given() && model.contact.law != ContactLaw::none) {
    const double crowded = c.time.fraction * step_bound(model, run.current(), {}, {}, contacts_in_a_heap).dt;
    for (StepAhead& a : ahead) a.longest = std::min(a.longest, crowded);
  }
  steps.crowded = steps_of_stages(c, model, ahead, run.stage_index(), dt);
  return steps;
}

/// Each stage with its size.
void print_stages(const Case& c, const Run& run, const StepsOfStages& of, double dt, bool dt_is_known) {
  const Model& model = run.model();
  const std::vector<std::int64_t>& steps = of.now;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const StageSpec& stage = c.stages[k];
    if (is_static(stage.kind))
      fmt::print("stage {:<10} {}, {} unknowns\n", printable(stage.name), to_text(stage.kind),
                 unknowns_of(stage, model));
    else
      fmt::print("stage {:<10} at most {}{} steps{}{}\n", printable(stage.name),
                 dt_is_known && (k == run.stage_index() || c.time.given()) ? "" : "about ", steps[k],
                 of.crowded[k] > steps[k]
                     ? fmt::format(", about {} if particles come to touch on all sides", of.crowded[k])
                     : "",
                 steps[k] < few_steps ? ": so few; is a unit missing, such as T0?" : "");
    if (k > 0 && !is_static(stage.kind) && c.time.given())  // of the first stage it is told with its step
      print_notes(times_not_met(expected_times(stage, model, dt)));
  }
}

/// A load is given for each particle, and easily taken for that on the group.
void print_loads(const Case& c, const Model& model) {
  const bool si = model.units == UnitSystem::si;
  for (const StageSpec& stage : c.stages)
    for (const LoadSpec& load : stage.loads) {
      const std::size_t n = resolve_groups({load.group}, model).front().particles.size();
      const auto print = [&](const char* what, double each, const char* unit) {
        if (n > 1 && each > 0.0)
          fmt::print(
              "load             stage {}: {} of {:.6g}{} on each of {} particles of {}, total {:.6g}{}\n",
              stage.name, what, each, si ? unit : "", n, load.group.value, static_cast<double>(n) * each,
              si ? unit : "");
      };
      print("force", norm(load.force), " N");
      print("moment", norm(load.moment), " N*m");
      const auto print_total = [&](const char* what, double total, const char* unit) {
        if (total > 0.0)
          fmt::print("load             stage {}: {} of {:.6g}{} on {}, shared by mass by its {} particles\n",
                     stage.name, what, total, si ? unit : "", load.group.value, n);
      };
      print_total("force", norm(load.total_force), " N");
      print_total("moment", norm(load.total_moment), " N*m");
    }
}

/// Intervals of output that no stage lasts for: mostly a time without its unit.
void print_output_remarks(const Case& c, const OutputPlan& plan, const Model& model) {
  double total = 0.0;
  for (const StageSpec& s : c.stages)
    if (!is_static(s.kind)) total += s.duration.resolve(model.T_0);
  if (total == 0.0) return;
  const char* unit = model.units == UnitSystem::si ? " s" : "";
  const auto look = [&](const char* key, double every) {
    if (std::isfinite(every) && every > total)
      fmt::print(
          "output           {} = {:.6g}{} is longer than the run, {:.6g}{}: is a unit missing, such as T0?\n",
          key, every, unit, total, unit);
  };
  look("history.every", plan.history_every);
  if (plan.frames_every) look("frames.every", *plan.frames_every);
  if (plan.checkpoint_every) look("checkpoint.every", *plan.checkpoint_every);
}

/// How the first stage is solved if it is static, and which later ones will be refused, as far as their bonds
/// are known.
void print_solvers(Run& run) {
  const auto print = [](const StaticStage& stage, const SolverChoice& choice) {
    fmt::print("solver           {}\n", solver_in_words(stage, choice));
  };
  if (const auto* first = std::get_if<StaticStage>(&run.prepare()))
    print(*first, solver_of(run.model(), *first, run.current()));
  if (!any_later_static(run.stages())) return;
  Outlook outlook = run.outlook();
  for (std::size_t k = 1; k < run.stages().size(); ++k) {
    const AnyStage stage = run.stages().look_ahead(k, run.model(), outlook);
    const auto* later = std::get_if<StaticStage>(&stage);
    if (!later || !outlook.pairs_known) continue;
    const SolverChoice choice = solver_of(run.model(), *later, outlook.state());
    if (will_be_refused(choice)) print(*later, choice);
  }
}

/// Everything that `run` would refuse, as mistakes of the case.
void refuse_all(Run& run) {
  std::vector<Problem> problems;
  for (const StageRefusal& r : run.refusals()) problems.push_back(r.problem);
  if (!problems.empty()) throw CaseError(problems);
}

void print_wall_time(const StepsOfStages& steps, const Run& run, const Stage& first, int threads) {
  const auto sum = [](const std::vector<std::int64_t>& of) {
    return std::accumulate(of.begin(), of.end(), 0.0);
  };
  try {
    const double each = seconds_per_step(run, first, threads), now = sum(steps.now),
                 crowded = sum(steps.crowded);
    fmt::print(
        "wall time        about {}{} without output, if no stage ends early (a few steps were timed)\n",
        hours(now * each),
        crowded > now ? ", or " + hours(crowded * each) + " and more if particles come to touch on all sides,"
                      : "");
  } catch (const Diverged& e) {  // the case is as its author wants it: whether to run it is not for us to say
    const std::string what = e.what();  // its second line is advice for a run: there are no frames to look at
    fmt::print("wall time        unknown, the trial for it went unphysical at {}\n",
               what.substr(0, what.find('\n')));
  }
}

}  // namespace

int check(const RunOptions& options) {
  const Case c = read_case(options.case_file, options.changes);
  const int threads = options.threads;
  require_statics(c);
  require_memory(c);
  Built built = build(c, threads);
  require_memory(c, built.model, built.state);
  Run run(std::move(built.model), std::move(built.state), stages_of(c, threads), threads);
  refuse_all(run);
  const Model& model = run.model();
  const AnyStage& first = run.prepare();
  const State& state = run.current();
  const auto* dynamics = std::get_if<Stage>(&first);
  const OutputPlan plan = plan_output(c, model, {});
  print_overview(c, model, state);
  print_contact_law(model);
  print_capsules(c, model);
  print_walls(c, model);
  print_notes(built.notes);
  if (dynamics) print_step(c, model, state, *dynamics);
  print_machine(c, threads);
  print_body(model, state);
  if (const std::string bodies = bodies_in_words(model, state); !bodies.empty())
    fmt::print("separate bodies  {}\n", bodies);
  print_notes(remarks(c, model, state));
  print_notes(run.notes_on_stage());
  print_overlaps(model, state);
  print_strengths(c);

  const bool fitted = dynamics && !c.time.given();  // other stages may have another step of their own
  const double dt = fitted ? dynamics->dt : expected_step(c, model, state);
  const StepsOfStages steps = expected_steps(c, run, dt);
  print_stages(c, run, steps, dt, dynamics || c.time.given());
  const std::optional<Stage> motion = dynamics ? *dynamics : print_step_ahead(c, run, dt);
  print_loads(c, model);
  print_output_remarks(c, plan, model);
  print_output_size(c, plan, model, state, steps.now);
  print_memory(c, model, state, options.ranks);
  print_bonds_to_come(c, run);
  print_solvers(run);
  if (motion) print_wall_time(steps, run, *motion, threads);
  fmt::print("{}: no mistakes found\n", printable(c.file));
  return done;
}

}  // namespace vbond::app
