#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/setup/fibres/fibre_segments.hpp"

namespace vbond {
namespace {

/// Where two segments of different fibres, or of images of one fibre, are nearest.
struct NearSegments {
  std::size_t fibre_i = 0, fibre_j = 0;
  Vec3d on_i, on_j;  ///< from the middle of each fibre  [length]
  Vec3d apart;       ///< from one point to the other  [length]
};

NearSegments nearest(const FibreField& field, const Segments& segments, const std::vector<Vec3d>& r,
                     const SegmentPair& pair) {
  const std::size_t p = segments.point[pair.i], q = segments.point[pair.j];
  const Vec3d p_0 = r[p], p_1 = r[p + 1], q_0 = r[q] + pair.shift, q_1 = r[q + 1] + pair.shift;
  const NearestOnSegments at = nearest_on_segments(p_0, p_1, q_0, q_1);
  const Vec3d on_i = on_segment(p_0, p_1, at.s), on_j = on_segment(q_0, q_1, at.t);
  NearSegments near{segments.fibre[pair.i], segments.fibre[pair.j], {}, {}, between(on_i, on_j)};
  near.on_i = between(field.middle[near.fibre_i], on_i);
  near.on_j = between(field.middle[near.fibre_j] + pair.shift, on_j);
  return near;
}

/// How far a point is inside of the two faces that an edge joins, negative: outside.
std::array<double, 2> inside(const FibreVessel& vessel, std::size_t edge, const Vec3d& r) {
  const double way = dot(between(vessel.corner, r), vessel.along(edge));
  return {way, norm(vessel.edges[edge]) - way};
}

/// Rigid motion down the energy 1/2 sum of (range - distance)^2 over near pairs, and of what is outside, by
/// FIRE (Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201): masses 1, moments of inertia as of masses spread
/// evenly over the points.
class Pushing {
 public:
  Pushing(FibreField& field, const TurnsAllowed& turns)
      : field_(field),
        turns_(turns),
        segments_(field),
        range_(field.distance * (1.0 + margin_)),
        v_(field.size()),
        w_(field.size()),
        F_(field.size()),
        M_(field.size()) {
    for (std::size_t f = 0; f < field.size(); ++f) {
      double sum = 0.0;
      for (std::size_t k = field.first[f]; k < field.first[f + 1]; ++k) sum += norm2(field.shape[k]);
      inertia_.push_back(std::max(sum / static_cast<double>(field.points_of(f)), sq(field.radius)));
    }
    r_ = field_.points();
  }

  bool run() {
    constexpr int most = 5000, window = 200;
    double dt = 0.1, alpha = 0.1, before = INFINITY;
    int downhill = 0;
    for (int step = 0; step < most; ++step) {
      loads();
      if (clear_) return true;
      if (step % window == 0) {
        if (energy_ > 0.9 * before) return false;  // it does not come to an end
        before = energy_;
      }
      double power = 0.0, vv = 0.0, FF = 0.0;
      for (std::size_t f = 0; f < v_.size(); ++f) {
        power += dot(F_[f], v_[f]) + dot(M_[f], w_[f]);
        vv += norm2(v_[f]) + inertia_[f] * norm2(w_[f]);
        FF += norm2(F_[f]) + norm2(M_[f]) / inertia_[f];
      }
      if (power > 0.0) {
        const double mixed = alpha * std::sqrt(vv / FF);
        for (std::size_t f = 0; f < v_.size(); ++f) {
          v_[f] = (1.0 - alpha) * v_[f] + mixed * F_[f];
          w_[f] = (1.0 - alpha) * w_[f] + (mixed / inertia_[f]) * M_[f];
        }
        if (++downhill > 5) dt = std::min(1.1 * dt, 0.25), alpha *= 0.99;
      } else {
        std::fill(v_.begin(), v_.end(), Vec3d{});
        std::fill(w_.begin(), w_.end(), Vec3d{});
        dt = std::max(0.5 * dt, 1e-3), alpha = 0.1, downhill = 0;
      }
      move(dt);
    }
    return false;
  }

 private:
  static constexpr double margin_ = 1e-2;  // beyond what is asked for, which is reached the sooner

