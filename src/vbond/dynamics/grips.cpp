#include "vbond/dynamics/grips.hpp"

#include <algorithm>
#include <utility>

namespace vbond {

Grips::Grips(const Stage& stage, Bodies& bodies, const Team& team) : stage_(stage), bodies_(bodies) {
  std::vector<char> taken(bodies.pose.size(), 0);  // by a grip that agrees
  for (const Support& s : stage.supports) {
    if (!s.rigid) continue;
    grips_.push_back({&s, TimeIntegral(s.factor), {}, members_.size()});
    for (const ParticleId p : s.particles)
      members_.push_back({bodies.order.row[p].value, grips_.size() - 1, {}});
  }
  std::vector<ByBlock::Entry> entries;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (!std::exchange(taken[members_[k].row], 1)) {
      members_[k].moved = true;
      if (members_[k].row < bodies.order.own) entries.push_back({members_[k].row, k});
    }
  held_ = ByBlock(std::move(entries), team.blocks());
  work_.resize(team.blocks() * grips_.size());
}

Grips::Place Grips::place_of(const Grip& grip, double s) const {
  const double since = s - grip.state.from;
  const RigidMotion motion{grip.state.pivot, grip.support->velocity, grip.support->angular_velocity};
  return {s, motion.pivot_at(since), motion.turn(since)};
}

PoseRow Grips::pose_at(const Member& m, const Place& at) {
  PoseRow pose;
  pose.r = at.pivot + rotate(at.turn, m.as_held.arm);
  pose.q = renormalised(at.turn * m.as_held.q);
  return pose;
}

bool Grips::stands_at(const Grip& grip, const Place& now) const {
  for (std::size_t k = grip.first; k < grip.first + grip.support->particles.size(); ++k) {
    if (!members_[k].moved) continue;
    const PoseRow &is = bodies_.pose[members_[k].row], belongs = pose_at(members_[k], now);
    if (!(is.r == belongs.r && is.q == belongs.q)) return false;
  }
  return true;
}

/// From the present poses on.
void Grips::take_hold(Grip& grip, double s) {
  const Support& support = *grip.support;
  Vec3d pivot;
  if (support.pivot) {
    pivot = *support.pivot + s * support.velocity;
  } else {
    for (const ParticleId p : support.particles) pivot += bodies_.pose[bodies_.order.row[p].value].r;
    pivot = pivot / static_cast<double>(support.particles.size());
  }
  grip.state.pivot = pivot;
  grip.state.from = s;
  grip.state.particles = static_cast<std::int64_t>(support.particles.size());
  for (std::size_t k = grip.first; k < grip.first + support.particles.size(); ++k) {
    const PoseRow& pose = bodies_.pose[members_[k].row];
    members_[k].as_held = {pose.r - pivot, pose.q};
  }
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
    if (kept) grip.state = state.grips[k];
    if (!kept || !stands_at(grip, place_of(grip, s))) take_hold(grip, s);
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
  }
}

/// What the velocities of a particle must be. The poses are those of the start or the end.
Grips::Rates Grips::rates(const Member& m, Instant at) const {
  const Grip& g = grips_[m.grip];
  const Vec3d &V = g.support->velocity, &W = g.support->angular_velocity;
  if (at == Instant::middle) {
    const double way = g.end.s - g.start.s;
    const Vec3d chord = way * V + swing(g.turn, rotate(g.start.turn, m.as_held.arm));
    return {(1.0 / stage_.dt) * chord, (way / stage_.dt) * W};
  }
  const bool start = at == Instant::start;
  const double factor = start ? g.factor_start : g.factor_end;
  const Vec3d arm = bodies_.pose[m.row].r - (start ? g.start : g.end).pivot;
  return {factor * (V + cross(W, arm)), factor * W};
}

double Grips::hold(const Block& block, Instant at) {
  double total = 0.0;
  for (const ByBlock::Entry* e = held_.begin_of(block.index); e != held_.end_of(block.index); ++e) {
    const Member& m = members_[e->index];
    const Rates given = rates(m, at);
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
    const Rates before = rates(m, from), after = rates(m, to);
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
  }
}

/// Block by block, so that the sum does not depend on the threads.
void Grips::close() {
  for (std::size_t k = 0; k < work_.size(); ++k) grips_[k % grips_.size()].state.work += work_[k];
  std::fill(work_.begin(), work_.end(), 0.0);
}

std::vector<GripView> Grips::views(std::int64_t stage_step) const {
  std::vector<GripView> all;
  for (const Grip& g : grips_) {
    const Place now = place_of(g, g.path(time_of(stage_step)));
    GripView view{g.support->group, {}, {}, now.s * norm(g.support->angular_velocity), g.state.work};
    for (std::size_t k = g.first; k < g.first + g.support->particles.size(); ++k) {
      const std::size_t row = members_[k].row;
      if (row >= bodies_.order.own) continue;
      const Vec3d F = stage_.b_translation * bodies_.motion[row].v - bodies_.load[row].F;
      view.force += F;
      view.moment += stage_.b_rotation * bodies_.motion[row].omega - bodies_.load[row].M +
                     cross(bodies_.pose[row].r - now.pivot, F);
    }
    all.push_back(std::move(view));
  }
  return all;
}

}  // namespace vbond
