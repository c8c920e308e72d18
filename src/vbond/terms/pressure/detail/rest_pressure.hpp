#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/state.hpp"
#include "vbond/statics/detail/rest_term.hpp"
#include "vbond/terms/pressure/pressed.hpp"
#include "vbond/terms/pressure/term_pressure.hpp"

namespace vbond {

class StaticBody;

/// Pressures of a stage at rest, in proportion to the load factor but for constant ones.
///
/// The force of a follower on a facet has no potential of its own: that of a closed surface has, and that of
/// one whose edge is held. So which part of the tangent is antisymmetric is summed up over all facets, and
/// what is left of it beyond rounding shows that the load has no energy.
class RestPressure final : public RestTerm {
 public:
  using Of = PressureTerm;
  /// Keeps references; state: that of the body.
  RestPressure(const StaticBody& body, State& state) : body_(body), state_(state) {}

  bool is_there() const override;
  /// The facets of the state, if it has those of this stage; else those of the stage.
  void take_hold() override;
  void add_applied(double load_factor, Loads& to) const override;
  void add_loads(LoadSum& to) const override;
  void add_load_rates(LoadSum& to) const override;
  void add_pairs(std::vector<Assembly::Pair>& pairs) const override;
  void add_stiffness(StiffnessSum& to) const override;
  double work(const Placement& from, const Placement& to, double load_factor) const override;
  double largest_skew() const override { return skew().largest; }
  void for_skew(const SkewEntry& entry) const override;
  std::optional<std::string> without_energy() const override;

 private:
  struct Entry {
    int row, column;
    double K, size;  // of all that has been added up
  };
  struct Skew {
    std::vector<Entry> entries;
    double largest = 0;  // sum of a row  [force/length]
    std::uint64_t placement = 0;
  };
  double at(std::uint32_t pressure, double load_factor) const;
  Assembly::Block block(const PressedFacet& facet, int corner) const;
  template <class Visit>
  void for_blocks(const Visit& visit) const;
  void push(ParticleId p, const Vec3d& change, StiffnessSum& to) const;
  const Skew& skew() const;

  const StaticBody& body_;
  State& state_;
  PressedSurfaces surfaces_;
  mutable Skew skew_;  // of the placement with this number
};

}  // namespace vbond
