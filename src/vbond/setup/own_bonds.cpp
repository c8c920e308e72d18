#include "vbond/setup/own_bonds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/joint_cells.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/stage_step.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond {
namespace {

/// A set of the case: the pairs of this process, and of the whole body how many have each particle as their
/// first.
struct SetOfPairs {
  SelectedPairs selected;
  PerParticle<std::uint32_t> of_first;
  std::size_t cells = 1;  // bonds of each pair
};

/// What is known of the bonds of all sets by their pairs.
struct ToCome {
  PerParticle<std::uint32_t> of_first, of_each;  // bonds that have a particle as their first, or as an end
  std::size_t bonds = 0;
  double longest2 = 0;  // [length^2]
};

/// Selects pairs whose first particles are those of a slice.
std::vector<SetOfPairs> select_in_slice(const Case& c, const Model& model, const State& state,
                                        const PerParticle<char>& slice, Problems& problems,
                                        SharedCells& shared) {
  std::vector<SetOfPairs> sets(c.bonds.size());
  std::vector<SelectedPairs> before;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    before.push_back(select_pairs(c, set, model, state, problems, shared, before, &slice));
    sets[set].cells = recipes_of(c.bonds[set].recipe).size();
  }
  for (std::size_t set = 0; set < sets.size(); ++set) sets[set].selected = std::move(before[set]);
  return sets;
}

/// Adds up what all processes have selected. Throws CaseError if a set has no pairs, which may be a mistake.
ToCome count(const Case& c, std::vector<SetOfPairs>& sets, const State& state, const Communicator& all) {
  ToCome to_come;
  to_come.of_first.assign(state.r.size(), 0), to_come.of_each.assign(state.r.size(), 0);
  for (SetOfPairs& set : sets) {
    set.of_first.assign(state.r.size(), 0);
    const auto cells = static_cast<std::uint32_t>(set.cells);
    for (const Pair& p : set.selected.pairs) {
      ++set.of_first[p.i];
      to_come.of_each[p.i] += cells, to_come.of_each[p.j] += cells;
      to_come.longest2 = std::max(to_come.longest2, norm2(between(state, p.i, p.j, p.image_j)));
    }
    all.sum_counts({set.of_first.data(), set.of_first.size()});
    std::size_t pairs = 0;
    for (const ParticleId p : state.r.ids())
      pairs += set.of_first[p], to_come.of_first[p] += cells * set.of_first[p];
    if (pairs == 0) throw CaseError(Problem{{c.file, 0, 0}, "a set of bonds finds no pairs", "", ""});
    to_come.bonds += pairs * set.cells;
  }
  all.sum_counts({to_come.of_each.data(), to_come.of_each.size()});
  all.max({&to_come.longest2, 1});
  return to_come;
}

/// Pairs go to the process that has their first particle.
void send_to_owners(std::vector<Pair>& pairs, const PerParticle<char>& own, const Communicator& all) {
  const auto is_own = [&own](const Pair& p) { return own[p.i] != 0; };
  const auto kept = std::partition(pairs.begin(), pairs.end(), is_own);
  const std::vector<Pair> go(kept, pairs.end());
  pairs.erase(kept, pairs.end());
  all.tell_all(go, [&](const Pair& p) {
    if (is_own(p)) pairs.push_back(p);
  });
  std::sort(pairs.begin(), pairs.end());
}

/// Adds the numbers that own bonds of a set have in the whole body, the first bond of which is this one.
void add_names(const SetOfPairs& set, const PerParticle<char>& own, BondId first, PerBond<BondId>& names) {
  names.reserve(names.size() + set.selected.pairs.size() * set.cells);
  for (const ParticleId p : own.ids()) {
    const std::size_t bonds = set.of_first[p] * set.cells;
    for (std::size_t k = 0; k < bonds && own[p] != 0; ++k) names.push_back(BondId{first.value + k});
    first.value += static_cast<std::uint32_t>(bonds);
  }
}

/// A bond by which another process can make it, too.
struct NamedBond {
  BondId name;
  std::uint16_t set;
  std::uint32_t cell;
  BondSite i, j;
};

Bond made(const NamedBond& named, const Case& c) {
  BondRecipe recipe = c.bonds[named.set].recipe;
  recipe.set = named.set;
  return *make_bond(recipes_of(recipe)[named.cell], named.i, named.j);
}

