#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/specimen_figures.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/packing/pack.hpp"

namespace vbond {

struct KeepOwnBonds;

/// A case turned into numbers: what stays and what changes.
struct Built {
  Model model;
  State state;
  std::vector<std::string> notes;  ///< what is made of the files that the case reads and what not, what cuts
                                   ///< leave, bonds that break at once; a line each
  /// Specimens of packed grains and what they are like; places and radii stand in the model.
  std::vector<std::pair<std::string, packing::Packing>> packings;
  std::vector<SpecimenFigures> figures;  ///< of specimens that are made at random
  /// Where this process keeps its own bonds alone, what it knows of all; else null.
  std::shared_ptr<BondsFromSetUp> own = {};

  /// Keeps references.
  BodyPart body() const { return body_of(state, own); }
};

/// Particles that the case makes itself; those that it reads from files or cuts are not counted.
double count_particles(const Case& c);

/// Particles, groups, the bonds made at the start, initial velocities and T_0; the names and times of
/// all stages and outputs are checked too, so that a run does not find them wrong hours later.
/// Throws CaseError with as many mistakes at once as do not depend on each other. Results do not depend on
/// threads, which packings and Voronoi cells use; 0: as many as the machine runs at once.
Built build(const Case& c, int threads = 0);
/// The same, called by all of these processes together: each keeps its own bonds alone, if the case may be
/// set up so (may_keep_own_bonds).
Built build(const Case& c, int threads, const KeepOwnBonds& processes);

/// The largest stable step of the assembled body in a stage  [time]; infinite if nothing is elastic;
/// throws NoConvergence if it cannot be found.
/// statics/ knows it (exact_critical_step), which this layer does not know.
using ExactCriticalStep = std::function<double(const Model&, const State&, const Stage&)>;

/// Stage k of the case, 0 <= k < stages.size(), of kind dynamics, with names looked up and times in the
/// model's unit. If state.clock.stage_step == 0, makes the stage's bonds (when = stage) in `state` and
/// chooses the step: the given one, or the fraction of step_bound(), or of exact_step() if the case wants it
/// exact, or less where the times of the stage need it (fitting_step). Factors over time bend on steps
/// (on_steps). A stage that is under way keeps state.clock.dt. Throws CaseError, also for a given step above
/// the bound unless the case insists; std::logic_error if the stage is static.
/// own: if the state has own bonds alone.
Stage build_stage(const Case& c, const Model& model, int k, State& state,
                  const ExactCriticalStep& exact_step = {}, int threads = 0,
                  const std::shared_ptr<const BondsFromSetUp>& own = {});

/// The step that a stage of dynamics would have in this state, before it is fitted to the stage's times;
/// infinite if nothing is elastic.  [time]
double expected_step(const Case& c, const Model& model, const BodyPart& body);

/// What dynamics stage k bonds on approach.
std::vector<BondingRule> bonding_rules(const Case& c, const Model& model, std::size_t k);

/// The same as build_stage for a stage of any static kind; the clock of `state` is left alone.
StaticStage build_static_stage(const Case& c, const Model& model, int k, State& state, int threads = 0);

/// The groups of these names. Throws CaseError naming the nearest and all known groups.
std::vector<Group> resolve_groups(const std::vector<Placed<std::string>>& names, const Model& model);
/// The volume that a group of output.history.stress takes up. Throws CaseError.
double resolve_volume(const StressSpec& s, const Model& model);

/// The same, where digits stand for the group of that one particle.
std::vector<Group> resolve_groups_or_particles(const std::vector<Placed<std::string>>& names,
                                               const char* what, const Model& model);

/// A time in the model's unit. Throws CaseError if it is a multiple of T_0 and the model, in SI units
/// and without any bond, has none; `what` names the key.
double resolve_time(const CaseTime& time, const Model& model, const std::string& what,
                    const SourcePlace& place);

}  // namespace vbond
