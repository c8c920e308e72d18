#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/specimen_figures.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/observe/breaks.hpp"
#include "vbond/observe/history_values.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// How a static stage went.
struct StaticSummary {
  StageKind kind = StageKind::equilibrium;
  StaticResult result;  ///< shapes and residuals do not go into run.json
  std::string failure;  ///< what stood in the way, if there is no result
  friend bool operator==(const StaticSummary&, const StaticSummary&) = default;
};

/// How a stage went.
struct StageSummary {
  std::string name;
  StopReason stop = StopReason::running;
  std::int64_t steps = 0;
  double dt = 0;                         ///< [time]
  double time = 0;                       ///< of the run at the stage's end  [time]
  std::optional<double> critical_force;  ///< largest block average, if the stop was a peak  [force]
  std::optional<double> peak_time;       ///< end of that block  [time]
  std::optional<StaticSummary> statics;  ///< of a static stage, to which stop and dt say nothing
  std::string failure;                   ///< what went wrong, if the stop was `diverged`
  friend bool operator==(const StageSummary&, const StageSummary&) = default;
};

/// Wall time of one phase of the program.
struct PhaseTime {
  std::string name;
  double seconds = 0;
};

/// What has broken, where bonds may break.
struct BreakSummary {
  std::int64_t broken = 0;  ///< bonds at the end
  BreakRecord first;
  std::optional<double> peak_load;  ///< of the rows of history.csv and of breaks  [force]
};

/// A wall at the end of a run.
struct WallSummary {
  std::string name;
  Vec3d force, moment;       ///< of particles on it, moment about its centre  [force], [moment]
  Vec3d displacement;        ///< of its centre  [length]
  double work = 0;           ///< that it has done on particles  [energy]
  double largest_force = 0;  ///< size, of the rows of history.csv  [force]
  friend bool operator==(const WallSummary&, const WallSummary&) = default;
};

/// The cell of a periodic body at the end of a run.
struct CellSummary {
  std::array<Vec3d, 3> edges;  ///< [length]
  CellValues values;
  friend bool operator==(const CellSummary&, const CellSummary&) = default;
};
CellSummary summarise_cell(const Model& model, const BodyPart& body);

/// What has come in and gone by the end of a run.
struct PassageSummary {
  struct OfSource {
    std::string name;
    std::int64_t bodies = 0, came_in = 0, due = 0;  ///< due: more that were, and have not come in
    friend bool operator==(const OfSource&, const OfSource&) = default;
  };
  std::int64_t present = 0;  ///< particles that take part
  MassBooks mass;
  double inserted = 0, removed = 0;  ///< [energy]
  std::vector<OfSource> sources;
  friend bool operator==(const PassageSummary&, const PassageSummary&) = default;
};
PassageSummary summarise_passage(const Model& model, const State& state);

/// A specimen of packed grains, as it was packed.
struct PackingSummary {
  std::string name;
  std::int64_t grains = 0, rattlers = 0, removed = 0, grown = 0;
  double porosity = 0, core_porosity = 0;  ///< core: deeper than a mean radius below walls; -1: there is none
  double least_radius = 0, mean_radius = 0, largest_radius = 0,
         size_factor = 1;  ///< [length]; radii over those asked
  double sizes_off = 0;    ///< largest distance of the curve of sizes from that asked for
  /// Volumes of the cells of grains, porosities of these, faces; -1: not worked out in such a vessel.
  double least_cell_volume = -1, mean_cell_volume = -1, largest_cell_volume = -1;  ///< [length^3]
  double least_local_porosity = -1, mean_local_porosity = -1, largest_local_porosity = -1, cell_faces = -1;
  double contacts = 0, backbone_contacts = 0, overlap = 0, pressure = 0;
  std::vector<std::array<double, 2>> neighbours;  ///< factor of the sum of radii, mean number within it
  double rdf_step = 0;                            ///< in mean diameters
  std::vector<double> rdf;
  friend bool operator==(const PackingSummary&, const PackingSummary&) = default;
};

/// The results of a run, as run.json holds them.
struct RunSummary {
  std::string title, version;
  std::string instruction_set;  ///< of the bond kernel, see instruction_set()
  std::string blas_kernel;      ///< with which static stages compute; empty if there are none
  int threads = 1;              ///< asked for
  int threads_used = 1;         ///< in the last stage; a small body is not shared out
  UnitSystem units = UnitSystem::reduced;
  std::int64_t particles = 0, bonds = 0;
  double T_0 = 0;                          ///< [time]
  std::optional<BreakSummary> breaks;      ///< absent where no bond may break
  std::vector<WallSummary> walls;          ///< in the order of the case
  std::vector<SpecimenFigures> specimens;  ///< those that are made at random
  std::optional<CellSummary> cell;         ///< of periodic bodies
  std::optional<PassageSummary> passage;   ///< where bodies come in or particles are taken out
  std::vector<PackingSummary> packings;
  /// What is dissipated at the end, by the causes that the case may have.  [energy]
  std::vector<std::pair<std::string, double>> dissipated;
  std::vector<StageSummary> stages;                  ///< those that ended, or were interrupted last
  double energy_balance_error = 0;                   ///< largest |balance_error| of history.csv, relative
  std::int64_t strained = 0, snapped = 0;            ///< bonds as they stand at the end
  std::int64_t ever_strained = 0, ever_snapped = 0;  ///< bonds that the watch has seen so at any time
  std::int64_t ever_overlapping = 0;                 ///< pairs without a bond that it has seen overlap
  std::int64_t ever_stretched = 0;                   ///< bonds that it has seen beyond twice their length
  std::optional<std::int64_t> dropped;               ///< particles, where the case drops such
  double too_fast = 0;                               ///< WatchRecord::fastest if reported, else 0
  std::int64_t bond_steps = 0;                       ///< bonds times steps since the program was started
  double stepping_seconds = 0;                       ///< wall time of those steps, without output
  std::vector<PhaseTime> wall_time;
};

/// The wall time of the steps as phases that add up to it: bonds, contacts, integrate in the shares of
/// these times, or "steps" if they are all zero, as in a run too short for a sample; and "set_up_anew" if
/// that was done.
std::vector<PhaseTime> split_steps(double seconds, const StepTimes& times);

/// The stage of this simulation as it stands.
StageSummary summarise_stage(const Simulation& run, StopReason stop);

/// "duration", "distance", "peak", "rest", "breaks", "interrupted", "running": as in run.json.
const char* to_text(StopReason reason);

/// "dynamics", "equilibrium", "path", "buckling", "modes", "fracture".
const char* to_text(StageKind kind);

/// Whether a stage was in motion: static ones have no balance of energy over time.
bool any_dynamics(const RunSummary& summary);

/// The text of run.json. Critical force, critical forces and frequencies of the run are those of the last
/// stage that found any.
std::string to_json(const RunSummary& summary);

/// Replaces run.json in one go. Throws IoError.
void write_summary(const std::filesystem::path& path, const RunSummary& summary);

/// A run.json read back, but for wall times and what it was computed with. Throws IoError if the file cannot
/// be read or is not a run.json.
RunSummary read_summary(const std::filesystem::path& path);

/// The stages in a run.json that end at or before a stage index, to go on with when resuming: those
/// before `stage`. Throws IoError if the file cannot be read or is not a run.json.
std::vector<StageSummary> read_stages_before(const std::filesystem::path& path, std::int32_t stage);

}  // namespace vbond
