#include "vbond/run/memory_needed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "vbond/core/error.hpp"
#include "vbond/core/memory.hpp"
#include "vbond/dynamics/step_memory.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/own_bonds.hpp"

namespace vbond {
namespace {

constexpr const char* whose_limit = "the memory of the machine, or the limit of its container or of ulimit";

/// The most that any of these processes takes, and the least that there may be for one: so all refuse, or
/// none.
struct Needed {
  Needed(double needed, double there, const Communicator& all) : bytes(needed), limit(there) {
    std::array<double, 2> largest{bytes, -limit};
    all.max(largest);
    bytes = largest[0], limit = -largest[1];
  }
  double bytes, limit;
};

std::string limit_in_words(double limit) {
  return fmt::format("{}: {}", bytes_in_units(limit), whose_limit);
}

void require(double here, const std::string& what, const Case& c, const Communicator& all) {
  const auto [bytes, limit] = Needed(here, memory_limit(), all);
  if (bytes <= limit) return;
  throw CaseError({{c.file, 0, 0},
                   fmt::format("{} take at least {} of memory", what, bytes_in_units(bytes)),
                   "there may be " + limit_in_words(limit),
                   "take fewer particles, or another machine"});
}

void require(double here, const char* how, const Case& c, const RanksHere& ranks, const Communicator& all) {
  const auto [bytes, limit] = Needed(here, machine_memory(), all);
  if (bytes <= limit) return;
  throw CaseError(
      {{c.file, 0, 0},
       fmt::format("{} ranks on one machine take {} {} of memory", ranks.number, how, bytes_in_units(bytes)),
       fmt::format("there may be {}, and each rank makes all particles", bytes_in_units(limit)),
       "take fewer ranks, or more machines, or vbond --threads N, which holds the body once"});
}

/// The largest distance at which the rule bonds a pair.  [length]
double farthest(const BondingRule& rule, const Model& model) {
  double R = 0.0;
  for (const ParticleId p : model.radius.ids())
    if (rule.in_a[p.value] || rule.in_b[p.value]) R = std::max(R, model.radius[p]);
  return rule.reach(R, R);
}

/// Pairs that the rule joins and that have no bond yet.
double pairs_now(const BondingRule& rule, const Model& model, const State& state) {
  const double most = memory_limit() / memory_use(model, state).per_bond;
  const std::size_t all =
      pairs_within(model, state, {rule.distance, rule.factor}, rule.in_a, rule.in_b, most).size();
  const auto is_one = [&](const Bond& b) {
    const bool joins =
        (rule.in_a[b.i.value] && rule.in_b[b.j.value]) || (rule.in_a[b.j.value] && rule.in_b[b.i.value]);
    const double reach = rule.limit(model.radius[b.i], model.radius[b.j]);
    return !b.broken && joins && norm(between(state, b)) <= reach;
  };
  const auto bonded = std::count_if(state.bonds.begin(), state.bonds.end(), is_one);
  return static_cast<double>(all) - static_cast<double>(bonded);
}

/// With bodies that wait.
double bonds_to_come(const Model& model, const State& state) {
  double bonds = 0.0;
  for (const Source& s : model.sources)
    bonds += static_cast<double>((s.bodies - bodies_in(s, state)) * s.bonds.size());
  return bonds;
}

double pairs_ever(const BondingRule& rule) {
  double in_a = 0.0, in_b = 0.0, in_both = 0.0;
  for (std::size_t p = 0; p < rule.in_a.size(); ++p) {
    in_a += rule.in_a[p] ? 1.0 : 0.0, in_b += rule.in_b[p] ? 1.0 : 0.0;
    in_both += rule.in_a[p] && rule.in_b[p] ? 1.0 : 0.0;
  }
  return in_a * in_b - 0.5 * in_both * (in_both + 1.0);  // each pair once, none with itself
}

BondsToCome bonds_to_come(const Case& c, const Run& run, const BondingRule& rule) {
  try {
    return {rule.name, farthest(rule, run.model()), pairs_now(rule, run.model(), run.current()),
            pairs_ever(rule)};
  } catch (const std::length_error&) {
    const auto set =
        std::find_if(c.bonds.begin(), c.bonds.end(), [&](const BondSpec& s) { return s.name == rule.name; });
    throw CaseError(Problem{
        set != c.bonds.end() ? set->place : SourcePlace{c.file, 0, 0},
        fmt::format("bonds \"{}\": more pairs are within {} as the run begins than there is memory for",
                    rule.name, farthest(rule, run.model())),
        "they would be bonded at once, and there may be " + memory_limit_in_words(),
        "use a little more than the spacing; is the distance in the right unit?"});
  }
}

}  // namespace

std::string bytes_in_units(double bytes) {
  constexpr double KiB = 0x1p10, MiB = 0x1p20, GiB = 0x1p30;
  if (std::isinf(bytes)) return "more than 16 GiB";  // beyond CHOLMOD's index
  if (bytes >= GiB) return fmt::format("{:.3g} GiB", bytes / GiB);
  if (bytes >= MiB) return fmt::format("{:.3g} MiB", bytes / MiB);
  return fmt::format("{:.3g} KiB", bytes / KiB);
}

void require_memory(const Case& c) {
  const double n = count_particles(c);
  require(n * memory_use({}, {}).per_particle, fmt::format("{:.0f} particles", n), c, alone());
}

void require_memory(const Case& c, const Model& model, const BodyPart& body) {
  const MemoryUse use = memory_use(model, body.state);
  const double to_come = bonds_to_come(model, body.state);
  const auto n = static_cast<double>(model.particles()),
             here = static_cast<double>(body.state.bonds.size()) + to_come;
  const double bonds = static_cast<double>(count_bonds(body)) + to_come;
  require(n * use.per_particle + here * use.per_bond,
          fmt::format("{:.0f} particles and {:.0f} bonds", n, bonds), c, body.all);
}

std::vector<BondsToCome> bonds_to_come(const Case& c, const Run& run) {
  std::vector<BondsToCome> found;
  for (std::size_t k = run.stage_index(); k < c.stages.size(); ++k) {
    if (is_static(c.stages[k].kind)) continue;
    for (const BondingRule& rule : bonding_rules(c, run.model(), k)) {
      const auto known = [&](const BondsToCome& other) { return other.name == rule.name; };
      if (std::none_of(found.begin(), found.end(), known)) found.push_back(bonds_to_come(c, run, rule));
    }
  }
  return found;
}

RanksKeep ranks_keep(const Case& c) {
  if (may_keep_own_first_places(c)) return RanksKeep::own_first_places;
  if (may_keep_own_motion(c)) return RanksKeep::own_motion;
  return may_keep_own_bonds(c) ? RanksKeep::own_bonds : RanksKeep::all_bonds;
}

void require_memory(const Case& c, const RanksHere& ranks) {
  constexpr double place = sizeof(Vec3d), motion = state_bytes_per_particle - place;
  const int times_motion = may_keep_own_motion(c) ? 1 : ranks.number;  // once, or on each
  require(count_particles(c) * ((model_bytes_per_particle + place) * ranks.number + motion * times_motion),
          "at least", c, ranks, alone());
}

void require_memory(const Case& c, const Model& model, const BodyPart& body, const RanksHere& ranks) {
  if (ranks.all == 1) return;  // it is one process as any, of which this is told already
  const double of_each = memory_of_each_rank(model, body.state, static_cast<double>(count_bonds(body)),
                                             ranks.all, kept_by(model, body));
  require(ranks.number * of_each, "about", c, ranks, body.all);
}

std::string memory_limit_in_words() {
  return limit_in_words(memory_limit());
}

}  // namespace vbond
