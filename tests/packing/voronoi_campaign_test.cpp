#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "packing/plain_packing.hpp"
#include "packing/plain_voronoi.hpp"

/// Cells of random packings against cells that are clipped by every plane there is.
namespace vbond::packing::voronoi_campaign {
namespace {

using namespace packing::testing;
using vbond::testing::Dice;
using vbond::testing::Tally;
using vbond::testing::Verdict;
using vbond::testing::wrong;

struct Plan {
  Vessel vessel;
  std::vector<Vec3d> r;
  std::vector<double> R;
};

Vessel some_vessel(Dice& dice, double s) {
  switch (dice.below(4)) {
    case 0: return box({s, s * dice(0.5, 1.5), s * dice(0.5, 1.5)});
    case 1: return cube(s);
    default: {
      Vessel v =
          periodic_cell({s, 0, 0}, {s * dice(-0.4, 0.4), s * dice(0.7, 1.3), 0},
                        {s * dice(-0.4, 0.4), s * dice(-0.4, 0.4), s * dice(0.7, 1.3)}, dice.vector(5));
      if (dice.chance(0.3)) {  // open along an edge, between its two faces
        const std::size_t k = dice.below(3);
        const Vec3d n = normalised(cross(v.edges[(k + 1) % 3], v.edges[(k + 2) % 3]));
        v.periodic[k] = false;
        v.walls.push_back(half_space(v.corner, -n));
        v.walls.push_back(half_space(v.corner + v.edges[k], n));
      }
      return v;
    }
  }
}

/// Grains packed without overlaps, or spheres at random places, which may overlap each other.
Plan plan_of(unsigned seed) {
  Dice dice(seed);
  Plan p;
  const double s = dice(4, 7);
  p.vessel = some_vessel(dice, s);
  if (dice.chance(0.6)) {
    Request q;
    q.vessel = p.vessel;
    q.kinds.push_back({"grain", Sizes(dice.chance(0.5) ? SizeLaw(EqualSizes{dice(0.5, 0.8)})
                                                       : SizeLaw(UniformSizes{0.25, dice(0.5, 1.0)}))});
    q.until = ToPorosity{dice(0.55, 0.8)};
    q.seed = seed;
    Packing packed = pack(q);
    p.r = packed.r, p.R = packed.radius;
    return p;
  }
  const double smallest = dice.chance(0.3) ? 1.0 : dice.ratio(0.05, 1.0);
  for (std::size_t k = dice.count(1, 80); k > 0; --k) {
    p.r.push_back(p.vessel.at({dice(0, 1), dice(0, 1), dice(0, 1)}));
    p.R.push_back(dice.ratio(smallest, 1.0));
  }
  return p;
}

Verdict judge(unsigned seed, Tally& tally) {
  const Plan p = plan_of(seed);
  const VoronoiSpace space = *space_of(p.vessel);
  // particles of a run need not stand in the cell
  Dice dice(seed + 1000000);
  std::vector<Vec3d> moved = p.r;
  std::vector<Image> by(p.r.size());
  for (std::size_t i = 0; i < p.r.size(); ++i) {
    const auto edges = [&](std::size_t k) { return p.vessel.periodic[k] ? dice.whole(-2, 2) : 0; };
    by[i] = {edges(0), edges(1), edges(2)};
    moved[i] = moved[i] + double(by[i].a) * space.edges[0] + double(by[i].b) * space.edges[1] +
               double(by[i].c) * space.edges[2];
  }
  const VoronoiCells cells = voronoi_cells(space, moved, p.R, dice.whole(1, 2));
  const double V = p.vessel.frame_volume(), mean = V / double(p.r.size()), area = std::pow(mean, 2.0 / 3.0);
  const double sum = std::accumulate(cells.volume.begin(), cells.volume.end(), 0.0);
  tally.below("sum of volumes off", std::abs(sum / V - 1.0), 1e-12);
  tally.add("cells", double(p.r.size()));
  for (std::size_t i = 0; i < p.r.size(); ++i) {
    const Clipped plain = plain_cell(space, p.r, p.R, i);
    tally.below("volume off", std::abs(cells.volume[i] - plain.volume()) / mean, 1e-10);
    if (cells.volume[i] == 0.0) tally.add("without room");
    std::map<FaceName, double> areas = plain.areas();
    for (const VoronoiFace& f : cells.faces_of(i)) {
      const Image n = f.image + by[f.of] - by[i];
      const FaceName name{f.of, n.a, n.b, n.c};
      const auto at = areas.find(name);
      if (at == areas.end()) {
        if (f.area > 1e-9 * area) return wrong(fmt::format("cell {} has a face of {} too many", i, f.area));
        continue;
      }
      tally.below("area off", std::abs(at->second - f.area) / area, 1e-9);
      tally.add("faces");
      if (n != Image{}) tally.add("through the cell's faces");
      if (f.of == i) tally.add("with itself");
      areas.erase(at);
    }
    for (const auto& [name, left] : areas)
      if (left > 1e-9 * area) return {"missed", fmt::format("a face of {} of cell {}", left, i)};
  }
  return {};
}

TEST(VoronoiCampaign, CellsAreThoseThatEveryPlaneLeaves) {
  const Tally tally = vbond::testing::campaign("cells of packings", 40, judge);
  if (!tally.full) return;
  EXPECT_GT(tally.sum("through the cell's faces"), 1000.0);
  EXPECT_GT(tally.sum("with itself"), 0.0);
  EXPECT_GT(tally.sum("without room"), 0.0);
}

}  // namespace
}  // namespace vbond::packing::voronoi_campaign
