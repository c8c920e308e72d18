#include "vbond/dynamics/part_bonds.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

namespace vbond {
namespace {

/// What parts send of a bond.
struct SentBond {
  BondId name;
  ParticleId i, j;
  std::uint32_t law, rules;  // in SharedByBonds
  std::uint16_t set;
  bool broken;
  BreakMode mode;
  Image image_j;
  double a, R_i, R_j, capsule;
  Coefficients coefficients;
  Quatd frame_i, frame_j;
};

template <class T>
std::uint32_t place_in(const std::vector<T>& all, const T& one) {
  return static_cast<std::uint32_t>(std::find(all.begin(), all.end(), one) - all.begin());
}

SentBond sent(const Bond& b, BondId name, const SharedByBonds& shared) {
  return {.name = name,
          .i = b.i,
          .j = b.j,
          .law = shared.place_of_law(b),
          .rules = shared.place_of_rules(b),
          .set = b.set,
          .broken = b.broken,
          .mode = b.mode,
          .image_j = image_of_j(b),
          .a = b.a,
          .R_i = b.R_i,
          .R_j = b.R_j,
          .capsule = capsule_of(b),
          .coefficients = b.coefficients,
          .frame_i = b.frame_i,
          .frame_j = frame_j(b)};
}

Bond received(const SentBond& s, const SharedByBonds& shared) {
  Bond b{.i = s.i,
         .j = s.j,
         .a = s.a,
         .R_i = s.R_i,
         .R_j = s.R_j,
         .coefficients = s.coefficients,
         .frame_i = {},
         .law = shared.laws[s.law],
         .rules = shared.rules[s.rules],
         .set = s.set,
         .broken = s.broken,
         .mode = s.mode};
  set_frames(b, s.frame_i, s.frame_j);
  set_capsule(b, s.capsule);
  set_image_of_j(b, s.image_j);
  return b;
}

/// All that a state has of bonds, taken out of it; and where it is.
struct BondsOfState {
  PerBond<Bond> bonds;
  PerBond<BondHistory> history;
  std::vector<WarmBond> warm;
};
BondsOfState take_bonds(State& state) {
  return {std::exchange(state.bonds, {}), std::exchange(state.bond_history, {}),
          std::exchange(state.warm_bonds, {})};
}
struct AllBonds {
  const PerBond<Bond>& bonds;
  const PerBond<BondHistory>& history;
  const std::vector<WarmBond>& warm;
};

/// Takes up what is known to a part of the bonds from this one on: own ones, and ends of others.
template <class IsOwn>
void take_up(const AllBonds& whole, std::size_t first, IsOwn is_own, const Order& order, State& state,
             PartBonds& to, SharedByBonds& shared) {
  for (std::size_t k = first; k < whole.bonds.size(); ++k) {
    const Bond& b = whole.bonds[BondId{k}];
    shared.add(b);
    if (is_own(b)) {
      state.bonds.push_back(b);
      to.names.push_back(BondId{k});
    } else if (!b.broken && (order.knows(b.i) || order.knows(b.j))) {
      to.others.push_back({BondId{k}, b.i, b.j, image_of_j(b), is_cracked(b)});
    }
  }
  if (!whole.history.empty())
    for (std::size_t k = state.bond_history.size(); k < state.bonds.size(); ++k) {
      const BondId name = to.names[BondId{k}];
      state.bond_history.push_back(name.value < whole.history.size() ? whole.history[name] : no_history);
    }
  for (WarmBond w : whole.warm) {
    const auto k = w.bond.value < first ? std::nullopt : to.find(w.bond);
    if (!k) continue;
    w.bond = *k;
    state.warm_bonds.push_back(w);
  }
}

/// What all parts send, some names at a time: take(name, what was sent for it).
template <class T, class Send, class Take>
void tell_all(std::size_t bonds, const PartBonds& part, const Communicator& all, Send send, Take take) {
  constexpr std::size_t at_once = 1 << 16;
  std::size_t next = 0;  // of own ones
  for (std::size_t last = at_once, first = 0; first < bonds; first = last, last += at_once) {
    std::vector<T> some;
    for (; next < part.names.size() && part.names[BondId{next}].value < last; ++next)
      some.push_back(send(BondId{next}));
    for (const T& told : all.gather(some)) take(told);
  }
}

/// Gives a state those of all parts, of which each has these as its own.
void give_all_bonds(const AllBonds& own, const PartBonds& part, const SharedByBonds& shared,
                    const Communicator& all, State& whole) {
  std::array<double, 2> sums{static_cast<double>(own.bonds.size()), own.history.empty() ? 0.0 : 1.0};
  all.sum(sums);
  const auto bonds = static_cast<std::size_t>(sums[0]);
  whole.bonds.assign(bonds, {});
  tell_all<SentBond>(
      bonds, part, all, [&](BondId k) { return sent(own.bonds[k], part.names[k], shared); },
      [&](const SentBond& b) { whole.bonds[b.name] = received(b, shared); });
  whole.bond_history.assign(sums[1] > 0.0 ? bonds : 0, {});
  struct Memory {
    BondId name;
    BondHistory history;
  };
  if (sums[1] > 0.0)
    tell_all<Memory>(
        bonds, part, all,
        [&](BondId k) {
          return Memory{part.names[k], k.value < own.history.size() ? own.history[k] : no_history};
        },
        [&](const Memory& m) { whole.bond_history[m.name] = m.history; });
  whole.warm_bonds = in_order_of_bonds(all.gather(by_name(own.warm, part.names)));
}

}  // namespace

void SharedByBonds::add(const Bond& b) {
  if (laws.empty() || laws.back() != b.law)
    if (place_in(laws, b.law) == laws.size()) laws.push_back(b.law);
  if (rules.empty() || rules.back() != b.rules)
    if (place_in(rules, b.rules) == rules.size()) rules.push_back(b.rules);
}

std::uint32_t SharedByBonds::place_of_law(const Bond& b) const {
  return place_in(laws, b.law);
}
std::uint32_t SharedByBonds::place_of_rules(const Bond& b) const {
  return place_in(rules, b.rules);
}

std::vector<WarmBond> by_name(std::vector<WarmBond> warm, const PerBond<BondId>& names) {
  for (WarmBond& w : warm) w.bond = names[w.bond];
  return warm;
}

std::vector<WarmBond> in_order_of_bonds(std::vector<WarmBond> warm) {
  std::sort(warm.begin(), warm.end(), [](const WarmBond& a, const WarmBond& b) { return a.bond < b.bond; });
  return warm;
}

PartBonds keep_own_bonds(State& state, const Order& order, bool leads, SharedByBonds& shared) {
  const BondsOfState whole = take_bonds(state);
  const auto is_own = [&](const Bond& b) { return order.has(b.i) || (leads && is_absent(state, b.i)); };
  const auto own = static_cast<std::size_t>(std::count_if(whole.bonds.begin(), whole.bonds.end(), is_own));
  PartBonds bonds{.own_alone = true, .names = {}, .others = {}};
  state.bonds.reserve(own), bonds.names.reserve(own);
  if (!whole.history.empty()) state.bond_history.reserve(own);
  take_up({whole.bonds, whole.history, whole.warm}, 0, is_own, order, state, bonds, shared);
  return bonds;
}

SharedByBonds shared_by(const BondsFromSetUp& own) {
  SharedByBonds shared;
  for (const Bond& b : own.kinds) shared.add(b);
  return shared;
}

std::vector<BondEnds> ends_of_others(const PerBond<BondId>& names, const State& state, const Order& order,
                                     const Communicator& all) {
  if (!all.any(!state.bonds.empty())) return {};
  std::vector<ParticleId> known;
  for (Row k{order.own}; k.value < order.known; ++k.value)
    if (!order.is_empty(k)) known.push_back(order.particle[k]);
  PerParticle<char> is_known(state.r.size(), 0);  // by any other than its own part
  all.tell_all(known, [&is_known](ParticleId p) { is_known[p] = 1; });
  std::vector<BondEnds> mine, others;
  for (const BondId k : state.bonds.ids()) {
    const Bond& b = state.bonds[k];
    if (!b.broken && (is_known[b.i] != 0 || is_known[b.j] != 0))
      mine.push_back({names[k], b.i, b.j, image_of_j(b), is_cracked(b)});
  }
  all.tell_all(mine, [&](const BondEnds& b) {
    if (!order.has(b.i) && (order.knows(b.i) || order.knows(b.j))) others.push_back(b);
  });
  std::sort(others.begin(), others.end(),
            [](const BondEnds& a, const BondEnds& b) { return a.name < b.name; });
  return others;
}

PartBonds keep_known_bonds(BondsFromSetUp own, const State& state, const Order& order,
                           SharedByBonds& shared) {
  if (!std::all_of(state.bonds.begin(), state.bonds.end(),
                   [&order](const Bond& b) { return order.has(b.i); }))
    throw std::logic_error("a part has other particles than it was set up for");
  shared = shared_by(own);
  own.part.others = ends_of_others(own.part.names, state, order, *own.all);
  return std::move(own.part);
}

namespace {

/// A bond on its way, with all that a state has of it.
struct Moved {
  SentBond bond;
  BondHistory history;
  bool remembers;
  WarmBond warm;  // no expansion: it is none
};

/// A state takes up bonds one by one, in the order of their names.
class Appended {
 public:
  Appended(State& state, PerBond<BondId>& names, bool remember)
      : state_(state), names_(names), remember_(remember) {}

