// Bonds of packings: selected by gaps of surfaces, with sections that follow radii, stiffnesses per area,
// necks.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packing/plain_voronoi.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/setup/bond_pairs.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::packing_bonds_test {
namespace {

using testing::campaign;
using testing::Dice;
using testing::Tally;

// ---- which pairs -----------------------------------------------------------------------------------

struct Grains {
  std::vector<Vec3d> r;
  std::vector<double> R;
  std::vector<char> in_a, in_b;
  CellEdges cell;
  Periodic periodic{};
};

Grains random_grains(Dice& dice) {
  Grains g;
  const double size = dice.ratio(0.3, 6.0), spread = dice.ratio(1.0, 20.0);
  for (std::size_t k = dice.count(1, 25); k > 0; --k) {
    g.r.push_back(dice.vector(size));
    g.R.push_back(0.2 * dice.ratio(1.0 / spread, 1.0));
    g.in_a.push_back(dice.chance(0.8)), g.in_b.push_back(dice.chance(0.8));
  }
  if (dice.chance(0.35)) return g;
  const double edge = 2.0 * size;
  for (int k = 0; k < 3; ++k) {
    Vec3d along = 0.3 * edge * dice.vector(1.0);
    (k == 0 ? along.x : k == 1 ? along.y : along.z) = edge;
    g.cell.push_back({along});
    g.periodic[static_cast<std::size_t>(k)] = dice.chance(0.8);
  }
  return g;
}

using PairSet = std::set<std::tuple<std::size_t, std::size_t, std::int32_t, std::int32_t, std::int32_t>>;

/// Every particle with every image of every other, one by one; far: of images in each direction.
PairSet by_brute_force(const Grains& g, bool by_factor, double value, int far) {
  PairSet pairs;
  const auto range = [&](std::size_t k) { return g.cell.empty() || !g.periodic[k] ? 0 : far; };
  for (std::size_t i = 0; i < g.r.size(); ++i)
    for (std::size_t j = i; j < g.r.size(); ++j)
      for (int a = -range(0); a <= range(0); ++a)
        for (int b = -range(1); b <= range(1); ++b)
          for (int c = -range(2); c <= range(2); ++c) {
            if (i == j && !(Image{a, b, c} > Image{})) continue;
            if (!((g.in_a[i] && g.in_b[j]) || (g.in_a[j] && g.in_b[i]))) continue;
            Vec3d d = g.r[j] - g.r[i];
            if (!g.cell.empty())
              d = d + double(a) * g.cell[0].along + double(b) * g.cell[1].along + double(c) * g.cell[2].along;
            const double sum = g.R[i] + g.R[j], distance = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
            if (by_factor ? distance <= value * sum : distance - sum <= value) pairs.insert({i, j, a, b, c});
          }
  return pairs;
}

TEST(PackingBonds, JoinExactlyThePairsThatBruteForceFinds) {
  const Tally tally = campaign("pairs within gaps and factors", 400, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    const Grains g = random_grains(dice);
    const bool by_factor = dice.chance(0.5);
    const double value = by_factor ? dice(0.5, 3.0) : dice.chance(0.1) ? 0.0 : dice.ratio(1e-3, 0.5);
    const BondReach reach = by_factor ? BondReach{0.0, value} : BondReach{value, 1.0};
    double largest = 0.0;
    for (const double R : g.R) largest = std::max(largest, reach(R, R));
    int far = 0;
    if (!g.cell.empty()) {
      const Vec3d h = heights(g.cell);
      far = 2 + static_cast<int>(largest / std::min({h.x, h.y, h.z}));
    }
    PairSet found;
    for (const Pair& p : pairs_within(g.r, g.R, reach, g.in_a, g.in_b, INFINITY, g.cell, g.periodic))
      EXPECT_TRUE(found.insert({p.i.value, p.j.value, p.image_j.a, p.image_j.b, p.image_j.c}).second)
          << "twice";
    // points need not stand in the cell: images count from there, so that the search goes farther
    const PairSet wanted = by_brute_force(g, by_factor, value, far + 3);
    EXPECT_EQ(found, wanted);
    t.add("pairs", double(found.size()));
    for (const auto& [i, j, a, b, c] : found) {
      if (Image{a, b, c} != Image{}) t.add("through faces");
      if (i == j) t.add("of a particle with itself");
    }
  });
  if (!tally.full) return;
  EXPECT_GT(tally.sum("pairs"), 2000.0);
  EXPECT_GT(tally.sum("through faces"), 500.0);
  EXPECT_GT(tally.sum("of a particle with itself"), 10.0);
}

const std::string two_sizes =
    "[[specimen]]\nname = \"large\"\nkind = \"list\"\npositions = [[0, 0, 0], [4.1, 0, 0]]\nradius = 2\nmass "
    "= 8\n"
    "[[specimen]]\nname = \"small\"\nkind = \"list\"\npositions = [[0, 3, 0], [0, 5.05, 0]]\nradius = 1\n"
    "mass = 1\n";
bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::string still = "[[stage]]\nduration = 1\n";

Case of_two_sizes(const std::string& bonds, const std::string& more = "") {
  return parse_case(two_sizes + more + "[[bonds]]\nname = \"b\"\n" + bonds + still, "case.toml");
}
std::string mistake_of(const std::string& bonds, const std::string& more = "") {
  try {
    build(of_two_sizes(bonds, more));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

const std::string stiff = "stiffness = { c_A = 1, c_D = 0.3, c_B = 0.1, c_T = 0.1 }\n";

using PairList = std::vector<std::array<std::size_t, 2>>;
PairList pairs_of(const Built& b) {
  PairList pairs;
  for (const Bond& bond : b.state.bonds) pairs.push_back({bond.i.value, bond.j.value});
  return pairs;
}

TEST(PackingBonds, WhereSizesDifferAGapTellsWhatADistanceCannot) {
  // gaps: .1 of the large ones, 0 of large and small (touching), .05 of the small ones
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap = 0\n" + stiff))), (PairList{{0, 2}}));
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap = 0.06\n" + stiff))), (PairList{{0, 2}, {2, 3}}));
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap = 0.11\n" + stiff))), (PairList{{0, 1}, {0, 2}, {2, 3}}));
  // in parts of the radii: 1.025, 1, 1.025
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap_factor = 1.02\n" + stiff))), (PairList{{0, 2}}));
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap_factor = 1.026\n" + stiff))),
            (PairList{{0, 1}, {0, 2}, {2, 3}}));
  EXPECT_EQ(pairs_of(build(of_two_sizes("gap = 0.11\nbetween = [\"large\", \"small\"]\n" + stiff))),
            (PairList{{0, 2}}));
}

TEST(PackingBonds, SelectionsThatCannotBeAreRefusedWithTheWayOut) {
  const std::string bare =
      "[[specimen]]\nname = \"bare\"\nkind = \"list\"\npositions = [[9, 9, 9]]\nmass = 1\ninertia = 1\n";
  const std::string error = mistake_of("gap = 0.1\n" + stiff, bare);
  EXPECT_TRUE(
      contains(error, "case.toml:21:1: bonds \"b\": gap: particle 4 of specimen \"bare\" has radius 0"))
      << error;
  EXPECT_TRUE(contains(error, "give the specimen a radius, or select by distance")) << error;
  EXPECT_EQ(mistake_of("gap = 0.1\nbetween = [\"small\", \"small\"]\n" + stiff, bare), "");
  const std::string none = mistake_of("gap = 0.01\nbetween = [\"large\", \"large\"]\n" + stiff);
  EXPECT_TRUE(contains(none, "no pair is within a gap of 0.01")) << none;
  EXPECT_TRUE(contains(none, "the nearest are 0.1 apart")) << none;
  const std::string factor = mistake_of("gap_factor = 1\nbetween = [\"large\", \"large\"]\n" + stiff);
  EXPECT_TRUE(contains(factor, "the nearest are 1.025 (R_i + R_j) apart")) << factor;
  for (const char* bad :
       {"gap = -0.1\n", "gap_factor = 0\n", "share = 0\ngap = 1\n", "share = 1.1\ngap = 1\n"})
    EXPECT_NE(mistake_of(bad + stiff), "") << bad;
  EXPECT_TRUE(contains(mistake_of("gap = 1\ndistance = 3\n" + stiff), "both of"));
  EXPECT_TRUE(contains(mistake_of("gap = 1\nseed = 3\n" + stiff), "is used only with share < 1"));
}

// ---- those whose Voronoi cells meet ----------------------------------------------------------------

/// How many bonds each particle has.
std::vector<int> bonds_of(const Built& b) {
  std::vector<int> n(b.model.particles());
  for (const Bond& bond : b.state.bonds) ++n[bond.i.value], ++n[bond.j.value];
  return n;
}
std::string list_of_places(const std::vector<Vec3d>& r, const std::string& more) {
  std::string text;
  char place[120];
  for (const Vec3d& p : r)
    std::snprintf(place, sizeof place, "%s[%.17g, %.17g, %.17g]", text.empty() ? "" : ", ", p.x, p.y, p.z),
        text += place;
  return "[[specimen]]\nkind = \"list\"\npositions = [" + text + "]\nmass = 1\n" + more;
}
const std::string faces = "[[bonds]]\nname = \"b\"\ngap_factor = 1.6\nneighbours = \"voronoi\"\n" + stiff;

TEST(PackingBonds, OfLatticesMeetThoseThatTheirPolyhedraDo) {
  // within 1.6 spacings there are more: 18 of sc, 18 of fcc and hcp, 14 of bcc
  for (const auto& [lattice, neighbours] :
       {std::pair{"simple-cubic", 6}, std::pair{"fcc", 12}, std::pair{"hcp", 12}, std::pair{"bcc", 14}}) {
    const Built b = build(parse_case("[[specimen]]\nkind = \"block\"\nlattice = \"" + std::string(lattice) +
                                         "\"\ncells = [6, 5, 5]\nradius = 0.5\nmass = 1\n" + faces + still,
                                     "case.toml"));
    const std::vector<int> n = bonds_of(b);
    BoundingBox box = box_around(b.state.r.values());
    int inside = 0;
    for (const ParticleId p : b.state.r.ids()) {
      const Vec3d low = b.state.r[p] - box.low, high = box.high - b.state.r[p];
      if (std::min({low.x, low.y, low.z, high.x, high.y, high.z}) < 1.5) continue;
      EXPECT_EQ(n[p.value], neighbours) << lattice << ", particle " << p.value;
      ++inside;
    }
    EXPECT_GE(inside, 2) << lattice;
  }
}

TEST(PackingBonds, SliversOfShakenLatticesAreNoNeighbours) {
  const std::string cell =
      "radius = 0.5\n[cell]\na = [4.2426406871192857, 0, 0]\nb = [0, 4.2426406871192857, 0]\n"
      "c = [0, 0, 4.2426406871192857]\n";
  const double edge = std::sqrt(2.0);
  Dice dice(5);
  std::vector<Vec3d> r;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        for (const Vec3d& b : {Vec3d{0, 0, 0}, Vec3d{0, 0.5, 0.5}, Vec3d{0.5, 0, 0.5}, Vec3d{0.5, 0.5, 0}})
          r.push_back(edge * (Vec3d{double(x), double(y), double(z)} + b) + dice.vector(0.01));
  const auto bonds_with = [&](const std::string& more) {
    return build(parse_case(list_of_places(r, cell) + faces + more + still, "case.toml")).state.bonds.size();
  };
  EXPECT_EQ(bonds_with(""), r.size() * 12 / 2);
  EXPECT_GT(bonds_with("least_face = 0\n"), r.size() * 13 / 2);  // near pairs of holes' corners
}

TEST(PackingBonds, WhoStandsBetweenTwoPartsThem) {
  const std::string three = list_of_places({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "radius = 0.5\n");
  const auto pairs = [&](const std::string& bonds) {
    return pairs_of(build(parse_case(three + "[[bonds]]\n" + bonds + stiff + still, "case.toml")));
  };
  EXPECT_EQ(pairs("distance = 2.1\n"), (PairList{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(pairs("distance = 2.1\nneighbours = \"all\"\n"), (PairList{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(pairs("distance = 2.1\nneighbours = \"voronoi\"\n"), (PairList{{0, 1}, {1, 2}}));
}

// Pair by pair, from cells that every plane has clipped.
TEST(PackingBonds, OfRandomGrainsInASlantedCellAreThoseWithAFace) {
  using packing::testing::FaceName;
  Dice dice(11);
  packing::VoronoiSpace space;
  space.edges = {Vec3d{5, 0, 0}, Vec3d{1.5, 4, 0}, Vec3d{-0.5, 1, 4.5}};
  space.periodic = {true, true, true};
  std::vector<Vec3d> r;
  std::vector<double> R;
  std::string csv = "x,y,z,radius,mass\n";
  while (r.size() < 40) {
    r.push_back(dice(0, 1) * space.edges[0] + dice(0, 1) * space.edges[1] + dice(0, 1) * space.edges[2]);
    R.push_back(dice(0.2, 0.7));
    char row[200];
    std::snprintf(row, sizeof row, "%.17g,%.17g,%.17g,%.17g,1\n", r.back().x, r.back().y, r.back().z,
                  R.back());
    csv += row;
  }
  std::set<std::tuple<std::size_t, std::size_t, int, int, int>> wanted, found;
  for (std::size_t i = 0; i < r.size(); ++i)
    for (const auto& [name, area] : packing::testing::plain_cell(space, r, R, i).areas()) {
      const auto& [j, a, b, c] = name;
      const Image n{a, b, c};
      if (j < i || (j == i && !(n > Image{}))) continue;
      const Vec3d d =
          r[j] + double(a) * space.edges[0] + double(b) * space.edges[1] + double(c) * space.edges[2] - r[i];
      if (norm(d) <= 2.2 * (R[i] + R[j]) && area >= 0.03 * norm2(d)) wanted.insert({i, j, a, b, c});
    }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("vbond-faces-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "grains.csv") << csv;
  const Built b =
      build(parse_case("[[specimen]]\nkind = \"csv\"\nfile = \"grains.csv\"\n[cell]\na = [5, 0, 0]\nb = "
                       "[1.5, 4, 0]\nc = [-0.5, 1, 4.5]\n[[bonds]]\ngap_factor = 2.2\nneighbours = "
                       "\"voronoi\"\nleast_face = 0.03\n" +
                           stiff + still,
                       (folder / "case.toml").string()));
  std::filesystem::remove_all(folder);
  for (const Bond& bond : b.state.bonds)
    found.insert({bond.i.value, bond.j.value, bond.image_j.a, bond.image_j.b, bond.image_j.c});
  EXPECT_EQ(found, wanted);
  EXPECT_GT(found.size(), 120u);
}

// What lies at a free edge or surface has a face with its neighbours there as inside: a sheet, a block and
// two points have all the bonds that they have without the choice.
TEST(PackingBonds, OfFreeSurfacesAreChosenAsInside) {
  const std::string head = "[[specimen]]\nmass = 1\ninertia = 1\n", bonds = "[[bonds]]\ndistance = 1.01\n";
  for (const std::string shape :
       {"kind = \"sheet\"\nlattice = \"square\"\nparticles = [5, 5]\nspacing = 1\n",
        "kind = \"block\"\nlattice = \"simple-cubic\"\ncells = [4, 3, 3]\nspacing = 1\n",
        "kind = \"rod\"\nparticles = 2\nspacing = 1\n"}) {
    const auto pairs = [&](const std::string& choice) {
      return pairs_of(build(parse_case(head + shape + bonds + choice + stiff + still, "case.toml")));
    };
    EXPECT_EQ(pairs("neighbours = \"voronoi\"\n"), pairs("")) << shape;
  }
}

TEST(PackingBonds, FacesThatCannotBeAreRefusedWithTheWayOut) {
  const std::string approach = mistake_of("gap = 1\nneighbours = \"voronoi\"\nwhen = \"approach\"\n" + stiff);
  EXPECT_TRUE(contains(approach, "chooses among pairs within distance, gap or gap_factor")) << approach;
  const std::string listed = mistake_of("pairs = [[0, 1]]\nneighbours = \"voronoi\"\n" + stiff);
  EXPECT_TRUE(contains(listed, "give gap_factor")) << listed;
  const std::string large = mistake_of("gap = 0.11\nneighbours = \"voronoi\"\nleast_face = 100\n" + stiff);
  EXPECT_TRUE(contains(large, "none of the 3 pairs within a gap of 0.11")) << large;
  EXPECT_TRUE(contains(mistake_of("gap = 1\nleast_face = 0.1\n" + stiff), "is used only with neighbours"));
}

// ---- a share of them -------------------------------------------------------------------------------

const std::string block =
    "[[specimen]]\nkind = \"block\"\nlattice = \"fcc\"\ncells = [6, 6, 6]\nradius = 0.5\nmass = 1\n";

PairList share_of_block(const std::string& selection) {
  return pairs_of(build(parse_case(block + "[[bonds]]\n" + selection + stiff + still, "case.toml")));
}

TEST(PackingBonds, AShareIsChosenByThePairAlone) {
  const PairList all = share_of_block("gap_factor = 1.01\n");
  const double n = static_cast<double>(all.size());
  ASSERT_GT(n, 3500.0);
  for (const double part : {0.1, 0.5, 0.9}) {
    const std::string share = "share = " + std::to_string(part) + "\n";
    const PairList chosen = share_of_block("gap_factor = 1.01\n" + share);
    EXPECT_NEAR(double(chosen.size()), n * part, 4.0 * std::sqrt(n * part * (1.0 - part)));
    EXPECT_EQ(share_of_block("gap = 0.01\n" + share), chosen);  // however they are selected
    EXPECT_EQ(share_of_block("distance = 1.01\n" + share), chosen);
    EXPECT_NE(share_of_block("gap = 0.01\nseed = 2\n" + share), chosen);
    const PairList more = share_of_block("gap = 0.01\nshare = " + std::to_string(part + 0.05) + "\n");
    EXPECT_TRUE(std::includes(more.begin(), more.end(), chosen.begin(), chosen.end()))
        << "a larger share has them";
    EXPECT_GT(more.size(), chosen.size());
  }
}

TEST(PackingBonds, APairHasOneNumberFromBothEnds) {
  Dice dice(1);
  double sum = 0.0, product = 0.0;
  constexpr int n = 20000;
  for (int k = 0; k < n; ++k) {
    const ParticleId i{dice.below(1000)}, j{1000 + dice.below(1000)};
    const Image image{dice.whole(-2, 2), dice.whole(-2, 2), dice.whole(-2, 2)};
    const double u = pair_variate(7, i, j, image);
    EXPECT_EQ(u, pair_variate(7, j, i, -image));
    if (image != Image{}) {
      EXPECT_NE(u, pair_variate(7, i, j));
      EXPECT_EQ(pair_variate(7, i, i, image), pair_variate(7, i, i, -image));
    }
    EXPECT_NE(u, pair_variate(8, i, j, image));
    EXPECT_TRUE(u >= 0.0 && u < 1.0);
    sum += u, product += (u - 0.5) * (pair_variate(8, i, j, image) - 0.5);
  }
  EXPECT_NEAR(sum / n, 0.5, 4.0 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(product / n, 0.0, 4.0 / 12.0 / std::sqrt(double(n)));  // seeds are independent of each other
}

// The factors of strength come from the same seed: a share must not leave the weak, nor the strong.
TEST(PackingBonds, AShareLeavesStrengthsAsTheyAre) {
  const Built b =
      build(parse_case(block + "[[bonds]]\ngap = 0.01\nshare = 0.3\n" + stiff +
                           "strength = { criterion = \"elongation\", elongation = 0.01, weibull = { "
                           "modulus = 1 } }\n" +
                           still,
                       "case.toml"));
  double sum = 0.0;
  for (const Bond& bond : b.state.bonds) sum += strength_factor(bond);
  const double n = static_cast<double>(b.state.bonds.size());
  EXPECT_NEAR(sum / n, 1.0, 4.0 / std::sqrt(n));  // exponential: mean 1, deviation 1
}

// ---- sections and stiffnesses ----------------------------------------------------------------------

struct RandomBond {
  BondRecipe recipe;
  BondSite i, j;
  double gap = 0;
  TheoryParameters& theory() { return std::get<TheoryParameters>(recipe.parameters); }
};

double near(double x, double y) {
  return std::abs(x / y - 1.0);
}

/// A bond of theory `parallel` whose section follows radii, between grains of different size anywhere.
RandomBond random_parallel(Dice& dice) {
  RandomBond b;
  TheoryParameters p;
  p.theory = BondTheory::parallel;
  const double R_i = dice.ratio(0.1, 10.0), R_j = R_i * dice.ratio(0.2, 5.0);
  p.of_radii = {dice(0.1, 1.0), dice.chance(0.3)};
  if (p.of_radii.of_mean) p.of_radii.factor *= 2.0 * std::min(R_i, R_j) / (R_i + R_j);
  if (dice.chance(0.4)) {
    p.material.E = dice.ratio(0.1, 10.0), p.per_area.ratio = dice.ratio(0.5, 5.0);
  } else {
    p.per_area.k_n = dice.ratio(0.1, 10.0), p.per_area.k_s = dice.ratio(0.1, 10.0);
  }
  if (dice.chance(0.3))
    p.per_area.grain_k_n = dice.ratio(0.1, 10.0), p.per_area.grain_k_s = dice.ratio(0.1, 10.0);
  b.recipe.parameters = p;
  b.recipe.law = named_laws()[dice.below(named_laws().size())];
  b.recipe.attachment = Attachment::neck;
  b.gap = dice(-0.02, 0.3) * p.of_radii.factor * p.of_radii.factor * std::min(R_i, R_j);
  const Vec3d r = dice.vector(R_i);
  b.i = {ParticleId{0}, r, dice.rotation(3.0), R_i, 1.0, 1.0};
  b.j = {ParticleId{1}, r + (R_i + R_j + b.gap) * dice.direction(), dice.rotation(3.0), R_j, 1.0, 1.0};
  return b;
}

TEST(PackingBonds, OfStiffnessesPerAreaHaveThemTimesTheirOwnSection) {
  const Tally tally = campaign("parallel bonds", 500, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    RandomBond b = random_parallel(dice);
    const TheoryParameters& p = b.theory();
    const double R = p.of_radii.of_mean ? (b.i.radius + b.j.radius) / 2 : std::min(b.i.radius, b.j.radius),
                 r = p.of_radii.factor * R, A = M_PI * r * r, J = M_PI * r * r * r * r / 4;
    double k_n = p.per_area.k_n, k_s = p.per_area.k_s;
    if (p.per_area.ratio > 0) k_n = p.material.E / (b.i.radius + b.j.radius), k_s = k_n / p.per_area.ratio;
    if (p.per_area.grain_k_n > 0) k_n = k_n * p.per_area.grain_k_n / (p.per_area.grain_k_n + 2 * k_n);
    if (p.per_area.grain_k_s > 0) k_s = k_s * p.per_area.grain_k_s / (p.per_area.grain_k_s + 2 * k_s);
    const BondStiffness<double> c = stiffness_of(b.recipe, 1.0, {b.i.radius, b.j.radius});
    t.below("error of c_A, c_D, c_B, c_T",
            std::max(
                {near(c.c_A, A * k_n), near(c.c_D, A * k_s), near(c.c_B, J * k_n), near(c.c_T, 2 * J * k_s)}),
            3e-15);
    const auto bond = make_bond(b.recipe, b.i, b.j);
    ASSERT_TRUE(bond);
    // through the coefficients of a law, B2 = c_B - B3/2: what rounding of the larger one leaves
    const BondStiffness<double> k = stiffness_of(*bond);
    const double scale = c.c_B + c.c_D * bond->a * bond->a + c.c_T;
    t.below("error of the law's",
            std::max({near(k.c_A, c.c_A), near(k.c_D, c.c_D), std::abs(k.c_B - c.c_B) / scale,
                      std::abs(k.c_T - c.c_T) / scale}),
            1e-14);
  });
  EXPECT_EQ(tally["right"], tally.cases);
}

// [PC04] eqs. (13) to (15) in one step from rest: forces k A u at the contact point, moments k I theta and
// k J theta, which act on the two particles with the lever of the contact point.
TEST(PackingBonds, AreParallelBondsAtTheContactPoint) {
  const Tally tally =
      campaign("parallel bonds against their own definition", 500, [](unsigned seed, Tally& t) {
        Dice dice(seed);
        RandomBond b = random_parallel(dice);
        const auto bond = make_bond(b.recipe, b.i, b.j);
        ASSERT_TRUE(bond);
        const BondStiffness<double> c = stiffness_of(b.recipe, 1.0, {b.i.radius, b.j.radius});
        const Vec3d n = normalised(b.j.r - b.i.r);
        const double to_i = b.i.radius + 0.5 * b.gap,
                     to_j = b.j.radius + 0.5 * b.gap;  // of the contact point
        // of the length of the bond, which also the turns of the grains shift their surfaces by
        const double size = 1e-6 * bond->a, turn = size / (to_i + to_j);
        const Vec3d u_i = size * dice.vector(1.0), u_j = size * dice.vector(1.0);
        const Vec3d w_i = turn * dice.vector(1.0), w_j = turn * dice.vector(1.0);
        const Vec3d u = u_j + cross(w_j, -to_j * n) - u_i - cross(w_i, to_i * n), w = w_j - w_i;
        const Vec3d F = c.c_A * dot(u, n) * n + c.c_D * (u - dot(u, n) * n);  // on i
        const Vec3d M = c.c_T * dot(w, n) * n + c.c_B * (w - dot(w, n) * n);
        const Vec3d M_i = M + cross(to_i * n, F), M_j = -M + cross(-to_j * n, -F);

        const Vec3d r_ij = b.j.r + u_j - b.i.r - u_i;
        const BondLoads<double> l = bond->law->loads(
            *bond, bond_pose(*bond, r_ij, rotation_of(w_i) * b.i.q, rotation_of(w_j) * b.j.q), {});
        // a bond turns by M/c_B, and its force by M/a times that: of second order in the motion
        const double force = norm(F) + norm(M) / bond->a,
                     moment = norm(M_i) + norm(M_j) + norm(F) * (to_i + to_j);
        t.below("error of the force", norm(l.F - F) / force, 2e-5);
        t.below("error of the moments", std::max(norm(l.M_ij - M_i), norm(l.M_ji - M_j)) / moment, 2e-5);
      });
  EXPECT_EQ(tally["right"], tally.cases);
}

TEST(PackingBonds, AreMadeOfTheKeysOfACase) {
  const Built b =
      build(of_two_sizes("gap = 0.11\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = "
                         "{ shape = \"circle\", factor "
                         "= 0.5 }\n"));
  ASSERT_EQ(b.state.bonds.size(), 3u);
  for (const Bond& bond : b.state.bonds) {
    const double R = std::min(b.model.radius[bond.i], b.model.radius[bond.j]), A = M_PI * 0.25 * R * R;
    EXPECT_NEAR(stiffness_of(bond).c_A, 3 * A, 1e-14 * A);
    EXPECT_NEAR(stiffness_of(bond).c_D, 2 * A, 1e-14 * A);
    EXPECT_NEAR(stiffness_of(bond).c_B, 3 * A * 0.25 * R * R / 4, 1e-14 * A * R * R);
    EXPECT_NEAR(stiffness_of(bond).c_T, 2 * A * 0.25 * R * R / 2, 1e-14 * A * R * R);
  }
  const Built beams =
      build(of_two_sizes("gap = 0.11\ntheory = \"bernoulli-euler\"\nE = 7\nnu = 0.2\nsection = { shape = "
                         "\"circle\", factor = 0.5, of = "
                         "\"mean\" }\n"));
  for (const Bond& bond : beams.state.bonds) {
    const double r = 0.25 * (b.model.radius[bond.i] + b.model.radius[bond.j]);
    EXPECT_NEAR(stiffness_of(bond).c_A, 7 * M_PI * r * r / bond.a, 1e-13);
    EXPECT_NEAR(stiffness_of(bond).c_B, 7 * M_PI * std::pow(r, 4) / 4 / bond.a, 1e-13);
  }
}

// ---- necks -----------------------------------------------------------------------------------------

TEST(PackingBonds, ANeckIsAsLongAsTheCementInItsSection) {
  Dice dice(3);
  for (int k = 0; k < 200; ++k) {
    const double R_i = dice.ratio(0.1, 10.0), R_j = dice.ratio(0.1, 10.0);
    const double r = dice(0.02, 1.0) * std::min(R_i, R_j), gap = dice(-0.1, 0.1) * r;
    // volume between the two surfaces inside a cylinder of radius r, by the midpoint rule in rho^2
    constexpr int n = 20000;
    double mean = 0.0;
    for (int m = 0; m < n; ++m) {
      const double rho2 = r * r * (m + 0.5) / n;
      mean += (gap + R_i - std::sqrt(R_i * R_i - rho2) + R_j - std::sqrt(R_j * R_j - rho2)) / n;
    }
    // the rule is right to 1/n^(3/2) of R where the surface is steep: r = R
    EXPECT_NEAR(neck_length(gap, r, R_i, R_j), mean, 1e-6 * r) << k;
    EXPECT_NEAR(neck_length(gap, 1e-5 * r, R_i, R_j), gap, 1e-9 * r);
  }
}

TEST(PackingBonds, ANeckHasItsMiddleBetweenTheSurfaces) {
  campaign("necks", 200, [](unsigned seed) {
    Dice dice(seed);
    RandomBond b = random_parallel(dice);
    const auto bond = make_bond(b.recipe, b.i, b.j);
    ASSERT_TRUE(bond);
    const Vec3d n = normalised(b.j.r - b.i.r);
    const double distance = norm(b.j.r - b.i.r);
    EXPECT_NEAR(bond->R_i + bond->a + bond->R_j, distance, 1e-13 * distance);
    EXPECT_NEAR(bond->R_i + 0.5 * bond->a, b.i.radius + 0.5 * b.gap, 1e-13 * distance);
    EXPECT_NEAR(
        bond->a,
        neck_length(b.gap, section_of(b.theory(), {b.i.radius, b.j.radius}).r, b.i.radius, b.j.radius),
        1e-13 * distance);
    EXPECT_NEAR(norm(n), 1.0, 1e-14);
  });
}

TEST(PackingBonds, WithoutLengthSayThatNecksHaveOne) {
  const std::string parallel =
      "theory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = \"circle\", factor = 0.5 }\n";
  const std::string surfaces = mistake_of("gap = 0\nattach = \"surfaces\"\n" + parallel);
  EXPECT_TRUE(contains(surfaces, "attach = \"neck\" takes the length from the section")) << surfaces;
  EXPECT_EQ(mistake_of("gap = 0\nattach = \"neck\"\n" + parallel), "");
  const std::string deep = mistake_of("gap = 0\nattach = \"neck\"\n" + parallel,
                                      "[[specimen]]\nname = \"in\"\nkind = \"list\"\npositions = [[20, 0, "
                                      "0], [21, 0, 0]]\nradius = 1\nmass = 1\n");
  EXPECT_TRUE(contains(deep, "the mean gap of the surfaces over its section")) << deep;
  const std::string wide = mistake_of(
      "gap = 0\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = \"circle\", "
      "factor = 1.1 }\n");
  EXPECT_TRUE(contains(wide, "radius <= R_i and R_j")) << wide;
  EXPECT_TRUE(contains(mistake_of("gap = 0\nattach = \"neck\"\n" + stiff), "which only a theory has here"));
  EXPECT_TRUE(contains(
      mistake_of("gap = 0\nattach = \"neck\"\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape "
                 "= \"given\", A = 1, J = 1, J_p = 1 }\n"),
      "add radius to the section"));
}

TEST(PackingBonds, SectionsByRadiiAreRefusedWhereThereIsNoTheoryForThem) {
  const std::string of_strength = mistake_of(
      "gap = 0\n" + stiff +
      "strength = { criterion = \"stress\", tension = 1, shear = 1, section = { shape = \"circle\", "
      "factor = 1 } }\n");
  EXPECT_TRUE(contains(of_strength, "only the section of a theory follows the radii")) << of_strength;
  const std::string softening = mistake_of(
      "gap = 0.11\ntheory = \"bernoulli-euler\"\nE = 1\nnu = 0\nsection = { shape = \"circle\", factor = 1 "
      "}\n"
      "softening = { tension = 1, fracture_energy = 100 }\n");
  EXPECT_TRUE(contains(softening, "bonds that soften have one section")) << softening;
}

// ---- strengths -------------------------------------------------------------------------------------

// Limits in stresses are those of each bond's own section: the same shares as with that section given.
TEST(PackingBonds, BreakByTheStressesOfTheirOwnSection) {
  const Tally tally = campaign("strengths of own sections", 500, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    RandomBond own = random_parallel(dice);
    TheoryParameters& p = own.theory();
    if (dice.chance(0.6)) {
      p.theory =
          dice.one_of({BondTheory::bernoulli_euler, BondTheory::timoshenko, BondTheory::short_cylinder});
      p.material = {dice.ratio(0.1, 10.0), dice(-0.2, 0.4)}, p.kappa = 0.9;
    }
    const double s = dice.ratio(0.1, 10.0), s_t = dice.ratio(0.1, 10.0), b = dice(0.0, 1.0),
                 s_c = dice.ratio(0.5, 5.0);
    const int which = dice.whole(0, 3);
    const auto strength = [&](const Section& section) {
      if (which == 0) return stress_strength(section, s, s_t, b, s_c);
      if (which == 1) return fibre_strength(section, s, s_t, s_c);
      if (which == 2) return mohr_coulomb_strength(section, s, 0.7, s_t, b);
      return mohr_coulomb_strength(section, s, 0.7, s_t);
    };
    const BondRadii radii{own.i.radius, own.j.radius};
    RandomBond given = own;
    own.recipe.rules.strength = strength(unit_section);
    own.recipe.rules.strength.own_section = true;
    given.theory().section = section_of(p, radii), given.theory().of_radii = {};
    given.recipe.rules.strength = strength(given.theory().section);
    const auto x = make_bond(own.recipe, own.i, own.j), y = make_bond(given.recipe, given.i, given.j);
    ASSERT_TRUE(x && y);
    EXPECT_EQ(rules_of(numbers_of(own.recipe.rules)), own.recipe.rules) << "a checkpoint loses something";
    const double size = x->a;
    const Vec3d r_ij = own.j.r - own.i.r + 0.1 * size * dice.vector(1.0);
    const Quatd q_i = rotation_of(0.1 * dice.vector(1.0)) * own.i.q,
                q_j = rotation_of(0.1 * dice.vector(1.0)) * own.j.q;
    const Failure<double> f = x->law->failure(*x, bond_pose(*x, r_ij, q_i, q_j), {}),
                          g = y->law->failure(*y, bond_pose(*y, r_ij, q_i, q_j), {});
    const double most =
        std::max({std::abs(g.utilisation), std::abs(g.tension), g.shear, g.bending, g.torsion});
    t.below("difference of shares",
            std::max({std::abs(f.tension - g.tension), std::abs(f.shear - g.shear),
                      std::abs(f.bending - g.bending), std::abs(f.torsion - g.torsion),
                      std::abs(f.compression - g.compression), std::abs(f.utilisation - g.utilisation)}) /
                most,
            1e-12);
    const double N = dice(-1.0, 1.0);
    const BreakCause cause = break_cause_of(*x, g, N), wanted = break_cause_of(*y, g, N);
    EXPECT_EQ(cause.mode, wanted.mode);
    t.below("difference of the limit told",
            std::abs(cause.limit - wanted.limit) / (std::abs(wanted.limit) + s), 1e-12);
  });
  EXPECT_EQ(tally["right"], tally.cases);
}

// A bond pulled in its axis breaks at sigma A of its own section, one bent at sigma J/r.
TEST(PackingBonds, BreakAtTheLoadsOfTheirOwnSection) {
  const Built b =
      build(of_two_sizes("gap = 0.11\ntheory = \"parallel\"\nk_n = 3\nk_s = 2\nsection = { shape = "
                         "\"circle\", factor = 0.5 }\nstrength = "
                         "{ criterion = \"stress\", tension = 1e-4, shear = 1e-4 }\n"));
  for (const Bond& bond : b.state.bonds) {
    const double r = 0.5 * std::min(b.model.radius[bond.i], b.model.radius[bond.j]), A = M_PI * r * r;
    const double u = 1e-4 * A / stiffness_of(bond).c_A;  // sigma A
    const Vec3d r_ij = between(b.state, bond), e = normalised(r_ij);
    const auto use = [&](double pull, double angle) {
      const Vec3d axis = normalised(cross(e, Vec3d{0.3, 0.5, 0.8}));
      const Quatd turn = rotation_of(0.5 * angle * axis), back = rotation_of(-0.5 * angle * axis);
      // the bonded points stay where they are, so that it only bends
      const Vec3d apart = (bond.a + pull) * e + bond.R_i * rotate(turn, e) + bond.R_j * rotate(back, e);
      return bond.law->failure(bond, bond_pose(bond, apart, turn, back), {}).utilisation;
    };
    EXPECT_NEAR(use(u, 0.0), 1.0, 1e-10);                              // positions round to 1e-11 of u
    const double angle = 1e-4 * (A * r / 4) / stiffness_of(bond).c_B;  // sigma J/r over c_B
    EXPECT_NEAR(use(0.0, angle), 1.0, 1e-4);                           // of small angles: 1e-3 squared, and N
  }
}

}  // namespace
}  // namespace vbond::packing_bonds_test
