#include "vbond/core/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include "vbond/core/scalar.hpp"

namespace vbond {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t deepest = 64;  // halves of fewer than 2^32 triangles

BoundingBox box_of(const TriangleMesh& mesh, std::size_t k) {
  BoundingBox box;
  for (const std::uint32_t corner : mesh.triangles[k]) box.add(mesh.corners[corner]);
  return box;
}

}  // namespace

TrianglePoint closest_on_triangle(const Vec3d& r, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  using enum TrianglePart;
  const Vec3d ab = b - a, ac = c - a, ar = r - a, br = r - b, cr = r - c;
  const double ab_a = dot(ab, ar), ac_a = dot(ac, ar);
  if (ab_a <= 0.0 && ac_a <= 0.0) return {a, corner_0};
  const double ab_b = dot(ab, br), ac_b = dot(ac, br);
  if (ab_b >= 0.0 && ac_b <= ab_b) return {b, corner_1};
  const double w_c = ab_a * ac_b - ab_b * ac_a;  // weights of the corners, times 4 area^2
  if (w_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return {a + (ab_a / (ab_a - ab_b)) * ab, edge_01};
  const double ab_c = dot(ab, cr), ac_c = dot(ac, cr);
  if (ac_c >= 0.0 && ab_c <= ac_c) return {c, corner_2};
  const double w_b = ab_c * ac_a - ab_a * ac_c;
  if (w_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return {a + (ac_a / (ac_a - ac_c)) * ac, edge_20};
  const double w_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (w_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0)
    return {b + (from_b / (from_b + from_c)) * (c - b), edge_12};
  const double sum = w_a + w_b + w_c;
  return {a + (w_b / sum) * ab + (w_c / sum) * ac, face};
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) : order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<BoundingBox> boxes;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    boxes.push_back(box_of(mesh, k));
    box_.join(boxes.back());
  }
  if (!order_.empty()) split(0, static_cast<std::uint32_t>(order_.size()), boxes);
  for (const std::uint32_t k : order_) boxes_.push_back(boxes[k]);
}

/// A node of these triangles and all below it; halves by the middles of the boxes along the longest side.
void TriangleTree::split(std::uint32_t first, std::uint32_t count, const std::vector<BoundingBox>& boxes) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({{}, first, count, 0});
  for (std::uint32_t k = first; k < first + count; ++k) nodes_[node].box.join(boxes[order_[k]]);
  if (count <= leaf_size) return;
  const int axis = nodes_[node].box.axes_by_length()[0];
  const auto middle = [&](std::uint32_t k) {
    return component(boxes[k].low, axis) + component(boxes[k].high, axis);
  };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](std::uint32_t i, std::uint32_t j) {
    return middle(i) != middle(j) ? middle(i) < middle(j) : i < j;
  });
  split(first, count / 2, boxes);
  nodes_[node].second = static_cast<std::uint32_t>(nodes_.size());
  split(first + count / 2, count - count / 2, boxes);
}

bool TriangleTree::may_be_near(const Vec3d& r, double reach) const {
  return reach > 0.0 && box_.distance2(r) < sq(reach);
}

void TriangleTree::near(const Vec3d& r, double reach, std::vector<std::uint32_t>& triangles) const {
  if (!may_be_near(r, reach)) return;
  const auto found = static_cast<std::ptrdiff_t>(triangles.size());
  std::array<std::uint32_t, deepest> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t at = waiting[--count];
    const Node& node = nodes_[at];
    if (node.box.distance2(r) >= sq(reach)) continue;
    if (node.second != 0) {
      waiting[count++] = node.second;
      waiting[count++] = at + 1;
    } else {
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
        if (boxes_[k].distance2(r) < sq(reach)) triangles.push_back(order_[k]);
    }
  }
  std::sort(triangles.begin() + found, triangles.end());
}

}  // namespace vbond
