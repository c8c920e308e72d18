#include "vbond/observe/detail/fracture_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <sstream>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/observe/detail/fracture_tables.hpp"

namespace vbond {
namespace {

constexpr const char* begun_path = "/fracture/begun";

[[noreturn]] void damaged(const char* what) {
  throw IoError(fmt::format("is damaged: {}", what));
}
void require(bool holds, const char* what) {
  if (!holds) damaged(what);
}

/// Hands the numbers of a break to f(number), in their order; numbers are those of the row, or go there.
template <class Break, class Each>
void for_numbers_of_break(Break& b, Each&& f) {
  f(b.point), f(b.avalanche), f(b.use.bond), f(b.use.i), f(b.use.j), f(b.use.utilisation),
      f(b.use.load_factor);
  f(b.shares.tension), f(b.shares.shear), f(b.shares.bending), f(b.shares.torsion), f(b.shares.compression);
  f(b.section.N), f(b.section.V), f(b.section.M_b), f(b.section.M_t);
  f(b.middle.x), f(b.middle.y), f(b.middle.z), f(b.direction.x), f(b.direction.y), f(b.direction.z);
  f(b.load), f(b.load_factor_after), f(b.load_after), f(b.held), f(b.released), f(b.work), f(b.stored);
}
constexpr std::size_t known_after = 29;  // place of the number that follows these

struct ToNumber {
  double* to;
  void operator()(double x) { *to++ = x; }
  void operator()(int x) { *to++ = x; }
  template <class Tag>
  void operator()(const Id<Tag>& x) {
    *to++ = x.value;
  }
  void operator()(const std::optional<double>& x) { *to++ = x.value_or(0.0); }
};
struct FromNumber {
  const double* from;
  double whole() {
    const double x = *from++;
    if (!(x >= 0.0 && x < 0x1p31 && x == std::floor(x))) damaged("a break has an impossible number");
    return x;
  }
  void operator()(double& x) { x = *from++; }
  void operator()(int& x) { x = static_cast<int>(whole()); }
  template <class Tag>
  void operator()(Id<Tag>& x) {
    x = Id<Tag>{static_cast<std::size_t>(whole())};
  }
  void operator()(std::optional<double>& x) { x = *from++; }
};

FiledBreak filed_break(const BrokenBond& b) {
  FiledBreak row;
  for_numbers_of_break(b, ToNumber{row.numbers.data()});
  row.numbers[known_after] = b.load_after ? 1.0 : 0.0;
  return row;
}
BrokenBond break_of(const FiledBreak& row) {
  BrokenBond b;
  for_numbers_of_break(b, FromNumber{row.numbers.data()});
  if (row.numbers[known_after] == 0.0) b.load_factor_after.reset(), b.load_after.reset();
  return b;
}

template <class Row, class Value>
std::vector<Row> rows_with(const std::vector<Value>& values) {
  std::vector<Row> rows;
  for (const Value& v : values) rows.push_back({v});
  return rows;
}
template <class Value, class Row>
std::vector<Value> values_in(const std::vector<Row>& rows) {
  std::vector<Value> values;
  for (const Row& row : rows) values.push_back(row.value);
  return values;
}

std::vector<FiledWord> words_of(const std::mt19937_64& random) {
  std::ostringstream out;
  out << random;
  std::istringstream in(out.str());
  std::vector<FiledWord> words;
  for (std::uint64_t word = 0; in >> word;) words.push_back({static_cast<std::int64_t>(word)});
  return words;
}
std::mt19937_64 random_of(const std::vector<FiledWord>& words) {
  std::ostringstream out;
  for (const FiledWord& w : words) out << static_cast<std::uint64_t>(w.value) << ' ';
  std::istringstream in(out.str());
  std::mt19937_64 random;
  require(static_cast<bool>(in >> random), "its random numbers are not complete");
  return random;
}

FiledPart filed_part(const HeldPart& part) {
  FiledPart row{part.particle, part.dof, part.why == HeldPart::Why::floats, part.grip, part.axes.has_value()};
  for (std::size_t k = 0; part.axes && k < 6; ++k)
    for (int x = 0; x < 3; ++x)
      row.axes[3 * k + static_cast<std::size_t>(x)] = component(part.axes->of(k), x);
  return row;
}
HeldPart part_of(const FiledPart& row) {
  HeldPart part{row.particle, row.dof, row.floats != 0 ? HeldPart::Why::floats : HeldPart::Why::came_off,
                row.grip};
  require(row.dof < 6, "a part is held along an impossible direction");
  if (!row.turned) return part;
  part.axes.emplace();
  for (std::size_t k = 0; k < 6; ++k) {
    Vec3d& axis = k < 3 ? part.axes->along[k] : part.axes->about[k - 3];
    axis = {row.axes[3 * k], row.axes[3 * k + 1], row.axes[3 * k + 2]};
  }
  return part;
}

FiledFound filed_found(const StaticResult& r) {
  const FractureResult& f = r.fracture;
  const FractureBooks& b = f.books;
  return {r.points,    r.iterations,       r.factors, f.released_parts, f.avalanches, f.largest_avalanche,
          f.peak_load, f.peak_load_factor, b.initial, b.work,           b.stored,     b.dissipated,
          b.released,  b.largest};
}
StaticResult result_of(const FiledFound& f, double load_factor) {
  StaticResult r;
  r.load_factor = load_factor;
  r.points = static_cast<int>(f.points), r.iterations = static_cast<int>(f.iterations);
  r.factors = static_cast<int>(f.factors);
  r.unstable = 0;
  r.fracture.released_parts = static_cast<int>(f.released_parts);
  r.fracture.avalanches = static_cast<int>(f.avalanches);
  r.fracture.largest_avalanche = static_cast<int>(f.largest_avalanche);
  r.fracture.peak_load = f.peak_load, r.fracture.peak_load_factor = f.peak_load_factor;
  r.fracture.books = {f.initial, f.work, f.stored, f.dissipated, f.released, f.largest};
  return r;
}

using Pairs = std::vector<std::pair<ParticleId, ParticleId>>;

std::vector<FiledPair> filed_pairs(const Pairs& pairs) {
  std::vector<FiledPair> rows;
  for (const auto& [i, j] : pairs) rows.push_back({i, j});
  return rows;
}
Pairs pairs_of(const std::vector<FiledPair>& rows) {
  Pairs pairs;
  for (const FiledPair& p : rows) pairs.emplace_back(p.i, p.j);
  return pairs;
}

void file_factor(const KeptFactorUnderWay& k, const Pairs& pattern, FiledFracture& to) {
  if (k.random != std::mt19937_64()) to.random = words_of(k.random);
  if (!k.made_at) return;
  const KeptFactorUnderWay::Place& at = *k.made_at;
  to.factor = {at.load_factor, at.breaks, k.proofs, k.spent, k.in_cycle, k.slow, k.wasted, k.recent};
  to.factor_r = at.r, to.factor_q = at.q;
  for (const CellEdge& e : at.cell) to.factor_cell.push_back({e.along});
  for (const KeptFactorUnderWay::Change& c : k.changes) {
    to.change_sizes.push_back({static_cast<std::int32_t>(c.unknowns.size())});
    for (const std::int32_t u : c.unknowns) to.change_unknowns.push_back({u});
    for (const double x : c.numbers) to.change_numbers.push_back({x});
    to.change_least.push_back({c.least_part});
  }
  if (at.pattern != pattern) to.factor_pattern = filed_pairs(at.pattern);
  to.random_as_made = words_of(k.random_as_made);
}

/// The next so many of these, from a place on that moves with them.
template <class Value, class Row>
std::vector<Value> take(const std::vector<Row>& rows, std::size_t& from, std::size_t number) {
  require(number <= rows.size() - from, "a change of its factor is cut short");
  std::vector<Value> values;
  for (std::size_t k = 0; k < number; ++k) values.push_back(rows[from++].value);
  return values;
}
std::size_t size_of(const FiledCount& size) {
  constexpr std::int32_t most = 1000;  // unknowns: their squares are stored
  require(size.value > 0 && size.value <= most, "a change of its factor has an impossible size");
  return static_cast<std::size_t>(size.value);
}

KeptFactorUnderWay factor_of(const FiledFracture& f) {
  KeptFactorUnderWay k;
  if (!f.random.empty()) k.random = random_of(f.random);
  if (f.factor_r.empty()) return k;
  KeptFactorUnderWay::Place at{f.factor_r, f.factor_q, {}, f.factor.load_factor, f.factor.breaks, {}};
  for (const FiledPlace& e : f.factor_cell) at.cell.push_back({.along = e.value});
  at.pattern = pairs_of(f.factor_pattern.empty() ? f.pattern : f.factor_pattern);
  k.made_at = std::make_shared<const KeptFactorUnderWay::Place>(std::move(at));
  std::size_t unknown = 0, number = 0;
  for (const FiledCount& c : f.change_sizes) {
    const std::size_t size = size_of(c);
    KeptFactorUnderWay::Change change{take<std::int32_t>(f.change_unknowns, unknown, size), {}, 1e-3};
    change.numbers = take<double>(f.change_numbers, number, size * size);
    if (k.changes.size() < f.change_least.size()) change.least_part = f.change_least[k.changes.size()].value;
    k.changes.push_back(std::move(change));
  }
  const auto exists = [&](const FiledCount& u) { return u.value >= 0 && u.value < f.numbers.unknowns; };
  require(std::all_of(f.change_unknowns.begin(), f.change_unknowns.end(), exists),
          "its factor is of other unknowns");
  k.random_as_made = random_of(f.random_as_made);
  k.proofs = f.factor.proofs, k.spent = f.factor.spent, k.in_cycle = f.factor.in_cycle;
  k.slow = f.factor.slow, k.wasted = f.factor.wasted, k.recent = f.factor.recent;
  return k;
}

/// The tangent has room for all bonds that are left.
bool has_room(const FiledFracture& f, const State& state) {
  if (f.pattern.empty()) return true;
  Pairs pairs = pairs_of(f.pattern);
  std::sort(pairs.begin(), pairs.end());
  return std::all_of(state.bonds.begin(), state.bonds.end(), [&](const Bond& b) {
    return b.broken || std::binary_search(pairs.begin(), pairs.end(), std::pair(b.i, b.j));
  });
}

void check_sense(const FiledFracture& f, const FractureUnderWay& then, const Model& model,
                 const State& state) {
  const std::size_t n = model.particles();
  const std::vector<BrokenBond>& breaks = then.found.fracture.breaks;
  require(f.found.points > 0 && f.found.points == state.clock.stage_step, "its stage is at another point");
  require(f.numbers.breaks >= 0 && f.numbers.breaks <= static_cast<std::int64_t>(breaks.size()),
          "it has more breaks than are listed");
  require(!then.factor.made_at || (f.factor.breaks >= 0 && f.factor.breaks <= f.numbers.breaks &&
                                   f.factor_q.size() == n && f.factor_cell.size() == state.cell.size()),
          "its factor is of another body");
  for (const BrokenBond& b : breaks)
    require(b.use.bond.value < state.bonds.size() && b.use.i.value < n && b.use.j.value < n &&
                b.point <= f.found.points,
            "a break is of none of its bonds");
  for (const HeldPart& part : then.held) require(part.particle.value < n, "a part that is held is missing");
  for (const auto* pairs : {&f.pattern, &f.factor_pattern})
    for (const FiledPair& p : *pairs) require(p.i.value <= n && p.j.value <= n, "its tangent is of others");
  require(has_room(f, state), "its tangent lacks a bond");
  require(f.rate.empty() || static_cast<std::int64_t>(f.rate.size()) == f.numbers.unknowns,
          "it moves other unknowns");
  require(then.begun->bonds.size() == state.bonds.size(), "it began with other bonds");
  require(!f.numbers.flows ||
              (f.remembered.size() == state.bonds.size() && state.bond_history.size() == state.bonds.size()),
          "bonds that flow have no past");
}

}  // namespace

void write_fracture(H5Writer& file, const FractureUnderWay& now) {
  FiledFracture f;
  f.numbers = now.numbers;
  f.found = filed_found(now.found);
  for (const BrokenBond& b : now.found.fracture.breaks) f.breaks.push_back(filed_break(b));
  f.residuals = rows_with<FiledNumber>(now.found.residuals);
  f.rate = rows_with<FiledNumber>(now.rate);
  for (const HeldPart& part : now.held) f.held.push_back(filed_part(part));
  f.turned = rows_with<FiledTurn>(now.turned_at_start);
  f.turns_of_grips = rows_with<FiledTurn>(now.turns_of_grips);
  f.pattern = filed_pairs(*now.pattern);
  f.remembered = now.remembered_before, f.of_tangent = now.remembered_of_tangent;
  file_factor(now.factor, *now.pattern, f);
  write_tables(file, under_way_table, f);
  file.go_into(begun_path);
  write_tables(file, state_table, *now.begun);
  file.go_into("");
}

bool has_fracture(const H5Reader& file) {
  return file.has("/fracture") && file.has("/fracture/load_factor");
}

std::shared_ptr<const FractureUnderWay> read_fracture(H5Reader& file, const Model& model, const State& state,
                                                      KnownLaws laws) {
  FiledFracture f;
  const FileSizes sizes{.particles = model.particles(), .bonds = state.bonds.size()};
  read_tables(file, under_way_table, sizes, laws, f);
  State begun;
  file.go_into(begun_path);
  read_tables(file, state_table, {.particles = model.particles(), .bonds = file.rows("/bonds/i")}, laws,
              begun);
  file.go_into("");
  for (const auto& mistakes : {mistakes_in(model, begun), mistakes_in_values(model, begun)})
    require(mistakes.empty(), "the state in which its stage began");
  auto then = std::make_shared<FractureUnderWay>();
  then->numbers = f.numbers;
  then->found = result_of(f.found, f.numbers.load_factor);
  if (f.numbers.open) then->found.unstable.reset();
  for (const FiledBreak& row : f.breaks) then->found.fracture.breaks.push_back(break_of(row));
  then->found.residuals = values_in<double>(f.residuals);
  then->rate = values_in<double>(f.rate);
  for (const FiledPart& row : f.held) then->held.push_back(part_of(row));
  then->turned_at_start = values_in<Quatd>(f.turned);
  then->turns_of_grips = values_in<Quatd>(f.turns_of_grips);
  then->pattern = std::make_shared<const Pairs>(pairs_of(f.pattern));
  then->remembered_before = f.remembered, then->remembered_of_tangent = f.of_tangent;
  then->begun = std::make_shared<const State>(std::move(begun));
  then->factor = factor_of(f);
  check_sense(f, *then, model, state);
  return then;
}

}  // namespace vbond
