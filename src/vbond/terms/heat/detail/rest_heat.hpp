#pragma once
#include <vector>

#include "vbond/model/state.hpp"
#include "vbond/statics/detail/rest_term.hpp"
#include "vbond/terms/heat/term_heat.hpp"

namespace vbond {

class StaticBody;

/// Temperatures of a stage at rest, which change in proportion to the load factor.
class RestHeat final : public RestTerm {
 public:
  using Of = HeatTerm;
  /// Keeps references; state: that of the body.
  RestHeat(const StaticBody& body, State& state) : body_(body), state_(state) {}

  bool is_there() const override;
  void take_hold() override;
  void follow() override;
  /// Differences over an interval in which loads are linear but for the square of its length.
  void add_load_rates(LoadSum& to) const override;
  double imposed_strain() const override;

  /// Whether bonds change their lengths with the load factor.
  bool changes_bonds() const { return !growth_rate_.empty(); }
  /// What it does to bonds, per load factor.  [energy]
  double power() const;

 private:
  const StaticBody& body_;
  State& state_;
  PerParticle<double> temperature_before_;  // as the stage took hold
  std::vector<double> growth_rate_;         // of each bond that expands, per load factor
};

}  // namespace vbond
