// What a run with walls cannot go on with, and what observers look for.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "vbond/terms/walls/motion_walls.hpp"

namespace vbond {

/// A body of this mass between springs that are fixed at their other ends.
void MotionWalls::look_at_servo(std::size_t w, const Slopes& sum, double dt) {
  const double mass = drive_[w]->servo->mass, least = 0.25 * sq(dt) * sum.k + 0.5 * dt * sum.g;
  if (mass < least) faults_.push_back({Fault::light, static_cast<std::uint32_t>(w), {}, mass, least});
}

std::vector<DeepInWall> MotionWalls::deeper_than(double part) const {
  std::vector<DeepInWall> deep;
  std::vector<WallTouch> touches;
  const auto overlap_with = [&](std::uint32_t w, const Vec3d& r, double R) {
    touches.clear();
    if (surfaces_[w].may_touch(r, R)) surfaces_[w].touches(r, R, touches);
    double overlap = 0.0;
    for (const WallTouch& t : touches) overlap = std::max(overlap, R - t.distance);
    return overlap;
  };
  for (const OfBlock& block : blocks_)
    for (const Near& near : block.near) {
      const ParticleId p = bodies_.order.particle[Row{near.row}];
      const double R = model_.radius[p];
      const double overlap = overlap_with(near.wall, at_start(near.wall, bodies_.pose[near.row].r), R);
      if (!(overlap > part * R)) continue;
      if (comes_in(model_, p) || overlap > part * R + overlap_with(near.wall, model_.r_0[p], R))
        deep.push_back({p, near.wall, overlap});
    }
  deep = on_.exchange.gather(deep);
  std::sort(deep.begin(), deep.end(), [](const DeepInWall& x, const DeepInWall& y) {
    return std::pair(x.p, x.wall) < std::pair(y.p, y.wall);
  });
  return deep;
}

std::vector<MotionWalls::FaultyTouch> MotionWalls::faults() const {
  std::vector<FaultyTouch> all;
  for (const OfBlock& b : blocks_) all.insert(all.end(), b.faults.begin(), b.faults.end());
  all.insert(all.end(), faults_.begin(), faults_.end());
  return all;
}

/// Who is at fault, what is wrong, and a way out.
MotionWalls::Told MotionWalls::in_words(const FaultyTouch& found) const {
  const std::string particle = "particle " + std::to_string(found.p.value),
                    wall = "wall \"" + model_.walls[found.wall].name + '"';
  const double dt = on_.stage.dt;
  switch (found.fault) {
    case Fault::passed: return {particle, "its centre has passed through " + wall, gentler_contact};
    case Fault::fast:
      return {particle,
              fmt::format("it moves by {:.3g} of its radius in a step near {}, which it could pass unseen",
                          found.is / found.limit, wall),
              fmt::format("use a time.step below {:.3g}, or lower velocities", dt * found.limit / found.is)};
    case Fault::too_wide:
      return {particle, "it is not smaller than the hollow " + wall + " that it touches",
              "use a larger radius of the wall, or keep the particle out of it"};
    case Fault::light:
      return {wall,
              fmt::format("its servo has the mass {:.4g}: too little for the time step and what it touches",
                          found.is),
              fmt::format("give it at least {:.3g}, better four times that, or a smaller time.step",
                          found.limit)};
  }
  return {};
}

}  // namespace vbond
