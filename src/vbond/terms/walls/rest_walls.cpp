#include "vbond/terms/walls/detail/rest_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {

RestWalls::RestWalls(const StaticBody& body, State& state)
    : body_(body), state_(state), walls_(body.model()) {}

Vec3d RestWalls::centre_of(std::size_t wall) const {
  return body_.model().walls[wall].centre + state_.walls[wall].displacement;
}

/// By how much the load factor has grown since the stage took hold.
double RestWalls::since() const {
  return body_.load_factor() - body_.held_at();
}

void RestWalls::take_hold() {
  if (state_.walls.empty()) state_.walls.resize(body_.model().walls.size());
  state_.wall_history.clear();
  for (WallState& w : state_.walls) w.velocity = w.angular_velocity = {}, w.servo = 0.0, w.off = 0;
  for (const WallDrive& d : body_.stage().walls) {
    state_.walls[d.index].off = d.off ? 1 : 0;
    if (d.off) continue;
    const WallState& now = state_.walls[d.index];
    const Vec3d pivot = d.pivot ? *d.pivot + body_.load_factor() * d.velocity
                                : body_.model().walls[d.index].centre + now.displacement;
    driven_.push_back({&d, {pivot, d.velocity, d.angular_velocity}, now});
  }
}

void RestWalls::follow() {
  const double f = since();
  if (f == 0.0) {  // to the last bit
    for (const Driven& d : driven_)
      state_.walls[d.drive->index].displacement = d.as_held.displacement,
      state_.walls[d.drive->index].q = d.as_held.q;
    return;
  }
  for (const Driven& d : driven_) {
    const Quatd turn = d.motion.turn(f);
    const Vec3d arm = body_.model().walls[d.drive->index].centre + d.as_held.displacement - d.motion.pivot;
    WallState& now = state_.walls[d.drive->index];
    now.displacement = d.as_held.displacement + f * d.motion.velocity + swing(turn, arm);
    now.q = normalised(turn * d.as_held.q);
  }
}

/// How the point of a wall that is at r goes, per load factor.
Vec3d RestWalls::rate_of(std::size_t wall, const Vec3d& r) const {
  for (const Driven& d : driven_)
    if (d.drive->index == wall) return d.motion.rate_at(since(), r);
  return {};
}

const RestWalls::Touched& RestWalls::at_hand() const {
  if (std::exchange(touched_at_, body_.placement_number()) == body_.placement_number()) return touched_;
  touched_.on_walls.assign(body_.model().walls.size(), {});
  touched_.touches = walls_.touches(state_);
  for (const RestingTouch& t : touched_.touches) {
    const Vec3d F = t.force * t.normal;
    touched_.on_walls[t.wall].force -= F;
    touched_.on_walls[t.wall].moment -= cross(state_.r[t.p] - t.distance * t.normal - centre_of(t.wall), F);
  }
  return touched_;
}

void RestWalls::add_loads(LoadSum& to) const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const RestingTouch& t : at_hand().touches) {
    to.loads.F[t.p] += t.force * t.normal;
    to.largest = larger(to.largest, t.force);
    // of the place, which is rounded: the slope of the force is 3/2 F/d at most
    const double place = eps * (norm(state_.r[t.p]) + body_.model().radius[t.p]);
    to.rounding_of_force = larger(to.rounding_of_force, 1.5 * place * t.force / t.overlap);
    to.rounding_of_potential += place * t.force + eps * t.energy;
  }
}

void RestWalls::add_stiffness(StiffnessSum& to) const {
  const std::vector<RestingTouch>& touches = at_hand().touches;
  for (std::size_t k = 0; k < touches.size(); ++k) {
    const auto [p, wall] = std::pair(touches[k].p, touches[k].wall);
    if (k > 0 && touches[k - 1].p == p && touches[k - 1].wall == wall) continue;  // one slope for all of them
    const ForceSlope s = walls_.slope(state_, p, wall);
    Assembly::Block K = Assembly::Block::Zero();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) K(a, b) = -s.d[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    // what the wall's motion does, and that of the particle where it is held
    const Vec3d went = body_.held_rate(p).shift - rate_of(wall, state_.r[p]);
    Vec3d change;
    for (int a = 0; a < 3; ++a)
      component(change, a) = -(K(a, 0) * went.x + K(a, 1) * went.y + K(a, 2) * went.z);
    for (const Driven& d : driven_)
      if (d.drive->index == wall) change += cross(d.motion.angular_velocity, s.force);
    body_.unknowns().add_load(p, {change, {}}, to.load_direction);
    K = to.assembly.in_axes(p, p, K);
    to.assembly.add_own(p, 0.5 * (K + K.transpose()));
    if (body_.flows()) to.full.add_own(p, K);
  }
}

