#include "vbond/model/free_room.hpp"

#include <algorithm>
#include <cmath>

#include "vbond/core/images.hpp"

namespace vbond {
namespace {

bool overlap(const FreeRoom::Ball& a, const FreeRoom::Ball& b) {
  return norm2(between(a.r, b.r)) < sq(a.R + b.R);
}

}  // namespace

FreeRoom::FreeRoom(const Model& model, const Stage& stage, const State& state, const BoundingBox& box,
                   double largest)
    : model_(model), cell_(state.cell), wall_states_(state.walls), box_(box), largest_(largest) {
  for (const ParticleId p : model.radius.ids())
    if (!is_absent(state, p)) largest_ = std::max(largest_, model.radius[p]);
  const Vec3d wide{2.0 * largest_, 2.0 * largest_, 2.0 * largest_};
  box_.low -= wide, box_.high += wide;
  width_ = largest_ > 0.0 ? 2.0 * largest_ * (1.0 + 1e-9) : std::max(box_.diagonal(), 1e-300);
  std::vector<char> off(model.walls.size(), 0);
  for (const WallDrive& d : stage.walls) off[d.index] = d.off ? 1 : 0;
  for (std::size_t w = 0; w < model.walls.size(); ++w)
    if (off[w] == 0) walls_.push_back({WallSurface(model.walls[w].shape), w});
  for (const ParticleId p : model.radius.ids())
    if (!is_absent(state, p)) add_with_images({state.r[p], model.radius[p]});
}

std::int64_t FreeRoom::cell_of(double x, double low) const {
  return static_cast<std::int64_t>(std::floor((x - low) / width_));
}

FreeRoom::Key FreeRoom::key_of(std::int64_t x, std::int64_t y, std::int64_t z) const {
  constexpr Key mask = (Key{1} << 21) - 1;  // cells that share a key cost a look at some balls too many
  return (static_cast<Key>(x) & mask) | (static_cast<Key>(y) & mask) << 21 |
         (static_cast<Key>(z) & mask) << 42;
}

void FreeRoom::add(const Ball& b) {
  const Vec3d &r = b.r, &low = box_.low, &high = box_.high;
  if (r.x < low.x || r.y < low.y || r.z < low.z || r.x > high.x || r.y > high.y || r.z > high.z) return;
  table_[key_of(cell_of(r.x, low.x), cell_of(r.y, low.y), cell_of(r.z, low.z))].push_back(
      static_cast<std::uint32_t>(balls_.size()));
  balls_.push_back(b);
}

void FreeRoom::add_with_images(const Ball& b) {
  if (cell_.empty()) return add(b);
  for_images_in(box_, cell_, model_.cell.periodic, b.r, [&](const Image& n) {
    add({b.r + to_image(cell_, n), b.R});
  });
}

bool FreeRoom::meets_walls(const Ball& b) const {
  std::vector<WallTouch> touches;
  for (const auto& [surface, index] : walls_) {
    const Vec3d r =
        index < wall_states_.size() ? at_start(model_.walls[index], wall_states_[index], b.r) : b.r;
    if (!surface.may_touch(r, b.R)) continue;
    touches.clear();
    surface.touches(r, b.R, touches);
    if (!touches.empty()) return true;
  }
  return false;
}

bool FreeRoom::meets_balls(const Ball& b) const {
  const std::int64_t x = cell_of(b.r.x, box_.low.x), y = cell_of(b.r.y, box_.low.y),
                     z = cell_of(b.r.z, box_.low.z);
  for (std::int64_t k = z - 1; k <= z + 1; ++k)
    for (std::int64_t j = y - 1; j <= y + 1; ++j)
      for (std::int64_t i = x - 1; i <= x + 1; ++i) {
        const auto at = table_.find(key_of(i, j, k));
        if (at == table_.end()) continue;
        for (const std::uint32_t n : at->second)
          if (overlap(balls_[n], b)) return true;
      }
  return false;
}

bool FreeRoom::meets_its_images(const std::vector<Ball>& body) const {
  if (cell_.empty()) return false;
  BoundingBox around;
  for (const Ball& b : body) around.add(b.r, b.R);
  const Vec3d height = heights(cell_);
  const double size = around.diagonal();
  std::array<std::int32_t, 3> most{};
  for (int k = 0; k < 3; ++k)
    if (model_.cell.periodic[static_cast<std::size_t>(k)])
      most[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::ceil(size / component(height, k)));
  for (std::int32_t a = 0; a <= most[0]; ++a)  // of two opposite images one is enough
    for (std::int32_t b = -most[1]; b <= most[1]; ++b)
      for (std::int32_t c = -most[2]; c <= most[2]; ++c) {
        const Image n{a, b, c};
        if (!(n > Image{})) continue;
        const Vec3d way = to_image(cell_, n);
        for (const Ball& x : body)
          for (const Ball& y : body)
            if (overlap(x, {y.r + way, y.R})) return true;
      }
  return false;
}

bool FreeRoom::has_room_for(const std::vector<Ball>& body) const {
  return std::none_of(body.begin(), body.end(),
                      [this](const Ball& b) { return meets_balls(b) || meets_walls(b); }) &&
         !meets_its_images(body);
}

void FreeRoom::take(const std::vector<Ball>& body) {
  for (const Ball& b : body) add_with_images(b);
}

}  // namespace vbond