  void add(const Bond& bond, BondId name, const BondHistory& history, WarmBond warm) {
    warm.bond = BondId{state_.bonds.size()};
    state_.bonds.push_back(bond);
    names_.push_back(name);
    if (remember_) state_.bond_history.push_back(history);
    if (warm.expansion != 0.0) state_.warm_bonds.push_back(warm);
  }

 private:
  State& state_;
  PerBond<BondId>& names_;
  bool remember_;
};

}  // namespace

void move_bonds(const GoesTo& goes_to, State& state, PartBonds& bonds, const SharedByBonds& shared,
                const Communicator& all) {
  const auto history = [&state](BondId k) {
    return state.bond_history.empty() ? no_history : state.bond_history[k];
  };
  const auto warm = [&state](BondId k) {
    const auto at = std::lower_bound(state.warm_bonds.begin(), state.warm_bonds.end(), k,
                                     [](const WarmBond& w, BondId id) { return w.bond < id; });
    return at != state.warm_bonds.end() && at->bond == k ? *at : WarmBond{};
  };
  bool remember = !state.bond_history.empty(), any_leave = false;
  std::vector<std::vector<Moved>> leave(static_cast<std::size_t>(all.ranks()));
  for (const BondId k : state.bonds.ids())
    if (const auto to = goes_to(state.bonds[k].i)) {
      leave[*to].push_back({sent(state.bonds[k], bonds.names[k], shared), history(k), remember, warm(k)});
      any_leave = true;
    }
  std::vector<Moved> come;
  for (const std::vector<Moved>& some : all.swap(leave)) come.insert(come.end(), some.begin(), some.end());
  if (come.empty() && !any_leave) return;
  std::sort(come.begin(), come.end(),
            [](const Moved& a, const Moved& b) { return a.bond.name < b.bond.name; });
  for (const Moved& m : come) remember |= m.remembers;

  State now;
  PerBond<BondId> names;
  Appended to(now, names, remember);
  auto next = come.begin();
  const auto add_come_before = [&](BondId name) {
    for (; next != come.end() && next->bond.name < name; ++next)
      to.add(received(next->bond, shared), next->bond.name, next->history, next->warm);
  };
  for (const BondId k : state.bonds.ids()) {
    if (goes_to(state.bonds[k].i)) continue;
    add_come_before(bonds.names[k]);
    to.add(state.bonds[k], bonds.names[k], history(k), warm(k));
  }
  add_come_before(BondId{std::numeric_limits<std::uint32_t>::max()});
  state.bonds = std::move(now.bonds);
  state.bond_history = std::move(now.bond_history);
  state.warm_bonds = std::move(now.warm_bonds);
  bonds.names = std::move(names);
}

std::shared_ptr<const IdSet<ParticleId>> particles_of_part(const State& state, const Stage& stage,
                                                           const Order& order) {
  return std::make_shared<IdSet<ParticleId>>(IdSet<ParticleId>::of(state.r.size(), [&](const auto& add) {
    for (const ParticleId p : absent(state)) add(p);
    for (Row k{0}; k.value < order.known; ++k.value) add(order.particle[k]);
    for (const Bond& b : state.bonds) add(b.i), add(b.j);
    for (const Support& s : stage.supports)
      if (s.rigid)
        for (const ParticleId p : s.particles) add(p);
  }));
}

void take_up_bonds(const State& whole, std::size_t first, const Order& order, State& state, PartBonds& bonds,
                   SharedByBonds& shared) {
  take_up(
      {whole.bonds, whole.bond_history, whole.warm_bonds}, first,
      [&order](const Bond& b) { return order.has(b.i); }, order, state, bonds, shared);
}

State with_all_bonds(State& state, const PartBonds& part, const SharedByBonds& shared,
                     const Communicator& all) {
  BondsOfState own = take_bonds(state);
  State whole = state;  // without a copy of these, which would be the largest part of it
  state.bonds = std::move(own.bonds);
  state.bond_history = std::move(own.history);
  state.warm_bonds = std::move(own.warm);
  give_all_bonds({state.bonds, state.bond_history, state.warm_bonds}, part, shared, all, whole);
  return whole;
}

State with_all_bonds(State&& state, const PartBonds& part, const SharedByBonds& shared,
                     const Communicator& all) {
  const BondsOfState own = take_bonds(state);
  State whole = std::move(state);
  give_all_bonds({own.bonds, own.history, own.warm}, part, shared, all, whole);
  return whole;
}

}  // namespace vbond
