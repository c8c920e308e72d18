#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/case/csv_columns.hpp"
#include "vbond/case/fibre_spec.hpp"
#include "vbond/case/packing_spec.hpp"
#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"
#include "vbond/case/source_spec.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/static_stage.hpp"
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

// ---- specimens -------------------------------------------------------------------------------

struct RodSpecimen {
  std::int64_t particles = 0;  ///< >= 2
  double spacing = 1.0;
  Vec3d origin;              ///< first particle
  Vec3d direction{1, 0, 0};  ///< any length but zero
};

/// The paper's half-sphere: a fixed rim, the rest random and relaxed by a repulsion of range cutoff.
struct HemisphereSpecimen {
  std::int64_t particles = 0;  ///< with the rim
  double radius = 0;           ///< R_c
  double spacing = 1.0;        ///< a: the length scale; rim count = round(2 pi R_c / a)
  double min_distance = 0.4;   ///< of the random start, in units of spacing
  double strength = 1e-2;      ///< f_0 in units of c_A (reduced: as is)
  double cutoff = 2.1;         ///< in units of spacing
  double damping = 0.052;      ///< b in units of sqrt(m c_A): 26e-3 b_0
  double step = 0.01;          ///< in units of T_0
  std::int64_t steps = 15000;
  std::uint64_t seed = 1;
};

enum class Lattice : std::uint8_t { simple_cubic, fcc, hcp, bcc };
struct BlockSpecimen {
  Lattice lattice = Lattice::simple_cubic;
  std::array<std::int64_t, 3> cells{
      1, 1, 1};  ///< simple cubic: particles; fcc: cubic cells of 4; hcp: orthogonal cells of 4; bcc: of 2
  double spacing = 1.0;  ///< nearest-neighbour distance
  Vec3d origin;
};

constexpr int particles_in_cell(Lattice lattice) {
  return lattice == Lattice::simple_cubic ? 1 : lattice == Lattice::bcc ? 2 : 4;
}

enum class SheetLattice : std::uint8_t { triangular, square, random };
struct SheetSpecimen {
  SheetLattice lattice = SheetLattice::triangular;
  std::array<std::int64_t, 2> particles{1, 1};  ///< along x, rows along y; not of random ones
  double spacing = 1.0;
  Vec3d origin;
  std::array<double, 2> size{};  ///< random: along x and y  [length]
  std::uint64_t seed = 1;        ///< random
};

struct RingSpecimen {          ///< in the x-y plane, particle 0 on +x
  std::int64_t particles = 0;  ///< >= 3
  double radius = 0;
  Vec3d centre;
};

struct HelixSpecimen {         ///< about z, starting on +x
  std::int64_t particles = 0;  ///< >= 2
  double radius = 0, pitch = 0, turns = 0;
  Vec3d origin;  ///< centre of the first turn's circle
};

/// The unit of a column, and what its numbers are multiplied by.
struct ColumnUnit {
  std::string text;
  double factor = 1;
};

struct CsvSpecimen {                   ///< what stands in it: csv_columns, in whose order the arrays are
  Placed<std::filesystem::path> file;  ///< relative to the case file
  /// Names in the header of the file. Without any, columns have the names of csv_columns, and others are
  /// refused; else those without a name are not read.
  std::array<std::optional<std::string>, csv_columns.size()> columns{};
  std::array<std::optional<ColumnUnit>, csv_columns.size()> units{};
  double scale = 1;                                           ///< of lengths
  std::optional<Placed<std::filesystem::path>> bonds_file{};  ///< CSV with pairs of rows of `file`

  bool names_columns() const {
    return std::any_of(columns.begin(), columns.end(), [](const auto& name) { return name.has_value(); });
  }
  bool has_units() const {
    return std::any_of(units.begin(), units.end(), [](const auto& unit) { return unit.has_value(); });
  }
};

struct LammpsSpecimen {  ///< `atom_style bond` / `molecular` / `full` / `bpm/sphere`-like data file with its
                         ///< Bonds section
  Placed<std::filesystem::path> file;
  std::optional<std::string> atom_style;  ///< absent: that which the file names
  bool velocities = true;  ///< its Velocities section, if there is one, is where the run begins
};

struct ListedSpecimen {
  std::vector<Vec3d> positions;
};

/// How many particles the largest circle of a surface of revolution has, and how far it goes around. Exactly
/// one of spacing and particles is given.
struct AroundSpec {
  std::optional<double> spacing;          ///< of neighbours on the largest circle
  std::optional<std::int64_t> particles;  ///< on a circle; of a panel those of its first one, ends counted
  double angle = 2.0 * std::numbers::pi;  ///< of a panel; a full turn: closed
  Vec3d axis{0, 0, 1};                    ///< any length but zero; x turns with it from z
};

/// Where the particles of a curved surface are: in rows of circles, or at random and even distances.
enum class SurfaceLattice : std::uint8_t { triangular, random };

struct CylinderSpecimen {  ///< a triangular or random sheet rolled up
  double radius = 0, length = 0;
  Vec3d origin;  ///< centre of its first circle
  AroundSpec around;
  SurfaceLattice lattice = SurfaceLattice::triangular;
  std::uint64_t seed = 1;  ///< random
};

struct ConeSpecimen {             ///< truncated; circles of equal numbers of particles
  std::array<double, 2> radii{};  ///< at the origin and at the other end
  double length = 0;              ///< along the axis
  Vec3d origin;                   ///< centre of its first circle
  AroundSpec around;
};

struct SphereSpecimen {
  double radius = 0;
  Vec3d centre;
  std::optional<std::array<double, 2>> polar;  ///< a zone between these angles from the axis; else closed
  AroundSpec around;
  SurfaceLattice lattice = SurfaceLattice::triangular;  ///< random: closed only
  std::uint64_t seed = 1;                               ///< random
};

