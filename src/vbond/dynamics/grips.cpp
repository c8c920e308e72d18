#include "vbond/dynamics/grips.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vbond {

Grips::Grips(const Stage& stage, Bodies& bodies, const Team& team) : stage_(stage), bodies_(bodies) {
  PerParticle<char> taken(bodies.order.row.size(), 0);  // by a grip that agrees
  for (const Support& s : stage.supports) {
    if (!s.rigid) continue;
    grips_.push_back({&s, TimeIntegral(s.factor), {}, members_.size()});
    for (const ParticleId p : s.particles)
      members_.push_back({bodies.order.row[p].value, grips_.size() - 1, {}});
  }
  std::vector<ByBlock::Entry> entries;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (!std::exchange(taken[particle_of(members_[k], k)], 1)) {
      members_[k].moved = true;
      if (members_[k].row < bodies.order.own) entries.push_back({members_[k].row, k});
    }
  waiting_.resize(team.blocks(), 0);
  for (const ByBlock::Entry& e : entries)
    if (is_free_grip(*grips_[members_[e.index].grip].support))
      waiting_[e.row / block_rows] = 1, any_free_ = true;
  held_ = ByBlock(std::move(entries), team.blocks());
  work_.resize(team.blocks() * grips_.size());
}

Grips::Place Grips::place_of(const Grip& grip, double s) const {
  const double since = s - grip.state.from;
  const RigidMotion motion{grip.state.pivot, grip.support->velocity, grip.support->angular_velocity};
  if (!grip.free) return {s, motion.pivot_at(since), motion.turn(since)};
  const bool turns = grip.free->body.turns() != FreeGrip::Turns::held;
  return {s, motion.pivot_at(since) + grip.state.shift, turns ? grip.state.turn : motion.turn(since)};
}

PoseRow Grips::pose_at(const Member& m, const Place& at) {
  PoseRow pose;
  pose.r = at.pivot + rotate(at.turn, m.as_held.arm);
  pose.q = renormalised(at.turn * m.as_held.q);
  return pose;
}

/// Member k, which other parts of the body may move.
ParticleId Grips::particle_of(const Member& m, std::size_t k) const {
  const Grip& grip = grips_[m.grip];
  return grip.support->particles[k - grip.first];
}

/// But for rounding: a stage that was made longer sums up its factor anew.
bool Grips::stands_at(const Grip& grip, const Place& now, const State& state) const {
  constexpr double rounding = 1e-12;
  for (std::size_t k = grip.first; k < grip.first + grip.support->particles.size(); ++k) {
    const ParticleId p = particle_of(members_[k], k);
    if (!members_[k].moved || is_absent(state, p)) continue;  // who is gone stays where it was
    const PoseRow belongs = pose_at(members_[k], now);
    const double size = norm(now.pivot) + norm(members_[k].as_held.arm);
    const Vec3d &r = state.r[p], off = r - belongs.r;
    const Quatd &q = state.q[p], &at = belongs.q;
    const double turned = std::hypot(std::hypot(q.w - at.w, q.x - at.x), std::hypot(q.y - at.y, q.z - at.z));
    if (!(norm(off) <= rounding * size && turned <= rounding)) return false;
  }
  return true;
}

/// From the present poses on.
void Grips::take_hold(Grip& grip, double s, const State& state) {
  const Support& support = *grip.support;
  Vec3d pivot;
  if (support.pivot) {
    pivot = *support.pivot + s * support.velocity;
  } else {
    double weight = 0.0;
    for (const ParticleId p : support.particles) {
      if (is_absent(state, p)) continue;
      const std::size_t row = bodies_.order.row[p].value;
      const double w = is_free_grip(support) ? bodies_.mass[row] : 1.0;
      pivot += w * state.r[p], weight += w;
    }
    pivot = weight > 0.0 ? pivot / weight : state.r[support.particles.front()];
  }
  grip.state.pivot = pivot;
  grip.state.from = s;
  grip.state.particles = static_cast<std::int64_t>(support.particles.size());
  for (std::size_t k = grip.first; k < grip.first + support.particles.size(); ++k) {
    const ParticleId p = particle_of(members_[k], k);
    members_[k].as_held = {state.r[p] - pivot, state.q[p]};
  }
  if (!is_free_grip(support)) return;
  begin_free(grip);
  grip.state.shift = {};
  grip.state.turn = {1, 0, 0, 0};
  grip.state.angle = 0.0;
  if (grip.free) find_motion(grip, pivot);
}

