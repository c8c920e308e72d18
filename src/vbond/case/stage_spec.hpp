#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/terms/keys_terms.hpp"

/// Stages as the user wrote them.
namespace vbond {

struct SupportSpec {
  SourcePlace place;
  Placed<std::string> group;
  HeldDofs held{};                  ///< along and about the world's axes
  std::vector<Vec3d> along, about;  ///< held as well: translations along, rotations about these, not zero
  // dynamics
  Vec3d velocity, angular_velocity;
  TimeFunctionSpec factor;
  // static stages: at load factor 1
  Vec3d displacement, rotation;
  bool rigid = false;
  std::optional<Vec3d> pivot = {};  ///< rigid
};

/// What a support holds.
inline HeldDirections directions_of(const SupportSpec& s) {
  return held_directions(s.held, s.along, s.about);
}

struct LoadSpec {
  SourcePlace place;
  Placed<std::string> group;
  Vec3d force, moment;                        ///< on each particle
  TimeFunctionSpec factor;                    ///< dynamics
  bool constant = false;                      ///< static stages: not in proportion to the load factor
  Vec3d total_force = {}, total_moment = {};  ///< on the group, shared by mass
  bool follower = false;                      ///< along the axes of each particle
};

/// What moves a component of the cell: one of rate (dynamics) and strain (at rest), or a stress.
struct CellComponentSpec {
  SourcePlace place;
  std::optional<double> rate, strain, stress;
  TimeFunctionSpec factor;  ///< dynamics
};
struct CellDriveSpec {
  std::array<std::optional<CellComponentSpec>, 6> component{};  ///< as cell_component_names
  std::optional<CellServo> servo;                               ///< dynamics
};

struct DistanceStopSpec {
  SourcePlace place;
  std::array<std::int64_t, 2> between{};
  double value = 0;
  bool below = true;
};

struct RestStopSpec {
  SourcePlace place;
  double kinetic_energy_below = 0;
  CaseTime during;
};

struct BreakStopSpec {
  SourcePlace place;
  std::int64_t count = 1;
};

struct PeakStopSpec {
  SourcePlace place;
  PeakQuantity quantity = PeakQuantity::compressive_force;
  Placed<std::string> group;
  Placed<std::string> wall;  ///< wall_force
  Vec3d direction{1, 0, 0};
  double drop = 0.015;
  double above = 0;
  CaseTime average_over;
};

struct StageSpec : TermSpecs {
  SourcePlace place;
  std::string name;
  StageKind kind = StageKind::dynamics;
  Vec3d gravity;
  std::vector<SupportSpec> supports;
  std::vector<LoadSpec> loads;
  std::optional<CellDriveSpec> cell;              ///< all kinds but modes
  std::optional<DistanceStopSpec> stop_distance;  ///< dynamics, path

  // dynamics
  CaseTime duration;  ///< required, > 0: the longest the stage may take
  double b_translation = 0, b_rotation = 0, local_damping = 0;
  std::optional<PeakStopSpec> stop_peak;
  std::optional<RestStopSpec> stop_rest;
  std::optional<BreakStopSpec> stop_breaks;

  // static stages; what these mean stands with StaticStage
  bool constant_gravity = false;
  NewtonSettings newton;
  int steps = 1;                         ///< equilibrium, fracture
  AtSaddle at_saddle = AtSaddle::leave;  ///< equilibrium
  PathSettings path;                ///< path; its distance comes from stop_distance; two keys of it: buckling
  FractureSettings fracture;        ///< fracture
  double search_to = 0;             ///< buckling
  int count = 6;                    ///< buckling, modes
  int frames_per_mode = 16;         ///< buckling, modes
  double amplitude = 0;             ///< buckling, modes
  std::vector<Vec3d> wave_vectors;  ///< buckling, modes: of a periodic body  [1/length]
  std::vector<Vec3d> wave_phases;   ///< the same, in parts of 2 pi along each edge
};

}  // namespace vbond
