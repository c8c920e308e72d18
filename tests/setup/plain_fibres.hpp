#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

/// Fibres of a built case, judged pair by pair and by formulas of the tests' own.
namespace vbond::plain_fibres {

/// Each fibre as its points, which go on where it leaves the cell.
struct Chains {
  std::vector<std::vector<Vec3d>> points;
  std::array<Vec3d, 3> edges{};
  std::array<bool, 3> periodic{};
};

/// The bonds of chains are in the order of their particles.
inline Chains chains_of(const Built& b) {
  Chains chains;
  chains.edges = b.model.cell.edges;
  chains.periodic = b.model.cell.periodic;
  std::size_t last = 0;
  for (const Bond& bond : b.state.bonds) {
    // a chain goes on from its last particle; bonds through a face may be kept from the other end
    const bool forward = bond.i.value < bond.j.value;
    const std::size_t from = forward ? bond.i.value : bond.j.value,
                      to = forward ? bond.j.value : bond.i.value;
    if (to != from + 1) return {};
    if (chains.points.empty() || from != last) chains.points.push_back({b.model.r_0[ParticleId{from}]});
    Vec3d way = b.model.r_0[ParticleId{to}] - b.model.r_0[ParticleId{from}];
    const Image n = forward ? image_of_j(bond) : -image_of_j(bond);
    for (const auto& [k, count] : {std::pair{0, n.a}, {1, n.b}, {2, n.c}})
      way = way + static_cast<double>(count) * chains.edges[static_cast<std::size_t>(k)];
    chains.points.back().push_back(chains.points.back().back() + way);
    last = to;
  }
  return chains;
}

/// The least distance of p to a segment.
inline double to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const double l2 = norm2(b - a);
  return norm(a + std::clamp(l2 > 0.0 ? dot(p - a, b - a) / l2 : 0.0, 0.0, 1.0) * (b - a) - p);
}

/// Of two segments: the distance of a point of the first to the second is convex along the first.
inline double between_segments(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 80; ++k) {
    const double s = low + (high - low) / 3.0, t = high - (high - low) / 3.0;
    if (to_segment(a + s * (b - a), c, d) < to_segment(a + t * (b - a), c, d))
      high = t;
    else
      low = s;
  }
  return to_segment(a + 0.5 * (low + high) * (b - a), c, d);
}

/// The least distance of the axes of two fibres, or of a fibre and an image of its own: every fibre against
/// every image of every other one. Those farther apart than `enough` are passed over.
inline double least_distance(const Chains& chains, double enough) {
  std::vector<Vec3d> middle;
  std::vector<double> radius;  // of a ball around each fibre
  double extent = 0.0;
  for (const auto& p : chains.points) {
    middle.push_back(0.5 * (p.front() + p.back()));
    radius.push_back(0.0);
    for (const Vec3d& r : p) radius.back() = std::max(radius.back(), norm(r - middle.back()));
    for (const Vec3d& m : middle) extent = std::max(extent, norm(middle.back() - m));
  }
  const double widest = radius.empty() ? 0.0 : *std::max_element(radius.begin(), radius.end());
  std::array<int, 3> far{};
  for (std::size_t k = 0; k < 3; ++k)
    if (chains.periodic[k]) {
      const Vec3d &e = chains.edges[k], &f = chains.edges[(k + 1) % 3], &g = chains.edges[(k + 2) % 3];
      const double height = std::abs(dot(e, cross(f, g))) / norm(cross(f, g));
      far[k] = 1 + static_cast<int>(std::ceil((extent + 2.0 * widest + enough) / height));
    }
  double least = INFINITY;
  for (int x = -far[0]; x <= far[0]; ++x)
    for (int y = -far[1]; y <= far[1]; ++y)
      for (int z = -far[2]; z <= far[2]; ++z) {
        const Vec3d shift =
            double(x) * chains.edges[0] + double(y) * chains.edges[1] + double(z) * chains.edges[2];
        const bool itself = x == 0 && y == 0 && z == 0;
        for (std::size_t f = 0; f < chains.points.size(); ++f)
          for (std::size_t g = itself ? f + 1 : 0; g < chains.points.size(); ++g) {
            if (norm(middle[g] + shift - middle[f]) > radius[f] + radius[g] + enough) continue;
            const auto &p = chains.points[f], &q = chains.points[g];
            for (std::size_t i = 0; i + 1 < p.size(); ++i)
              for (std::size_t j = 0; j + 1 < q.size(); ++j) {
                const Vec3d apart = 0.5 * (q[j] + q[j + 1]) + shift - 0.5 * (p[i] + p[i + 1]);
                if (norm(apart) > 0.5 * (norm(q[j + 1] - q[j]) + norm(p[i + 1] - p[i])) + enough) continue;
                least = std::min(least, between_segments(p[i], p[i + 1], q[j] + shift, q[j + 1] + shift));
              }
          }
      }
  return least;
}

inline double contour(const std::vector<Vec3d>& p) {
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < p.size(); ++k) sum += norm(p[k + 1] - p[k]);
  return sum;
}

/// A case of this specimen of fibres, with its bonds.
inline Case fibres(const std::string& keys, const std::string& before = "", const std::string& after = "") {
  return parse_case(
      before + "[[specimen]]\nname = \"mat\"\nkind = \"fibres\"\n" + keys +
          "\n[[bonds]]\nfrom_specimen = true\ntheory = \"bernoulli-euler\"\nE = 1000\nnu = 0.3\n"
          "section = { shape = \"circle\", diameter = 0.1 }\n" +
          after + "[[stage]]\nduration = 1\n",
      "case.toml");
}

}  // namespace vbond::plain_fibres
