#include "vbond/dynamics/borders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "vbond/core/images.hpp"

namespace vbond {
namespace {

constexpr double rounding = 1e-9;  // a particle too many does no harm

/// What some particles are in, along three coordinates. Empty: low is above high.
struct Box {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{inf, inf, inf}, high{-inf, -inf, -inf};
};

/// The coordinates by which particles are near: places, or of a periodic body parts of the edges of its cell,
/// where whole numbers along periodic edges make no difference.
class Coordinates {
 public:
  Coordinates(const Model& model, const State& state, double reach)
      : cell_(state.cell), periodic_(cell_.empty() ? Periodic{} : model.cell.periodic) {
    const Vec3d h = cell_.empty() ? Vec3d{1.0, 1.0, 1.0} : heights(cell_);
    for (std::size_t k = 0; k < 3; ++k) reach_[k] = reach / component(h, static_cast<int>(k)) + rounding;
  }

  std::array<double, 3> of(const Vec3d& r) const {
    const Vec3d s = cell_.empty() ? r : in_edges(cell_, r);
    std::array<double, 3> x{s.x, s.y, s.z};
    for (std::size_t k = 0; k < 3; ++k)
      if (periodic_[k]) x[k] -= std::floor(x[k]);
    return x;
  }
  bool are_near(const Box& a, const Box& b) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (!are_near(k, a.low[k], a.high[k], b.low[k], b.high[k])) return false;
    return true;
  }
  bool is_near(const std::array<double, 3>& x, const Box& b) const { return are_near({x, x}, b); }

 private:
  /// Of intervals: there is a whole number by which one is moved near the other, 0 along open edges.
  bool are_near(std::size_t k, double low, double high, double other_low, double other_high) const {
    const double least = other_low - reach_[k] - high, most = other_high + reach_[k] - low;
    return periodic_[k] ? std::ceil(least) <= std::floor(most) : least <= 0.0 && most >= 0.0;
  }

  const CellEdges& cell_;
  Periodic periodic_;
  std::array<double, 3> reach_{};
};

}  // namespace

std::vector<PlacedParticle> particles_across_borders(const Model& model, const State& state,
                                                     const std::vector<ParticleId>& own, double reach,
                                                     const Exchange& exchange) {
  const Coordinates coordinates(model, state, reach);
  Box mine;
  for (const ParticleId p : own) {
    const std::array<double, 3> x = coordinates.of(state.r[p]);
    for (std::size_t k = 0; k < 3; ++k)
      mine.low[k] = std::min(mine.low[k], x[k]), mine.high[k] = std::max(mine.high[k], x[k]);
  }
  const std::vector<Box> boxes = exchange.gather(std::vector<Box>{mine});
  std::vector<std::size_t> near_parts;
  for (std::size_t k = 0; k < boxes.size(); ++k)
    if (static_cast<int>(k) != exchange.rank() && coordinates.are_near(mine, boxes[k]))
      near_parts.push_back(k);

  std::vector<std::vector<PlacedParticle>> told(boxes.size());
  for (const ParticleId p : own) {
    const std::array<double, 3> x = coordinates.of(state.r[p]);
    for (const std::size_t k : near_parts)
      if (coordinates.is_near(x, boxes[k])) told[k].push_back({p, exchange.rank(), state.r[p], model.r_0[p]});
  }
  std::vector<PlacedParticle> across;
  for (const std::vector<PlacedParticle>& some : exchange.swap(told))
    across.insert(across.end(), some.begin(), some.end());
  return across;
}

}  // namespace vbond