/// Whether a bond has a law or rules that none of these has.
bool is_of_new_kind(const Bond& b, const std::vector<Bond>& kinds) {
  return std::none_of(kinds.begin(), kinds.end(), [&b](const Bond& k) { return k.law == b.law; }) ||
         std::none_of(kinds.begin(), kinds.end(), [&b](const Bond& k) { return k.rules == b.rules; });
}

/// The first bonds of each law and of all rules, and of the first pair: of the whole body.
void add_first_ones(const Case& c, const std::vector<SetOfPairs>& sets, const Model& model,
                    const State& state, BondsFromSetUp& bonds) {
  std::vector<NamedBond> mine;
  std::vector<Bond> kinds;
  std::size_t of_set = 0;  // before this one
  std::uint16_t last_set = 0;
  for (const BondId k : state.bonds.ids()) {
    const Bond& b = state.bonds[k];
    if (std::exchange(last_set, b.set) != b.set) of_set = k.value;
    const bool is_new = is_of_new_kind(b, kinds);
    if (is_new) kinds.push_back(b);
    if (is_new || bonds.part.names[k].value == 0)
      mine.push_back({bonds.part.names[k], b.set,
                      static_cast<std::uint32_t>((k.value - of_set) % sets[b.set].cells),
                      bond_site(model, state, b.i), bond_site(model, state, b.j, image_of_j(b))});
  }
  std::vector<NamedBond> all = bonds.all->gather(mine);
  std::sort(all.begin(), all.end(), [](const NamedBond& a, const NamedBond& b) { return a.name < b.name; });
  for (const NamedBond& named : all) {
    const Bond b = made(named, c);
    if (is_of_new_kind(b, bonds.kinds)) bonds.kinds.push_back(b);
  }
  if (all.empty()) return;
  for (NamedBond first = all.front(); first.cell < sets[first.set].cells; ++first.cell)
    bonds.first.push_back(made(first, c));
}

/// Books what all processes have, in the order of the bonds of the whole body.
void book_in_order(const std::vector<UnbookedBond>& own, const BondsFromSetUp& bonds, EnergyBooks& books) {
  if (!bonds.all->any(!own.empty())) return;
  constexpr std::size_t at_once = 1 << 16;
  auto next = own.begin();
  for (std::size_t last = at_once; last < bonds.whole + at_once; last += at_once) {
    std::vector<UnbookedBond> some;  // with names
    for (; next != own.end() && bonds.part.names[next->bond].value < last; ++next)
      some.push_back({bonds.part.names[next->bond], next->energy});
    some = bonds.all->gather(some);
    std::sort(some.begin(), some.end(),
              [](const UnbookedBond& a, const UnbookedBond& b) { return a.bond < b.bond; });
    for (const UnbookedBond& b : some) book(b.energy, books);
  }
}

}  // namespace

namespace {

bool is_rigid(const SupportSpec& s) {
  return s.rigid;
}
bool has_rigid_groups(const StageSpec& s) {
  return std::any_of(s.supports.begin(), s.supports.end(), is_rigid);
}
bool has_stress_on_cell(const StageSpec& s) {
  if (!s.cell) return false;
  const auto& components = s.cell->component;
  return std::any_of(components.begin(), components.end(), [](const auto& c) { return c && c->stress; });
}

/// Whether the bonds that a process has are those of its own particles throughout such a stage.
bool may_begin_in_parts(const Case& c, const StageSpec& s) {
  const bool may_be_torn = c.cell && has_rigid_groups(s);  // which is asked of all bonds
  return !is_static(s.kind) && s.pressures.empty() && !has_stress_on_cell(s) && !may_be_torn;
}

}  // namespace

bool may_keep_own_bonds(const Case& c) {
  if (!c.sources.empty() || step_is_exact(c)) return false;
  const auto is_simple = [](const BondSpec& b) {
    return b.when == BondTime::start && !b.recipe.capsule && b.recipe.expansion == 0.0 &&
           !std::holds_alternative<AtCrossings>(b.select.value);
  };
  return std::all_of(c.stages.begin(), c.stages.end(),
                     [&c](const StageSpec& s) { return may_begin_in_parts(c, s); }) &&
         std::all_of(c.bonds.begin(), c.bonds.end(), is_simple);
}

