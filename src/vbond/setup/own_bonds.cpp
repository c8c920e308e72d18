#include "vbond/setup/own_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "vbond/model/joint_cells.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/stage_step.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {
namespace {

/// What is known of the bonds of all sets by their pairs alone.
struct ToCome {
  PerParticle<std::uint32_t> of_first;  ///< how many have each particle as their first
  double longest2 = 0;                  ///< [length^2]
};

ToCome bonds_of(const Case& c, const std::vector<SelectedPairs>& sets, const State& state) {
  ToCome to_come{PerParticle<std::uint32_t>(state.r.size(), 0)};
  for (std::size_t set = 0; set < sets.size(); ++set) {
    const auto cells = static_cast<std::uint32_t>(recipes_of(c.bonds[set].recipe).size());
    for (const Pair& p : sets[set].pairs) {
      to_come.of_first[p.i] += cells;
      to_come.longest2 = std::max(to_come.longest2, norm2(between(state, p.i, p.j, p.image_j)));
    }
  }
  return to_come;
}

bool differs_in_law(const Bond& b, const std::vector<Bond>& kinds) {
  return std::none_of(kinds.begin(), kinds.end(), [&b](const Bond& k) { return k.law == b.law; });
}
bool differs_in_rules(const Bond& b, const std::vector<Bond>& kinds) {
  return std::none_of(kinds.begin(), kinds.end(), [&b](const Bond& k) { return k.rules == b.rules; });
}

/// So that there is less and less of them as bonds are made.
std::vector<SelectedPairs> in_pieces(const SelectedPairs& whole) {
  constexpr std::size_t at_once = 1 << 17;
  std::vector<SelectedPairs> pieces;
  for (std::size_t first = 0; first < whole.pairs.size(); first += at_once) {
    const auto begin = whole.pairs.begin() + static_cast<std::ptrdiff_t>(first);
    const auto size = static_cast<std::ptrdiff_t>(std::min(at_once, whole.pairs.size() - first));
    pieces.push_back({{begin, begin + size}, {}});
  }
  return pieces;
}

}  // namespace

bool may_keep_own_bonds(const Case& c) {
  if (c.stages.size() != 1 || is_static(c.stages[0].kind) || !c.sources.empty() || step_is_exact(c))
    return false;
  const StageSpec& stage = c.stages[0];
  if (!stage.pressures.empty()) return false;
  if (stage.cell)
    for (const auto& component : stage.cell->component)
      if (component && component->stress) return false;
  return std::all_of(c.bonds.begin(), c.bonds.end(), [](const BondSpec& b) {
    return b.when == BondTime::start && !b.recipe.capsule && b.recipe.expansion == 0.0 &&
           !std::holds_alternative<AtCrossings>(b.select.value);
  });
}

BondKeeper::BondKeeper(const std::vector<ParticleId>& own, std::size_t particles, const Communicator& all)
    : is_own_(particles, 0) {
  for (const ParticleId p : own) is_own_[p] = 1;
  bonds_.part.own_alone = true;
  bonds_.all = &all;
}

std::size_t BondKeeper::expect(std::span<const SelectedPairs> pieces, std::size_t bonds_of_each) {
  std::size_t kept = 0, all = 0;
  for (const SelectedPairs& piece : pieces)
    for (const Pair& p : piece.pairs) kept += is_own_[p.i] != 0 ? bonds_of_each : 0, all += bonds_of_each;
  bonds_.part.names.reserve(bonds_.part.names.size() + kept);
  bonds_.others.reserve(bonds_.others.size() + all - kept);
  return kept + 1;
}

void BondKeeper::look_at_last(State& state) {
  const BondId name{bonds_.bonds()}, last{state.bonds.size() - 1};
  const Bond& b = state.bonds[last];
  const bool is_of_first =
      bonds_.first.empty() || (name.value == bonds_.first.size() && b.set == bonds_.first[BondId{0}].set &&
                               b.i == bonds_.first[BondId{0}].i && b.j == bonds_.first[BondId{0}].j &&
                               b.image_j == bonds_.first[BondId{0}].image_j);
  if (is_of_first) bonds_.first.push_back(b);
  if (differs_in_law(b, bonds_.kinds) || differs_in_rules(b, bonds_.kinds)) bonds_.kinds.push_back(b);
  any_history_ = any_history_ || !state.bond_history.empty();
  if (is_own_[b.i] != 0) {
    bonds_.part.names.push_back(name);
    return;
  }
  bonds_.add_other(b);
  keep_bonds(state, last.value);
  state.bond_history.resize(std::min<std::size_t>(state.bond_history.size(), last.value));
}

BondsFromSetUp BondKeeper::finish(State& state) && {
  if (any_history_) state.bond_history.resize(state.bonds.size(), no_history);
  return std::move(bonds_);
}

BondsFromSetUp make_own_bonds(const Case& c, const Model& model, State& state, const KeepOwnBonds& processes,
                              Problems& problems, SharedCells& shared) {
  std::vector<SelectedPairs> sets;
  for (std::size_t set = 0; set < c.bonds.size(); ++set)
    sets.push_back(select_pairs(c, set, model, state, problems, shared, sets));
  problems.throw_if_any();
  processes.meet();
  const ToCome to_come = bonds_of(c, sets, state);
  BondKeeper keeper(processes.spread(model, state, to_come.of_first, std::sqrt(to_come.longest2)),
                    model.particles(), processes.all);
  for (std::size_t set = 0; set < sets.size(); ++set) {
    std::vector<SelectedPairs> pieces = in_pieces(sets[set]);
    sets[set] = {};
    make_bonds(c, set, model, state, std::move(pieces), problems, keeper);
  }
  problems.throw_if_any();
  return std::move(keeper).finish(state);
}

}  // namespace vbond
