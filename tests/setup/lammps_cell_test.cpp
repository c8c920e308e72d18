// Periodic boxes of LAMMPS data files as cells.
#include <fmt/format.h>

#include "lammps_files.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond::test {
namespace lammps_cell_tests {

/// Four atoms in a tilted box, one bond through a face.
const std::string tilted =
    "title\n\n4 atoms\n1 bonds\n\n-1 3 xlo xhi\n0 3 ylo yhi\n2 7 zlo zhi\n1.2 -0.5 0.75 xy xz yz\n\n"
    "Masses\n\n1 1\n\nAtoms # bond\n\n1 0 1 0 1 3\n2 0 1 1 1 3\n3 0 1 2.5 1 3\n4 0 1 0 2 5 0 0 1\n\nBonds\n\n"
    "1 1 1 3\n";

Case with_cell(const TemporaryFile& file, const std::string& cell, const std::string& more = "") {
  return parse_case("[cell]\n" + cell + "\n[[specimen]]\nname = \"grains\"\nkind = \"lammps\"\nfile = \"" +
                        file.path().string() + "\"\nradius = 0.3\n" + more +
                        "\n[[bonds]]\nname = \"b\"\nfrom_specimen = true\n"
                        "stiffness = { c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n"
                        "[[stage]]\nduration = 1.0\n",
                    "case.toml");
}

std::string mistake(const std::string& data, const std::string& cell, const std::string& more = "") {
  const TemporaryFile file("box.data", data);
  try {
    build(with_cell(file, cell, more));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

TEST(LammpsCell, IsTheBoxOfTheFile) {
  const TemporaryFile file("box.data", tilted);
  const Built b = build(with_cell(file, "from_specimen = \"grains\""));
  EXPECT_EQ(b.model.cell.edges, (std::array<Vec3d, 3>{Vec3d{4, 0, 0}, {1.2, 3, 0}, {-0.5, 0.75, 5}}));
  EXPECT_EQ(b.model.cell.corner, (Vec3d{-1, 0, 2}));
  EXPECT_EQ(b.model.cell.periodic, (Periodic{true, true, true}));
  EXPECT_EQ(b.model.r_0[ParticleId{3}], (Vec3d{-0.5, 2.75, 10}));  // by its flag, not back in the cell
  ASSERT_EQ(b.state.bonds.size(), 1u);
  EXPECT_EQ(image_of_j(b.state.bonds[BondId{0}]), (Image{-1, 0, 0}));
  EXPECT_DOUBLE_EQ(b.state.bonds[BondId{0}].a, 1.5);
  EXPECT_TRUE(b.notes.empty());
}

TEST(LammpsCell, TurnsAndMovesWithItsSpecimen) {
  const TemporaryFile file("box.data", tilted);
  const Built b =
      build(with_cell(file, "from_specimen = \"grains\"",
                      "turn = { axis = [0, 0, 1], angle = 1.5707963267948966 }\nmove = [10, 0, 1]"));
  const std::array<Vec3d, 3> edges{Vec3d{0, 4, 0}, {-3, 1.2, 0}, {-0.75, -0.5, 5}};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(norm(b.model.cell.edges[k] - edges[k]), 1e-14) << k;
  EXPECT_LT(norm(b.model.cell.corner - Vec3d{10, -1, 3}), 1e-14);
  EXPECT_NEAR(b.state.bonds[BondId{0}].a, 1.5, 1e-14);
}

TEST(LammpsCell, MayBeAGeneralBoxAndOpen) {
  const std::string rest = tilted.substr(tilted.find("\nMasses"));
  const TemporaryFile file("box.data",
                           "title\n\n4 atoms\n1 bonds\n\n3 1 0 avec\n-1 3 0 bvec\n0 0 5 cvec\n"
                           "1 2 3 abc origin\n" +
                               rest);
  const Built b = build(with_cell(file, "from_specimen = \"grains\"\nopen = [\"c\"]"));
  EXPECT_EQ(b.model.cell.edges, (std::array<Vec3d, 3>{Vec3d{3, 1, 0}, {-1, 3, 0}, {0, 0, 5}}));
  EXPECT_EQ(b.model.cell.corner, (Vec3d{1, 2, 3}));
  EXPECT_EQ(b.model.cell.periodic, (Periodic{true, true, false}));
}

TEST(LammpsCell, TellsConflicts) {
  const std::string both = [] {
    try {
      const TemporaryFile file("box.data", tilted);
      with_cell(file, "from_specimen = \"grains\"\na = [4, 0, 0]");
    } catch (const CaseError& e) {
      return std::string(e.what());
    }
    return std::string();
  }();
  EXPECT_TRUE(contains(both, "case.toml:3:1: cell.a = [4, 0, 0]\n  is used only with no from_specimen"))
      << both;
  const std::string from = "from_specimen = \"grains\"";
  const auto refuses = [](const std::string& text, const char* what) {
    EXPECT_TRUE(contains(text, what)) << text;
  };
  refuses(mistake(tilted, "from_specimen = \"grain\""),
          "case.toml:2:1: cell.from_specimen = \"grain\"\n  there is no such specimen\n"
          "  the specimens are grains");
  const std::string no_z = std::string(tilted).replace(tilted.find("2 7 zlo zhi\n"), 12, "");
  refuses(mistake(std::string(no_z).replace(no_z.find(" 0 0 1\n"), 7, "\n"), from),
          "gives no box with volume");
  refuses(mistake(tilted, from, "array = [{ count = 2, step = [20, 0, 0] }]"),
          "the array of this specimen has more than fits");
  Case block = with_cell(TemporaryFile("box.data", tilted), from);
  block.specimens[0].shape = BlockSpecimen{};
  block.specimens[0].mass = 1.0;
  refuses(text_of_error(block), "this specimen is no LAMMPS data file");
}

TEST(LammpsCell, NotesACellThatIsNotTheBoxOfTheFile) {
  const TemporaryFile file("box.data", tilted);
  const auto notes = [&](const std::string& c) {
    return build(with_cell(file, "a = [4, 0, 0]\nb = [1.2, 3, 0]\nc = " + c)).notes;
  };
  EXPECT_TRUE(notes("[-0.5, 0.75, 5]").empty());
  const auto told = notes("[0, 0.75, 5]");
  ASSERT_EQ(told.size(), 1u);
  EXPECT_TRUE(contains(told[0],
                       "specimen \"grains\": edge c of the box of its file is [-0.5, 0.75, 5], that of "
                       "the cell is [0, 0.75, 5]"))
      << told[0];
}

/// The text of a data file as LAMMPS would write it: atoms in the box, with image flags; bonds by number.
std::string written(const Built& b) {
  const CellEdges& cell = b.state.cell;
  std::string text = fmt::format("title\n\n{} atoms\n{} bonds\n\n", b.state.r.size(), b.state.bonds.size());
  for (std::size_t k = 0; k < 3; ++k)
    text += fmt::format("{} {} {} {}vec\n", cell[k].along.x, cell[k].along.y, cell[k].along.z, "abc"[k]);
  const Vec3d o = b.model.cell.corner;
  text += fmt::format("{} {} {} abc origin\n\nMasses\n\n1 1\n\nAtoms # bond\n\n", o.x, o.y, o.z);
  for (const ParticleId p : b.state.r.ids()) {
    const Image n = image_in_cell(cell, b.model.cell.periodic, o, b.state.r[p]);
    const Vec3d r = b.state.r[p] + to_image(cell, n);
    text += fmt::format("{} 1 1 {} {} {} {} {} {}\n", p.value + 1, r.x, r.y, r.z, -n.a, -n.b, -n.c);
  }
  text += "\nBonds\n\n";
  for (const BondId k : b.state.bonds.ids())
    text +=
        fmt::format("{} 1 {} {}\n", k.value + 1, b.state.bonds[k].i.value + 1, b.state.bonds[k].j.value + 1);
  return text;
}

// A lattice in a tilted cell, sheared by 3 % and shaken, some particles gone through faces: written and read,
// it is the same body. Its bonds are then at rest as they stand, so that both are strained alike to compare.
TEST(LammpsCell, ABodyThatIsWrittenAndReadHasTheSameEnergy) {
  const auto cell = [](double tilt) {
    return fmt::format("a = [4, 0, 0]\nb = [{}, 4, 0]\nc = [0, {}, 4]\ncorner = [-1, 0.5, 2]\n", tilt,
                       2 * tilt);
  };
  Built first = build(parse_case(
      "[cell]\n" + cell(1.0) +
          "[[specimen]]\nkind = \"block\"\nlattice = \"simple-cubic\"\ncells = [4, 4, 4]\nradius = 0.3\nmass "
          "= 1.0\n"
          "[[bonds]]\nname = \"b\"\ndistance = 1.45\n"
          "stiffness = { c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n[[stage]]\nduration = 1.0\n",
      "case.toml"));
  for (const ParticleId p : first.state.r.ids())  // some go through faces, and far
    first.state.r[p] += to_image(first.state.cell, {p.value % 3 == 0 ? 2 : 0, p.value % 5 == 0 ? -1 : 0, 0});
  first.model.r_0 = first.state.r;
  for (Bond& bond : first.state.bonds) {
    const auto moved = [&](ParticleId p) {
      return Image{p.value % 3 == 0 ? 2 : 0, p.value % 5 == 0 ? -1 : 0, 0};
    };
    set_image_of_j(bond, image_of_j(bond) + moved(bond.i) - moved(bond.j));
  }
  const TemporaryFile file("box.data", written(first));
  Built again = build(with_cell(file, "from_specimen = \"grains\""));
  ASSERT_EQ(again.state.bonds.size(), first.state.bonds.size());
  for (Built* b : {&first, &again}) {
    for (CellEdge& edge : b->state.cell) edge.along.x += 0.03 * edge.along.y;
    for (const ParticleId p : b->state.r.ids()) {
      b->state.r[p].x += 0.03 * b->state.r[p].y;
      b->state.r[p] += 0.05 * Vec3d{std::sin(7.0 * double(p.value)), std::cos(3.0 * double(p.value)), 0.3};
    }
  }
  const double U = bond_energies(first.state).potential();
  EXPECT_GT(U, 0.1);
  EXPECT_NEAR(bond_energies(again.state).potential(), U, 1e-12 * U);
}

}  // namespace lammps_cell_tests
}  // namespace vbond::test
