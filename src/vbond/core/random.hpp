#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Random numbers that are the same on every machine: the generator is fixed by the C++ standard, the
/// distributions of its library are not, so they are written here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  /// Uniform in [0, 1), from the upper 53 bits.
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }

  /// Standard normal, Box & Muller (1958); 1 - u lies in (0, 1], so the logarithm is finite.
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  /// Uniform over the area of the unit disc: two coordinates, and zero.
  Vec3d in_disc() {
    for (;;) {
      const double x = 2.0 * uniform() - 1.0, y = 2.0 * uniform() - 1.0;
      if (x * x + y * y <= 1.0) return {x, y, 0.0};
    }
  }

  /// Uniform over the volume of the unit ball.
  Vec3d in_ball() {
    for (;;) {
      const double x = 2.0 * uniform() - 1.0, y = 2.0 * uniform() - 1.0, z = 2.0 * uniform() - 1.0;
      if (x * x + y * y + z * z <= 1.0) return {x, y, z};
    }
  }

  /// Uniform over the unit half-sphere z >= 0 (Archimedes: z is uniform).
  Vec3d on_half_sphere() {
    const double z = uniform(), phi = 2.0 * std::numbers::pi * uniform(), rho = std::sqrt(1.0 - z * z);
    return {rho * std::cos(phi), rho * std::sin(phi), z};
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace vbond
