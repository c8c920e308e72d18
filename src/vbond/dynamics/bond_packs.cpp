#include "vbond/dynamics/bond_packs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "vbond/dynamics/kernel.hpp"

namespace vbond {
namespace {

/// Types beyond these are not looked for: each bond is compared with all.
constexpr std::size_t most_types = 16;

bool close(double x, double y) {
  return std::abs(x - y) <= 4.0 * std::numeric_limits<double>::epsilon() * std::abs(y);
}

bool is_scaled(const Bond& b, const BondType& t, double scale) {
  for (std::size_t k = 0; k < most_coefficients; ++k)
    if (!close(scale * t.coefficients[k], b.coefficients[k])) return false;
  return true;
}

std::size_t upper_row(const Bond& b, const Order& order) {
  return std::max(order.row_i(b), order.row_j(b)).value;
}

std::size_t row_of_work(const Bond& b, const Order& order) {
  const std::size_t upper = upper_row(b, order);
  return order.ghost_bonds_last && upper >= order.ghosts ? upper : lower_row(b, order);
}

void put(const Quatd& q, std::size_t l, double (&to)[4][pack_bonds]) {
  to[0][l] = q.w, to[1][l] = q.x, to[2][l] = q.y, to[3][l] = q.z;
}

void fill_lane(CompactPack& p, std::size_t l, const Bond& b, double scale) {
  p.a[l] = b.a;
  p.scale[l] = scale;
  put(b.frame_i, l, p.frame);
}
void fill_lane(FullPack& p, std::size_t l, const Bond& b, double /*scale*/) {
  p.a[l] = b.a, p.R_i[l] = b.R_i, p.R_j[l] = b.R_j;
  for (std::size_t k = 0; k < most_coefficients; ++k) p.coefficients[k][l] = b.coefficients[k];
  put(b.frame_i, l, p.frame_i);
  put(frame_j(b), l, p.frame_j);
}

/// By their own rows: those of images depend on which images there are, and with them the order of bonds
/// would change when a run is resumed.
std::size_t rows_apart(const Bond& b, const Order& order) {
  const std::size_t i = order.row[b.i].value, j = order.row[b.j].value;
  return i < j ? j - i : i - j;
}

/// The farther apart its particles are, to a factor of two, the sooner.
int pass_of(const Bond& b, const Order& order) {
  return -static_cast<int>(std::bit_width(rows_apart(b, order)));
}

BondRates<double> rates_between(const MotionRow& i, const MotionRow& j) {
  return {j.v - i.v, i.omega, j.omega};
}

/// Calls f(first, last) for the longest stretches of items that are `alike`.
template <class Items, class Alike, class F>
void for_stretches(const Items& items, Alike alike, F f) {
  for (std::size_t first = 0, last; first < items.size(); first = last) {
    last = first + 1;
    while (last < items.size() && alike(items[first], items[last])) ++last;
    f(first, last);
  }
}

}  // namespace

/// A bond with what it is sorted by.
struct BondPacks::Sorted {
  std::size_t row;  // the one with whose block it is worked on
  Kind kind;
  int pass;  // through its block
  BondId bond;
  bool expands;
  std::size_t block() const { return row / block_rows; }
};

BondPacks::Kind BondPacks::kind_of(const Bond& b, bool expands) {
  if (!has_other_frame(b) && !expands && !b.law->has_offsets) {
    for (std::size_t t = 0; t < types_.size(); ++t) {
      const BondType& type = types_[t];
      if (type.law != b.law || type.rules != b.rules || type.R_i != b.R_i || type.R_j != b.R_j) continue;
      for (const double scale : {1.0, type.a / b.a})
        if (is_scaled(b, type, scale)) return {true, static_cast<std::uint32_t>(t), scale};
    }
    if (types_.size() < most_types) {
      types_.push_back({b.law, b.rules, is_damped(b), can_break(b), b.a, b.R_i, b.R_j, b.coefficients});
      return {true, static_cast<std::uint32_t>(types_.size() - 1), 1.0};
    }
  }
  return {false, number_of(b), 1.0};
}

/// The place of a bond's law and rules among those that occur: first the library's laws without rules, then
/// others as they come.
std::uint32_t BondPacks::number_of(const Bond& b) {
  const auto at = std::find_if(full_types_.begin(), full_types_.end(),
                               [&](const BondType& t) { return t.law == b.law && t.rules == b.rules; });
  const auto number = static_cast<std::uint32_t>(at - full_types_.begin());
  if (at == full_types_.end()) full_types_.push_back({b.law, b.rules, is_damped(b), can_break(b)});
  return number;
}

void BondPacks::arrange(const State& state, const Order& order, const Team& team, const Communicator& all) {
  *this = {};
  const PerBond<Bond>& bonds = state.bonds;
  for (const BondLaw* law : named_laws()) full_types_.push_back({law});
  std::vector<Sorted> sorted;
  sorted.reserve(static_cast<std::size_t>(std::count_if(
      bonds.begin(), bonds.end(), [&order](const Bond& b) { return !b.broken && order.has(b.i); })));
  bool any_far = false;  // broken ones, too: so this does not change when a run is resumed
  auto warm = state.warm_bonds.begin();
  for (const BondId b : bonds.ids()) {
    const bool expands = warm != state.warm_bonds.end() && warm->bond == b;
    if (expands) ++warm;
    const Kind kind =
        kind_of(bonds[b], expands);  // asked of broken ones too: kinds are numbered as they come
    if (!order.has(bonds[b].i)) continue;
    any_far |= rows_apart(bonds[b], order) >= block_rows;
    if (bonds[b].broken) continue;
    note(bonds[b]);
    ++bonds_;
    // Full packs are so long that they would push the rows of a block out of the cache between two passes.
    const int pass = kind.compact ? pass_of(bonds[b], order) : 0;
    sorted.push_back({row_of_work(bonds[b], order), kind, pass, b, expands});
  }
  tell_each_other(all);
  if (!any_far)
    for (Sorted& s : sorted) s.pass = 0;
  std::sort(sorted.begin(), sorted.end(), [](const Sorted& a, const Sorted& b) {
    return std::tuple(a.block(), a.kind.compact, a.kind.type, a.pass, a.row, a.bond) <
           std::tuple(b.block(), b.kind.compact, b.kind.type, b.pass, b.row, b.bond);
  });
  const auto of_one_run = [](const Sorted& a, const Sorted& b) {
    return a.block() == b.block() && a.kind == b.kind;
  };

  std::size_t compact = 0, full = 0;
  for_stretches(sorted, of_one_run, [&](std::size_t first, std::size_t last) {
    (sorted[first].kind.compact ? compact : full) += (last - first + pack_bonds - 1) / pack_bonds;
  });
  compact_.reserve(compact);
  full_.reserve(full);

  for_stretches(sorted, of_one_run, [&](std::size_t first, std::size_t last) {
    const std::size_t block = sorted[first].block();
    while (first_run_.size() <= block) first_run_.push_back(runs_.size());
    const Part& own = team.part_of_row(block * block_rows);
    runs_.push_back(add_run(sorted.data() + first, last - first, state, order, own));
  });
  while (first_run_.size() <= team.blocks()) first_run_.push_back(runs_.size());

  at_border_.assign(team.blocks(), 0);
  waits_for_ghosts_.assign(team.blocks(), 0);
  for (std::size_t k = 0; k < team.blocks(); ++k) reach_.push_back(k + 1);
  struct Crossing {
    Sorted bond;
    std::size_t upper;
  };
  std::vector<Crossing> crossing;  // from part to part
  for (const Sorted& s : sorted) {
    const std::size_t lower_block = lower_row(bonds[s.bond], order) / block_rows;
    if (lower_block != s.block()) waits_for_ghosts_[lower_block] = 1;
    const std::size_t upper = upper_row(bonds[s.bond], order), block = upper / block_rows;
    if (upper < order.own && !order.is_early(block))
      reach_[s.block()] = std::max(reach_[s.block()], block + 1);
    if (team.part_of_row(s.row).has(upper)) continue;
    crossing.push_back({s, upper});
    at_border_[s.block()] = 1;
    if (block < team.blocks()) at_border_[block] = 1;
  }

  for (const Part& part : team.parts()) {
    std::vector<Sorted> below, above;
    for (const Crossing& c : crossing)
      if (part.has(c.upper)) (c.bond.block() < part.first_block ? below : above).push_back(c.bond);
    const auto add = [&](const std::vector<Sorted>& others, std::vector<Run>& runs) {
      for_stretches(
          others, [](const Sorted& a, const Sorted& b) { return a.kind == b.kind; },
          [&](std::size_t first, std::size_t last) {
            runs.push_back(add_run(others.data() + first, last - first, state, order, part));
          });
    };
    add(below, from_below_.emplace_back());
    add(above, from_above_.emplace_back());
  }
  std::stable_sort(known_.begin(), known_.end());
}

void BondPacks::note(const Bond& b) {
  reads_rates_ |= needs_rates(b);
  damp_ |= is_damped(b);
  remembers_ |= b.law->remembers();
  all_elastic_ &= !needs_rates(b) && !can_break(b);
}

/// What holds of the bonds of any part holds of the body: parts exchange the same.
void BondPacks::tell_each_other(const Communicator& all) {
  std::array<double, 4> any{reads_rates_ ? 1.0 : 0.0, damp_ ? 1.0 : 0.0, remembers_ ? 1.0 : 0.0,
                            all_elastic_ ? 0.0 : 1.0};
  all.max(any);
  reads_rates_ = any[0] != 0.0, damp_ = any[1] != 0.0, remembers_ = any[2] != 0.0,
  all_elastic_ = any[3] == 0.0;
  auto bonds = static_cast<double>(bonds_);
  all.sum({&bonds, 1});
  bonds_ = static_cast<std::size_t>(bonds);
}

BondPacks::Run BondPacks::add_run(const Sorted* sorted, std::size_t count, const State& state,
                                  const Order& order, const Part& own) {
  const PerBond<Bond>& bonds = state.bonds;
  const PerBond<BondHistory>& history = state.bond_history;
  const Kind kind = sorted->kind;
  const auto add = [&](auto& store) {
    const BondLaw& law = *bonds[sorted->bond].law;
    const Run run{kind.compact,
                  kind.type,
                  &bond_loops(law, step_kernel()),
                  &law,
                  store.packs.size(),
                  (count + pack_bonds - 1) / pack_bonds,
                  store.history.size()};
    const std::size_t remembered = law.history.size();
    for (std::size_t first = 0; first < count; first += pack_bonds) {
      auto& pack = store.packs.emplace_back();
      PackLanes& lanes = store.lanes.emplace_back();
      lanes.active = static_cast<std::uint8_t>((1u << std::min(pack_bonds, count - first)) - 1);
      const std::size_t at = store.history.size();
      store.history.resize(at + remembered * pack_bonds);
      for (std::size_t l = 0; l < pack_bonds; ++l) {
        const Sorted& s = sorted[std::min(first + l, count - 1)];  // lanes past the last bond repeat it
        const Bond& b = bonds[s.bond];
        pack.i[l] = order.row_i(b).value;
        pack.j[l] = order.row_j(b).value;
        fill_lane(pack, l, b, s.kind.scale);
        for (std::size_t n = 0; n < remembered && s.bond.value < history.size(); ++n)
          store.history[at + n * pack_bonds + l] = history[s.bond][n];
        if ((can_break(b) || s.expands) && first + l < count)
          known_.push_back({s.bond, kind.compact, store.bond.size(), at + l, &law});
        store.bond.push_back(s.bond);
        if (lanes.has(l) && own.has(pack.i[l])) lanes.to_i |= static_cast<std::uint8_t>(1u << l);
        if (lanes.has(l) && own.has(pack.j[l])) lanes.to_j |= static_cast<std::uint8_t>(1u << l);
      }
    }
    return run;
  };
  return kind.compact ? add(compact_) : add(full_);
}

/// Calls f(the kernel's functions for its packs, run as they take it, where it lies).
template <class F>
void BondPacks::visit(const Run& run, F f) const {
  if (run.compact)
    f(run.loops->compact, compact_.run(run, &types_[run.type]), compact_);
  else
    f(run.loops->full, full_.run(run, &full_types_[run.type]), full_);
}

void BondPacks::add_loads(const std::vector<Run>& runs, BondSweep& sweep) {
  for (const Run& r : runs)
    visit(r, [&](const auto& kernel, const auto& run, const auto&) { kernel.add_loads(run, sweep); });
}

void BondPacks::add_loads(const Block& block, BondSweep& sweep, const RowsAhead& ahead,
                          std::vector<BreakingBond>* broken) {
  const std::size_t first = first_run_[block.index];
  for (std::size_t r = first; r < first_run_[block.index + 1]; ++r)
    visit(runs_[r], [&](const auto& kernel, auto&& run, const auto& store) {
      if (r == first) run.ahead = ahead;
      if (broken == nullptr || !run.type->breakable) return kernel.add_loads(run, sweep);
      std::vector<std::uint8_t> breaking(run.count);
      sweep.broken = breaking.data();
      kernel.add_loads(run, sweep);
      sweep.broken = nullptr;
      for (std::size_t k = 0; k < run.count; ++k)
        for (std::size_t l = 0; breaking[k] >> l != 0; ++l)
          if ((breaking[k] >> l & 1) != 0)
            broken->push_back(
                {store.bond[(runs_[r].first + k) * pack_bonds + l],
                 reads_rates_ ? rates_between(sweep.rates[run.packs[k].i[l]], sweep.rates[run.packs[k].j[l]])
                              : BondRates<double>{}});
    });
}

void BondPacks::take_lengths(BondId bond, const Bond& b) {
  const auto [first, last] = std::equal_range(known_.begin(), known_.end(), Lane{bond});
  for (auto at = first; at != last; ++at) {
    FullPack& pack = full_.packs[at->lane / pack_bonds];
    const std::size_t l = at->lane % pack_bonds;
    pack.a[l] = b.a, pack.R_i[l] = b.R_i, pack.R_j[l] = b.R_j;
  }
}

void BondPacks::remove(BondId bond) {
  const auto [first, last] = std::equal_range(known_.begin(), known_.end(), Lane{bond});
  for (auto at = first; at != last; ++at) {
    std::vector<PackLanes>& lanes = at->compact ? compact_.lanes : full_.lanes;
    lanes[at->lane / pack_bonds].remove(at->lane % pack_bonds);
  }
  ++removed_;
}

BondHistory BondPacks::history(BondId bond) const {
  BondHistory history{};
  const auto at = std::lower_bound(known_.begin(), known_.end(), Lane{bond});
  const LargeArray<double>& numbers = at->compact ? compact_.history : full_.history;
  for (std::size_t n = 0; n < at->law->history.size(); ++n)
    history[n] = numbers[at->history + n * pack_bonds];
  return history;
}

void BondPacks::put_history(BondId bond, const BondHistory& history) {
  const auto [first, last] = std::equal_range(known_.begin(), known_.end(), Lane{bond});
  for (auto at = first; at != last; ++at) {
    LargeArray<double>& numbers = at->compact ? compact_.history : full_.history;
    for (std::size_t n = 0; n < at->law->history.size(); ++n)
      numbers[at->history + n * pack_bonds] = history[n];
  }
}

void BondPacks::collect(PerBond<BondHistory>& history) const {
  const auto collect_run = [&](const Run& run, const auto& store) {
    const std::size_t n = run.law->history.size();
    for (std::size_t k = 0; k < run.count * pack_bonds; ++k)
      for (std::size_t number = 0; number < n && store.lanes[run.first + k / pack_bonds].has(k % pack_bonds);
           ++number)
        history[store.bond[run.first * pack_bonds + k]][number] =
            store.history[run.first_history + (k / pack_bonds * n + number) * pack_bonds + k % pack_bonds];
  };
  for (const Run& run : runs_)
    if (run.law->remembers()) run.compact ? collect_run(run, compact_) : collect_run(run, full_);
}

Energies BondPacks::survey(const Team& team, const PoseRow* pose, std::vector<BondId>& deformed) const {
  std::vector<BondEnergies> of_block(team.blocks());
  std::vector<std::vector<BondId>> of_part(team.parts().size());
  team.for_parts([&](const Part& part) {
    std::vector<std::uint8_t> look;
    for (std::size_t b = part.first_block; b < part.last_block; ++b)
      for (std::size_t r = first_run_[b]; r < first_run_[b + 1]; ++r)
        visit(runs_[r], [&](const auto& kernel, const auto& run, const auto& store) {
          look.resize(run.count);
          kernel.survey(run, pose, of_block[b], look.data());
          for (std::size_t k = 0; k < run.count; ++k)
            for (std::size_t l = 0; look[k] >> l != 0; ++l)
              if ((look[k] >> l & 1) != 0)
                of_part[part.index].push_back(store.bond[(runs_[r].first + k) * pack_bonds + l]);
        });
  });
  Energies sum;
  for (const BondEnergies& e : of_block) sum.U_L += e.U_L, sum.U_B += e.U_B, sum.U_T += e.U_T;
  for (const std::vector<BondId>& bonds : of_part)
    deformed.insert(deformed.end(), bonds.begin(), bonds.end());
  std::sort(deformed.begin(), deformed.end());
  return sum;
}

}  // namespace vbond
