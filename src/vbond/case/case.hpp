#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/bond_spec.hpp"
#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"
#include "vbond/case/source_spec.hpp"
#include "vbond/case/specimen_spec.hpp"
#include "vbond/case/stage_spec.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/model.hpp"
#include "vbond/terms/keys_terms.hpp"

/// A case as the user wrote it, checked key by key and turned into the units of the model.
/// Names of groups, walls and stages are still names, and times may still be multiples of T_0: setup/
/// resolves both.
namespace vbond {

// ---- the cell -----------------------------------------------------------------------------------

/// What a periodic body repeats with.
struct CellSpec {
  SourcePlace place;
  /// Whose file has the box that gives edges and corner; absent: they are those below.
  std::optional<Placed<std::string>> from_specimen;
  std::array<Vec3d, 3> edges{};
  Vec3d corner;
  std::array<bool, 3> open{};
  bool triangular = false;
};

// ---- the run -------------------------------------------------------------------------------------

enum class VelocityKind : std::uint8_t { given, circle, ball, gaussian, rigid };
struct VelocitySpec {
  SourcePlace place;
  Placed<std::string> group{"all", {}};
  VelocityKind kind = VelocityKind::given;
  Vec3d velocity, angular_velocity;  ///< given: of each particle; rigid: of the group as one body
  double magnitude = 0;              ///< circle, ball: radius v_0; gaussian: standard deviation per component
  Vec3d normal{1, 0, 0};             ///< circle: the plane's normal
  std::array<bool, 3> zero{};        ///< components set to zero afterwards
  std::uint64_t seed = 1;
};

struct ExactStep {};  ///< a fraction of the exact critical step of the assembled body

struct TimeSpec {
  /// Absent: a fraction of the bound that single bonds give.
  std::optional<Placed<std::variant<CaseTime, ExactStep>>> step;
  double fraction = 0.1;  ///< of the critical step, unless a time is given
  bool insist = false;    ///< accept a given time above the bound
  const CaseTime* given() const { return step ? std::get_if<CaseTime>(&step->value) : nullptr; }
};

/// A volume that is worked out from particles as they stand at the start.
enum class StressVolume : std::uint8_t {
  spheres,  ///< theirs, as spheres
  box       ///< of the box along the axes around them, with their radii
};

/// A group whose mean stress and strain are written.
struct StressSpec {
  SourcePlace place;
  Placed<std::string> group;
  std::variant<double, StressVolume> volume;  ///< that the group takes up
};

struct FramesSpec {
  std::optional<CaseTime> every;  ///< of dynamics stages, which need it; static stages write every point
  bool single_precision = false;  ///< real numbers of 32 bits, not 64
  bool compressed = true;
  bool stress = false;    ///< of each particle
  bool contacts = false;  ///< a file for them, too
  bool wrap = false;      ///< particles of a periodic body are shown in its cell
};

struct OutputSpec {
  CaseTime history_every{10, true};
  std::vector<Placed<std::string>> reactions;      ///< groups: total support force and moment
  std::vector<Placed<std::string>> axial_force;    ///< groups: mean tension over the bonds inside
  std::vector<Placed<std::string>> displacements;  ///< groups, or particle numbers as text
  std::vector<Placed<std::string>> velocities;     ///< likewise
  std::vector<StressSpec> stresses;                ///< of groups
  std::optional<FramesSpec> frames;                ///< absent: none
  bool lammps_dump = false;                        ///< with the frames
  std::optional<CaseTime> checkpoint_every;        ///< absent: only at the end and on a signal
};

struct WatchSpec {
  std::int64_t every = 100;    ///< steps between looks at bonds and energy
  double energy_error = 0.05;  ///< relative; above it the run stops
  double overlap = 0.1;  ///< of the smaller radius; more, of what is not bonded, is reported; 0: none is
  OnUnphysical on_unphysical = OnUnphysical::stop;
};

struct Case {
  std::string file;                  ///< path as given, for messages
  std::vector<std::string> changes;  ///< of keys, made after the file was read
  std::string title;
  UnitSystem units = UnitSystem::reduced;
  std::optional<CellSpec> cell;
  std::vector<SpecimenSpec> specimens;
  std::vector<GroupSpec> groups;
  std::vector<BondSpec> bonds;
  std::vector<MaterialSpec> materials;
  std::vector<WallSpec> walls;
  ContactModel contact;
  std::vector<ContactPairSpec> contact_between;
  std::vector<VelocitySpec> velocities;
  std::vector<SourceSpec> sources;
  std::vector<SinkSpec> sinks;
  TimeSpec time;
  std::vector<StageSpec> stages;
  OutputSpec output;
  WatchSpec watch;

  bool any_dynamics() const {
    return std::any_of(stages.begin(), stages.end(), [](const StageSpec& s) { return !is_static(s.kind); });
  }
};

}  // namespace vbond
