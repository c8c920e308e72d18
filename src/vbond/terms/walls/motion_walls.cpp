#include "vbond/terms/walls/motion_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vbond/core/rigid_motion.hpp"
#include "vbond/model/contact_bound.hpp"

namespace vbond {
MotionWalls::MotionWalls(const BodyInMotion& on)
    : on_(on),
      model_(on.model),
      bodies_(on.bodies),
      drive_(model_.walls.size(), nullptr),
      walls_(model_.walls.size()),
      forms_(touch_forms(model_.contact)) {
  if (!is_there()) return;
  for (const WallDrive& d : on.stage.walls) drive_[d.index] = &d;
  double R_max = 0.0;
  least_radius_ = std::numeric_limits<double>::infinity();
  for (const double R : model_.radius)
    if (R > 0.0) R_max = std::max(R_max, R), least_radius_ = std::min(least_radius_, R);
  const std::size_t materials = std::max<std::size_t>(1, model_.materials.size());
  for (const Wall& w : model_.walls) {
    surfaces_.emplace_back(w.shape);
    numbers_.emplace_back();
    for (std::uint32_t m = 0; m < materials; ++m) {
      numbers_.back().push_back(touch_numbers(model_.contact, model_.materials, m, w.material));
      const TouchNumbers<double>& n = numbers_.back().back();
      if (forms_.adhesion == AdhesionForm::jkr)
        reach_ = std::max(reach_, reach_of_adhesion(n.stiffness, n.work, R_max));
    }
  }
  masses_ = ContactMasses(model_, on.stage.supports);
  skin_ = 0.4 * R_max;
  blocks_.resize(on.team.blocks());
  for (OfBlock& b : blocks_)
    b.F.resize(walls_.size()), b.M.resize(walls_.size()), b.slopes.resize(walls_.size());
}

/// What a servo of the stage before has left, if this stage has one along the same direction.
double MotionWalls::speed_kept(std::size_t w) const {
  if (!has_servo(w)) return 0.0;
  const WallState& before = walls_[w];
  const double along = dot(before.velocity, drive_[w]->servo->direction), speed = std::abs(before.servo);
  return std::abs(std::abs(along) - speed) <= 1e-9 * speed ? along : 0.0;
}

void MotionWalls::read(const State& s) {
  const std::vector<WallState> worked_out = walls_;
  if (s.walls.size() == walls_.size()) walls_ = s.walls;
  // Particles have gone from a state without loads within a stage: what presses on walls is what is left.
  for (std::size_t w = 0; w < walls_.size() && s.loads.F.empty() && s.clock.stage_step != 0; ++w)
    walls_[w].force = worked_out[w].force, walls_[w].moment = worked_out[w].moment;
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    if (s.clock.stage_step != 0) break;
    walls_[w].servo = speed_kept(w);
    prescribe(w, 0.0, 0.0);
    if (walls_[w].servo != 0.0) walls_[w].velocity += walls_[w].servo * drive_[w]->servo->direction;
  }
  dt_before_ = s.clock.dt;
  room_ = 0.0;
  for (OfBlock& b : blocks_) b.near.clear();
  for (const WallMemory& m : s.wall_history) {
    if (!bodies_.order.has(m.p)) continue;
    const std::size_t row = bodies_.order.row[m.p].value;
    std::vector<Near>& near = blocks_[row / block_rows].near;
    auto at = std::find_if(near.begin(), near.end(),
                           [&](const Near& n) { return n.row == row && n.wall == m.wall; });
    if (at == near.end()) at = near.insert(near.end(), {row, m.wall, 0, 0, {}});
    at->slots.push_back({m.normal, m.history});
  }
  for (OfBlock& b : blocks_)
    std::sort(b.near.begin(), b.near.end(), [](const Near& x, const Near& y) {
      return std::pair(x.row, x.wall) < std::pair(y.row, y.wall);
    });
}

