#include "vbond/terms/walls/resting_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/physics/tangent.hpp"

namespace vbond {

RestingWalls::RestingWalls(const Model& model) : model_(model), forms_(touch_forms(model.contact)) {
  const std::size_t materials = std::max<std::size_t>(1, model.materials.size());
  for (const Wall& w : model.walls) {
    surfaces_.emplace_back(w.shape);
    numbers_.emplace_back();
    for (std::uint32_t m = 0; m < materials; ++m)
      numbers_.back().push_back(touch_numbers(model.contact, model.materials, m, w.material));
  }
}

std::vector<RestingTouch> RestingWalls::near(const State& state, double farther) const {
  std::vector<RestingTouch> all;
  std::vector<WallTouch> found;
  for (const ParticleId p : state.r.ids()) {
    if (!state.r.holds(p) || is_absent(state, p)) continue;  // of a part of a body, or of all of it
    for (std::uint32_t w = 0; w < surfaces_.size(); ++w) {
      const WallState now = wall_of(state, w);
      if (now.off != 0) continue;
      const Vec3d r = at_start(model_.walls[w], now, state.r[p]);
      const double R = model_.radius[p];
      if (!surfaces_[w].may_touch(r, R + farther)) continue;
      found.clear();
      surfaces_[w].touches(r, R + farther, found);
      for (const WallTouch& t : found) {
        RestingTouch touch{p, w, rotate(now.q, t.normal), t.distance, R - t.distance,
                           0, 0, t.curvature_1 < 0.0};
        const double R_e = is_too_wide(R, t.curvature_1, t.curvature_2)
                               ? std::numeric_limits<double>::quiet_NaN()
                               : effective_radius(R, t);
        touch.reduced_radius = R_e;
        if (std::isnan(R_e)) touch.overlap = touch.force = touch.energy = R_e;
        if (touch.overlap > 0.0) {
          const TouchNumbers<double>& c = numbers_[w][model_.material_of(p)];
          touch.force = normal_force(forms_, c, R_e, touch.overlap).F;
          touch.energy = normal_energy(forms_, c, R_e, touch.overlap);
        }
        all.push_back(touch);
      }
    }
  }
  return all;
}

std::vector<RestingTouch> RestingWalls::touches(const State& state) const {
  return near(state, 0.0);
}

std::vector<WallTouch> RestingWalls::near(const State& state, std::uint32_t wall, const Vec3d& r,
                                          double reach) const {
  const WallState now = wall_of(state, wall);
  const Vec3d there = at_start(model_.walls[wall], now, r);
  std::vector<WallTouch> found;
  if (now.off != 0 || !surfaces_[wall].may_touch(there, reach)) return found;
  surfaces_[wall].touches(there, reach, found);
  for (WallTouch& t : found) t.normal = rotate(now.q, t.normal);
  return found;
}

ForceSlope RestingWalls::slope(const State& state, ParticleId p, std::uint32_t wall) const {
  using D = Dual<3>;
  const WallState now = wall_of(state, wall);
  const double R = model_.radius[p];
  const TouchNumbers<D> c = repulsion(numbers_[wall][model_.material_of(p)]);
  std::vector<MovedWallTouch> found;
  // the wall stands as at the start, and the particle moves along axes that are the world's in its eyes
  const Quatd back = conjugate(now.q);
  Vec3<D> r = constant<D>(at_start(model_.walls[wall], now, state.r[p]));
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d axis = rotate(back, Vec3d{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0});
    r.x.d[k] = axis.x, r.y.d[k] = axis.y, r.z.d[k] = axis.z;
  }
  surfaces_[wall].touches(r, R, found);
  const Quat<D> turn{D(now.q.w), D(now.q.x), D(now.q.y), D(now.q.z)};
  Vec3<D> F;
  for (const MovedWallTouch& t : found) {
    const D overlap = D(R) - t.distance;
    if (!(overlap.value > 0.0)) continue;
    F += normal_force(forms_, c, D(effective_radius(R, t.curvature_1, t.curvature_2)), overlap).F *
         rotate(turn, t.normal);
  }
  return {{F.x.value, F.y.value, F.z.value}, {F.x.d, F.y.d, F.z.d}};
}

PairHistory memory_of(const State& s, const RestingTouch& t) {
  constexpr double same = 1.0 - 1e-9;
  const std::pair place(t.p, t.wall);
  for (auto m = std::lower_bound(s.wall_history.begin(), s.wall_history.end(), place,
                                 [](const WallMemory&w, const auto&at) { return place_of(w) < at; });
       m != s.wall_history.end() && place_of(*m) == place; ++m)
    if (dot(m->normal, t.normal) > same) return m->history;
  return {};
}

double RestingWalls::energy(const State& state) const {
  double U = 0.0;
  for (const RestingTouch& t : touches(state)) U += t.energy;
  return U;
}

}  // namespace vbond
