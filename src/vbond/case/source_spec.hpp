#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"
#include "vbond/core/vec3.hpp"

/// What comes in and goes during a run, as the user wrote it; see case.hpp.
namespace vbond {

/// When it is looked at, in stages of dynamics.
struct VisitSpec {
  std::vector<Placed<std::string>> stages;  ///< none: all stages of dynamics
  std::optional<CaseTime> from, until;      ///< of the time of each of these stages
  std::optional<CaseTime> every;            ///< absent: after Visits::default_steps
};

/// Where bodies come in: it ends on all sides.
using ClosedRegion = std::variant<BoxRegion, SphereRegion, CylinderRegion, MeshRegion>;

struct SourceSpec {
  SourcePlace place;
  std::string name;
  Placed<std::string> specimen;  ///< the body
  std::int64_t count = 1;        ///< bodies in all
  double rate = 0;               ///< bodies per time; 0: all are due at once
  VisitSpec visits;
  ClosedRegion region;
  bool whole = true;   ///< the region holds all of a body; else its centre
  bool turned = true;  ///< at random; else as the specimen stands
  Vec3d velocity, angular_velocity;
  double velocity_spread = 0, angular_velocity_spread = 0;
  std::uint64_t seed = 1;
  std::int64_t tries = 100;
};

struct SinkSpec {
  SourcePlace place;
  std::string name;
  Placed<std::string> group{"all", {}};
  Region region;
  bool outside = false;  ///< what is outside of the region goes; else what is inside
  VisitSpec visits;
};

}  // namespace vbond
