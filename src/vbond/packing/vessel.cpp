#include "vbond/packing/vessel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/images.hpp"
#include "vbond/packing/voronoi.hpp"

namespace vbond::packing {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A wall with one nearest place at most: a function of the depth and its gradient.
class SmoothWall : public Wall {
 public:
  double depth(const Vec3d& r) const final { return nearest(r).depth; }
  void feel(const Vec3d& r, double reach, std::vector<Feel>& out) const final {
    const Feel f = nearest(r);
    if (f.depth < reach) out.push_back(f);
  }

 protected:
  virtual Feel nearest(const Vec3d& r) const = 0;
};

class HalfSpace final : public SmoothWall {
 public:
  HalfSpace(const Vec3d& point, const Vec3d& normal) : point_(point), inward_(-normal) {}
  bool add_planes(std::vector<Plane>& planes) const override {
    planes.push_back({-inward_, -dot(point_, inward_)});
    return true;
  }

 protected:
  Feel nearest(const Vec3d& r) const override { return {dot(r - point_, inward_), inward_}; }

 private:
  Vec3d point_, inward_;
};

/// Any direction where there is none: a point on an axis is as far from the wall all around.
Vec3d direction_of(const Vec3d& d, double length, const Vec3d& otherwise) {
  return length > 0.0 ? d / length : otherwise;
}
Vec3d normal_to(const Vec3d& e) {
  const Vec3d other = std::abs(e.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalised(cross(e, other));
}

class Ball final : public SmoothWall {
 public:
  Ball(const Vec3d& centre, double radius, bool inside) : centre_(centre), radius_(radius), inside_(inside) {}
  bool add_planes(std::vector<Plane>& planes) const override {
    if (!inside_) return false;
    for (const Plane& p : planes_around_ball())
      planes.push_back({p.normal, radius_ * p.at + dot(centre_, p.normal)});
    return true;
  }

 protected:
  Feel nearest(const Vec3d& r) const override {
    const Vec3d d = r - centre_;
    const double distance = norm(d);
    const Vec3d out = direction_of(d, distance, {1, 0, 0});
    if (inside_) return {radius_ - distance, -out};
    return {distance - radius_, out};
  }

 private:
  Vec3d centre_;
  double radius_;
  bool inside_;
};

class Tube final : public SmoothWall {
 public:
  Tube(const Vec3d& point, const Vec3d& axis, double radius) : point_(point), axis_(axis), radius_(radius) {}
  bool add_planes(std::vector<Plane>& planes) const override {
    for (const Plane& p : planes_around_cylinder(axis_))
      planes.push_back({p.normal, radius_ * p.at + dot(point_, p.normal)});
    return true;
  }

 protected:
  Feel nearest(const Vec3d& r) const override {
    const Vec3d d = r - point_, across = d - dot(d, axis_) * axis_;
    const double distance = norm(across);
    return {radius_ - distance, -direction_of(across, distance, normal_to(axis_))};
  }

 private:
  Vec3d point_, axis_;
  double radius_;
};

class AroundCylinder final : public SmoothWall {
 public:
  AroundCylinder(const Vec3d& from, const Vec3d& to, double radius)
      : centre_(0.5 * (from + to)),
        axis_(normalised(to - from)),
        half_(0.5 * norm(to - from)),
        radius_(radius) {}

 protected:
  Feel nearest(const Vec3d& r) const override {
    const Vec3d d = r - centre_;
    const double along = dot(d, axis_);
    const Vec3d across = d - along * axis_;
    const double distance = norm(across);
    const Vec3d out = direction_of(across, distance, normal_to(axis_)), end = along < 0.0 ? -axis_ : axis_;
    const double side = distance - radius_, cap = std::abs(along) - half_;
    if (side > 0.0 && cap > 0.0) {  // the rim is nearest
      const double far = std::hypot(side, cap);
      return {far, (side / far) * out + (cap / far) * end};
    }
    if (side > cap) return {side, out};
    return {cap, end};
  }

 private:
  Vec3d centre_, axis_;
  double half_, radius_;
};

class AroundBox final : public SmoothWall {
 public:
  AroundBox(const Vec3d& min, const Vec3d& max) : centre_(0.5 * (min + max)), half_(0.5 * (max - min)) {}

 protected:
  Feel nearest(const Vec3d& r) const override {
    const Vec3d d = r - centre_;
    const Vec3d out{std::abs(d.x) - half_.x, std::abs(d.y) - half_.y, std::abs(d.z) - half_.z};
    const Vec3d sign{std::copysign(1.0, d.x), std::copysign(1.0, d.y), std::copysign(1.0, d.z)};
    const Vec3d outside{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)};
    const double far = norm(outside);
    if (far > 0.0) return {far, Vec3d{sign.x * outside.x, sign.y * outside.y, sign.z * outside.z} / far};
    if (out.x >= out.y && out.x >= out.z) return {out.x, {sign.x, 0, 0}};
    if (out.y >= out.z) return {out.y, {0, sign.y, 0}};
    return {out.z, {0, 0, sign.z}};
  }

 private:
  Vec3d centre_, half_;
};

class AroundSlab final : public SmoothWall {
 public:
  AroundSlab(const Vec3d& point, const Vec3d& normal, double half)
      : point_(point), normal_(normal), half_(half) {}

 protected:
  Feel nearest(const Vec3d& r) const override {
    const double across = dot(r - point_, normal_);
    return {std::abs(across) - half_, across < 0.0 ? -normal_ : normal_};
  }

 private:
  Vec3d point_, normal_;
  double half_;
};

}  // namespace

