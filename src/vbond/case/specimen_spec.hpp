#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/csv_columns.hpp"
#include "vbond/case/fibre_spec.hpp"
#include "vbond/case/packing_spec.hpp"
#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"
#include "vbond/core/vec3.hpp"

/// Specimens as the user wrote them.
namespace vbond {

struct RodSpecimen {
  std::int64_t particles = 0;  ///< >= 2
  double spacing = 1.0;
  Vec3d origin;              ///< first particle
  Vec3d direction{1, 0, 0};  ///< any length but zero
  bool half_ends = false;    ///< the first and the last particle have half the mass
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

}  // namespace vbond
