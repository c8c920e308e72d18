#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/run/rest_mistakes.hpp"
#include "vbond/run/run.hpp"
#include "vbond/run/static_solver.hpp"

/// What can be told of the stages of a run before it begins.
namespace vbond {
namespace {

/// The same particles and bonds in places that have nothing to do with each other. What a support holds at
/// any places it holds at most of them: a body that is free at such places is free wherever it is.
State anywhere(State s) {
  const double size = std::max(box_around(s.r).diagonal(), 1e-300);
  std::mt19937_64 random(1);
  const auto next = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
  for (Vec3d& r : s.r) r += size * Vec3d{next(), next(), next()};
  return s;
}

Problem problem_of(const NoEquilibrium& refusal, const SourcePlace& place) {
  const std::string text = refusal.what();  // the finding, and on a line of its own a way out
  const std::size_t end = text.find("\n  ");
  return {place, text.substr(0, end), "run will refuse the stage as it begins",
          end == std::string::npos ? "hold the body" : text.substr(end + 3)};
}

/// Takes the temperatures of particles (empty: 0) from the start of a stage to its end. False: they depend on
/// when it ends.
bool go_on(PerParticle<double>& temperature, std::size_t particles, const AnyStage& stage) {
  std::visit(
      [&](const auto& s) {
        if (!s.heating.empty()) temperature.resize(particles);
      },
      stage);
  if (const auto* statics = std::get_if<StaticStage>(&stage)) {
    for (const Heating& h : statics->heating)
      for (const ParticleId p : h.particles) temperature[p] += h.temperature;
    return statics->kind == StageKind::equilibrium || statics->heating.empty();
  }
  bool known = true;
  for (const Heating& h : std::get<Stage>(stage).heating) {
    for (const ParticleId p : h.particles) temperature[p] = h.temperature * h.factor(0.0);
    known &= h.factor.points.size() < 2;
  }
  return known;
}

/// One mistake of the case can stand in the way of several stages.
bool is_told(const std::vector<StageRefusal>& found, const Problem& p) {
  const auto same = [&p](const StageRefusal& f) {
    const SourcePlace &a = f.problem.place, &b = p.place;
    return !b.file.empty() && std::tie(a.file, a.line, a.column) == std::tie(b.file, b.line, b.column) &&
           f.problem.rule == p.rule && f.problem.way_out == p.way_out;
  };
  return std::any_of(found.begin(), found.end(), same);
}

}  // namespace

/// Whether supports leave the body of a static stage where it is a question of its bonds alone: contacts,
/// bonds to come and places after another stage are not known.
void Run::look_at_balance(std::size_t k, const StaticStage& stage, const Outlook& outlook,
                          std::vector<StageRefusal>& found) const {
  const bool now = k == stage_index();
  if (now && under_way_) return;                                  // it holds what has come off
  if (!(now ? state_ : outlook.state()).waiting.empty()) return;  // who is there then is not known
  if (!now && (!outlook.pairs_known || model_.contact.law != ContactLaw::none)) return;
  if (!now && !mistakes_in(stage.supports, outlook.state()).empty())
    return;  // of bonds that may break till then
  const auto refusal = refusal_of(model_, stage, now ? state_ : outlook.state());
  if (!refusal || (!now && !refusal_of(model_, stage, anywhere(outlook.state())))) return;
  found.push_back({k, problem_of(*refusal, stages_->place(k)), refusal});
}

/// Where the first stage cannot be made, what is known of its bonds.
void Run::expect_bonds_of_first(Outlook& outlook) const {
  try {
    stages_->look_ahead(stage_index(), model_, outlook);
  } catch (const std::exception&) {  // told already; the outlook is complete
  }
}

std::vector<StageRefusal> Run::refusals() {
  std::vector<StageRefusal> found;
  if (complete() || simulation_) return found;
  Outlook outlook = this->outlook();
  PerParticle<double> temperature = state_.temperature;
  bool temperature_known = true;
  for (std::size_t k = stage_index(); k < stages_->size(); ++k) {
    try {
      const bool now = k == stage_index();
      if (!now && outlook.state().temperature != temperature) outlook.changed().temperature = temperature;
      const AnyStage stage = now ? prepare() : stages_->look_ahead(k, model_, outlook);
      if (now && std::holds_alternative<Stage>(stage) && !std::get<Stage>(stage).bonding.empty())
        outlook.pairs_known = outlook.bonds_known = false;
      if (!temperature_known && !outlook.state().warm_bonds.empty())
        outlook.changed().warm_bonds.clear();  // what they have grown by
      if (const auto* statics = std::get_if<StaticStage>(&stage)) {
        const SourcePlace& place = stages_->place(k);
        const State& state = now ? state_ : outlook.state();
        const auto mistake = place.file.empty() ? std::nullopt  // no case that could be mended
                                                : mistake_at_rest(model_, state, *statics, now, place);
        if (mistake)
          found.push_back({k, *mistake, {}});
        else
          look_at_balance(k, *statics, outlook, found);
      }
      temperature_known = go_on(temperature, state_.r.size(), stage) && temperature_known;
    } catch (const CaseError& e) {
      for (const Problem& p : e.problems())
        if (!is_told(found, p)) found.push_back({k, p, {}});
    } catch (const std::invalid_argument& e) {
      found.push_back({k, {{}, e.what(), {}, {}}, {}});
    }
    if (k == stage_index() && !stage_) expect_bonds_of_first(outlook);
  }
  return found;
}

void Run::check() {
  const std::vector<StageRefusal> found = refusals();
  checked_ = true;
  if (found.empty()) return;
  checked_ = false;
  const auto is_mistake = [](const StageRefusal& r) { return !r.no_equilibrium; };
  if (std::none_of(found.begin(), found.end(), is_mistake)) {
    std::string texts = found.front().no_equilibrium->what();
    for (std::size_t k = 1; k < found.size(); ++k)
      texts += std::string("\n") + found[k].no_equilibrium->what();
    throw NoEquilibrium(texts);
  }
  std::vector<Problem> problems;
  for (const StageRefusal& r : found) problems.push_back(r.problem);
  if (stages_->place(0).file.empty()) throw std::invalid_argument("Run: " + to_text(problems));
  throw CaseError(problems);
}

}  // namespace vbond
