#include "vbond/terms/walls/motion_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "vbond/core/rigid_motion.hpp"
#include "vbond/model/contact_bound.hpp"

namespace vbond {
namespace {

/// Two normals farther apart than 60 degrees belong to two touches.
constexpr double same_touch = 0.5;

Vec3d velocity_at(const WallState& w, const Vec3d& centre, const Vec3d& x) {
  return w.velocity + cross(w.angular_velocity, x - centre - w.displacement);
}

}  // namespace

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
  skin_ = 0.4 * R_max;
  blocks_.resize(on.team.blocks());
  for (OfBlock& b : blocks_)
    b.F.resize(walls_.size()), b.M.resize(walls_.size()), b.slopes.resize(walls_.size());
}

void MotionWalls::read(const State& s) {
  if (s.walls.size() == walls_.size()) walls_ = s.walls;
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    if (s.clock.stage_step != 0) break;
    walls_[w].servo = 0.0;
    prescribe(w, 0.0, 0.0);
  }
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
  for (OfBlock& block : blocks_)
    for (const Near& near : block.near)
      if (changes[near.wall] != 0 && !run_begins) {
        const double U = wants_off(near.wall) ? -energy(near) : energy(near);
        walls_[near.wall].work += U;
        work += U;
      }
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
  const double h = stage_step == 0 ? 0.5 * dt : dt,
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
      const double moved = dt * norm(bodies_.motion[k].v - velocity_at(walls_[w], model_.walls[w].centre, r));
      if (!(R > 0.0) || !(moved > R) ||
          !surfaces_[w].may_touch(at_start(static_cast<std::uint32_t>(w), r), R + moved))
        continue;
      faults_.push_back({Fault::fast, static_cast<std::uint32_t>(w), p, moved, R});
    }
  }
}

/// Those that are still near keep what they remember.
void MotionWalls::list(OfBlock& block, RowRange rows) {
  std::vector<Near> before = std::exchange(block.near, {});
  auto old = before.begin();
  block.triangles.clear();
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    if (!is_finite(bodies_.pose[k].r)) continue;
    const double reach = model_.radius[bodies_.order.particle[Row{k}]] + reach_ + skin_;
    for (std::uint32_t w = 0; w < walls_.size(); ++w) {
      if (walls_[w].off != 0) continue;
      const Vec3d r = at_start(w, bodies_.pose[k].r);
      while (old != before.end() && std::pair(old->row, old->wall) < std::pair(k, w)) ++old;
      const bool was_near = old != before.end() && old->row == k && old->wall == w;
      if (!surfaces_[w].may_touch(r, reach) && !(was_near && !old->slots.empty())) continue;
      Near near{k, w, static_cast<std::uint32_t>(block.triangles.size()), 0, {}};
      surfaces_[w].near(r, reach, block.triangles);
      near.last = static_cast<std::uint32_t>(block.triangles.size());
      if (was_near) near.slots = std::move(old->slots);
      block.near.push_back(std::move(near));
    }
  }
}

const TouchNumbers<double>& MotionWalls::numbers(const Near& near) const {
  return numbers_[near.wall][model_.material_of(bodies_.order.particle[Row{near.row}])];
}

Touching<double> MotionWalls::touching(const Near& near, const WallTouch& touch) const {
  const std::size_t k = near.row;
  const double R = model_.radius[bodies_.order.particle[Row{k}]];
  const WallState& wall = walls_[near.wall];
  const MotionRow& motion = bodies_.motion[k];
  Touching<double> p{};
  p.n = -rotate(wall.q, touch.normal);
  p.overlap = R - touch.distance;
  p.R = effective_radius(R, touch);
  p.m = bodies_.mass[k];
  p.Theta = bodies_.inertia[k];
  p.l_i = touch.distance;
  p.v =
      velocity_at(wall, model_.walls[near.wall].centre, bodies_.pose[k].r + touch.distance * p.n) - motion.v;
  p.w_i = motion.omega;
  p.w_j = wall.angular_velocity;
  return p;
}

