#pragma once
#include <vector>

#include "vbond/core/triangle_mesh.hpp"
#include "vbond/core/triangle_tree.hpp"
#include "vbond/setup/mesh_inside.hpp"

namespace vbond {

/// The closed surfaces of a mesh whose edges have an even number of triangles: what hangs together by edges
/// of two triangles, and by more where that leaves an edge open, or triangles that face opposite ways.
std::vector<TriangleMesh> closed_parts(const TriangleMesh& mesh);

/// Whether triangles that meet in an edge face the same side: each edge goes as often one way as the other.
bool face_alike(const TriangleMesh& mesh);

/// Whether an edge has more than two triangles.
bool has_crowded_edge(const TriangleMesh& mesh);

/// How two closed surfaces lie to each other. Touching is neither crossing nor lying within.
enum class Position { apart, crossing, first_within, second_within };

/// Finds how surfaces lie that are not the same. What differs by less than `same` is touching.
class PositionFinder {
 public:
  PositionFinder(const std::vector<ClosedSurface>& surfaces, double same);
  Position operator()(std::size_t i, std::size_t j) const;

 private:
  struct Side {
    bool within = false, outside = false;
  };
  bool some_triangles_cross(std::size_t i, std::size_t j) const;
  Side side_of(std::size_t i, std::size_t of) const;

  const std::vector<ClosedSurface>& surfaces_;
  std::vector<TriangleTree> trees_;
  double same_;
};

}  // namespace vbond
