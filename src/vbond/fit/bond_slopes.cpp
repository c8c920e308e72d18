#include "vbond/fit/bond_slopes.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/statics/point_view.hpp"

namespace vbond::fit {
namespace {

constexpr std::size_t at_value = 3;  // of the seven changes of a Nudge

/// The recipes of all sets of a case.
using Recipes = std::vector<BondRecipe>;

/// The bonds as they are made by these recipes between the same particles; nothing if one has no length.
std::optional<PerBond<Bond>> made_by(const Recipes& recipes, const Model& model, const State& made) {
  PerBond<Bond> bonds;
  for (const Bond& b : made.bonds) {
    if (b.set >= recipes.size() || b.law->has_offsets) return std::nullopt;
    BondRecipe recipe = recipes[b.set];
    recipe.set = b.set;
    auto bond = make_bond(recipe, bond_site(model, made, b.i), bond_site(model, made, b.j, image_of_j(b)));
    if (!bond) return std::nullopt;
    bonds.push_back(*bond);
  }
  return bonds;
}

/// The recipes at v + k step; a reason if the case refuses one of the values.
std::variant<std::array<Recipes, 7>, std::string> recipes_of(const CaseText& text, const Nudge& nudge) {
  std::array<Recipes, 7> recipes;
  try {
    for (std::size_t k = 0; k < recipes.size(); ++k) {
      const Case c = parse_case(text.text, text.file, nudge.changes[k]);
      for (const BondSpec& spec : c.bonds) recipes[k].push_back(spec.recipe);
    }
  } catch (const CaseError&) {
    return std::string("the case refuses values next to it");
  }
  return recipes;
}

}  // namespace

struct BondSlopes::Inside {
  const Run& run;
  State made;
  std::vector<Slope> slopes;            // of all values
  std::vector<std::size_t> followed{};  // those that are parameters of bonds
  std::optional<Sensitivities> sensitivities{};
  std::optional<std::int32_t> stage{};

  /// Why a value is no parameter of bonds alone; else what it makes of them.
  std::variant<BondParameter, std::string> parameter_of(const CaseText& text, const Nudge& nudge) const {
    if (!nudge.why_not.empty()) return nudge.why_not;
    auto found = recipes_of(text, nudge);
    if (const auto* why = std::get_if<std::string>(&found)) return *why;
    auto recipes =
        std::make_shared<const std::array<Recipes, 7>>(std::get<std::array<Recipes, 7>>(std::move(found)));
    const Model& model = run.model();
    bool changes = false;
    for (std::size_t k = 0; k < recipes->size(); ++k) {
      const auto bonds = made_by((*recipes)[k], model, made);
      if (!bonds || (k == at_value && *bonds != made.bonds))
        return std::string("its bonds cannot be made anew one by one");
      changes = changes || *bonds != made.bonds;
    }
    if (!changes) return std::string("it changes no bond that is there");
    return BondParameter{nudge.step, [this, recipes](int k) {
                           return *made_by((*recipes)[static_cast<std::size_t>(k + 3)], run.model(), made);
                         }};
  }

  void begin_stage(const BodyView& body) {
    State state = body.state();
    state.clock.stage_step = 0;
    const std::size_t bonds = state.bonds.size();
    const auto k = static_cast<std::size_t>(state.clock.stage);
    const AnyStage any = run.stages().make(k, run.model(), state);
    const auto* stage_at_rest = std::get_if<StaticStage>(&any);
    if (stage_at_rest == nullptr || state.bonds.size() != bonds || bonds != made.bonds.size())
      return lose(fmt::format("stage \"{}\" {}", run.stages().name(k),
                              stage_at_rest == nullptr ? "is one of motion" : "makes bonds"));
    if (const auto why = sensitivities->begin(*stage_at_rest, body.state())) lose(*why);
  }

  void lose(const std::string& why) {
    for (const std::size_t j : followed) slopes[j] = {{}, why};
    followed.clear();
    sensitivities.reset();
  }
};

BondSlopes::BondSlopes(const CaseText& text, const std::vector<Nudge>& nudges, const Run& run, State made)
    : in_(new Inside{run, std::move(made), std::vector<Slope>(nudges.size())}) {
  std::vector<BondParameter> parameters;
  for (std::size_t j = 0; j < nudges.size(); ++j) {
    auto parameter = in_->parameter_of(text, nudges[j]);
    if (auto* why = std::get_if<std::string>(&parameter)) {
      in_->slopes[j].why_not = std::move(*why);
    } else {
      in_->followed.push_back(j);
      parameters.push_back(std::get<BondParameter>(std::move(parameter)));
    }
  }
  if (parameters.empty()) return;
  in_->sensitivities.emplace(run.model(), std::move(parameters));
  for (std::size_t k = 0; k < run.stages().size(); ++k)
    if (in_->sensitivities && !is_static(run.stages().kind(k)))
      in_->lose(fmt::format("stage \"{}\" is one of motion", run.stages().name(k)));
}

BondSlopes::~BondSlopes() = default;

void BondSlopes::at(const BodyView& body, const BalancePoint& balance, const RowNumbers& numbers) {
  if (!in_->sensitivities) return;
  if (in_->stage != body.clock().stage) {
    in_->stage = body.clock().stage;
    in_->begin_stage(body);
    if (!in_->sensitivities) return;
  }
  const StaticPoint point{body.state(), balance.load_factor, balance.kind, balance.unstable, {}, {}, {},
                          0.0,          balance.relieved};
  std::string why;
  const auto changes = in_->sensitivities->at(
      point, [&](const StaticPoint& p) { return numbers(PointView(in_->run.model(), p)); }, why);
  if (!changes) return in_->lose(why);
  for (std::size_t n = 0; n < in_->followed.size(); ++n) {
    std::vector<std::vector<double>>& columns = in_->slopes[in_->followed[n]].columns;
    const std::vector<double>& change = (*changes)[n];
    columns.resize(change.size());
    for (std::size_t column = 0; column < change.size(); ++column) columns[column].push_back(change[column]);
  }
}

void BondSlopes::lose(const std::string& why) {
  in_->lose(why);
}

std::vector<Slope> BondSlopes::take() && {
  return std::move(in_->slopes);
}

}  // namespace vbond::fit
