// How long a part of a body knows all whom its particles may meet: the parts fly through each other, and the
// pairs of all parts are looked at one by one. The processes are threads here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "campaigns/dice.hpp"
#include "dynamics/spheres_and_walls.hpp"
#include "observe/bar_in_parts.hpp"
#include "vbond/core/bounding_box.hpp"

namespace vbond::parts_test {
namespace {

constexpr double dt = 0.01, margin = 0.5;

/// Spheres in a long box, of a stuff so soft that they fly on straight. Most move together, some fast.
Specimen flying_spheres(testing::Dice& dice) {
  std::vector<Vec3d> r;
  for (int k = 0; k < 120; ++k) r.push_back({dice(0.0, 30.0), dice(0.0, 4.0), dice(0.0, 4.0)});
  Specimen s = testing::particles_at(r, 0.2);
  s.model.contact = testing::linear(1e-30, 0.0);
  const Vec3d together = dice.vector(1.0);
  for (const ParticleId p : s.state.v.ids())
    s.state.v[p] = together + dice.vector(dice.chance(0.05) ? 5.0 : 0.1);
  return s;
}

struct Parts {
  std::size_t number;
  double reach;
  const State& state;
  std::size_t of(ParticleId p) const {
    return std::min(number - 1, static_cast<std::size_t>(state.r[p].x / 30.0 * static_cast<double>(number)));
  }
  bool are_known(ParticleId p, ParticleId q) const {
    return norm(state.r[p] - state.r[q]) <= (1.0 + margin) * reach;
  }
  Share share(std::size_t k, bool tells_boxes) const {
    Holding holding{.own = {}, .early = {}, .ghosts = {}, .others_in_one_row = true};
    std::vector<BoundingBox> boxes(number);
    for (const ParticleId p : state.r.ids()) {
      boxes[of(p)].add(state.r[p]);
      if (of(p) == k) holding.own.push_back(p);
      for (const ParticleId q : state.r.ids())
        if (of(p) != k && of(q) == k && are_known(p, q)) {
          holding.ghosts.push_back({p, {}});
          break;
        }
    }
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(k));
    Share share{.order = part_of(spatial_order(state.r), holding),
                .farthest = 0.5 * margin * reach,
                .lost_beyond = 1e9,
                .begins = true};
    if (tells_boxes) share.others = boxes;
    return share;
  }
};

/// The steps that parts make before they ask to be spread anew.
std::int64_t steps_of(const Specimen& s, const Parts& parts, bool tells_boxes) {
  Meeting meeting(parts.number);
  std::vector<std::int64_t> steps(parts.number);
  in_processes(parts.number, [&](std::size_t k) {
    Process process(meeting, k);
    State mine = s.state;
    Simulation part(s.model, testing::plain_stage(dt, 1e9), &mine, parts.share(k, tells_boxes), process);
    EXPECT_EQ(part.run({}, 100'000), StopReason::running);
    steps[k] = part.clock().step;
  });
  EXPECT_EQ(std::count(steps.begin(), steps.end(), steps[0]), std::ssize(steps));
  return steps[0];
}

TEST(RoomOfParts, LastsAsLongAsNobodyUnknownIsWithinReach) {
  std::int64_t with = 0, without = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    testing::Dice dice(seed);
    const Specimen s = flying_spheres(dice);
    const double reach = acquaintance(s.model, testing::plain_stage(dt, 1e9), s.state).reach;
    const Parts parts{2 + seed % 3, reach, s.state};
    const std::int64_t steps = steps_of(s, parts, true);
    std::int64_t met = steps;  // the first step in which an unknown one is within reach
    for (const ParticleId p : s.state.r.ids())
      for (ParticleId q{0}; q < p; ++q.value) {
        if (parts.of(p) == parts.of(q) || parts.are_known(p, q)) continue;
        const Vec3d r = s.state.r[p] - s.state.r[q], v = s.state.v[p] - s.state.v[q];
        for (std::int64_t k = 0; k < met; ++k)
          if (norm(r + (static_cast<double>(k) * dt) * v) < reach) met = k;
      }
    EXPECT_GE(met, steps - 1) << "seed " << seed;  // it shows once it has happened
    with += steps, without += steps_of(s, parts, false);
  }
  EXPECT_GT(with, 2 * without);
}

}  // namespace
}  // namespace vbond::parts_test
