// Which pairs of a packing are bonded: by gaps of surfaces, faces of Voronoi cells, a share of them.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <tuple>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packing/plain_voronoi.hpp"
#include "two_sizes.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/setup/bond_pairs.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::packing_pairs_test {
namespace {

using namespace two_sizes;
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

/// Bit by bit: a process may look for pairs of its own particles where another has looked for all.
TEST(PackingBonds, OfSomeParticlesAreThoseOfAllWithSuchAFirstOne) {
  const Tally tally = campaign("pairs of some first particles", 400, [](unsigned seed, Tally& t) {
    Dice dice(seed);
    const Grains g = random_grains(dice);
    Model model;
    State state;
    model.radius = PerParticle<double>(g.R), model.cell.periodic = g.periodic;
    state.r = PerParticle<Vec3d>(g.r), state.cell = g.cell;
    const double at = dice(-0.5, 0.5) * norm(g.r[0]);
    PerParticle<char> some(g.r.size(), 0);
    for (const ParticleId p : some.ids()) some[p] = state.r[p].x < at || dice.chance(0.05);
    // now and then a pair is exactly at the distance
    const double distance = dice.chance(0.5) && g.r.size() > 1 ? norm(g.r[1] - g.r[0]) : dice.ratio(0.1, 3.0);
    for (const BondReach& reach :
         {BondReach{distance, 0.0}, BondReach{0.0, dice(0.5, 3.0)}, BondReach{dice(0.0, 0.5), 1.0}}) {
      std::vector<Pair> wanted = pairs_within(model, state, reach, g.in_a, g.in_b, INFINITY);
      const std::size_t all = wanted.size();
      std::erase_if(wanted, [&some](const Pair& p) { return some[p.i] == 0; });
      EXPECT_TRUE(pairs_within(model, state, reach, g.in_a, g.in_b, INFINITY, some) == wanted);
      if (!wanted.empty()) {
        EXPECT_THROW(pairs_within(model, state, reach, g.in_a, g.in_b, double(wanted.size()) - 1.0, some),
                     std::length_error);
      }
      t.add("of some", double(wanted.size())), t.add("of others", double(all - wanted.size()));
    }
  });
  if (!tally.full) return;
  EXPECT_GT(tally.sum("of some"), 2000.0);
  EXPECT_GT(tally.sum("of others"), 2000.0);
}

TEST(PackingBonds, WhereSizesDifferAGapTellsWhatADistanceCannot) {
  const auto pairs = [](const std::string& by) { return pairs_of(build(of_two_sizes(by + stiff))); };
  // gaps: .1 of the large ones, 0 of large and small (touching), .05 of the small ones
  EXPECT_EQ(pairs("gap = 0\n"), (PairList{{0, 2}}));
  EXPECT_EQ(pairs("gap = 0.06\n"), (PairList{{0, 2}, {2, 3}}));
  EXPECT_EQ(pairs("gap = 0.11\n"), (PairList{{0, 1}, {0, 2}, {2, 3}}));
  // in parts of the radii: 1.025, 1, 1.025
  EXPECT_EQ(pairs("gap_factor = 1.02\n"), (PairList{{0, 2}}));
  EXPECT_EQ(pairs("gap_factor = 1.026\n"), (PairList{{0, 1}, {0, 2}, {2, 3}}));
  EXPECT_EQ(pairs("gap = 0.11\nbetween = [\"large\", \"small\"]\n"), (PairList{{0, 2}}));
}

TEST(PackingBonds, SelectionsThatCannotBeAreRefusedWithTheWayOut) {
  const std::string bare =
      "[[specimen]]\nname = \"bare\"\nkind = \"list\"\npositions = [[9, 9, 9]]\nmass = 1\ninertia = 1\n";
  const std::string error = mistake_of("gap = 0.1\n" + stiff, bare);
  EXPECT_PRED2(contains, error,
               "case.toml:21:1: bonds \"b\": gap: particle 4 of specimen \"bare\" has radius 0");
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

/// The body of a case that is given without a stage.
Built built(const std::string& text) {
  return build(parse_case(text + still, "case.toml"));
}

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
    const Built b = built("[[specimen]]\nkind = \"block\"\nlattice = \"" + std::string(lattice) +
                          "\"\ncells = [6, 5, 5]\nradius = 0.5\nmass = 1\n" + faces);
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
    return built(list_of_places(r, cell) + faces + more).state.bonds.size();
  };
  EXPECT_EQ(bonds_with(""), r.size() * 12 / 2);
  EXPECT_GT(bonds_with("least_face = 0\n"), r.size() * 13 / 2);  // near pairs of holes' corners
}

