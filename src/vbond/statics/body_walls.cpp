// What walls do to a body at rest, and how they move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "vbond/statics/detail/body.hpp"

namespace vbond {

void StaticBody::take_hold_of_walls() {
  if (!walls_.any()) return;
  if (state_.walls.empty()) state_.walls.resize(model_.walls.size());
  state_.wall_history.clear();
  for (WallState& w : state_.walls) w.velocity = w.angular_velocity = {}, w.servo = 0.0, w.off = 0;
  for (const WallDrive& d : stage_.walls) {
    state_.walls[d.index].off = d.off ? 1 : 0;
    if (d.off) continue;
    const WallState& now = state_.walls[d.index];
    const Vec3d pivot =
        d.pivot ? *d.pivot + load_factor_ * d.velocity : model_.walls[d.index].centre + now.displacement;
    driven_.push_back({&d, {pivot, d.velocity, d.angular_velocity}, now});
  }
}

/// Walls to where they are at the load factor.
void StaticBody::carry_walls() {
  const double since = load_factor_ - held_at_;
  for (const DrivenWall& d : driven_) {
    const Quatd turn = d.motion.turn(since);
    const Vec3d arm = model_.walls[d.drive->index].centre + d.as_held.displacement - d.motion.pivot;
    WallState& now = state_.walls[d.drive->index];
    now.displacement = d.as_held.displacement + since * d.motion.velocity + swing(turn, arm);
    now.q = normalised(turn * d.as_held.q);
  }
}

/// How the point of a wall that is at r goes, per load factor.
Vec3d StaticBody::rate_of_wall(std::size_t wall, const Vec3d& r) const {
  for (const DrivenWall& d : driven_)
    if (d.drive->index == wall) return d.motion.rate_at(load_factor_ - held_at_, r);
  return {};
}

void StaticBody::add_walls(Loaded& to) const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  to.on_walls.assign(model_.walls.size(), {});
  to.touches = walls_.touches(state_);
  for (const RestingTouch& t : to.touches) {
    const Vec3d F = t.force * t.normal;
    const Vec3d centre = model_.walls[t.wall].centre + state_.walls[t.wall].displacement;
    to.loads.F[t.p] += F;
    to.on_walls[t.wall].force -= F;
    to.on_walls[t.wall].moment -= cross(state_.r[t.p] - t.distance * t.normal - centre, F);
    to.largest = larger(to.largest, t.force);
    // of the place, which is rounded: the slope of the force is 3/2 F/d at most
    const double place = eps * (norm(state_.r[t.p]) + model_.radius[t.p]);
    to.rounding_of_force = larger(to.rounding_of_force, 1.5 * place * t.force / t.overlap);
    to.rounding_of_potential += place * t.force + eps * t.energy;
  }
}

void StaticBody::add_walls(Stiffness& to) const {
  const std::vector<RestingTouch>& touches = loads_at_hand().touches;
  for (std::size_t k = 0; k < touches.size(); ++k) {
    const auto [p, wall] = std::pair(touches[k].p, touches[k].wall);
    if (k > 0 && touches[k - 1].p == p && touches[k - 1].wall == wall) continue;  // one slope for all of them
    const ForceSlope s = walls_.slope(state_, p, wall);
    Assembly::Block K = Assembly::Block::Zero();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) K(a, b) = -s.d[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    // what the wall's motion does, and that of the particle where it is held
    const Vec3d went = held_rate_[p].shift - rate_of_wall(wall, state_.r[p]);
    Vec3d change;
    for (int a = 0; a < 3; ++a)
      component(change, a) = -(K(a, 0) * went.x + K(a, 1) * went.y + K(a, 2) * went.z);
    for (const DrivenWall& d : driven_)
      if (d.drive->index == wall) change += cross(d.motion.angular_velocity, s.force);
    unknowns_.add_load(p, {change, {}}, to.load_direction);
    K = to.assembly.in_axes(p, p, K);
    to.assembly.add_own(p, 0.5 * (K + K.transpose()));
    if (flows()) to.full.add_own(p, K);
  }
}

Vector StaticBody::power_of_walls() const {
  Vector power = Vector::Zero(static_cast<Eigen::Index>(model_.walls.size()));
  const Loaded& l = loads_at_hand();
  for (const DrivenWall& d : driven_) {
    const std::size_t w = d.drive->index;
    const Vec3d centre = model_.walls[w].centre + state_.walls[w].displacement;
    power[static_cast<Eigen::Index>(w)] = -dot(l.on_walls[w].force, rate_of_wall(w, centre)) -
                                          dot(l.on_walls[w].moment, d.motion.angular_velocity);
  }
  return power;
}

