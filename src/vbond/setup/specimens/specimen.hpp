#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/packing/pack.hpp"

namespace vbond {

constexpr std::int64_t no_bond_type = 0;  ///< of the edges of a surface; files count types from 1

/// A bond that a specimen brings along: two particles, and the bond type of the file.
struct FileBond {
  std::array<std::int64_t, 2> pair;
  std::int64_t type;
  /// Distance of the particles through the boundary of the file's box, if the bond is meant to go there;
  /// 0: it is not.  [length]
  double across = 0;
};

/// The periodic box that a file gives its particles: three edges with volume, a right-handed system.
struct FileBox {
  std::array<Vec3d, 3> edges;  ///< [length]
  Vec3d corner;                ///< where they begin  [length]
};

/// What a particle stands for on a surface: its area, and the mean square of the distances to its neighbours.
struct SurfaceShare {
  double area = 0, square_spacing = 0;  ///< [length^2]
};

/// The particles of one specimen, numbered from 0 within it. Properties that the specimen's file does
/// not give are empty.
struct SpecimenPoints {
  std::vector<Vec3d> r;                       ///< [length]
  Quatd q;                                    ///< orientation of all
  std::vector<Quatd> orientations;            ///< before q, or empty
  std::vector<Vec3d> v, omega;                ///< per particle, or empty
  std::vector<double> radius, mass, inertia;  ///< per particle, or empty
  std::vector<Vec3d> moments;                 ///< of inertia; likewise
  std::vector<double> mass_factor;            ///< on the mass that the case gives; likewise
  std::vector<FileBond> bonds;                ///< of a file, edges of a surface, or chains of fibres
  std::vector<std::int64_t> fibre;            ///< per particle: which fibre it is of; or empty
  std::vector<std::pair<std::string, std::vector<std::int64_t>>> parts;  ///< such as "ends", "rim"
  std::optional<FileBox> box;        ///< turned and moved with the particles; of copies that of the first
  std::vector<SurfaceShare> shares;  ///< of surfaces: per particle, before anything is cut or copied
  /// What was reached where a specimen is made at random: name and one or more numbers.
  std::vector<std::pair<std::string, std::vector<double>>> figures;
  std::vector<std::string> notes;  ///< on cuts, unused parts of files, and how triangles differ
  std::vector<std::string> notes_on_open_bodies;  ///< that are true without a cell only
  std::optional<packing::Packing> packing;        ///< of packed grains, as they were before cuts
};

/// Places the particles of a specimen of this case, cut, turned, moved and copied. threads: see build().
/// Throws CaseError.
SpecimenPoints make_specimen(const SpecimenSpec& spec, const Case& c, int threads = 0);

/// How many particles that makes; 0 if they come from a file or are cut, so that only making them tells.
double count_points(const SpecimenSpec& spec);

/// Whether bonds may come with it: those of its files, chains of fibres, or the edges of a surface of
/// triangles.
bool brings_bonds(const SpecimenSpec& spec);

/// How many copies of its points the specimen has.
double count_copies(const SpecimenSpec& spec);

/// Cuts, turns, moves and copies points as the case says; their bonds and parts go with them. The copies
/// follow one another in full, those along the first step first.
void arrange(const SpecimenSpec& spec, const std::string& case_file, SpecimenPoints& points);

SpecimenPoints make_points(const RodSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const RingSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const HelixSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const BlockSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const SheetSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const ListedSpecimen& s, const SourcePlace& place);

/// Surfaces of triangles that are as nearly equilateral as the surface allows: their edges are bonds.
SpecimenPoints make_points(const CylinderSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const ConeSpecimen& s, const SourcePlace& place);
SpecimenPoints make_points(const SphereSpecimen& s, const SourcePlace& place);

/// How many particles these have.
double count_points(const CylinderSpecimen& s);
double count_points(const ConeSpecimen& s);
double count_points(const SphereSpecimen& s);

/// The paper's half-sphere, [KA12] section VI B: rim fixed on the equator, the rest relaxed from random
/// places under a repulsion. Particles 0 .. rim - 1 are the rim.
SpecimenPoints make_points(const HemisphereSpecimen& s, const SourcePlace& place);

/// Packed grains.
SpecimenPoints make_packing(const PackingSpecimen& s, const SpecimenSpec& spec, const CellSpec* cell,
                            const std::string& case_file, int threads);

/// Files of the specimen: already seen from the current folder.
SpecimenPoints read_csv_specimen(const CsvSpecimen& spec);

/// `file`: likewise. atom_style: empty: that which the file names. `velocities`: whether those of the file
/// count.
SpecimenPoints read_lammps_specimen(const std::filesystem::path& file, const std::string& atom_style,
                                    const SourcePlace& place, bool velocities = true);

}  // namespace vbond
