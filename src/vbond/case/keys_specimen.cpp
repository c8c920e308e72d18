#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "vbond/case/keys_specimen.hpp"
#include "vbond/physics/top.hpp"

namespace vbond::keys {
namespace {

const CountCodec two_or_more{2}, one_or_more{1};
constexpr const char* spacing_doc = "distance between neighbours";
constexpr const char* origin_doc = "position of the first particle";

/// As many particles as triangles of this spacing have on the area.
void check_random(Table& t, double area, double spacing) {
  check_total(t, 2.0 / std::numbers::sqrt3 * area / (spacing * spacing), {"spacing", "size"});
}

/// What stands for mass, and what mass and inertia need of the radius. Files may bring columns of their own.
void check_mass(Table& t, const SpecimenSpec& s) {
  t.check(!s.thickness || s.density, {"thickness", "density"},
          "thickness is there for masses: density times thickness times the area of each particle",
          "add density, or leave out thickness");
  const bool from_file =
      std::holds_alternative<CsvSpecimen>(s.shape) || std::holds_alternative<LammpsSpecimen>(s.shape);
  const bool fibres = std::holds_alternative<FibresSpecimen>(s.shape);
  t.check(!fibres || s.radius == 0.0, {"radius"}, "the radius of fibres is half of their diameter",
          "leave it out");
  t.check(!(s.mass && s.density), {"density", "mass"}, "only one of mass and density may be given",
          "keep one of them; density means m = 4/3 pi radius^3 density, or of a wall with a thickness");
  const auto* packing = std::get_if<PackingSpecimen>(&s.shape);
  const auto has_density = [](const GrainSpec& g) { return g.density.has_value(); };
  const bool of_grains = packing && std::any_of(packing->grains.begin(), packing->grains.end(), has_density);
  t.check(!packing || s.radius == 0.0, {"radius", "kind"}, "the radii of a packing are those of its grains",
          "leave radius out, and write grains = [{ radius = 1.0 }]");
  t.check(!of_grains || (!s.mass && !s.density &&
                         std::all_of(packing->grains.begin(), packing->grains.end(), has_density)),
          {"density", "mass", "grains"}, "the density is that of all grains, or each kind of grains has one",
          "give each kind of grains a density and none to the specimen, or the other way round");
  t.check(from_file || of_grains || s.mass || s.density, {"mass", "density", "kind", "grains"},
          "one of mass and density is required", "add mass = 1.0 (or density and a radius)");
  t.check(from_file || packing || fibres || s.thickness || !s.density || s.radius > 0,
          {"density", "radius", "thickness", "kind"},
          "density needs a radius, m = 4/3 pi radius^3 density, or the thickness of a sheet or shell",
          "add radius or thickness, or give mass instead of density");
  const int forms = s.inertia.has_value() + s.principal_inertia.has_value() + s.inertia_tensor.has_value() +
                    s.solid.has_value();
  t.check(forms <= 1, {"inertia", "principal_inertia", "inertia_tensor", "solid"},
          "only one of inertia, principal_inertia, inertia_tensor and solid may be given",
          "keep one of them");
  t.check(from_file || packing || fibres || s.thickness || forms > 0 || s.radius > 0,
          {"radius", "inertia", "thickness", "kind"},
          "inertia or a radius > 0 is required: the default 2/5 m radius^2 would be zero and a particle "
          "could not turn",
          "add the radius, or the moment of inertia of a particle");
}

/// Moments of inertia that differ, in one of three forms.
void describe_principal_inertia(Table& t, SpecimenSpec& s) {
  t.key("principal_inertia", s.principal_inertia, tuple_of<3>(positive(inertia)), optional,
        "instead of inertia: its three moments about the x, y and z axes of each particle");
  t.key("inertia_tensor", s.inertia_tensor, tuple_of<6>(number(inertia)), optional,
        "instead of inertia: the tensor xx, yy, zz, xy, xz, yz in the axes of each particle (xy = -sum of m "
        "x y)");
  t.table("solid", s.solid,
          "instead of inertia: moments of a homogeneous solid of the particle's mass; for "
          "contacts and bonds the particle stays a sphere");
  constexpr const char* rule =
      "no moment of inertia may be above the sum of the other two: no mass has such ones";
  const char* way_out = "correct them; a box has m/12 (b^2 + c^2), ... : see solid";
  if (s.principal_inertia) {
    const auto& I = *s.principal_inertia;
    t.check(keep_the_triangle_inequality({I[0], I[1], I[2]}), {"principal_inertia"}, rule, way_out);
  }
  if (s.inertia_tensor) {
    const auto& I = *s.inertia_tensor;
    const auto principal = principal_inertia({I[0], I[1], I[2], I[3], I[4], I[5]});
    const bool positive_definite = principal && least_of(principal->moments) > 0.0;
    t.check(positive_definite, {"inertia_tensor"}, "its principal moments must be > 0",
            "correct it: xx, yy, zz are its diagonal, xy, xz, yz stand beside it");
    t.check(!positive_definite || keep_the_triangle_inequality(principal->moments), {"inertia_tensor"}, rule,
            way_out);
  }
}

}  // namespace

void describe(Table& t, SpecimenSpec& s) {
  t.locate(s.place);
  t.key("name", s.name, NameCodec{}, optional,
        "name of the specimen; its particles form a group of this name");
  static const std::vector<std::string> kinds{"rod",   "hemisphere", "block",   "sheet", "ring",
                                              "helix", "csv",        "lammps",  "list",  "cylinder",
                                              "cone",  "sphere",     "packing", "fibres"};
  std::size_t kind = t.reading() ? kinds.size() : s.shape.index();
  t.key("kind", kind, ChoiceCodec<std::size_t>{kinds, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13}},
        required, "what it is made of");
  t.key("radius", s.radius, not_negative(length), optional,
        "radius of the particles: for contacts, bonds between surfaces, density and the default inertia");
  t.key("mass", s.mass, positive(mass), default_is("exactly one of mass and density, unless the file has it"),
        "mass of each particle");
  t.key("density", s.density, positive(density), optional,
        "instead of mass: m = 4/3 pi radius^3 density; with thickness: area times thickness times density; "
        "of fibres: the volume of the cylinder times density");
  const bool surface = kind == 3 || (kind >= 9 && kind <= 11);  // as named below
  t.when(surface, "kind = \"sheet\", \"cylinder\", \"cone\" or \"sphere\"", [&] {
    t.key("thickness", s.thickness, positive(length), optional,
          "of the wall that they stand for, h: with density, each particle has the mass of its share of the "
          "surface; the default inertia is then m (h^2/12 + 5/72 l^2), l: distance of its neighbours");
  });
  t.key("inertia", s.inertia, positive(inertia),
        default_is("2/5 m radius^2, or from thickness, or of fibres m (radius^2/4 + spacing^2/12)"),
        "moment of inertia of each particle, the same about all axes");
  t.key("material", s.material, material_name, default_is("the first of the case"),
        "what its particles are made of, as far as contacts ask");
  describe_principal_inertia(t, s);
  std::vector<std::string> conditions;
  for (const std::string& k : kinds) conditions.push_back("kind = \"" + k + "\"");
  t.alternatives(s.shape, kind, conditions);
  describe_arrangement(t, s);
  check_mass(t, s);
}

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double nearly = 1.0 - 1e-12;  // degrees and revolutions are rounded