/// The body that it is, from how it took hold of its particles: of those that are there.
void Grips::begin_free(Grip& grip) {
  GripMass mass;
  for (std::size_t k = grip.first; k < grip.first + grip.support->particles.size(); ++k) {
    const std::size_t row = members_[k].row;
    if (bodies_.mass[row] > 0.0)  // who is gone has none
      mass.add(members_[k].as_held.arm, bodies_.mass[row], bodies_.inertia[row], stage_.b_translation,
               stage_.b_rotation);
  }
  if (mass.mass == 0.0) return;  // all of them
  grip.free = Free{{grip.support->held, mass, 0.5 * stage_.dt}, {}, {}, {}, {}, {}};
  any_turn_ |= grip.free->body.turns() != FreeGrip::Turns::held;
}

/// It goes on with the momentum that its particles have.
void Grips::find_motion(Grip& grip, const Vec3d& pivot) {
  Vec3d P, L;
  for (std::size_t k = grip.first; k < grip.first + grip.support->particles.size(); ++k) {
    const MotionRow& motion = bodies_.motion[members_[k].row];
    const Vec3d p = bodies_.mass[members_[k].row] * motion.v;
    P += p;
    L += cross(bodies_.pose[members_[k].row].r - pivot, p) + bodies_.inertia[members_[k].row] * motion.omega;
  }
  const FreeGrip& body = grip.free->body;
  grip.state.velocity = body.free_part(P / body.mass());
  grip.state.spin = body.free_turn(L);
}

void Grips::read(const State& state, bool begun) {
  const auto same_size = [](const Grip& g, const GripState& s) {
    return s.particles == static_cast<std::int64_t>(g.support->particles.size());
  };
  const bool kept =
      begun && state.gripped.size() == members_.size() &&
      std::equal(grips_.begin(), grips_.end(), state.grips.begin(), state.grips.end(), same_size);
  for (std::size_t k = 0; kept && k < members_.size(); ++k) members_[k].as_held = state.gripped[k];
  for (std::size_t k = 0; k < grips_.size(); ++k) {
    Grip& grip = grips_[k];
    const double s = grip.path(time_of(state.clock.stage_step));
    if (kept) {
      grip.state = state.grips[k];
      if (is_free_grip(*grip.support)) begin_free(grip);
    }
    if (!kept || !stands_at(grip, place_of(grip, s), state))
      take_hold(grip, s, state);
    else if (grip.free && !is_finite(grip.state.velocity))
      find_motion(grip, place_of(grip, s).pivot);
    if (!grip.free) grip.state.velocity = {};  // of a driven one there is nothing to find
  }
}

void Grips::write(State& state) const {
  state.grips.clear();
  state.gripped.clear();
  for (const Grip& g : grips_) state.grips.push_back(g.state);
  for (const Member& m : members_) state.gripped.push_back(m.as_held);
}

void Grips::set_times(std::int64_t stage_step) {
  for (Grip& g : grips_) {
    const double t = time_of(stage_step), t_end = time_of(stage_step + 1);
    g.factor_start = g.support->factor(t), g.factor_end = g.support->factor(t_end);
    g.start = place_of(g, g.path(t)), g.end = place_of(g, g.path(t_end));
    g.turn = rotation_of((g.end.s - g.start.s) * g.support->angular_velocity);
    if (g.free) g.free->start = {g.state.velocity, g.free->body.rate(g.start.turn, g.state.spin)};
  }
}

/// Forces and moments on its particles, about this point.
Grips::Rates Grips::loads_on(const Grip& grip, const Vec3d& pivot) const {
  Rates sum;
  for (std::size_t k = grip.first; k < grip.first + grip.support->particles.size(); ++k) {
    const LoadRow& load = bodies_.load[members_[k].row];
    sum.v += load.F;
    sum.omega += load.M + cross(bodies_.pose[members_[k].row].r - pivot, load.F);
  }
  return sum;
}

/// Drag over half a step: it slows down what is free, and what is held has the support make up for it. hold()
/// will see the free velocities fall: that is not its work.
double Grips::slow_down(Grip& grip, const Place& place, double factor) {
  if (stage_.b_translation == 0.0 && stage_.b_rotation == 0.0) return 0.0;
  const Support& s = *grip.support;
  const GripDrag taken = grip.free->body.slow_down(
      place.turn, {factor * s.velocity, factor * s.angular_velocity}, grip.state.velocity, grip.state.spin);
  const double all = taken.lost + taken.against_support;
  work_[static_cast<std::size_t>(&grip - grips_.data())] += all;
  return all;
}

