#include "cases.hpp"

namespace vbond::test {
namespace {

// Distances of lattice sites differ from the nominal ones by a few roundings; the next shell of neighbours
// is at least 1.41 (cubic, fcc, hcp, square) or 1.73 (triangular) nearest distances away.
constexpr double first_shell = 1.2;

void expect_positions(const Built& b, const std::vector<Vec3d>& expected) {
  ASSERT_EQ(b.model.particles(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(norm(b.model.r_0[ParticleId{i}] - expected[i]), 1e-14) << "particle " << i;
}

TEST(Rod, GoesFromItsOriginInItsDirection) {
  // direction (3, 4, 0) is five units long: spacing 2 advances by (1.2, 1.6, 0)
  const Built b = build(case_of(RodSpecimen{3, 2.0, {1, 1, 1}, {3, 4, 0}}));
  expect_positions(b, {{1, 1, 1}, {2.2, 2.6, 1}, {3.4, 4.2, 1}});
  EXPECT_EQ(numbers(b.model, "ends"), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(numbers(b.model, "first"), (std::vector<std::size_t>{0}));
  EXPECT_EQ(numbers(b.model, "body.last"), (std::vector<std::size_t>{2}));
}

TEST(Block, SimpleCubicHasSixNeighboursInside) {
  const Built b = build(case_of(BlockSpecimen{Lattice::simple_cubic, {4, 5, 6}, 2.0, {1, 0, 0}}));
  EXPECT_EQ(b.model.particles(), 120u);
  EXPECT_NEAR(nearest_distance(b.model, 2.0 * first_shell), 2.0, 1e-14);
  const auto n = coordination(b.model, 2.0 * first_shell);
  EXPECT_EQ(*std::max_element(n.begin(), n.end()), 6);
  EXPECT_EQ(std::count(n.begin(), n.end(), 6), 2 * 3 * 4);  // all but the outer layer
  EXPECT_EQ(b.model.r_0[ParticleId{0}], (Vec3d{1, 0, 0}));
}

class ClosePacked : public ::testing::TestWithParam<Lattice> {};

TEST_P(ClosePacked, HasTwelveNeighboursInside) {
  const Built b = build(case_of(BlockSpecimen{GetParam(), {4, 4, 4}, 1.0, {}}));
  EXPECT_EQ(b.model.particles(), 4u * 64u);
  EXPECT_NEAR(nearest_distance(b.model, first_shell), 1.0, 1e-14);
  const auto n = coordination(b.model, first_shell);
  EXPECT_EQ(*std::max_element(n.begin(), n.end()), 12);
  // the 2 x 2 x 2 inner cells of four have all their neighbours
  EXPECT_GE(std::count(n.begin(), n.end(), 12), 4 * 8);
}
INSTANTIATE_TEST_SUITE_P(Lattices, ClosePacked, ::testing::Values(Lattice::fcc, Lattice::hcp));

TEST(Block, BccHasEightNeighboursAndRepeatsInItsCell) {
  const double edge = 3 * 1.5 * 2 / std::numbers::sqrt3;  // three cubes; neighbours along their diagonals
  Case c = case_of(BlockSpecimen{Lattice::bcc, {3, 3, 3}, 1.5, {0.1, 0.1, 0.1}});
  c.cell = CellSpec{};
  c.cell->edges = {Vec3d{edge, 0, 0}, Vec3d{0, edge, 0}, Vec3d{0, 0, edge}};
  c.bonds.push_back(bonds_within(1.5 * 1.1));  // the next ones are 1.155 spacings away
  const Built b = build(c);
  EXPECT_EQ(b.model.particles(), 2u * 27u);
  EXPECT_EQ(b.state.bonds.size(), 4u * 2u * 27u);
  for (const Bond& bond : b.state.bonds) EXPECT_NEAR(bond.a, 1.5, 1e-14);
  EXPECT_EQ(b.notes, std::vector<std::string>{}) << "it fits";
  c.cell->edges[2].z *= 1.01;
  EXPECT_TRUE(contains(build(c).notes.at(0), "the lattice has a seam"));
}

// A particle of an fcc crystal and its mirror image: of 12 neighbours every one has an opposite one; in hcp
// only the six of its own plane have.
TEST(Block, HcpIsNotFcc) {
  for (const auto& [lattice, opposite] : {std::pair{Lattice::fcc, 12}, std::pair{Lattice::hcp, 6}}) {
    const Built b = build(case_of(BlockSpecimen{lattice, {4, 4, 4}, 1.0, {}}));
    std::vector<std::vector<Vec3d>> neighbours(b.model.particles());
    for_near_pairs(b.model.r_0.values(), first_shell, [&](std::size_t i, std::size_t j, double) {
      const Vec3d e = b.model.r_0[ParticleId{j}] - b.model.r_0[ParticleId{i}];
      neighbours[i].push_back(e);
      neighbours[j].push_back(-e);
    });
    for (const auto& around : neighbours) {
      if (around.size() != 12) continue;
      int found = 0;
      for (const Vec3d& e : around)
        for (const Vec3d& o : around) found += norm(e + o) < 1e-12;
      EXPECT_EQ(found, opposite);
    }
  }
}

TEST(Sheet, TriangularHasSixNeighboursInside) {
  const Built b = build(case_of(SheetSpecimen{SheetLattice::triangular, {6, 5}, 1.5, {0, 0, 2}}));
  EXPECT_EQ(b.model.particles(), 30u);
  EXPECT_NEAR(nearest_distance(b.model, 1.5 * first_shell), 1.5, 1e-14);
  const auto n = coordination(b.model, 1.5 * first_shell);
  EXPECT_EQ(std::count(n.begin(), n.end(), 6), 4 * 3);
  for (const Vec3d& r : b.model.r_0) EXPECT_EQ(r.z, 2.0);
}

TEST(Sheet, SquareHasFourNeighboursInside) {
  const Built b = build(case_of(SheetSpecimen{SheetLattice::square, {6, 5}, 1.0, {}}));
  const auto n = coordination(b.model, first_shell);
  EXPECT_EQ(*std::max_element(n.begin(), n.end()), 4);
  EXPECT_EQ(std::count(n.begin(), n.end(), 4), 4 * 3);
}

TEST(Ring, IsClosedAndStartsOnX) {
  const Built b = build(case_of(RingSpecimen{4, 2.0, {1, 0, 0}}));
  expect_positions(b, {{3, 0, 0}, {1, 2, 0}, {-1, 0, 0}, {1, -2, 0}});
  EXPECT_EQ(b.model.find_group("ends"), nullptr);
}

TEST(Helix, RisesByItsPitchPerTurn) {
  // five particles over one turn: a quarter turn each
  const Built b = build(case_of(HelixSpecimen{5, 2.0, 4.0, 1.0, {0, 0, 1}}));
  expect_positions(b, {{2, 0, 1}, {0, 2, 2}, {-2, 0, 3}, {0, -2, 4}, {2, 0, 5}});
  EXPECT_EQ(numbers(b.model, "ends"), (std::vector<std::size_t>{0, 4}));
}

TEST(Specimens, AreCountedBeforeTheyAreMade) {
  for (const Case& c : {case_of(RodSpecimen{3, 2.0, {}, {1, 0, 0}}), case_of(RingSpecimen{7, 2.0, {}}),
                        case_of(HelixSpecimen{9, 1.0, 3.0, 2.0, {}}),
                        case_of(BlockSpecimen{Lattice::simple_cubic, {2, 3, 5}, 1.0, {}}),
                        case_of(BlockSpecimen{Lattice::fcc, {2, 3, 4}, 1.0, {}}),
                        case_of(BlockSpecimen{Lattice::hcp, {2, 3, 4}, 1.0, {}}),
                        case_of(BlockSpecimen{Lattice::bcc, {2, 3, 4}, 1.0, {}}),
                        case_of(SheetSpecimen{SheetLattice::triangular, {4, 3}, 1.0, {}}),
                        case_of(ListedSpecimen{{{0, 0, 0}, {2, 0, 0}}})})
    EXPECT_EQ(count_particles(c), static_cast<double>(build(c).model.particles()));
}

TEST(Specimens, FollowOneAnotherInOrder) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  c.specimens.push_back(specimen(ListedSpecimen{{{0, 5, 0}, {0, 6, 0}}}, "probe"));
  const Built b = build(c);
  EXPECT_EQ(numbers(b.model, "all").size(), 5u);
  EXPECT_EQ(b.model.groups.front().name, "all");
  EXPECT_EQ(numbers(b.model, "body"), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(numbers(b.model, "probe"), (std::vector<std::size_t>{3, 4}));
  EXPECT_EQ(numbers(b.model, "ends"), (std::vector<std::size_t>{0, 2})) << "only the rod has ends";
}

TEST(Specimens, PlainEndsAreLeftOutWhenTwoHaveThem) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  c.specimens.push_back(specimen(RodSpecimen{3, 1.0, {0, 2, 0}, {1, 0, 0}}, "second"));
  const Built b = build(c);
  EXPECT_EQ(b.model.find_group("ends"), nullptr);
  EXPECT_EQ(numbers(b.model, "second.ends"), (std::vector<std::size_t>{3, 5}));
}

TEST(Properties, DensityFillsASphereAndInertiaIsTwoFifths) {
  Case c = case_of(RodSpecimen{2, 3.0, {}, {1, 0, 0}});
  c.specimens[0].mass.reset();
  c.specimens[0].density = 3.0;
  c.specimens[0].radius = 0.5;
  const Built b = build(c);
  // 4/3 pi 0.125 * 3 = pi/2; 2/5 * pi/2 * 0.25 = pi/20
  EXPECT_DOUBLE_EQ(b.model.mass[ParticleId{1}], std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(b.model.inertia[ParticleId{1}], std::numbers::pi / 20);
}

TEST(CsvSpecimen, TakesItsColumnsInAnyOrder) {
  const TemporaryFile file("points.csv", "# two\nmass, z, y ,x,inertia\n\n1,3,2,1,0.5\n2, 6,5,4 ,0.25\r\n");
  Case c = case_of(CsvSpecimen{{file.path(), {"case.toml", 4, 1}}});
  c.specimens[0].mass.reset();
  const Built b = build(c);
  expect_positions(b, {{1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(b.model.mass.values(), (std::vector<double>{1, 2}));
  EXPECT_EQ(b.model.inertia.values(), (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(b.model.radius.values(), (std::vector<double>{0.4, 0.4}));
}

TEST(CsvSpecimen, IsNamedFromTheFolderOfTheCase) {
  const TemporaryFile file("points.csv", "x,y,z\n1,2,3\n");
  Case c = case_of(CsvSpecimen{{file.path().filename(), {"case.toml", 4, 1}}});
  c.file = (file.path().parent_path() / "case.toml").string();
  EXPECT_EQ(build(c).model.particles(), 1u);
}

TEST(CsvSpecimen, ReportsEveryWrongRowWithItsLine) {
  const TemporaryFile file("points.csv", "x,y,z\n1,2,3\n1,2\n1,two,3\n1,2,inf\n");
  const std::string error = text_of_error(case_of(CsvSpecimen{{file.path(), {"case.toml", 4, 1}}}));
  EXPECT_TRUE(contains(error, "points.csv:3:1: 2 fields")) << error;
  const TemporaryFile words("words.csv", "x,y,z\n1,2,3\n1,two,3\n1,2,inf\n");
  const std::string second = text_of_error(case_of(CsvSpecimen{{words.path(), {"case.toml", 4, 1}}}));
  EXPECT_TRUE(contains(second, "words.csv:3:1: y = \"two\"")) << second;
  EXPECT_TRUE(contains(second, "words.csv:4:1: z = \"inf\"")) << second;
}

TEST(CsvSpecimen, SuggestsTheColumnThatWasMeant) {
  const TemporaryFile file("points.csv", "x,y,z,raduis\n1,2,3,0.5\n");
  const std::string error = text_of_error(case_of(CsvSpecimen{{file.path(), {"case.toml", 4, 1}}}));
  EXPECT_TRUE(contains(error, "did you mean \"radius\"?")) << error;
}

TEST(CsvSpecimen, SaysWhichFileIsMissingAndWhereItIsNamed) {
  const std::string error = text_of_error(case_of(CsvSpecimen{{"no-such.csv", {"case.toml", 4, 8}}}));
  EXPECT_TRUE(contains(error, "case.toml:4:8: \"no-such.csv\" cannot be read")) << error;
}

}  // namespace
}  // namespace vbond::test