void describe_around(Table& t, AroundSpec& a, const char* spacing, bool may_count) {
  t.key("spacing", a.spacing, positive(length),
        default_is(may_count ? "exactly one of spacing and particles_around" : "required without polar"),
        spacing);
  t.key("particles_around", a.particles, two_or_more,
        default_is("exactly one of spacing and particles_around"),
        "instead of spacing: particles on each circle; of a panel on its first one, both sides counted");
  t.key("angle", a.angle, positive(angle), default_is("360 degrees: closed"), "of a panel, around the axis");
  t.key("axis", a.axis, direction_vector, optional,
        "of the surface; angles around it begin on x, turned as the axis is from z by the shortest way");
  const bool closed = a.angle >= full_turn * nearly;
  t.check(a.angle <= full_turn / nearly, {"angle"}, "must be a full turn at most", "360 degrees is closed");
  t.check(a.spacing.has_value() != a.particles.has_value(), {"spacing", "particles_around", "kind"},
          "exactly one of spacing and particles_around is required", "give one of them");
  t.check(!closed || a.particles.value_or(3) >= 3, {"particles_around"},
          "must be at least 3 on a closed circle", "take more particles");
}

void describe_surface_lattice(Table& t, SurfaceLattice& lattice, std::uint64_t& seed) {
  t.key(
      "lattice", lattice,
      ChoiceCodec<SurfaceLattice>{{"triangular", "random"},
                                  {SurfaceLattice::triangular, SurfaceLattice::random}},
      optional,
      "circles of particles, or of a closed sphere a divided icosahedron; or particles at random places and "
      "even distances");
  t.when(lattice == SurfaceLattice::random, "lattice = \"random\"",
         [&] { t.key("seed", seed, seed_number, optional, "of the random places"); });
}

}  // namespace

