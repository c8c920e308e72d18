#include "memory.hpp"

#include <fmt/format.h>

#include <cmath>

#include "vbond/build/build.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/memory.hpp"
#include "vbond/dynamics/memory.hpp"

namespace vbond::app {
namespace {

constexpr const char* whose_limit = "the memory of the machine, or the limit of its container or of ulimit";

void require(double bytes, const std::string& what, const Case& c) {
  const double limit = memory_limit();
  if (bytes <= limit) return;
  throw CaseError({{c.file, 0, 0},
                   fmt::format("{} take at least {} of memory", what, in_units(bytes)),
                   fmt::format("there may be {}: {}", in_units(limit), whose_limit),
                   "take fewer particles, or another machine"});
}

void require(double bytes, const Case& c, const RanksHere& ranks) {
  const double limit = machine_memory();
  if (bytes <= limit) return;
  throw CaseError(
      {{c.file, 0, 0},
       fmt::format("{} ranks on one machine take at least {} of memory", ranks.number, in_units(bytes)),
       fmt::format("there may be {}, and each rank holds the whole body", in_units(limit)),
       "take fewer ranks, or more machines, or vbond --threads N, which holds the body once"});
}

}  // namespace

std::string in_units(double bytes) {
  constexpr double KiB = 0x1p10, MiB = 0x1p20, GiB = 0x1p30;
  if (std::isinf(bytes)) return "more than 16 GiB";  // beyond CHOLMOD's index
  if (bytes >= GiB) return fmt::format("{:.3g} GiB", bytes / GiB);
  if (bytes >= MiB) return fmt::format("{:.3g} MiB", bytes / MiB);
  return fmt::format("{:.3g} KiB", bytes / KiB);
}

void require_memory(const Case& c) {
  const double n = count_particles(c);
  require(n * memory_use({}, {}).per_particle, fmt::format("{:.0f} particles", n), c);
}

void require_memory(const Case& c, const Model& model, const State& state) {
  const MemoryUse use = memory_use(model, state);
  const auto n = static_cast<double>(model.particles()), bonds = static_cast<double>(state.bonds.size());
  require(n * use.per_particle + bonds * use.per_bond,
          fmt::format("{:.0f} particles and {:.0f} bonds", n, bonds), c);
}

void require_memory(const Case& c, const RanksHere& ranks) {
  require(count_particles(c) * memory_use({}, {}).per_particle * ranks.number, c, ranks);
}

void require_memory(const Case& c, const Model& model, const State& state, const RanksHere& ranks) {
  const RankMemory use = memory_of_ranks(model, state, ranks.all);
  require(ranks.number * use.each + (ranks.first ? use.first - use.each : 0.0), c, ranks);
}

std::string out_of_memory() {
  return fmt::format(
      "memory has run out; there may be {}: {}\n"
      "  vbond check CASE says what the time loop takes; take fewer particles, or another machine",
      in_units(memory_limit()), whose_limit);
}

}  // namespace vbond::app
