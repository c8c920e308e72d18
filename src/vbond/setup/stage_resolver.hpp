#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// Turns the parts that stages of all kinds have from names into numbers, and records every mistake.
struct StageResolver {
  const Case& c;
  const Model& model;
  const StageSpec& spec;
  Problems& problems;

  std::vector<ParticleId> particles(const Placed<std::string>& group) const;
  std::optional<DistanceStop> distance_stop(const DistanceStopSpec& s) const;
  TimeFunction function(const TimeFunctionSpec& f, const SourcePlace& place) const;
  double time(const CaseTime& t, const char* what, const SourcePlace& place) const;
  double positive_time(const CaseTime& t, const char* what, const SourcePlace& place) const;
  /// A unit vector.
  Vec3d direction(const Vec3d& d, const char* what, const SourcePlace& place) const;

  /// Those that overlap must agree; grips need particles.
  std::vector<Support> supports() const;
  std::vector<PointLoad> loads() const;
  CellDrive cell_drive() const;
  /// Whether supports leave any degree of freedom.
  bool anything_is_free(const std::vector<Support>& supports) const;

 private:
  bool at_rest() const { return is_static(spec.kind); }
  void check_supports(const std::vector<Support>& supports) const;
  double mass_of(const std::vector<ParticleId>& particles) const;
};

/// Whether this bond set makes its bonds (when = stage) as this stage begins.
bool makes_bonds_as_it_begins(const BondSpec& set, const StageSpec& stage);

/// Makes the bonds (when = stage) of stage k, which begins. threads: see build().
void add_stage_bonds(const Case& c, std::size_t k, const Model& model, State& state, Problems& problems,
                     int threads);

}  // namespace vbond
