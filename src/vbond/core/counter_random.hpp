#pragma once
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"

namespace vbond {

/// Random numbers that follow from a key alone, the same on every machine: nothing of them has to be kept.
/// The mixing function is that of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
class CounterRandom {
 public:
  CounterRandom(std::initializer_list<std::uint64_t> key) {
    for (const std::uint64_t word : key) state_ = mixed(state_ + golden + word);
  }

  /// Uniform in [0, 1), from the upper 53 bits.
  double uniform() { return static_cast<double>(mixed(state_ += golden) >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal, Box & Muller (1958); 1 - u lies in (0, 1], so the logarithm is finite.
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  Vec3d gaussian_vector() {
    const double x = gaussian(), y = gaussian(), z = gaussian();
    return {x, y, z};
  }

  /// Uniform over all rotations: K. Shoemake, Graphics Gems III (1992) 124.
  Quatd rotation() {
    const double u = uniform(), v = 2.0 * std::numbers::pi * uniform(),
                 w = 2.0 * std::numbers::pi * uniform();
    const double a = std::sqrt(1.0 - u), b = std::sqrt(u);
    return normalised(Quatd{b * std::cos(w), a * std::sin(v), a * std::cos(v), b * std::sin(w)});
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;
  static constexpr std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint64_t state_ = 0;
};

}  // namespace vbond