Vector RestWalls::power() const {
  Vector power = Vector::Zero(static_cast<Eigen::Index>(body_.model().walls.size()));
  const std::vector<Reaction>& on_walls = at_hand().on_walls;
  for (const Driven& d : driven_) {
    const std::size_t w = d.drive->index;
    power[static_cast<Eigen::Index>(w)] = -dot(on_walls[w].force, rate_of(w, centre_of(w))) -
                                          dot(on_walls[w].moment, d.motion.angular_velocity);
  }
  return power;
}

void RestWalls::add_work(const Vector& work) {
  for (std::size_t w = 0; w < state_.walls.size(); ++w)
    state_.walls[w].work += work[static_cast<Eigen::Index>(w)];
}

void RestWalls::accept() {
  const std::vector<Reaction>& on_walls = at_hand().on_walls;
  for (std::size_t w = 0; w < state_.walls.size(); ++w)
    state_.walls[w].force = on_walls[w].force, state_.walls[w].moment = on_walls[w].moment;
  seen_at_ = state_.r;
  seen_walls_ = state_.walls;
}

/// The longest way of a wall to come in the stage, where particles are.
double RestWalls::farthest_way() const {
  double farthest = 0.0;
  for (const Driven& d : driven_) {
    double arm = 0.0;
    for (const Vec3d& r : state_.r) arm = std::max(arm, norm(r - d.motion.pivot_at(since())));
    const double left = 1.0 - body_.load_factor();
    farthest = std::max(farthest, left * (norm(d.motion.velocity) + arm * norm(d.motion.angular_velocity)));
  }
  return farthest;
}

void RestWalls::add_holds(bool to_come, std::vector<TermHold>& to) const {
  constexpr double rounding = 1e-9;  // of a radius: a wall at a specimen's surface touches it
  double reach = 0.0;
  if (to_come)
    for (const double R : body_.model().radius) reach = std::max(reach, rounding * R);
  if (to_come) reach += farthest_way();
  for (const RestingTouch& t : walls_.near(state_, reach)) {
    to.push_back({t.p, t.normal});
    // what is pressed into a hollow wall finds its place across the normal, too
    const WallShape& shape = body_.model().walls[t.wall].shape;
    if (const auto* sphere = std::get_if<SphereWall>(&shape); sphere && sphere->side == WallSide::inside)
      for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) to.push_back({t.p, e});
    if (const auto* cylinder = std::get_if<CylinderWall>(&shape); cylinder && t.hollow)
      to.push_back({t.p, cross(rotate(state_.walls[t.wall].q, cylinder->axis), t.normal)});
  }
}

double RestWalls::largest_change(const Vector& x, double load_factor_change) const {
  double largest = 0.0;
  for (std::size_t w = 0; w < body_.model().walls.size(); ++w)
    for (const ParticleId p : state_.r.ids()) {
      const Vec3d went =
          body_.movement(p, x, load_factor_change).shift - load_factor_change * rate_of(w, state_.r[p]);
      const double way = norm(went), R = body_.model().radius[p];
      if (!(way > 0.0) || !(R > 0.0) || !std::isfinite(way)) continue;
      double gap = std::numeric_limits<double>::infinity();
      for (const WallTouch& t :
           walls_.near(state_, static_cast<std::uint32_t>(w), state_.r[p], R + std::min(way, 1e3 * R)))
        gap = std::min(gap, t.distance - R);
      if (std::isfinite(gap)) largest = std::max(largest, way / (R + 2.0 * std::max(gap, 0.0)));
    }
  return largest;
}

std::optional<std::string> RestWalls::fault() const {
  const auto told = [&](ParticleId p, std::size_t wall, const char* what) {
    return fmt::format("particle {}: {} wall \"{}\"", p.value, what, body_.model().walls[wall].name);
  };
  for (const RestingTouch& t : at_hand().touches) {
    if (std::isnan(t.overlap)) return told(t.p, t.wall, "it is not smaller than the hollow");
    if (!(t.distance > 0.0)) return told(t.p, t.wall, "its centre has come through");
  }
  for (std::size_t w = 0; w < seen_walls_.size(); ++w) {
    if (!walls_.has_two_sides(w)) continue;
    const Wall& wall = body_.model().walls[w];
    const WallState& now = state_.walls[w];
    for (const ParticleId p : state_.r.ids()) {
      if (!is_finite(state_.r[p])) continue;
      // where the particle was, as the wall sees it where it stands now
      const Vec3d before = wall.centre + now.displacement +
                           rotate(now.q, at_start(wall, seen_walls_[w], seen_at_[p]) - wall.centre);
      const Vec3d way = state_.r[p] - before;
      for (const WallTouch& t : walls_.near(state_, static_cast<std::uint32_t>(w), state_.r[p],
                                            std::max(body_.model().radius[p], norm(way))))
        if (t.distance < dot(way, t.normal)) return told(p, w, "its centre has come through");
    }
  }
  return std::nullopt;
}

std::unique_ptr<RestTerm> WallsTerm::at_rest(const StaticBody& body, State& state) {
  return std::make_unique<RestWalls>(body, state);
}

}  // namespace vbond
