#include "vbond/dynamics/supports.hpp"

#include <algorithm>
#include <utility>

namespace vbond {
namespace {

/// The particles of all loads.
ByBlock by_block(const std::vector<PointLoad>& loads, const Order& order, std::size_t blocks) {
  std::vector<ByBlock::Entry> entries;
  for (std::size_t k = 0; k < loads.size(); ++k)
    for (const ParticleId p : loads[k].particles)
      if (order.has(p)) entries.push_back({order.row[p].value, k});
  return {std::move(entries), blocks};
}

/// What supports hold that are not rigid.
ByBlock by_block(const std::vector<Hold>& holds, const Stage& stage, const Order& order, std::size_t blocks) {
  std::vector<ByBlock::Entry> entries;
  for (std::size_t k = 0; k < holds.size(); ++k)
    if (!stage.supports[holds[k].support].rigid) entries.push_back({order.row[holds[k].particle].value, k});
  return {std::move(entries), blocks};
}

/// What supports hold of the particles that are moved here.
std::vector<Hold> holds_here(const Stage& stage, const Order& order) {
  std::vector<Hold> holds = holds_of(stage.supports);
  std::erase_if(holds, [&order](const Hold& h) { return !order.has(h.particle); });
  return holds;
}

}  // namespace

Supports::Supports(const Stage& stage, Bodies& bodies, const Team& team)
    : stage_(stage),
      bodies_(bodies),
      holds_(holds_here(stage, bodies.order)),
      held_(by_block(holds_, stage, bodies.order, team.blocks())),
      grips_(stage, bodies, team) {
  for (const Support& s : stage.supports) factors_.add(s.factor);
}

/// Calls f(support, rate, inertia, load, prescribed) for every held degree of freedom: rate is the velocity
/// or angular velocity component, which f may change; prescribed is at factor 1. The inertia of a top's
/// rotation is given as 0: its energy is no sum over components, and is looked at before and after.
template <class F>
void Supports::for_each_held(const Block& block, F f) const {
  for (const ByBlock::Entry* e = held_.begin_of(block.index); e != held_.end_of(block.index); ++e) {
    const Hold& hold = holds_[e->index];
    const Support& s = stage_.supports[hold.support];
    MotionRow& motion = bodies_.motion[e->row];
    const LoadRow& load = bodies_.load[e->row];
    const double theta = bodies_.tops.has(e->row) ? 0.0 : bodies_.inertia[e->row];
    if (hold.axes != nullptr) {
      for (std::size_t dof = 0; dof < 6; ++dof) {
        if (!hold.held[dof]) continue;
        const bool turns = dof >= 3;
        const Vec3d& axis = hold.axes->of(dof);
        Vec3d& rates = turns ? motion.omega : motion.v;
        const double before = dot(rates, axis);
        double rate = before;
        f(hold.support, rate, turns ? theta : bodies_.mass[e->row], dot(turns ? load.M : load.F, axis),
          dot(turns ? s.angular_velocity : s.velocity, axis));
        rates += (rate - before) * axis;
      }
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      if (hold.held[axis])
        f(hold.support, component(motion.v, k), bodies_.mass[e->row], component(load.F, k),
          component(s.velocity, k));
      if (hold.held[axis + 3])
        f(hold.support, component(motion.omega, k), theta, component(load.M, k),
          component(s.angular_velocity, k));
    }
  }
}

double Supports::energy_of_tops(const Block& block, Tops::Turns least) const {
  return bodies_.tops.energy(block.rows, least, bodies_.pose, bodies_.motion);
}

double Supports::do_hold(const Block& block, Instant at) const {
  double work = -energy_of_tops(block, Tops::Turns::about_one_axis);
  bodies_.tops.turn_about_free_axes(block.rows, bodies_.turning());
  for_each_held(block, [&](std::size_t support, double& rate, double m, double, double prescribed) {
    const double given = factors_.at(support, at) * prescribed;
    work += 0.5 * m * (given * given - rate * rate);
    rate = given;
  });
  return work + energy_of_tops(block, Tops::Turns::about_one_axis);
}

double Supports::do_hold_after_kick(const Block& block, Instant from, Instant to, double h) const {
  double work = -energy_of_tops(block, Tops::Turns::as_held);
  for_each_held(block, [&](std::size_t support, double& rate, double m, double load, double prescribed) {
    const double before = factors_.at(support, from), after = factors_.at(support, to);
    const double impulse = m * (after - before) * prescribed - h * load;
    work += impulse * 0.5 * (before + after) * prescribed;
    rate = after * prescribed;
  });
  return work + energy_of_tops(block, Tops::Turns::as_held);
}

AppliedLoads::AppliedLoads(const Stage& stage, Bodies& bodies, const Team& team)
    : stage_(stage),
      bodies_(bodies),
      loaded_(by_block(stage.loads, bodies.order, team.blocks())),
      any_(!loaded_.empty() || stage.gravity != Vec3d{}) {
  for (const PointLoad& l : stage.loads) factors_.add(l.factor);
}

void AppliedLoads::do_add(const Block& block, Instant at) const {
  for (const ByBlock::Entry* e = loaded_.begin_of(block.index); e != loaded_.end_of(block.index); ++e) {
    const PointLoad& l = stage_.loads[e->index];
    const double factor = factors_.at(e->index, at), mass = bodies_.mass[e->row];
    LoadRow& load = bodies_.load[e->row];
    if (l.follower) {
      const Quatd& q = bodies_.pose[e->row].q;
      load.F += rotate(q, factor * l.force_on(mass));
      load.M += rotate(q, factor * l.moment_on(mass));
      continue;
    }
    load.F += factor * l.force_on(mass);
    load.M += factor * l.moment_on(mass);
  }
  if (stage_.gravity == Vec3d{}) return;
  for (std::size_t k = block.rows.first; k < block.rows.last; ++k)
    bodies_.load[k].F += bodies_.mass[k] * stage_.gravity;
}

/// Mean power of what turns with a particle: the kicks at both ends of the step do its work with the rates
/// between them. The particle stands at the end; where it stood before follows from the rate, which is
/// constant but of tops: their work is asked for in halves.
double AppliedLoads::power_of_follower(const ByBlock::Entry& e, double dt, Instant at) const {
  const PointLoad& l = stage_.loads[e.index];
  const MotionRow& m = bodies_.motion[e.row];
  const double mass = bodies_.mass[e.row];
  const auto power = [&](const Quatd& q, Instant when) {
    return factors_.at(e.index, when) *
           (dot(rotate(q, l.force_on(mass)), m.v) + dot(rotate(q, l.moment_on(mass)), m.omega));
  };
  const Quatd& now = bodies_.pose[e.row].q;
  if (at != Instant::middle) return power(now, at);
  return 0.5 * (power(rotation_of(-dt * m.omega) * now, Instant::start) + power(now, Instant::end));
}

double AppliedLoads::do_work(const Block& block, double dt, Instant at) const {
  double work = 0.0;
  for (const ByBlock::Entry* e = loaded_.begin_of(block.index); e != loaded_.end_of(block.index); ++e) {
    const PointLoad& l = stage_.loads[e->index];
    if (l.follower) {
      work += dt * power_of_follower(*e, dt, at);
      continue;
    }
    const MotionRow& m = bodies_.motion[e->row];
    const double mean = 0.5 * (factors_.at(e->index, Instant::start) + factors_.at(e->index, Instant::end));
    const double mass = bodies_.mass[e->row];
    work += mean * dt * (dot(l.force_on(mass), m.v) + dot(l.moment_on(mass), m.omega));
  }
  if (stage_.gravity == Vec3d{}) return work;
  double momentum_along = 0.0;
  for (std::size_t k = block.rows.first; k < block.rows.last; ++k)
    momentum_along += bodies_.mass[k] * dot(stage_.gravity, bodies_.motion[k].v);
  return work + dt * momentum_along;
}

}  // namespace vbond
