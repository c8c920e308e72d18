#pragma once
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {

/// Where in a part of space there is room for bodies of spheres: what stands there, with images of a periodic
/// body, and walls.
class FreeRoom {
 public:
  struct Ball {
    Vec3d r;
    double R = 0;
  };

  /// All that is present within the box, and the walls that the stage has. largest: no ball asked for has a
  /// larger radius.
  FreeRoom(const Model& model, const Stage& stage, const State& state, const BoundingBox& box,
           double largest);

  /// Whether a body overlaps nothing: what is there, walls, images of itself. The balls of one body may
  /// overlap.
  bool has_room_for(const std::vector<Ball>& body) const;
  /// The body stands there from now on.
  void take(const std::vector<Ball>& body);

 private:
  using Key = std::uint64_t;
  Key key_of(std::int64_t x, std::int64_t y, std::int64_t z) const;
  std::int64_t cell_of(double x, double low) const;
  void add(const Ball& ball);
  void add_with_images(const Ball& ball);
  bool meets_walls(const Ball& ball) const;
  bool meets_balls(const Ball& ball) const;
  bool meets_its_images(const std::vector<Ball>& body) const;

  struct StandingWall {
    WallSurface surface;
    std::size_t index;
  };
  const Model& model_;
  CellEdges cell_;
  std::vector<WallState> wall_states_;
  BoundingBox box_;
  double width_ = 1.0;    // of the cells of the table, at least two of the largest radii
  double largest_ = 0.0;  // radius of what stands here and of what is asked for
  std::vector<StandingWall> walls_;
  std::vector<Ball> balls_;
  std::unordered_map<Key, std::vector<std::uint32_t>> table_;  // balls by the cells of their centres
};

}  // namespace vbond
