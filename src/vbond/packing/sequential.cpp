#include "vbond/packing/sequential.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"

namespace vbond::packing {
namespace {

/// Spheres that stand already, of sizes within a factor of two, in a grid of cells as wide as the largest of
/// them: a smaller one reaches into neighbouring cells at most. Images stand in it as the spheres do.
class Standing {
 public:
  Standing(const BoundingBox& box, double largest, std::size_t expected) : low_(box.low), largest_(largest) {
    const Vec3d size = box.high - box.low;
    const double cells = 8.0 * static_cast<double>(expected) + 64.0;
    width_ = std::max(2.0 * largest, std::cbrt(size.x * size.y * size.z / cells));
    for (int k = 0; k < 3; ++k)
      count_[k] = 1 + static_cast<std::int64_t>(std::min(component(size, k) / width_, 1e4));
    first_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), none);
  }

  double largest() const { return largest_; }

  void add(const Vec3d& r, double R) {
    std::uint32_t& first = first_[cell(at(r, 0), at(r, 1), at(r, 2))];
    spheres_.push_back({r, R, first});
    first = static_cast<std::uint32_t>(spheres_.size() - 1);
  }

  bool is_free(const Vec3d& r, double R) const {
    const std::int64_t x = at(r, 0), y = at(r, 1), z = at(r, 2);
    for (std::int64_t k = std::max<std::int64_t>(z - 1, 0); k <= std::min(z + 1, count_[2] - 1); ++k)
      for (std::int64_t j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, count_[1] - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, count_[0] - 1); ++i)
          for (std::uint32_t s = first_[cell(i, j, k)]; s != none; s = spheres_[s].next)
            if (norm2(between(spheres_[s].r, r)) < sq(spheres_[s].R + R)) return false;
    return true;
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFF;
  struct Sphere {
    Vec3d r;
    double R;
    std::uint32_t next;  // in the same cell
  };
  std::int64_t at(const Vec3d& r, int k) const {
    const double x = (component(r, k) - component(low_, k)) / width_;
    return std::clamp(static_cast<std::int64_t>(x), std::int64_t{0}, count_[k] - 1);
  }
  std::size_t cell(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>(x + count_[0] * (y + count_[1] * z));
  }

  Vec3d low_;
  double largest_, width_ = 1;
  std::int64_t count_[3] = {};
  std::vector<std::uint32_t> first_;
  std::vector<Sphere> spheres_;
};

/// Spheres of all sizes, and their images where a sphere may meet them.
class Placed {
 public:
  Placed(const Vessel& vessel, std::span<const double> radii)
      : vessel_(vessel), reach_(2.0 * radii.front()), radii_(radii) {
    for (int k = 0; k < 8; ++k)
      box_.add(vessel.at({double(k & 1), double(k >> 1 & 1), double(k >> 2)}), reach_);
    if (vessel.cell.empty()) return;
    // images whose cells come within reach of the cell
    const Vec3d height = heights(vessel.cell);
    const auto most = [&](int k) {
      return vessel.periodic[static_cast<std::size_t>(k)]
                 ? static_cast<std::int32_t>(std::ceil(reach_ / component(height, k)))
                 : 0;
    };
    for (std::int32_t a = -most(0); a <= most(0); ++a)
      for (std::int32_t b = -most(1); b <= most(1); ++b)
        for (std::int32_t c = -most(2); c <= most(2); ++c)
          if (const Image n{a, b, c}; !n.is_itself()) images_.push_back(to_image(vessel.cell, n));
  }

  bool is_free(const Vec3d& r, double R) const {
    return std::all_of(sizes_.begin(), sizes_.end(), [&](const Standing& s) { return s.is_free(r, R); });
  }

  void add(const Vec3d& r, double R, std::size_t number) {
    if (sizes_.empty() || R < 0.5 * sizes_.back().largest())
      sizes_.emplace_back(box_, R, radii_.size() - number);
    sizes_.back().add(r, R);
    for (const Vec3d& shift : images_)
      if (is_near(r + shift)) sizes_.back().add(r + shift, R);
  }

 private:
  bool is_near(const Vec3d& image) const {
    const Vec3d s = in_edges(vessel_.cell, image - vessel_.corner), height = heights(vessel_.cell);
    for (int k = 0; k < 3; ++k) {
      const double margin = reach_ / component(height, k);
      if (component(s, k) < -margin || component(s, k) > 1.0 + margin) return false;
    }
    return true;
  }

  const Vessel& vessel_;
  double reach_;
  std::span<const double> radii_;
  BoundingBox box_;
  std::vector<Vec3d> images_;
  std::vector<Standing> sizes_;
};

}  // namespace

std::vector<Vec3d> add_sequentially(const Vessel& vessel, std::span<const double> radii, Random& random,
                                    std::size_t most_draws) {
  std::vector<Vec3d> r;
  if (radii.empty()) return r;
  Placed placed(vessel, radii);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    bool found = false;
    for (std::size_t draw = 0; draw < most_draws && !found; ++draw) {
      const double a = random.uniform(), b = random.uniform(), c = random.uniform();
      const Vec3d at = vessel.at({a, b, c});
      if (vessel.depth(at) < radii[i] || !placed.is_free(at, radii[i])) continue;
      placed.add(at, radii[i], i);
      r.push_back(at);
      found = true;
    }
    if (!found) break;
  }
  return r;
}

}  // namespace vbond::packing
