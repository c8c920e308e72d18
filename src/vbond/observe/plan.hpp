#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/losses.hpp"
#include "vbond/model/model.hpp"
#include "vbond/observe/frame_format.hpp"

namespace vbond {

/// A group whose mean stress and strain are written, and the volume that it takes up as the run begins.
struct StressedGroup {
  Group group;
  double volume = 0;        ///< [length^3]
  bool of_spheres = false;  ///< that of its particles alone: those that a sink takes out take theirs along
};

/// What of a run is written by this process: of a body that several step, one of them writes everything but
/// for the others' parts of frames.
enum class Writes : std::uint8_t { everything, own_parts };

/// What a run writes, where, and how often; groups looked up and times in the units of the model.
struct OutputPlan {
  std::filesystem::path folder;  ///< exists and may be written to
  Writes writes = Writes::everything;
  bool writes_all() const { return writes == Writes::everything; }
  UnitSystem units = UnitSystem::reduced;  ///< of the model, for the names of units
  double history_every = 0;                ///< between rows of history.csv  [time], > 0
  std::vector<Group> reactions;            ///< total support force and moment, in history.csv
  std::vector<Group> axial_force;          ///< mean tension of the bonds inside, in history.csv
  std::vector<Group> displacements;        ///< mean of r - r_0, in history.csv
  std::vector<Group> velocities;           ///< mean of v, in history.csv
  std::vector<StressedGroup> stresses;     ///< mean stress and strain, in history.csv
  std::vector<std::string> walls;          ///< names of those of the model, in history.csv and in frames
  std::vector<std::string> grips;          ///< groups that some stage moves as rigid bodies, in history.csv
  /// Of terms, by their keys: groups with columns in history.csv.
  std::map<std::string, std::vector<Group>> of_terms;
  /// Between frames of dynamics  [time], > 0, infinite if there is none; absent: no frames at all.
  std::optional<double> frames_every;
  FrameFormat frame_format;                ///< of those frames, and of those of modes
  bool lammps_dump = false;                ///< dump.lammpstrj with the frames
  std::optional<double> checkpoint_every;  ///< [time], > 0; absent: only at the end and on a signal
  std::int64_t watch_every = 100;          ///< steps between looks at bonds and energy, > 0
  double overlap = 0.1;                    ///< of the smaller radius that is reported; 0: never looked at
  bool statics = false;                    ///< there are static stages, with columns of their own
  bool capsules = false;                   ///< some bond touches as a capsule: one more array in frames
  bool breaks = false;                     ///< some bond may break: breaks.csv, fragments.csv, more columns
  bool flow = false;                       ///< some bond may yield, creep or soften: arrays of bonds
  bool cell = false;                       ///< the body is periodic: columns of its cell, and its frames
  bool passage = false;                    ///< bodies come in or particles are taken out: more columns
  std::vector<Loss> losses;                ///< what may dissipate energy, in history.csv and run.json
  double energy_error = 0.05;              ///< relative error of the energy balance that stops a run

  FrameFormat format_of_frames() const {
    FrameFormat format = frame_format;
    format.breaks = breaks;
    format.capsules = capsules;
    format.flow = flow;
    format.walls = !walls.empty();
    format.cell = cell;
    return format;
  }
};

}  // namespace vbond
