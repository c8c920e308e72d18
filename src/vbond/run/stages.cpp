#include "vbond/run/stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/model/mistakes.hpp"
#include "vbond/model/swing_bound.hpp"
#include "vbond/run/static_solver.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/stage_resolver.hpp"

namespace vbond {
namespace {

constexpr const char* without_statics = "this vbond was built without statics";
constexpr const char* way_to_statics =
    "build it with -DVBOND_STATICS=ON, which needs libsuitesparse-dev, libopenblas-pthread-dev, "
    "libeigen3-dev and libspectra-dev";

class GivenStages : public Stages {
 public:
  explicit GivenStages(std::vector<AnyStage> stages) : stages_(std::move(stages)) {}
  std::size_t size() const override { return stages_.size(); }
  StageKind kind(std::size_t k) const override { return kind_of(stages_.at(k)); }
  std::string name(std::size_t k) const override { return name_of(stages_.at(k)); }

  AnyStage make(std::size_t k, const Model& model, State& state) const override {
    std::vector<std::string> mistakes = mistakes_in_stage(k, model);
    const Stage* dynamics = std::get_if<Stage>(&stages_.at(k));
    const bool goes_on = state.clock.stage_step > 0;
    if (dynamics && goes_on && dynamics->dt != state.clock.dt)
      mistakes.push_back(
          fmt::format("dt is {}, and the state is under way in this stage with dt = {}: a step is kept",
                      dynamics->dt, state.clock.dt));
    if (mistakes.empty())
      mistakes = std::visit([&state](const auto& stage) { return mistakes_in(stage.supports, state); },
                            stages_.at(k));
    if (dynamics && mistakes.empty() && !goes_on) look_at_step(*dynamics, model, state, mistakes);
    refuse(who(k), mistakes);
    return stages_[k];
  }

  AnyStage look_ahead(std::size_t k, const Model& model, Outlook& outlook) const override {
    std::vector<std::string> mistakes = mistakes_in_stage(k, model);
    if (const Stage* dynamics = std::get_if<Stage>(&stages_.at(k))) {
      const bool bound_is_known = outlook.bonds_known && model.contact.law == ContactLaw::none;
      if (mistakes.empty() && bound_is_known) look_at_step(*dynamics, model, outlook.state(), mistakes);
      if (!dynamics->bonding.empty()) outlook.pairs_known = outlook.bonds_known = false;
    }
    refuse(who(k), mistakes);
    return stages_[k];
  }

 private:
  std::string who(std::size_t k) const { return fmt::format("stage {} \"{}\"", k, name(k)); }

  std::vector<std::string> mistakes_in_stage(std::size_t k, const Model& model) const {
    if (is_static(kind(k)) && !has_statics())
      return {fmt::format("it is static: {}; {}", without_statics, way_to_statics)};
    std::vector<std::string> mistakes =
        std::visit([&model](const auto& stage) { return mistakes_in(model, stage); }, stages_.at(k));
    if (const Stage* stage = std::get_if<Stage>(&stages_.at(k))) look_at_swings(*stage, mistakes);
    return mistakes;
  }

  static void look_at_swings(const Stage& stage, std::vector<std::string>& mistakes) {
    const FastestSwing swing = fastest_swing(stage);
    if (stage.insist || !(stage.dt > swing.longest_step())) return;
    mistakes.push_back(
        fmt::format("dt is {}, {:.3g} steps in a period of {:.6g} of {}; {} are the fewest: use {:.6g}, {} "
                    "steps a period, "
                    "or insist = true",
                    stage.dt, swing.period / stage.dt, swing.period, swing.source, fewest_of_a_period,
                    swing.wanted_step(), steps_of_a_period));
  }

  static void look_at_step(const Stage& stage, const Model& model, const State& state,
                           std::vector<std::string>& mistakes) {
    if (stage.insist || (stage.critical > 0.0 && stage.dt <= stage.critical)) return;
    const StepBound bound = step_bound(model, state, stage, spins_against_given_step(state));
    if (stage.dt > bound.dt)
      mistakes.push_back(fmt::format(
          "dt is {}: above {:.6g} the run may blow up, from {}; use at most that, better 0.2 of it, "
          "or insist = true",
          stage.dt, bound.dt, bound.source));
  }

  std::vector<AnyStage> stages_;
};

class CaseStages : public Stages {
 public:
  CaseStages(const Case& c, int threads, std::shared_ptr<const BondsFromSetUp> own)
      : c_(c), threads_(threads), own_(std::move(own)) {}
  std::size_t size() const override { return c_.stages.size(); }
  StageKind kind(std::size_t k) const override { return c_.stages.at(k).kind; }
  std::string name(std::size_t k) const override { return c_.stages.at(k).name; }
  SourcePlace place(std::size_t k) const override { return c_.stages.at(k).place; }

  AnyStage make(std::size_t k, const Model& model, State& state) const override {
    const int index = static_cast<int>(k);
    if (is_static(kind(k))) return build_static_stage(c_, model, index, state, threads_);
    return build_stage(c_, model, index, state, exact_step(), threads_, own_);
  }

  std::vector<std::string> notes(std::size_t k, const State& state, std::size_t bonds_before) const override {
    std::vector<std::string> lines;
    for (std::size_t set = 0; set < c_.bonds.size(); ++set) {
      if (!makes_bonds_as_it_begins(c_.bonds[set], c_.stages.at(k))) continue;
      const auto first = state.bonds.begin() + static_cast<std::ptrdiff_t>(bonds_before);
      if (std::none_of(first, state.bonds.end(), [&](const Bond& b) { return b.set == set; }))
        lines.push_back(
            fmt::format("stage \"{}\": bonds \"{}\" find no pair that is not bonded yet, and bond nothing",
                        name(k), c_.bonds[set].name));
    }
    return lines;
  }

  AnyStage look_ahead(std::size_t k, const Model& model, Outlook& outlook) const override {
    return vbond::look_ahead(c_, model, k, outlook);
  }

 private:
  const Case& c_;
  int threads_;
  std::shared_ptr<const BondsFromSetUp> own_;
};

}  // namespace

StageKind kind_of(const AnyStage& stage) {
  const StaticStage* statics = std::get_if<StaticStage>(&stage);
  return statics ? statics->kind : StageKind::dynamics;
}

const std::string& name_of(const AnyStage& stage) {
  return std::visit([](const auto& s) -> const std::string& { return s.name; }, stage);
}

std::unique_ptr<const Stages> given_stages(std::vector<AnyStage> stages) {
  return std::make_unique<GivenStages>(std::move(stages));
}

std::unique_ptr<const Stages> stages_of(const Case& c, int threads,
                                        std::shared_ptr<const BondsFromSetUp> own) {
  require_statics(c);
  return std::make_unique<CaseStages>(c, threads, std::move(own));
}

void require_statics(const Case& c) {
  if (has_statics()) return;
  const auto refuse = [](const SourcePlace& place, const std::string& what) {
    throw CaseError({place, what, without_statics, way_to_statics});
  };
  for (const StageSpec& s : c.stages)
    if (is_static(s.kind)) refuse(s.place, fmt::format("stage \"{}\" is static", s.name));
  if (c.time.step && !c.time.given()) refuse(c.time.step->place, "time.step = \"exact\"");
}

}  // namespace vbond