/// The first half of a step: along the way that `end` then says.
void Grips::begin_step() {
  for (Grip& g : grips_) {
    if (!g.free) continue;
    Free& f = *g.free;
    GripState& state = g.state;
    const bool turns = f.body.turns() != FreeGrip::Turns::held;
    lost_ += slow_down(g, g.start, g.factor_start);
    f.start = {state.velocity, f.body.rate(g.start.turn, state.spin)};
    const Rates load = loads_on(g, g.start.pivot);
    const double half = 0.5 * stage_.dt;
    state.velocity += half / f.body.mass() * f.body.free_part(load.v);
    state.spin += half * f.body.free_turn(load.omega);
    f.middle_start = {state.velocity, f.body.rate(g.start.turn, state.spin)};
    state.shift += stage_.dt * state.velocity;
    if (turns) state.turn = f.body.turned(g.start.turn, state.spin, stage_.dt);
    g.end =
        place_of(g, g.end.s);  // as it will be found to the last bit, also by a run that goes on from there
    f.middle_end = {state.velocity, f.body.rate(g.end.turn, state.spin)};
    if (f.body.turns() == FreeGrip::Turns::about_axis)
      state.angle += stage_.dt * (f.middle_end.omega.x + f.middle_end.omega.y + f.middle_end.omega.z);
  }
}

/// The second half, once all loads are those of the end.
double Grips::finish_step() {
  for (Grip& g : grips_) {
    if (!g.free) continue;
    Free& f = *g.free;
    const Rates load = loads_on(g, g.end.pivot);
    const double half = 0.5 * stage_.dt;
    g.state.velocity += half / f.body.mass() * f.body.free_part(load.v);
    g.state.spin += half * f.body.free_turn(load.omega);
    f.end = {g.state.velocity, f.body.rate(g.end.turn, g.state.spin)};
    lost_ += slow_down(g, g.end, g.factor_end);
    f.slowed = {g.state.velocity, f.body.rate(g.end.turn, g.state.spin)};
  }
  return std::exchange(lost_, 0.0);
}

/// What the velocities of a particle must be, with the pose that it has at the start or the end.
Grips::Rates Grips::rates(const Member& m, Instant at, Instant pose) const {
  const Grip& g = grips_[m.grip];
  const Vec3d &V = g.support->velocity, &W = g.support->angular_velocity;
  const bool at_start = pose == Instant::start;
  const Place& place = at_start ? g.start : g.end;
  Rates given;
  if (at == Instant::middle) {
    const double way = g.end.s - g.start.s;
    const Vec3d chord = way * V + swing(g.turn, rotate(g.start.turn, m.as_held.arm));
    given = {(1.0 / stage_.dt) * chord, (way / stage_.dt) * W};
  } else {
    const double factor = at == Instant::start ? g.factor_start : g.factor_end;
    const Vec3d arm = bodies_.pose[m.row].r - place.pivot;
    given = {factor * (V + cross(W, arm)), factor * W};
  }
  if (!g.free) return given;
  const Free& f = *g.free;
  const Rates& more = at == Instant::start ? f.start
                      : at == Instant::end ? f.end
                      : at_start           ? f.middle_start
                                           : f.middle_end;
  given.v += more.v + cross(more.omega, bodies_.pose[m.row].r - place.pivot);
  given.omega += more.omega;
  return given;
}

/// At the end of the step, after drag.
Grips::Rates Grips::resting_rates(const Member& m) const {
  Rates given = rates(m, Instant::end, Instant::end);
  if (!grips_[m.grip].free) return given;
  const Free& f = *grips_[m.grip].free;
  const Vec3d turn = f.slowed.omega - f.end.omega;
  given.v += f.slowed.v - f.end.v + cross(turn, bodies_.pose[m.row].r - grips_[m.grip].end.pivot);
  given.omega += turn;
  return given;
}