void StaticBody::add_work_of_walls(const Vector& work) {
  for (std::size_t w = 0; w < state_.walls.size(); ++w)
    state_.walls[w].work += work[static_cast<Eigen::Index>(w)];
}

/// What presses on walls, for those who look at this balance; and where particles are before they go on.
void StaticBody::note_walls() {
  if (!walls_.any()) return;
  const Loaded& l = loads_at_hand();
  for (std::size_t w = 0; w < state_.walls.size(); ++w)
    state_.walls[w].force = l.on_walls[w].force, state_.walls[w].moment = l.on_walls[w].moment;
  seen_at_ = state_.r;
  seen_walls_ = state_.walls;
}

/// The longest way of a wall to come in the stage, where particles are.
double StaticBody::farthest_wall_way() const {
  double farthest = 0.0;
  for (const DrivenWall& d : driven_) {
    double arm = 0.0;
    for (const Vec3d& r : state_.r) arm = std::max(arm, norm(r - d.motion.pivot_at(load_factor_ - held_at_)));
    const double left = 1.0 - load_factor_;
    farthest = std::max(farthest, left * (norm(d.motion.velocity) + arm * norm(d.motion.angular_velocity)));
  }
  return farthest;
}

std::vector<WallHold> StaticBody::wall_holds(bool to_come) const {
  constexpr double rounding = 1e-9;  // of a radius: a wall at a specimen's surface touches it
  double reach = 0.0;
  if (to_come)
    for (const double R : model_.radius) reach = std::max(reach, rounding * R);
  if (to_come) reach += farthest_wall_way();
  std::vector<WallHold> holds;
  for (const RestingTouch& t : walls_.near(state_, reach)) {
    holds.push_back({t.p, t.normal});
    // what is pressed into a hollow wall finds its place across the normal, too
    const WallShape& shape = model_.walls[t.wall].shape;
    if (const auto* sphere = std::get_if<SphereWall>(&shape); sphere && sphere->side == WallSide::inside)
      for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) holds.push_back({t.p, e});
    if (const auto* cylinder = std::get_if<CylinderWall>(&shape); cylinder && t.hollow)
      holds.push_back({t.p, cross(rotate(state_.walls[t.wall].q, cylinder->axis), t.normal)});
  }
  return holds;
}

double StaticBody::largest_wall_change(const Vector& x, double load_factor_change) const {
  double largest = 0.0;
  for (std::size_t w = 0; w < model_.walls.size(); ++w)
    for (const ParticleId p : state_.r.ids()) {
      const Vec3d went =
          movement(p, x, load_factor_change).shift - load_factor_change * rate_of_wall(w, state_.r[p]);
      const double way = norm(went), R = model_.radius[p];
      if (!(way > 0.0) || !(R > 0.0) || !std::isfinite(way)) continue;
      double gap = std::numeric_limits<double>::infinity();
      for (const WallTouch& t :
           walls_.near(state_, static_cast<std::uint32_t>(w), state_.r[p], R + std::min(way, 1e3 * R)))
        gap = std::min(gap, t.distance - R);
      if (std::isfinite(gap)) largest = std::max(largest, way / (R + 2.0 * std::max(gap, 0.0)));
    }
  return largest;
}

std::optional<std::string> StaticBody::fault_at_walls() const {
  const auto told = [&](ParticleId p, std::size_t wall, const char* what) {
    return fmt::format("particle {}: {} wall \"{}\"", p.value, what, model_.walls[wall].name);
  };
  for (const RestingTouch& t : loads_at_hand().touches) {
    if (std::isnan(t.overlap)) return told(t.p, t.wall, "it is not smaller than the hollow");
    if (!(t.distance > 0.0)) return told(t.p, t.wall, "its centre has come through");
  }
  for (std::size_t w = 0; w < seen_walls_.size(); ++w) {
    if (!walls_.has_two_sides(w)) continue;
    const Wall& wall = model_.walls[w];
    const WallState& now = state_.walls[w];
    for (const ParticleId p : state_.r.ids()) {
      if (!is_finite(state_.r[p])) continue;
      // where the particle was, as the wall sees it where it stands now
      const Vec3d before = wall.centre + now.displacement +
                           rotate(now.q, at_start(wall, seen_walls_[w], seen_at_[p]) - wall.centre);
      const Vec3d way = state_.r[p] - before;
      for (const WallTouch& t : walls_.near(state_, static_cast<std::uint32_t>(w), state_.r[p],
                                            std::max(model_.radius[p], norm(way))))
        if (t.distance < dot(way, t.normal)) return told(p, w, "its centre has come through");
    }
  }
  return std::nullopt;
}

}  // namespace vbond
