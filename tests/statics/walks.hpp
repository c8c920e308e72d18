#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bodies.hpp"
#include "vbond/core/error.hpp"

namespace vbond::testing {

/// One point as an observer keeps it.
struct Seen {
  State state;
  double load_factor;
  PointKind kind;
  std::optional<int> unstable;
  double energy;
};

struct Walked {
  StaticResult result;
  std::vector<Seen> seen;
  const State& last() const { return seen.back().state; }
  const Seen& at(const SpecialPoint& p) const { return seen.at(static_cast<std::size_t>(p.point) - 1); }
};

inline Walked walk(const Specimen& s, const StaticStage& stage) {
  Walked w;
  StaticHooks hooks;
  hooks.point = [&w](const StaticPoint& p) {
    w.seen.push_back({p.state, p.load_factor, p.kind, p.unstable, p.energies.potential()});
  };
  w.result = run_static_stage(s.model, stage, s.state, hooks).result;
  return w;
}

inline std::string refusal(const Specimen& s, const StaticStage& stage) {
  try {
    walk(s, stage);
  } catch (const NoEquilibrium& e) {
    return e.what();
  }
  return "";
}

}  // namespace vbond::testing