double Grips::hold(const Block& block, Instant at) {
  double total = 0.0;
  for (const ByBlock::Entry* e = held_.begin_of(block.index); e != held_.end_of(block.index); ++e) {
    const Member& m = members_[e->index];
    const Rates given = at == Instant::end ? resting_rates(m) : rates(m, at, at);
    MotionRow& motion = bodies_.motion[m.row];
    const double work = 0.5 * bodies_.mass[m.row] * (norm2(given.v) - norm2(motion.v)) +
                        bodies_.rotation_energy(m.row, given.omega) -
                        bodies_.rotation_energy(m.row, motion.omega);
    motion.v = given.v, motion.omega = given.omega;
    work_[block.index * grips_.size() + m.grip] += work;
    total += work;
  }
  return total;
}

double Grips::hold_after_kick(const Block& block, Instant from, Instant to, double h) {
  double total = 0.0;
  for (const ByBlock::Entry* e = held_.begin_of(block.index); e != held_.end_of(block.index); ++e) {
    const Member& m = members_[e->index];
    const Instant pose = from == Instant::start ? from : to;
    const Rates before = rates(m, from, pose), after = rates(m, to, pose);
    const LoadRow& load = bodies_.load[m.row];
    const Vec3d impulse = bodies_.mass[m.row] * (after.v - before.v) - h * load.F;
    const double turning = bodies_.rotation_energy(m.row, after.omega) -
                           bodies_.rotation_energy(m.row, before.omega) -
                           0.5 * h * dot(load.M, before.omega + after.omega);
    const double work = 0.5 * dot(impulse, before.v + after.v) + turning;
    MotionRow& motion = bodies_.motion[m.row];
    motion.v = after.v, motion.omega = after.omega;
    work_[block.index * grips_.size() + m.grip] += work;
    total += work;
  }
  return total;
}

void Grips::carry(const Block& block) {
  for (const ByBlock::Entry* e = held_.begin_of(block.index); e != held_.end_of(block.index); ++e) {
    const Member& m = members_[e->index];
    const PoseRow belongs = pose_at(m, grips_[m.grip].end);
    bodies_.pose[m.row].r = belongs.r;
    bodies_.pose[m.row].q = belongs.q;
    if (!grips_[m.grip].free) continue;
    const Rates given = rates(m, Instant::middle, Instant::end);
    bodies_.motion[m.row].v = given.v, bodies_.motion[m.row].omega = given.omega;
  }
}

/// Block by block, so that the sum does not depend on the threads.
void Grips::close() {
  for (std::size_t k = 0; k < work_.size(); ++k) grips_[k % grips_.size()].state.work += work_[k];
  std::fill(work_.begin(), work_.end(), 0.0);
}

void Grips::leave_held(const Support& support, std::int64_t stage_step, Vec3d& F, Vec3d& moment) const {
  const auto g = std::find_if(grips_.begin(), grips_.end(),
                              [&support](const Grip& grip) { return grip.support == &support; });
  const Vec3d pivot = place_of(*g, g->path(time_of(stage_step))).pivot;
  const Vec3d free_F = g->free->body.free_part(F), about_pivot = moment - cross(pivot, F);
  F -= free_F;
  moment -= g->free->body.free_turn(about_pivot) + cross(pivot, free_F);
}

std::vector<GripView> Grips::views(std::int64_t stage_step) const {
  std::vector<GripView> all;
  for (const Grip& g : grips_) {
    const Place now = place_of(g, g.path(time_of(stage_step)));
    GripView view{g.support->group, {}, {}, now.s * norm(g.support->angular_velocity), g.state.work};
    if (g.free && g.free->body.turns() == FreeGrip::Turns::about_axis) view.angle = g.state.angle;
    if (g.free && g.free->body.turns() == FreeGrip::Turns::freely)
      view.angle = norm(rotation_vector(g.state.turn));
    for (std::size_t k = g.first; k < g.first + g.support->particles.size(); ++k) {
      const std::size_t row = members_[k].row;
      if (row >= bodies_.order.own) continue;
      const Vec3d F = stage_.b_translation * bodies_.motion[row].v - bodies_.load[row].F;
      view.force += F;
      view.moment += stage_.b_rotation * bodies_.motion[row].omega - bodies_.load[row].M +
                     cross(bodies_.pose[row].r - now.pivot, F);
    }
    if (g.free) {
      view.force -= g.free->body.free_part(view.force);
      view.moment -= g.free->body.free_turn(view.moment);
    }
    all.push_back(std::move(view));
  }
  return all;
}

}  // namespace vbond
