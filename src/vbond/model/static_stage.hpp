#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/stage.hpp"

namespace vbond {

/// What a stage computes. All but the first are static: they look for balance, not for motion.
enum class StageKind : std::uint8_t { dynamics, equilibrium, path, buckling, modes, fracture };
constexpr bool is_static(StageKind kind) {
  return kind != StageKind::dynamics;
}

/// Loads that turn with a particle have no potential: no critical loads, no modes, no books of fracture.
constexpr bool takes_followers(StageKind kind) {
  return kind == StageKind::dynamics || kind == StageKind::equilibrium || kind == StageKind::path;
}

enum class LinearSolver : std::uint8_t { automatic, direct, multigrid };
enum class AtSaddle : std::uint8_t { leave, keep };

/// How far Newton's method goes.
struct NewtonSettings {
  double tolerance = 1e-10;  ///< largest unbalanced force over the largest force in the body
  int iterations = 60;       ///< most for one load factor
  LinearSolver solver = LinearSolver::automatic;
};

/// Where a path turns off at a bifurcation.
struct BranchSwitch {
  int bifurcation = 1;  ///< the first on the path is 1
  int mode = 1;         ///< of several that become unstable at once, from 1
  double sense = 1.0;   ///< +1 or -1: which way along the mode
};

/// Settings of a path.
struct PathSettings {
  double first_step = 0.01;  ///< change of the load factor in the first step, != 0
  /// Longest step, as the largest movement of a particle, or its rotation times the length scale  [length];
  /// 0: automatic.
  double largest_step = 0.0;
  int most_points = 1000;       ///< > 0
  std::optional<double> above;  ///< ends where the load factor reaches this from below
  std::optional<double> below;  ///< ends where the load factor reaches this from above
  std::optional<DistanceStop> distance;
  std::optional<BranchSwitch> branch;
};

/// What happens to the load factor while bonds break: it stays, so that one break may bring on the next, or
/// it is lowered until one bond alone is at its strength.
enum class FractureControl : std::uint8_t { load, crack };

/// Settings of a stage of fracture. The load factor begins at 0.
struct FractureSettings {
  FractureControl control = FractureControl::load;
  double end = 1.0;                 ///< load factor at which the stage ends, > 0
  int most_breaks = 1'000'000;      ///< > 0
  std::optional<double> load_drop;  ///< ends when this part of the peak load is lost, > 0, <= 1
};

/// Waves of a periodic body: how its images move against each other.
struct WaveVectors {
  std::vector<Vec3d> q;  ///< the image at a distance w moves as the particle times exp(i q . w)
  /// q is not in 1/length: its components are the parts of 2 pi by which the phase grows along the three
  /// edges of the cell.
  bool of_edges = false;
};

/// One static leg of the run, resolved: no names to look up, all in the units of the model.
struct StaticStage : StageTerms {
  std::string name;
  StageKind kind = StageKind::equilibrium;
  Vec3d gravity;                  ///< [length/time^2]
  bool constant_gravity = false;  ///< at full size from the start
  std::vector<Support> supports;
  std::vector<PointLoad> loads;
  CellDrive cell;  ///< of a periodic body: all kinds but modes
  /// Path, buckling, fracture: what run_static_stage() takes from the balance at load factor 0: the stress of
  /// components that give way [force/length^2], and how rigid supports have turned, in their order.
  std::array<double, 6> cell_stress_at_start{};
  std::vector<Quatd> grip_turns_at_start;
  WaveVectors waves;  ///< of a periodic body: modes, buckling; none: the images move alike
  NewtonSettings newton;
  int steps = 1;  ///< equilibrium, fracture: load steps at least; more if they are too large
  AtSaddle at_saddle = AtSaddle::leave;  ///< equilibrium: what to do at an unstable balance
  PathSettings path;
  FractureSettings fracture;
  double search_to =
      0;          ///< buckling: largest load factor at which critical loads are looked for; 0: no limit
  int count = 6;  ///< modes: frequencies besides those of rigid motions; buckling: critical loads
  int frames_per_mode = 16;  ///< modes, buckling: frames of one swing; 0: none
  double amplitude = 0;  ///< of the frames: largest movement of a particle [length]; 0: a tenth of the body
};

}  // namespace vbond