bool may_keep_own_motion(const Case& c) {
  return may_keep_own_bonds(c) && std::none_of(c.stages.begin(), c.stages.end(), has_rigid_groups);
}

bool may_keep_own_first_places(const Case& c) {
  return may_keep_own_motion(c) && !particles_touch(c.contact) && c.output.stresses.empty() &&
         std::none_of(c.stages.begin(), c.stages.end(),
                      [](const StageSpec& s) { return s.strain.has_value(); });
}

PerParticle<char> slice_of(const PerParticle<Vec3d>& r, const Communicator& all) {
  constexpr std::size_t bins = 1 << 14;
  const BoundingBox box = box_around(r);
  const Vec3d size = box.high - box.low;
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (component(size, k) > component(size, axis)) axis = k;
  const double low = component(box.low, axis), width = component(size, axis);
  const auto bin_of = [&](ParticleId p) {
    const double x = width > 0.0 ? (component(r[p], axis) - low) / width : 0.0;
    return std::min(bins - 1, static_cast<std::size_t>(x * static_cast<double>(bins)));
  };
  std::vector<std::size_t> in_bin(bins, 0);
  for (const ParticleId p : r.ids()) ++in_bin[bin_of(p)];
  std::vector<char> is_own(bins, 0);
  const auto ranks = static_cast<std::size_t>(all.ranks()), rank = static_cast<std::size_t>(all.rank());
  std::size_t before = 0;
  for (std::size_t bin = 0; bin < bins; before += in_bin[bin++])
    is_own[bin] = (2 * before + in_bin[bin]) * ranks / (2 * std::max<std::size_t>(1, r.size())) == rank;
  PerParticle<char> own(r.size(), 0);
  for (const ParticleId p : r.ids()) own[p] = is_own[bin_of(p)];
  return own;
}

void throw_if_any_has(const Problems& problems, const Communicator& all) {
  if (!all.any(!problems.none())) return;
  problems.throw_if_any();
  throw CaseError(Problem{{}, "another process has found a mistake", "", ""});
}

BondsFromSetUp make_own_bonds(const Case& c, const Model& model, State& state, const PerParticle<char>& slice,
                              const KeepOwnBonds& processes,
                              const std::function<void(const std::vector<ParticleId>&)>& complete,
                              Problems& problems, SharedCells& shared) {
  const Communicator& all = processes.all;
  std::vector<SetOfPairs> sets = select_in_slice(c, model, state, slice, problems, shared);
  throw_if_any_has(problems, all);
  ToCome to_come = count(c, sets, state, all);
  BondsFromSetUp bonds;
  bonds.all = &all;
  bonds.part.own_alone = true;
  bonds.whole = to_come.bonds;
  bonds.bonds = std::move(to_come.of_each);
  bonds.own.assign(model.particles(), 0);
  std::vector<ParticleId> asked_for =
      processes.spread(model, state, to_come.of_first, std::sqrt(to_come.longest2));
  for (const ParticleId p : asked_for) bonds.own[p] = 1;
  to_come.of_first = {};
  std::size_t first = 0;
  for (SetOfPairs& set : sets) {
    send_to_owners(set.selected.pairs, bonds.own, all);
    add_names(set, bonds.own, BondId{first}, bonds.part.names);
    for (const std::uint32_t pairs : set.of_first) first += pairs * set.cells;
    set.of_first = {};
    for (const Pair& p : set.selected.pairs)
      if (bonds.own[p.j] == 0) asked_for.push_back(p.j);
  }
  complete(asked_for);
  state.bonds.reserve(bonds.part.names.size());
  std::vector<UnbookedBond> unbooked;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    const auto of_set = make_some_bonds(c, set, model, state, sets[set].selected, problems);
    unbooked.insert(unbooked.end(), of_set.begin(), of_set.end());
    sets[set].selected = {};
  }
  throw_if_any_has(problems, all);
  if (all.any(!state.bond_history.empty())) state.bond_history.resize(state.bonds.size(), no_history);
  book_in_order(unbooked, bonds, state.books);
  add_first_ones(c, sets, model, state, bonds);
  return bonds;
}

}  // namespace vbond