void MotionWalls::before_stage(bool run_begins) {
  const auto wants_off = [this](std::size_t w) { return drive_[w] != nullptr && drive_[w]->off; };
  std::vector<char> changes(walls_.size(), 0);
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    changes[w] = wants_off(w) != (walls_[w].off != 0) ? 1 : 0;
    if (changes[w] != 0) walls_[w].off = 0;  // until what touches it is known
  }
  if (std::find(changes.begin(), changes.end(), 1) == changes.end()) return;
  room_ = 0.0;
  refresh(std::numeric_limits<double>::infinity());
  double work = 0.0;
  std::vector<double> work_of(walls_.size(), 0.0);  // what a wall has done all parts know: the first adds it
  for (std::size_t w = 0; w < walls_.size() && on_.exchange.leads(); ++w) work_of[w] = walls_[w].work;
  for (OfBlock& block : blocks_)
    for (const Near& near : block.near)
      if (changes[near.wall] != 0 && !run_begins) {
        const double U = wants_off(near.wall) ? -energy(near) : energy(near);
        work_of[near.wall] += U;
        work += U;
      }
  on_.exchange.sum(work_of);
  for (std::size_t w = 0; w < walls_.size(); ++w) walls_[w].work = work_of[w];
  for (std::size_t w = 0; w < walls_.size(); ++w) walls_[w].off = wants_off(w) ? 1 : 0;
  for (OfBlock& block : blocks_)
    std::erase_if(block.near, [this](const Near& near) { return walls_[near.wall].off != 0; });
  on_.books.work_supports += work;
}

void MotionWalls::write(State& s) const {
  s.walls = walls_;
  s.wall_history.clear();
  for (const OfBlock& b : blocks_)
    for (const Near& n : b.near)
      for (const Slot& slot : n.slots)
        s.wall_history.push_back({bodies_.order.particle[Row{n.row}], n.wall, slot.normal, slot.history});
  std::stable_sort(s.wall_history.begin(), s.wall_history.end(),
                   [](const WallMemory& a, const WallMemory& b) { return place_of(a) < place_of(b); });
}

/// The mean velocity from t to t + dt of the stage, without a servo's; dt = 0: that at t. Without a pivot the
/// wall turns about its centre, wherever that is.
void MotionWalls::prescribe(std::size_t w, double t, double dt) {
  WallState& now = walls_[w];
  now.velocity = now.angular_velocity = {};
  if (drive_[w] == nullptr) return;
  const WallDrive& d = *drive_[w];
  const double factor = d.factor(t + 0.5 * dt);
  now.velocity = factor * d.velocity;
  now.angular_velocity = factor * d.angular_velocity;
  const double rate = 2.0 * std::numbers::pi * d.frequency;
  if (d.pivot) {  // what the wall has swung by is not turned along
    const Vec3d arm = model_.walls[w].centre + now.displacement - std::sin(rate * t) * d.amplitude - *d.pivot;
    // on the circle, not on its tangent
    now.velocity += dt > 0.0 ? (1.0 / dt) * swing(rotation_of(dt * now.angular_velocity), arm)
                             : cross(now.angular_velocity, arm);
  }
  if (d.frequency > 0.0) {
    const double mean =
        dt > 0.0 ? (std::sin(rate * (t + dt)) - std::sin(rate * t)) / dt : rate * std::cos(rate * t);
    now.velocity += mean * d.amplitude;
  }
}

/// The mean velocity of the step that begins.
void MotionWalls::set_velocity(std::size_t w, std::int64_t stage_step, double dt) {
  const double t = static_cast<double>(stage_step) * dt;
  prescribe(w, t, dt);
  if (!has_servo(w)) return;
  WallState& now = walls_[w];
  const WallDrive& d = *drive_[w];
  const WallDrive::Servo& s = *d.servo;
  // a body that is pushed, against what presses on it: kicked from step to step
  const double h = stage_step > 0     ? dt
                   : now.servo == 0.0 ? 0.5 * dt
                                      : 0.5 * (dt_before_ + dt),
               force = s.factor(t) * s.force + dot(now.force, s.direction);
  now.servo = (now.servo + h / s.mass * force) / (1.0 + h / s.mass * s.damping);
  if (s.fastest > 0.0) now.servo = std::clamp(now.servo, -s.fastest, s.fastest);
  now.velocity += now.servo * s.direction;
}

void MotionWalls::begin_step() {
  const double dt = on_.stage.dt;
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    set_velocity(w, on_.state.clock.stage_step, dt);
    WallState& now = walls_[w];
    now.displacement += dt * now.velocity;
    if (now.angular_velocity != Vec3d{}) now.q = renormalised(rotation_of(dt * now.angular_velocity) * now.q);
    room_ -= dt * (norm(now.velocity) + extent_ * norm(now.angular_velocity));
  }
}

void MotionWalls::particles_moved(double dt, double way) {
  refresh(way);
  if (dt > 0.0) look_at_drift(dt, way);
}

