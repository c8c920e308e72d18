#include "vbond/dynamics/bonding.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

bool joins(const BondingRule& rule, ParticleId i, ParticleId j) {
  return (rule.in_a[i.value] && rule.in_b[j.value]) || (rule.in_a[j.value] && rule.in_b[i.value]);
}

std::string pair_name(ParticleId i, ParticleId j) {
  return "particles " + std::to_string(i.value) + " and " + std::to_string(j.value);
}

Bond bond_between(const BondRecipe& recipe, const Model& model, const State& s, const Bonding::Pair& pair) {
  const auto& [rule, i, j, image] = pair;
  if (const auto bond = make_bond(recipe, bond_site(model, s, i), bond_site(model, s, j, image))) {
    if (const auto mistake = capsule_mistake(model, *bond, norm(between(s, i, j, image))))
      throw Diverged(s.clock.step, s.clock.time(), pair_name(i, j) + ", whose bond is to touch as a capsule",
                     mistake->rule, mistake->way_out);
    return *bond;
  }
  throw Diverged(s.clock.step, s.clock.time(), pair_name(i, j),
                 "came within bonding distance, but their bonded points are no apart (a <= 0)",
                 "attach the bonds at the centres or by necks, or bond at a larger distance than R_i + R_j");
}

}  // namespace

Bonding::Bonding(const Model& model, const Stage& stage, const Order& order, const BondIndex& index,
                 const Exchange& exchange)
    : model_(model),
      order_(order),
      exchange_(exchange),
      walls_(stage.walls),
      supports_(stage.supports),
      insist_(stage.insist) {
  for (const BondingRule& rule : stage.bonding) {
    const auto keep = [&rule, &order, &index](Row i, Row* first, Row* last) {
      return std::remove_if(first, last, [&, p = order.particle[i]](Row j) {
        const ParticleId o = order.particle[j];
        return !is_worked_out_here(order, i, j) || !joins(rule, p, o) ||
               index.bonded(p, o, order.image(j) - order.image(i));
      });
    };
    PerRow<double> half(order.known, 0.5 * rule.limit(0.0, 0.0));
    double mean = 0.0, largest = 0.0;
    for (const ParticleId p : model.radius.ids())
      mean += model.radius[p] / static_cast<double>(model.particles()),
          largest = std::max(largest, model.radius[p]);
    if (rule.factor > 0.0)
      for (const Row k : half.ids()) {
        const double R = model.radius[order.particle[k]];
        half[k] = 0.5 * rule.limit(R, R);
      }
    rules_.push_back(
        {&rule, NeighbourList(half, 0.2 * rule.reach(mean, mean), keep), rule.limit(largest, largest)});
  }
}

void Bonding::check_step(const State& state) const {
  const StepBound bound = step_bound(model_, state, {}, walls_, 1.0, supports_);
  if (insist_ || state.clock.dt <= bound.dt) return;
  throw Diverged(state.clock.step, state.clock.time(), "new bonds",
                 fmt::format("the time step {:.6g} is above the critical step {:.6g}, from {}",
                             state.clock.dt, bound.dt, bound.source),
                 "choose a smaller time.step or time.fraction");
}

/// Not broken as it is made: it would be made and break for ever.
bool Bonding::holds(const BondRecipe& recipe, std::span<const PoseRow> pose, Row i, Row j) const {
  const auto site = [&](Row k) {
    const ParticleId p = order_.particle[k];
    const PoseRow& at = pose[k.value];
    return BondSite{p, at.r, at.q, model_.radius[p], model_.mass[p], model_.inertia[p], order_.image(k)};
  };
  const auto bond = make_bond(recipe, site(i), site(j));
  return !bond || !breaks_as_made(*bond, site(i), site(j));
}

bool Bonding::within_reach(const BondingRule& rule, std::span<const PoseRow> pose, Row i, Row j) const {
  const auto R = [this](Row k) { return model_.radius[order_.particle[k]]; };
  return norm2(between(pose[i.value], pose[j.value])) <= sq(rule.limit(R(i), R(j)));
}

std::vector<Bonding::Pair> Bonding::find(std::span<const PoseRow> pose, const Team& team) {
  std::vector<Pair> found;
  std::set<std::tuple<ParticleId, ParticleId, Image>> taken;  // by this rule or an earlier one
  for (std::uint32_t number = 0; number < rules_.size(); ++number) {
    RuleList& list = rules_[number];
    list.near.refresh(pose, team);
    for (std::size_t k = 0; k < pose.size(); ++k)
      for (const Row j : list.near.of(Row{k})) {
        if (j.value < k || !within_reach(*list.rule, pose, Row{k}, j)) continue;
        const bool in_order = order_.image_of(Row{k}) < order_.image_of(j);
        const Row first = in_order ? Row{k} : j, second = in_order ? j : Row{k};
        if (list.rule->recipe.prestrain != 0.0 && !holds(list.rule->recipe, pose, first, second)) continue;
        const auto [p, image_p] = order_.image_of(first);
        const auto [o, image_o] = order_.image_of(second);
        const BondShare& share = list.rule->share;
        if (share.part < 1.0 && !(pair_variate(share.seed, p, o, image_o - image_p) < share.part)) continue;
        if (taken.insert({p, o, image_o}).second) found.push_back({number, p, o, image_o});
      }
  }
  found = exchange_.gather(found);
  std::sort(found.begin(), found.end(), [](const Pair& a, const Pair& b) {
    return std::tuple(a.rule, a.i, a.j, a.image_j) < std::tuple(b.rule, b.i, b.j, b.image_j);
  });
  return found;
}

void Bonding::unbonded(ParticleId first, ParticleId second, const Image& image_j) {
  const auto list_pair = [this](Row i, const std::optional<Row>& j) {
    if (!j || std::max(i, *j).value >= order_.known || !is_worked_out_here(order_, i, *j)) return false;
    for (RuleList& list : rules_)
      if (joins(*list.rule, order_.particle[i], order_.particle[*j])) list.near.add(i, *j);
    return true;
  };
  // seen from one of its two, if it is a pair of a particle and an image
  if (!list_pair(order_.row[first], order_.find(second, image_j)) && !image_j.is_itself())
    list_pair(order_.row[second], order_.find(first, -image_j));
}

void Bonding::make(const std::vector<Pair>& pairs, State& state) {
  for (const Pair& pair : pairs)
    add_bond(model_, bond_between(recipe(pair.rule), model_, state, pair), recipe(pair.rule), state);
  for (RuleList& list : rules_) list.near.invalidate();
  check_step(state);
}

}  // namespace vbond