TouchLosses<double> MotionWalls::add_touches(OfBlock& block, Near& near, LoadRow& load, double dt) {
  const Vec3d r = bodies_.pose[near.row].r;
  const double R = model_.radius[bodies_.order.particle[Row{near.row}]];
  std::vector<WallTouch>& touches = block.touches;
  touches.clear();
  surfaces_[near.wall].touches_of({block.triangles.data() + near.first, block.triangles.data() + near.last},
                                  at_start(near.wall, r), reach_ > 0.0 ? R + reach_ + 0.5 * skin_ : R,
                                  touches);
  const TouchNumbers<double>& c = numbers(near);
  TouchLosses<double> lost;
  std::vector<Slot>& before = block.slots;
  before.clear();
  std::swap(before, near.slots);
  for (const WallTouch& touch : touches) {
    if (is_too_wide(R, touch.curvature_1, touch.curvature_2)) {
      block.faults.push_back({Fault::too_wide, near.wall, bodies_.order.particle[Row{near.row}]});
      continue;
    }
    const Touching<double> p = touching(near, touch);
    const Vec3d normal = -p.n;
    auto same = before.end();
    for (auto s = before.begin(); s != before.end(); ++s) {
      const double likeness = dot(s->normal, normal);
      if (likeness > (same == before.end() ? same_touch : dot(same->normal, normal))) same = s;
    }
    Slot slot{normal, same == before.end() ? PairHistory{} : same->history};
    const bool touches_now =
        p.overlap > 0.0 || (slot.history[3] > 0.0 && holds_on(forms_, c, p.R, p.overlap));
    if (!touches_now && same == before.end()) continue;
    if (same != before.end()) before.erase(same);
    if (!touches_now) {
      if (dt > 0.0) lost += lost_on_parting(forms_, c, p, dt, touch_history(slot.history));
      continue;
    }
    if (!(p.l_i > 0.0) || p.l_i < dt * dot(p.v, p.n))  // the centre was on the other side
      block.faults.push_back({Fault::passed, near.wall, bodies_.order.particle[Row{near.row}]});
    if (has_servo(near.wall)) {
      const ContactSlopes slopes = contact_slopes(forms_, c, p.R, p.m, std::max(p.overlap, 0.0));
      const double along = sq(dot(p.n, drive_[near.wall]->servo->direction)), across = 1.0 - along;
      const double c_t = slopes.tangential > 0.0 ? c.tangential_damping : 0.0;
      block.slopes[near.wall].k += along * slopes.normal + across * slopes.tangential;
      block.slopes[near.wall].g += (along + across * c_t) * slopes.damping;
    }
    const TouchLoads<double> l = vbond::touch(forms_, c, p, dt, touch_history(slot.history));
    load.F += l.F;
    load.M += p.l_i * cross(p.n, l.F) + l.M;
    const Vec3d arm = r + p.l_i * p.n - model_.walls[near.wall].centre - walls_[near.wall].displacement;
    block.F[near.wall] -= l.F;
    block.M[near.wall] -= cross(arm, l.F) + l.M;
    if (dt > 0.0) lost += l.lost;
    slot.history = numbers_of(l.history);
    near.slots.push_back(slot);
  }
  if (dt > 0.0)
    for (const Slot& s : before) {  // what it does not touch any more
      Touching<double> p{};
      p.n = -s.normal, p.R = R, p.l_i = R;
      p.w_i = bodies_.motion[near.row].omega, p.w_j = walls_[near.wall].angular_velocity;
      p.v = velocity_at(walls_[near.wall], model_.walls[near.wall].centre, r + R * p.n) -
            bodies_.motion[near.row].v;
      lost += lost_on_parting(forms_, c, p, dt, touch_history(s.history));
    }
  return lost;
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

double MotionWalls::energy(const Near& near) const {
  double U = 0.0;
  std::vector<WallTouch> touches;
  const std::vector<std::uint32_t>& triangles = blocks_[near.row / block_rows].triangles;
  const double R = model_.radius[bodies_.order.particle[Row{near.row}]];
  surfaces_[near.wall].touches_of({triangles.data() + near.first, triangles.data() + near.last},
                                  at_start(near.wall, bodies_.pose[near.row].r), R + reach_, touches);
  for (const WallTouch& touch : touches) {
    const Touching<double> p = touching(near, touch);
    const bool held = std::any_of(near.slots.begin(), near.slots.end(), [&](const Slot& s) {
      return dot(s.normal, p.n) < -same_touch && s.history[3] > 0.0;
    });
    if (p.overlap > 0.0 || (held && holds_on(forms_, numbers(near), p.R, p.overlap)))
      U += normal_energy(forms_, numbers(near), p.R, p.overlap);
  }
  for (const Slot& s : near.slots) U += history_energy(forms_, numbers(near), touch_history(s.history));
  return U;
}

double MotionWalls::energy() const {
  double U = 0.0;
  for (const OfBlock& block : blocks_)
    for (const Near& near : block.near) U += energy(near);
  return U;
}

}  // namespace vbond