  void loads() {
    if (stale()) list();
    std::fill(F_.begin(), F_.end(), Vec3d{});
    std::fill(M_.begin(), M_.end(), Vec3d{});
    energy_ = 0.0;
    clear_ = true;
    for (const SegmentPair& pair : near_) {
      if (distance2(segments_, r_, pair) >= sq(range_)) continue;
      const NearSegments at = nearest(field_, segments_, r_, pair);
      const double d = norm(at.apart);
      clear_ = clear_ && d >= field_.distance;
      push(at, d, segments_.point[pair.i], segments_.point[pair.j]);
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (field_.vessel.faces[k] != Face::through) push_in(k);
    if (turns_.dimensions == 3) return;
    for (Vec3d& M : M_) M = turns_.dimensions == 2 ? dot(M, turns_.normal) * turns_.normal : Vec3d{};
  }

  void push(const NearSegments& at, double d, std::size_t p, std::size_t q) {
    Vec3d n =
        d > 1e-9 * field_.radius ? at.apart / d : cross(between(r_[p], r_[p + 1]), between(r_[q], r_[q + 1]));
    if (norm(n) == 0.0) n = {0, 0, 1};  // one upon the other: any way is as good
    const Vec3d F = (range_ - d) * normalised(n);
    energy_ += 0.5 * sq(range_ - d);
    F_[at.fibre_i] -= F;
    F_[at.fibre_j] += F;
    M_[at.fibre_i] -= cross(at.on_i, F);
    M_[at.fibre_j] += cross(at.on_j, F);
  }

  /// What is outside of the faces that an edge joins.
  void push_in(std::size_t edge) {
    const bool whole = field_.vessel.faces[edge] == Face::whole;
    const Vec3d n = field_.vessel.along(edge);
    const double least = whole ? field_.radius : 0.0, range = least + margin_ * field_.radius;
    const auto look_at = [&](std::size_t f, const Vec3d& r) {
      const auto [low, high] = inside(field_.vessel, edge, r);
      for (const auto& [in, way] : {std::pair{low, 1.0}, {high, -1.0}}) {
        if (in >= range) continue;
        clear_ = clear_ && in >= least;
        const Vec3d F = (way * (range - in)) * n;
        energy_ += 0.5 * sq(range - in);
        F_[f] += F;
        M_[f] += cross(between(field_.middle[f], r), F);
      }
    };
    for (std::size_t f = 0; f < field_.size(); ++f)
      if (!whole)
        look_at(f, field_.middle[f]);
      else
        for (std::size_t k = field_.first[f]; k < field_.first[f + 1]; ++k) look_at(f, r_[k]);
  }

  void move(double dt) {
    for (std::size_t f = 0; f < v_.size(); ++f) {
      v_[f] += dt * F_[f];
      w_[f] += (dt / inertia_[f]) * M_[f];
      field_.middle[f] += dt * v_[f];
      if (w_[f] != Vec3d{}) field_.turn[f] = normalised(rotation_of(dt * w_[f]) * field_.turn[f]);
    }
    r_ = field_.points();
  }

  bool stale() const {
    if (r_listed_.empty()) return true;
    for (std::size_t k = 0; k < r_.size(); ++k)
      if (norm2(r_[k] - r_listed_[k]) > sq(0.5 * skin())) return true;
    return false;
  }
  double skin() const { return 0.5 * field_.distance; }

  void list() {
    near_.clear();
    for_segments_within(field_.vessel, segments_, r_, range_ + skin(), [this](const SegmentPair& pair) {
      if (distance2(segments_, r_, pair) < sq(range_ + skin())) near_.push_back(pair);
    });
    r_listed_ = r_;
  }

  FibreField& field_;
  TurnsAllowed turns_;
  Segments segments_;
  double range_;
  std::vector<Vec3d> v_, w_, F_, M_;
  std::vector<double> inertia_;
  std::vector<Vec3d> r_, r_listed_;
  std::vector<SegmentPair> near_;
  double energy_ = 0.0;
  bool clear_ = false;
};

}  // namespace

bool push_apart(FibreField& field, const TurnsAllowed& turns) {
  return Pushing(field, turns).run();
}

}  // namespace vbond