void MotionWalls::refresh(double way) {
  room_ -= way;
  if (room_ > 0.0) return;
  on_.team.for_blocks([&](const Block& b) {
    list(blocks_[b.index], {b.rows.first, std::min(b.rows.last, bodies_.order.own)});
  });
  room_ = 0.5 * skin_;
  extent_ = 0.0;
  for (std::size_t k = 0; k < bodies_.order.own; ++k)
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const double distance = norm(bodies_.pose[k].r - model_.walls[w].centre - walls_[w].displacement);
      if (std::isfinite(distance)) extent_ = std::max(extent_, distance + skin_);
    }
}

void MotionWalls::look_at_drift(double dt, double way) {
  faults_.clear();
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    const double of_wall = dt * (norm(walls_[w].velocity) + extent_ * norm(walls_[w].angular_velocity));
    if (walls_[w].off != 0 || way + of_wall <= least_radius_ || !surfaces_[w].has_two_sides()) continue;
    for (const ParticleId p : model_.radius.ids()) {
      const std::size_t k = bodies_.order.row[p].value;
      if (!bodies_.order.has(p)) continue;
      const double R = model_.radius[p];
      const Vec3d r = bodies_.pose[k].r;
      const double moved = dt * norm(bodies_.motion[k].v - velocity_at(w, r));
      if (!(R > 0.0) || !(moved > R) ||
          !surfaces_[w].may_touch(at_start(static_cast<std::uint32_t>(w), r), R + moved))
        continue;
      faults_.push_back({Fault::fast, static_cast<std::uint32_t>(w), p, moved, R});
    }
  }
}

void MotionWalls::add_loads(const Block& b, double dt) {
  OfBlock& block = blocks_[b.index];
  std::fill(block.F.begin(), block.F.end(), Vec3d{});
  std::fill(block.M.begin(), block.M.end(), Vec3d{});
  std::fill(block.slopes.begin(), block.slopes.end(), Slopes{});
  block.faults.clear();
  TouchLosses<double> lost;
  for (Near& near : block.near) lost += add_touches(block, near, on_.bodies.load[near.row], dt);
  on_.host.lose(b.index, lost);
}

/// What presses on each wall, and the slopes of its touches.
std::vector<MotionWalls::OnWall> MotionWalls::sums() const {
  std::vector<OnWall> on(walls_.size());
  for (std::size_t w = 0; w < walls_.size(); ++w)
    for (const OfBlock& b : blocks_) {
      on[w].F += b.F[w], on[w].M += b.M[w];
      on[w].slopes.k += b.slopes[w].k, on[w].slopes.g += b.slopes[w].g;
    }
  static_assert(sizeof(OnWall) == 8 * sizeof(double));
  if (!on.empty()) on_.exchange.sum({&on.front().F.x, 8 * on.size()});
  return on;
}

/// In a step of dt.  [energy]
double MotionWalls::work_of(double dt) {
  double work = 0.0;
  const std::vector<OnWall> on = sums();
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    WallState& now = walls_[w];
    const Vec3d F = now.force, M = now.moment;
    now.force = on[w].F, now.moment = on[w].M;
    const double done =
        -0.5 * dt * (dot(F + now.force, now.velocity) + dot(M + now.moment, now.angular_velocity));
    now.work += done;
    work += done;
    if (dt > 0.0 && has_servo(w)) look_at_servo(w, on[w].slopes, dt);
  }
  return work;
}

/// The run ends if it cannot go on with walls; if it only cannot with particles that the stage drops, these
/// are lost.
void MotionWalls::end_step(double dt) {
  const double work = work_of(dt);
  if (on_.exchange.leads()) on_.books.work_supports += work;  // all parts know of it
  const bool drops = dt > 0.0 && on_.stage.on_unphysical == OnUnphysical::drop;
  for (const FaultyTouch& found : faults()) {
    const Told told = in_words(found);
    const bool is_lost = found.fault == Fault::passed || found.fault == Fault::fast;
    if (!drops || !is_lost) return on_.host.diverge(found.p.value, told.who, told.what, told.way_out);
    on_.host.lose_particle({found.p, {}, told.what});
  }
}

double MotionWalls::energy() const {
  double U = 0.0;
  for (const OfBlock& block : blocks_)
    for (const Near& near : block.near) U += energy(near);
  return U;
}

std::unique_ptr<MotionTerm> WallsTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionWalls>(on);
}

}  // namespace vbond
