#include "vbond/dynamics/encounters.hpp"

#include <algorithm>
#include <cmath>

namespace vbond {

Vec3d nearest_point(const Encounter& e) {
  const Vec3d way = e.to - e.from;
  const double way2 = norm2(way);
  if (!(way2 > 0.0)) return e.to;
  return e.from + std::clamp(-dot(e.from, way) / way2, 0.0, 1.0) * way;
}

Encounters::Encounters(const Model& model, const BondIndex& index, const Exchange& exchange,
                       const std::vector<Support>& supports)
    : model_(model), index_(index), exchange_(exchange), bodies_(model.particles(), carried_by(supports)) {
  if (model.particles() == 0) return;
  const auto [min, max] = std::minmax_element(model.radius.begin(), model.radius.end());
  // a point may touch a ball, so that the least sum of two radii is not always twice the least one
  limit_ = 0.5 * longest_approach * (*min > 0.0 ? *min + *min : *max);
}

void Encounters::count_capsules(double radius) {
  limit_ = std::min(limit_, longest_approach * radius);
}

void Encounters::look_at_drift(const Bodies& bodies, double dt, double largest_way2, const Tensor* flow) {
  found_.clear();
  fastest_.reset();
  if (largest_way2 > sq(limit_) && find_fast(bodies, dt, flow)) find_passing(bodies, dt);
}

void Encounters::add_deep(const Bodies& bodies, const std::vector<std::pair<Row, Row>>& pairs) {
  for (const auto& [i, j] : pairs) {
    const Vec3d r = bodies.between(i, j);
    add(bodies.order, i, j, r, r);
  }
}

/// Takes down the particles that move too far against the mean of all: a body may fly as fast as it likes.
bool Encounters::find_fast(const Bodies& bodies, double dt, const Tensor* flow) {
  const std::size_t n = bodies.order.known;
  auto all = static_cast<double>(bodies.order.own);
  exchange_.sum({&all, 1});
  const auto velocity = [&](std::size_t k) {
    return flow == nullptr ? bodies.motion[k].v : bodies.motion[k].v - times(*flow, bodies.pose[k].r);
  };
  Vec3d mean;
  for (std::size_t k = 0; k < bodies.order.own; ++k) mean += velocity(k) / all;
  exchange_.sum({&mean.x, 3});
  fast_.clear();
  is_fast_.assign(n, 0);
  r_.clear();
  for (std::size_t k = 0; k < n; ++k) {
    const double way = dt * norm(velocity(k) - mean);
    if (!std::isfinite(way) || !is_finite(bodies.pose[k].r)) return false;  // the check of loads will tell
    r_.push_back(bodies.pose[k].r);
    if (!(way > limit_)) continue;
    fast_.push_back(Row{k});
    is_fast_[k] = 1;
    if (!fastest_ || way > fastest_->way) fastest_ = {bodies.order.particle[Row{k}], way, limit_};
  }
  return !fast_.empty();
}

/// All pairs of which one is fast, however far the step has taken it: no list of near pairs would have them.
void Encounters::find_passing(const Bodies& bodies, double dt) {
  std::vector<double> radius;
  for (std::size_t k = 0; k < r_.size(); ++k) radius.push_back(model_.radius[bodies.order.particle[Row{k}]]);
  SizedPoints points(radius, 2.0 * fastest_->way);
  points.sort(r_);
  for (const Row i : fast_)
    points.scan_near(i.value, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
      for (; first != last && found_.size() < most; ++first) {
        const Row j{first->i};
        if (j == i || (is_fast_[j.value] && j < i)) continue;
        const Vec3d to = between(r_[i.value], r_[j.value]);
        add(bodies.order, i, j, to - dt * (bodies.motion[j.value].v - bodies.motion[i.value].v), to);
      }
    });
}

void Encounters::share() {
  const std::vector<Encounter> of_all = exchange_.gather(found_);
  found_.clear();
  for (const Encounter& e : of_all) take_down(e);
  std::vector<FastParticle> fast;
  if (fastest_) fast.push_back(*fastest_);
  for (const FastParticle& f : exchange_.gather(fast))
    if (!fastest_ || f.way > fastest_->way || (f.way == fastest_->way && f.p < fastest_->p)) fastest_ = f;
}

/// Once, and not too many.
void Encounters::take_down(const Encounter& e) {
  const auto same = [&e](const Encounter& f) { return f.i == e.i && f.j == e.j && f.of_j == e.of_j; };
  if (found_.size() < most && std::none_of(found_.begin(), found_.end(), same)) found_.push_back(e);
}

void Encounters::add(const Order& order, Row row_i, Row row_j, const Vec3d& from, const Vec3d& to) {
  Encounter e{order.particle[row_i], order.particle[row_j], from, to};
  const Image n = order.image(row_j) - order.image(row_i);
  const bool as_it_is = e.i < e.j || (e.i == e.j && n > Image{});
  if (!as_it_is) e = {e.j, e.i, -from, -to};
  const Image of_j = e.of_j = as_it_is ? n : -n;
  const double deep2 = sq(deep_part * (model_.radius[e.i] + model_.radius[e.j]));
  if (!(norm2(nearest_point(e)) < deep2)) return;
  if (stood_together(model_, e.i, e.j) &&
      norm2(between(model_.r_0, cell_at_start(model_), e.i, e.j, of_j)) < deep2)
    return;  // it is meant
  if (index_.bonded(e.i, e.j, of_j) || bodies_.are_one(e.i, e.j, of_j)) return;
  if (index_.of_fibre(e.i) || index_.of_fibre(e.j)) return;  // as part of a fibre, not as a ball
  take_down(e);
}

}  // namespace vbond