TEST(PackingBonds, WhoStandsBetweenTwoPartsThem) {
  const std::string three =
      list_of_places({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, "radius = 0.5\n[[bonds]]\ndistance = 2.1\n");
  const auto pairs = [&](const std::string& choice) { return pairs_of(built(three + choice + stiff)); };
  EXPECT_EQ(pairs(""), (PairList{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(pairs("neighbours = \"all\"\n"), (PairList{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(pairs("neighbours = \"voronoi\"\n"), (PairList{{0, 1}, {1, 2}}));
}

// Pair by pair, from cells that every plane has clipped.
TEST(PackingBonds, OfRandomGrainsInASlantedCellAreThoseWithAFace) {
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
    found.insert({bond.i.value, bond.j.value, image_of_j(bond).a, image_of_j(bond).b, image_of_j(bond).c});
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
    const std::string all = head + shape + bonds, chosen = all + "neighbours = \"voronoi\"\n";
    EXPECT_EQ(pairs_of(built(chosen + stiff)), pairs_of(built(all + stiff))) << shape;
  }
}

// Cells end farther outside of a free surface for a set that reaches farther: sets must not take each
// other's.
TEST(PackingBonds, WithFacesDoNotDependOnSetsBeforeThem) {
  const std::string sheet = "[[specimen]]\nkind = \"sheet\"\nparticles = [6, 5]\nradius = 0.3\nmass = 1\n";
  const auto set = [](const std::string& name, const std::string& distance) {
    return "[[bonds]]\nname = \"" + name + "\"\nneighbours = \"voronoi\"\ndistance = " + distance + "\n" +
           stiff;
  };
  const auto pairs = [&](const std::string& sets) {
    PairList list = pairs_of(built(sheet + sets));
    std::sort(list.begin(), list.end());
    return list;
  };
  const PairList near = pairs(set("near", "1.01")), far = pairs(set("far", "1.8"));
  EXPECT_GT(far.size(), near.size());  // along the rim those of the second row meet outside
  EXPECT_EQ(pairs(set("near", "1.01") + set("far", "1.8")), far);
}

TEST(PackingBonds, FacesThatCannotBeAreRefusedWithTheWayOut) {
  const std::string approach = mistake_of("gap = 1\nneighbours = \"voronoi\"\nwhen = \"approach\"\n" + stiff);
  EXPECT_TRUE(contains(approach, "chooses among pairs within distance, gap or gap_factor")) << approach;
  const std::string listed = mistake_of("pairs = [[0, 1]]\nneighbours = \"voronoi\"\n" + stiff);
  EXPECT_TRUE(contains(listed, "give gap_factor")) << listed;
  const std::string large = mistake_of("gap = 0.11\nneighbours = \"voronoi\"\nleast_face = 100\n" + stiff);
  EXPECT_TRUE(contains(large, "none of the 3 pairs within a gap of 0.11")) << large;
  EXPECT_TRUE(contains(mistake_of("gap = 1\nleast_face = 0.1\n" + stiff), "is used only with neighbours"));
  const std::string negative = mistake_of("gap = 1\nneighbours = \"voronoi\"\nleast_face = -1\n" + stiff);
  EXPECT_TRUE(contains(negative, "0.01")) << negative;  // of the size that such a face has
}

// ---- a share of them -------------------------------------------------------------------------------

const std::string block =
    "[[specimen]]\nkind = \"block\"\nlattice = \"fcc\"\ncells = [6, 6, 6]\nradius = 0.5\nmass = 1\n";

PairList share_of_block(const std::string& selection) {
  return pairs_of(built(block + "[[bonds]]\n" + selection + stiff));
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
      built(block + "[[bonds]]\ngap = 0.01\nshare = 0.3\n" + stiff +
            "strength = {criterion = \"elongation\", elongation = 0.01, weibull = {modulus = 1}}\n");
  double sum = 0.0;
  for (const Bond& bond : b.state.bonds) sum += strength_factor(bond);
  const double n = static_cast<double>(b.state.bonds.size());
  EXPECT_NEAR(sum / n, 1.0, 4.0 / std::sqrt(n));  // exponential: mean 1, deviation 1
}

}  // namespace
}  // namespace vbond::packing_pairs_test