void describe(Table& t, CylinderSpecimen& s) {
  t.key("cylinder_radius", s.radius, positive(length), required, "radius of the middle of its wall");
  t.key("length", s.length, positive(length), required, "along the axis, from the first circle to the last");
  t.key("origin", s.origin, vector_of(length), optional, "centre of the first circle");
  describe_around(t, s.around,
                  "about what neighbours are apart: within 3 %, so that triangles fit the length", true);
  describe_surface_lattice(t, s.lattice, s.seed);
  if (s.lattice != SurfaceLattice::random) return;
  t.check(s.around.spacing.has_value(), {"particles_around", "lattice"},
          "a random lattice goes by the spacing", "give spacing instead");
  check_random(t, s.around.angle * s.radius * s.length, s.around.spacing.value_or(INFINITY));
}

void describe(Table& t, ConeSpecimen& s) {
  t.key("cone_radii", s.radii, tuple_of<2>(positive(length)), required, "of the first and the last circle");
  t.key("length", s.length, positive(length), required, "along the axis, from the first circle to the last");
  t.key("origin", s.origin, vector_of(length), optional, "centre of the first circle");
  describe_around(t, s.around,
                  "about what neighbours on the larger circle are apart; elsewhere less, as the radius",
                  true);
}

void describe(Table& t, SphereSpecimen& s) {
  t.key("sphere_radius", s.radius, positive(length), required, "radius of the middle of its wall");
  t.key("centre", s.centre, vector_of(length), optional, "centre of the sphere");
  t.key("polar", s.polar, tuple_of<2>(positive(angle)), default_is("a closed sphere"),
        "two angles from the axis, the smaller one first: only the zone between them, or with angle a panel");
  describe_around(t, s.around, "about what neighbours are apart; of a zone on its largest circle", false);
  if (s.polar)
    t.check((*s.polar)[0] < (*s.polar)[1] && (*s.polar)[1] < std::numbers::pi, {"polar"},
            "the first angle must be smaller than the second, and this smaller than 180 degrees",
            "correct them");
  t.check(s.polar || (!s.around.particles && s.around.angle >= full_turn * nearly),
          {"angle", "particles_around", "polar", "kind"},
          "angle and particles_around belong to a zone or panel of a sphere",
          "add polar = [from, to], or leave them out");
  describe_surface_lattice(t, s.lattice, s.seed);
  if (s.lattice != SurfaceLattice::random) return;
  t.check(!s.polar, {"polar", "lattice"}, "random particles are those of a closed sphere",
          "leave polar out, and cut what is not wanted");
  check_random(t, 4.0 * std::numbers::pi * s.radius * s.radius, s.around.spacing.value_or(INFINITY));
}

