// Which particles are near walls, and what those that touch them do.
#include <algorithm>
#include <utility>

#include "vbond/model/contact_bound.hpp"
#include "vbond/physics/touch_mass.hpp"
#include "vbond/terms/walls/motion_walls.hpp"

namespace vbond {
namespace {

/// Two normals farther apart than 60 degrees belong to two touches.
constexpr double same_touch = 0.5;
constexpr std::size_t no_slot = static_cast<std::size_t>(-1);

}  // namespace

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
  const ParticleId particle = bodies_.order.particle[Row{k}];
  const double R = model_.radius[particle];
  const WallState& wall = walls_[near.wall];
  const MotionRow& motion = bodies_.motion[k];
  Touching<double> p{};
  p.n = -rotate(wall.q, touch.normal);
  p.overlap = R - touch.distance;
  p.R = effective_radius(R, touch);
  p.m = masses_.of(particle);
  p.Theta = bodies_.inertia[k];
  p.l_i = touch.distance;
  p.v = velocity_at(near.wall, bodies_.pose[k].r + touch.distance * p.n) - motion.v;
  p.w_i = motion.omega;
  p.w_j = wall.angular_velocity;
  undamp_if_none_is_free(p);
  return p;
}

/// Which of the slots each touch goes on with: the one with the likest normal, touches before surfaces that
/// are near only. So it does not matter in which order triangles stand, and what a particle does not touch
/// takes nothing from what it does.
void MotionWalls::match(const Near& near, const std::vector<WallTouch>& touches,
                        const std::vector<Slot>& slots, std::vector<std::size_t>& slot_of) const {
  const double R = model_.radius[bodies_.order.particle[Row{near.row}]];
  const Quatd& q = walls_[near.wall].q;
  slot_of.assign(touches.size(), no_slot);
  for (const bool touching : {true, false})
    for (;;) {
      std::size_t touch = 0, slot = no_slot;
      double most = same_touch;
      for (std::size_t t = 0; t < touches.size(); ++t) {
        if (slot_of[t] != no_slot || (touches[t].distance < R) != touching) continue;
        const Vec3d normal = rotate(q, touches[t].normal);
        for (std::size_t s = 0; s < slots.size(); ++s)
          if (const double likeness = dot(slots[s].normal, normal);
              likeness > most && std::find(slot_of.begin(), slot_of.end(), s) == slot_of.end())
            most = likeness, touch = t, slot = s;
      }
      if (slot == no_slot) break;
      slot_of[touch] = slot;
    }
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
  match(near, touches, before, block.slot_of);
  for (std::size_t t = 0; t < touches.size(); ++t) {
    const WallTouch& touch = touches[t];
    if (is_too_wide(R, touch.curvature_1, touch.curvature_2)) {
      block.faults.push_back({Fault::too_wide, near.wall, bodies_.order.particle[Row{near.row}]});
      continue;
    }
    const Touching<double> p = touching(near, touch);
    const std::size_t same = block.slot_of[t];
    Slot slot{-p.n, same == no_slot ? PairHistory{} : before[same].history};
    const bool touches_now =
        p.overlap > 0.0 || (slot.history[3] > 0.0 && holds_on(forms_, c, p.R, p.overlap));
    if (!touches_now && same == no_slot) continue;
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
    for (std::size_t k = 0; k < before.size(); ++k) {  // what it does not touch any more
      if (std::find(block.slot_of.begin(), block.slot_of.end(), k) != block.slot_of.end()) continue;
      const Slot& s = before[k];
      Touching<double> p{};
      p.n = -s.normal, p.R = R, p.l_i = R;
      p.w_i = bodies_.motion[near.row].omega, p.w_j = walls_[near.wall].angular_velocity;
      p.v = velocity_at(near.wall, r + R * p.n) - bodies_.motion[near.row].v;
      lost += lost_on_parting(forms_, c, p, dt, touch_history(s.history));
    }
  return lost;
}

double MotionWalls::energy(const Near& near) const {
  double U = 0.0;
  std::vector<WallTouch> touches;
  const std::vector<std::uint32_t>& triangles = blocks_[near.row / block_rows].triangles;
  const double R = model_.radius[bodies_.order.particle[Row{near.row}]];
  surfaces_[near.wall].touches_of({triangles.data() + near.first, triangles.data() + near.last},
                                  at_start(near.wall, bodies_.pose[near.row].r), R + reach_, touches);
  std::vector<std::size_t> slot_of;
  match(near, touches, near.slots, slot_of);
  for (std::size_t t = 0; t < touches.size(); ++t) {
    const Touching<double> p = touching(near, touches[t]);
    const bool held = slot_of[t] != no_slot && near.slots[slot_of[t]].history[3] > 0.0;
    if (p.overlap > 0.0 || (held && holds_on(forms_, numbers(near), p.R, p.overlap)))
      U += normal_energy(forms_, numbers(near), p.R, p.overlap);
  }
  for (const Slot& s : near.slots) U += history_energy(forms_, numbers(near), touch_history(s.history));
  return U;
}

}  // namespace vbond