std::shared_ptr<const Wall> half_space(const Vec3d& point, const Vec3d& normal) {
  return std::make_shared<HalfSpace>(point, normal);
}
std::shared_ptr<const Wall> ball(const Vec3d& centre, double radius, bool inside) {
  return std::make_shared<Ball>(centre, radius, inside);
}
std::shared_ptr<const Wall> tube(const Vec3d& point, const Vec3d& axis, double radius) {
  return std::make_shared<Tube>(point, axis, radius);
}
std::shared_ptr<const Wall> around_cylinder(const Vec3d& from, const Vec3d& to, double radius) {
  return std::make_shared<AroundCylinder>(from, to, radius);
}
std::shared_ptr<const Wall> around_box(const Vec3d& min, const Vec3d& max) {
  return std::make_shared<AroundBox>(min, max);
}
std::shared_ptr<const Wall> around_slab(const Vec3d& point, const Vec3d& normal, double half_width) {
  return std::make_shared<AroundSlab>(point, normal, half_width);
}

Vec3d Vessel::in_cell(const Vec3d& r) const {
  if (cell.empty()) return r;
  return r + to_image(cell, image_in_cell(cell, periodic, corner, r));
}

double Vessel::depth(const Vec3d& r) const {
  double least = infinite;
  if (walls.empty()) return least;
  const Vec3d in = in_cell(r);
  for (const auto& wall : walls) least = std::min(least, wall->depth(in));
  return least;
}

void Vessel::feel(const Vec3d& r, double reach, std::vector<Feel>& out) const {
  if (walls.empty()) return;
  const Vec3d in = in_cell(r);
  for (const auto& wall : walls) wall->feel(in, reach, out);
}

void set_frame(Vessel& vessel, const BoundingBox& box) {
  const Vec3d size = box.high - box.low;
  vessel.corner = box.low;
  vessel.edges = {Vec3d{size.x, 0, 0}, Vec3d{0, size.y, 0}, Vec3d{0, 0, size.z}};
}

void add_box(Vessel& vessel, const Vec3d& min, const Vec3d& max) {
  for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    vessel.walls.push_back(half_space(min, -e));
    vessel.walls.push_back(half_space(max, e));
  }
}

void add_cylinder(Vessel& vessel, const Vec3d& from, const Vec3d& to, double radius) {
  const Vec3d axis = normalised(to - from);
  vessel.walls.push_back(tube(from, axis, radius));
  vessel.walls.push_back(half_space(from, -axis));
  vessel.walls.push_back(half_space(to, axis));
}

namespace {

/// A part of the frame, [low, low + size] in parts of the edges.
struct FramePart {
  Vec3d low;
  double size = 1;
};

double longest_diagonal(const std::array<Vec3d, 3>& e) {
  return std::max({norm(e[0] + e[1] + e[2]), norm(e[0] + e[1] - e[2]), norm(e[0] - e[1] + e[2]),
                   norm(e[1] + e[2] - e[0])});
}

}  // namespace

double volume_deeper_than(const Vessel& vessel, double depth) {
  if (vessel.walls.empty()) return vessel.frame_volume();
  constexpr double smallest = 1.0 / 256;  // parts of the edges
  const double diagonal = longest_diagonal(vessel.edges);
  const double least_edge = std::min({norm(vessel.edges[0]), norm(vessel.edges[1]), norm(vessel.edges[2])});
  double share = 0.0;
  std::vector<FramePart> parts{{}};
  while (!parts.empty()) {
    const FramePart p = parts.back();
    parts.pop_back();
    const double half = 0.5 * p.size;
    const double d = vessel.depth(vessel.at(p.low + Vec3d{half, half, half})) - depth;
    const double reach = half * diagonal;
    if (d <= -reach) continue;
    if (d >= reach) {
      share += p.size * p.size * p.size;
      continue;
    }
    if (p.size > smallest) {
      for (int k = 0; k < 8; ++k)
        parts.push_back({p.low + half * Vec3d{double(k & 1), double(k >> 1 & 1), double(k >> 2)}, half});
      continue;
    }
    // the wall is flat here and passes anywhere: what one part counts too much others count too little
    share += p.size * p.size * p.size * std::clamp(0.5 + d / (p.size * least_edge), 0.0, 1.0);
  }
  return share * vessel.frame_volume();
}

double largest_radius(const Vessel& vessel) {
  double most = infinite;
  if (!vessel.cell.empty() && (vessel.periodic[0] || vessel.periodic[1] || vessel.periodic[2])) {
    const Image n = nearest_image(vessel.cell, vessel.periodic, vessel.corner, vessel.corner);
    most = 0.5 * norm(to_image(vessel.cell, n));
  }
  if (vessel.walls.empty()) return most;
  // Depth changes by no more than the way: parts that cannot hold a deeper place than is known are left out.
  const double diagonal = longest_diagonal(vessel.edges);
  double deepest = 0.0;
  std::vector<FramePart> parts{{}}, next;
  for (double size = 1.0; !parts.empty() && size * diagonal > 0.01 * deepest && size > 1e-3; size *= 0.5) {
    std::vector<double> at(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const double half = 0.5 * parts[k].size;
      at[k] = vessel.depth(vessel.at(parts[k].low + Vec3d{half, half, half}));
      deepest = std::max(deepest, at[k]);
    }
    next.clear();
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const double half = 0.5 * parts[k].size;
      if (at[k] + half * diagonal <= 1.01 * deepest) continue;
      for (int c = 0; c < 8; ++c)
        next.push_back(
            {parts[k].low + half * Vec3d{double(c & 1), double(c >> 1 & 1), double(c >> 2)}, half});
    }
    parts.swap(next);
  }
  return std::min(most, deepest);
}

}  // namespace vbond::packing
