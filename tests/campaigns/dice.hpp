#pragma once
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <random>

#include "vbond/core/quat.hpp"

namespace vbond::testing {

/// Random numbers from a seed, the same on every machine: the bits of a 64-bit Mersenne twister.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}

  /// Evenly from low to below high.
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  bool chance(double p) { return (*this)(0.0, 1.0) < p; }
  /// 0 to n - 1.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>((*this)(0.0, static_cast<double>(n))); }
  /// Both ends included.
  std::size_t count(std::size_t least, std::size_t most) { return least + below(most - least + 1); }
  int whole(int low, int high) { return low + static_cast<int>((*this)(0.0, high - low + 1.0)); }
  /// Equal chances for equal ratios.
  double ratio(double low, double high) { return std::exp((*this)(std::log(low), std::log(high))); }
  std::size_t log_count(double low, double high) {
    return static_cast<std::size_t>(std::lround(ratio(low, high)));
  }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(values.size())];
  }

  /// Evenly in a cube.
  Vec3d vector(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size), z = (*this)(-size, size);
    return {x, y, z};
  }
  /// A unit vector, no direction before others.
  Vec3d direction() {
    Vec3d e = vector(1.0);
    while (norm(e) < 0.2 || norm(e) > 1.0) e = vector(1.0);
    return normalised(e);
  }
  Quatd rotation(double largest_angle) {
    Vec3d axis = vector(1.0);
    while (norm(axis) < 0.1) axis = vector(1.0);
    return rotation_of((*this)(0.0, largest_angle) * normalised(axis));
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace vbond::testing