void describe(Table& t, RodSpecimen& s) {
  t.key("particles", s.particles, two_or_more, required, "number of particles");
  t.key("spacing", s.spacing, positive(length), required_in_si, spacing_doc);
  t.key("origin", s.origin, vector_of(length), optional, origin_doc);
  t.key("direction", s.direction, direction_vector, optional, "along the rod; its length does not matter");
  t.key("half_ends", s.half_ends, FlagCodec{}, optional,
        "true: the first and the last particle have half the mass, as free ends of a bar");
}

void describe(Table& t, HemisphereSpecimen& s) {
  t.key("particles", s.particles, two_or_more, required, "number of particles, with the rim");
  t.key("sphere_radius", s.radius, positive(length), required, "radius R_c of the half-sphere");
  t.key("spacing", s.spacing, positive(length), required_in_si,
        "length scale a; the rim has round(2 pi sphere_radius / spacing) particles");
  t.key("seed", s.seed, seed_number, optional, "of the random start");
  t.table(
      "relaxation", optional, "how the random start is spread out, see the page on the shell",
      [&s](Table& r) {
        r.key("min_distance", s.min_distance, NumberCodec{pure, {0, 1, false, false}}, optional,
              "least distance in the random start, in units of spacing");
        r.key("strength", s.strength, positive(pure), optional,
              "f_0 of the repulsion -f_0 (a/r)^8 r, in units of c_A");
        r.key("cutoff", s.cutoff, NumberCodec{pure, {0, 100, true, false}}, optional,
              "range of the repulsion, in units of spacing");
        r.key("damping", s.damping, not_negative(pure), optional, "viscous damping, in units of sqrt(m c_A)");
        r.key("step", s.step, NumberCodec{pure, {0, 1, true, false}}, optional, "time step, in units of T0");
        r.key("steps", s.steps, CountCodec{0, 1'000'000'000}, optional, "number of steps");
      });
  const double rim = std::round(2.0 * std::numbers::pi * s.radius / s.spacing);
  t.check(static_cast<double>(s.particles) > rim, {"particles", "sphere_radius", "spacing"},
          "must be more than the rim alone takes, round(2 pi sphere_radius / spacing)",
          "take more particles: about 2 pi (sphere_radius / spacing)^2 * 1.15 cover the half-sphere");
}

void describe(Table& t, BlockSpecimen& s) {
  t.key("lattice", s.lattice,
        ChoiceCodec<Lattice>{{"simple-cubic", "fcc", "hcp", "bcc"},
                             {Lattice::simple_cubic, Lattice::fcc, Lattice::hcp, Lattice::bcc}},
        optional, "crystal lattice");
  t.key("cells", s.cells, tuple_of<3>(one_or_more), required,
        "cells along x, y, z; simple-cubic: one particle each; fcc and hcp: four each; bcc: two each");
  t.key("spacing", s.spacing, positive(length), required_in_si, spacing_doc);
  t.key("origin", s.origin, vector_of(length), optional, origin_doc);
  const double cells =
      static_cast<double>(s.cells[0]) * static_cast<double>(s.cells[1]) * static_cast<double>(s.cells[2]);
  check_total(t, static_cast<double>(particles_in_cell(s.lattice)) * cells, {"cells"});
}

void describe(Table& t, SheetSpecimen& s) {
  t.key("lattice", s.lattice,
        ChoiceCodec<SheetLattice>{{"triangular", "square", "random"},
                                  {SheetLattice::triangular, SheetLattice::square, SheetLattice::random}},
        optional, "pattern in the x-y plane");
  const bool random = s.lattice == SheetLattice::random;
  t.when(!random, "lattice = \"triangular\" or \"square\"", [&] {
    t.key("particles", s.particles, tuple_of<2>(one_or_more), required, "particles along x, rows along y");
  });
  t.when(random, "lattice = \"random\"", [&] {
    t.key("size", s.size, tuple_of<2>(positive(length)), required,
          "edges along x and y, from particle to particle");
    t.key("seed", s.seed, seed_number, optional, "of the random places");
  });
  t.key("spacing", s.spacing, positive(length), required_in_si,
        "distance between neighbours; random: about the mean one");
  t.key("origin", s.origin, vector_of(length), optional, origin_doc);
  if (random) return check_random(t, s.size[0] * s.size[1], s.spacing);
  check_total(t, static_cast<double>(s.particles[0]) * static_cast<double>(s.particles[1]), {"particles"});
}

void describe(Table& t, RingSpecimen& s) {
  t.key("particles", s.particles, CountCodec{3}, required, "number of particles; the first is on +x");
  t.key("ring_radius", s.radius, positive(length), required, "radius of the ring, in the x-y plane");
  t.key("centre", s.centre, vector_of(length), optional, "centre of the ring");
}

void describe(Table& t, HelixSpecimen& s) {
  t.key("particles", s.particles, two_or_more, required, "number of particles; the first is on +x");
  t.key("helix_radius", s.radius, positive(length), required, "radius of the helix about z");
  t.key("pitch", s.pitch, number(length), required, "rise along z per turn; negative: left-handed downwards");
  t.key("turns", s.turns, positive(pure), required, "number of turns");
  t.key("origin", s.origin, vector_of(length), optional, "centre of the first turn's circle");
}

void describe(Table& t, CsvSpecimen& s) {
  t.key("file", s.file, FileCodec{}, required,
        "CSV file with a header line and a line for each particle: x, y, z and what `columns` lists besides");
  t.table(
      "columns", optional,
      "the names that columns have in the header of the file; those that are not named here are not read",
      [&s](Table& c) {
        for (std::size_t k = 0; k < csv_columns.size(); ++k)
          c.key(csv_columns[k].name, s.columns[k], TextCodec{}, k < 3 ? required : optional,
                csv_columns[k].meaning);
      },
      s.names_columns());
  std::set<std::string> names;
  bool once = true;
  for (const auto& name : s.columns) once = once && (!name || names.insert(*name).second);
  t.check(once, {"columns"}, "no column of the file may be read as two", "correct the names");
  t.table(
      "units", optional, "units of columns, in SI cases; columns that are not named here are in SI units",
      [&s](Table& u) {
        for (std::size_t k = 0; k < csv_columns.size(); ++k) {
          if (csv_columns[k].dimension == pure) continue;
          const UnitCodec unit{csv_columns[k].dimension};
          u.key(csv_columns[k].name, s.units[k], unit, optional, csv_columns[k].meaning);
        }
      },
      s.has_units());
  t.key("scale", s.scale, positive(pure), optional,
        "factor of the lengths in the file: of positions, radii and velocities; of moments of inertia its "
        "square");
  t.check(s.scale == 1.0 || !s.has_units(), {"scale", "units"}, "only one of scale and units may be given",
          "keep one of them; a unit says the same for one column");
  t.key("bonds_file", s.bonds_file, FileCodec{}, optional,
        "CSV file of bonds for from_specimen: pairs i, j of particles of `file`, counted from 0, and "
        "optionally a type; they go with the particles through cut, turn, move and array");
}

void describe(Table& t, LammpsSpecimen& s) {
  t.key("file", s.file, FileCodec{}, required, "LAMMPS data file; its Bonds section serves from_specimen");
  static const std::vector<std::string> styles{"atomic",    "charge", "bond",   "angle",
                                               "molecular", "full",   "sphere", "bpm/sphere"};
  t.key("atom_style", s.atom_style, ChoiceCodec<std::string>{styles, styles},
        default_is("that which the file names, as in `Atoms # bond`"), "LAMMPS atom_style of the file");
  t.key("velocities", s.velocities, FlagCodec{}, optional,
        "the particles begin with the Velocities section of the file, if it has one");
}

void describe(Table& t, ListedSpecimen& s) {
  t.key("positions", s.positions, list_of(vector_of(length), 1), required, "one position per particle");
}

}  // namespace vbond::keys