struct EllipsoidSolid {
  std::array<double, 3> semi_axes{};
};
struct BoxSolid {
  std::array<double, 3> edges{};
};
struct CylinderSolid {           ///< about z
  std::array<double, 2> size{};  ///< radius, length
};
/// A homogeneous body whose moments of inertia, with its particle's mass, a particle has.
struct SolidSpec {
  std::variant<EllipsoidSolid, BoxSolid, CylinderSolid> shape;
};

struct SpecimenSpec {
  SourcePlace place;
  std::string name = "body";  ///< becomes a group
  std::variant<RodSpecimen, HemisphereSpecimen, BlockSpecimen, SheetSpecimen, RingSpecimen, HelixSpecimen,
               CsvSpecimen, LammpsSpecimen, ListedSpecimen, CylinderSpecimen, ConeSpecimen, SphereSpecimen,
               PackingSpecimen, FibresSpecimen>
      shape;
  double radius = 0;           ///< >= 0; required > 0 for contacts, surface bonds, density
  std::optional<double> mass;  ///< exactly one of mass, density (or a file column)
  /// m = 4/3 pi R^3 density, or with a thickness: area * thickness * density, or of fibres their volume.
  std::optional<double> density;
  std::optional<double> thickness;                         ///< of the wall that a surface stands for
  std::optional<double> inertia;                           ///< default 2/5 m R^2
  std::optional<std::array<double, 3>> principal_inertia;  ///< about the axes of the body
  std::optional<std::array<double, 6>> inertia_tensor;     ///< xx, yy, zz, xy, xz, yz
  std::optional<SolidSpec> solid;
  std::optional<Placed<std::string>> material;  ///< default: the first of the case
  std::vector<CutSpec> cut;
  std::optional<TurnSpec> turn;
  Vec3d move;
  std::vector<CopiesSpec> array;  ///< 3 at most
};

// ---- bonds -------------------------------------------------------------------------------------

struct WithinDistance {
  double distance;
};
struct WithinGap {  ///< of the surfaces
  double gap;
};
struct WithinFactor {  ///< of the sum of the radii
  double factor;
};
struct ListedPairs {
  std::vector<std::array<std::int64_t, 2>> pairs;
};
struct PairsFile {
  std::filesystem::path file;
};                                        ///< CSV with header i,j
struct SpecimenPairs {                    ///< the bonds of a LAMMPS data file, or of a bonds_file
  std::optional<std::int64_t> bond_type;  ///< only those of this type of the file
};
struct AtCrossings {  ///< of fibres, bonded where their axes are nearest
  double gap;         ///< of their surfaces
};
enum class BondTime : std::uint8_t { start, stage, approach };

/// Limits as the case names them; which of them count, the criterion says. recipe.rules has what follows.
struct StrengthSpec {
  Criterion criterion = Criterion::none;           ///< not read yet
  double tension = 0, shear = 0, compression = 0;  ///< stresses; compression 0: none
  double moment_share = 1;
  double cohesion = 0, friction_angle = 0;  ///< mohr-coulomb; the angle in rad
  double axial_force = 0, shear_force = 0, bending_moment = 0, torque = 0;  ///< linear, quadratic
  bool compression_relieves = false;                                        ///< linear
  std::optional<double> moments;                                            ///< mohr-coulomb: moment_share
  double tension_energy = 0, other_energy = 0;                              ///< energy
  double elongation = 0;
  std::optional<Section> section;  ///< where no theory has one
};

/// Loads at which bonds flow; those that are not given are never reached.
struct YieldSpec {
  std::optional<double> axial_force, compression_force, shear_force, bending_moment, torque;
  FlowLimits isotropic, kinematic;
};
struct CreepSpec {
  bool is_norton = false;
  double viscosity = 0;         ///< Maxwell's
  std::int64_t exponent = 1;    ///< Norton's
  double speed = 0, force = 0;  ///< it creeps at this speed under this force
};
struct SofteningSpec {
  SourcePlace place;
  double tension = 0, fracture_energy = 0;
  std::optional<Section> section;  ///< where no theory has one
};

/// Of pairs selected by how near they are, those alone whose Voronoi cells meet.
struct FaceChoice {
  bool only = false;
  double least = 0.01;  ///< area of the face over the square of the distance
};

struct BondSpec {
  /// Of pairs selected by how near they are; nothing if they are listed.
  std::optional<BondReach> reach() const {
    if (const auto* s = std::get_if<WithinDistance>(&select.value)) return BondReach{s->distance, 0.0};
    if (const auto* s = std::get_if<WithinGap>(&select.value)) return BondReach{s->gap, 1.0};
    if (const auto* s = std::get_if<WithinFactor>(&select.value)) return BondReach{0.0, s->factor};
    return std::nullopt;
  }

  SourcePlace place;
  std::string name;
  std::array<Placed<std::string>, 2> between{Placed<std::string>{"all", {}}, {"all", {}}};  ///< groups
  Placed<std::variant<WithinDistance, ListedPairs, PairsFile, SpecimenPairs, WithinGap, WithinFactor,
                      AtCrossings>>
      select;
  FaceChoice faces;
  BondShare share;  ///< of the selected pairs that is bonded
  BondTime when = BondTime::start;
  std::vector<Placed<std::string>> stages;  ///< for `stage` and `approach`; approach: none means all
  std::optional<StrengthSpec> strength;
  std::optional<YieldSpec> yield;
  std::optional<CreepSpec> creep;
  std::optional<SofteningSpec> softening;
  BondRecipe recipe;  ///< its law is one without rules
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
