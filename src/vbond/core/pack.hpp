#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "vbond/core/portable.hpp"

namespace vbond {

/// A vector register of W doubles, in the compilers' own extension (g++ and clang).
template <std::size_t W>
struct NativePack;
template <>
struct NativePack<2> {
  using Type [[gnu::vector_size(16)]] = double;
};
template <>
struct NativePack<4> {
  using Type [[gnu::vector_size(32)]] = double;
};
template <>
struct NativePack<8> {
  using Type [[gnu::vector_size(64)]] = double;
};

/// W doubles on which a law is evaluated at once. A scalar in the sense of `Scalar`: every lane rounds as a
/// double does.
template <std::size_t W>
struct Pack {
  using Native = typename NativePack<W>::Type;
  Native v;

  Pack() = default;
  VBOND_HD explicit Pack(double s) : v(Native{} + s) {}
  VBOND_HD explicit Pack(Native lanes) : v(lanes) {}

  static VBOND_HD Pack load(const double* from) {
    Pack p;
    std::memcpy(&p.v, from, sizeof p.v);
    return p;
  }
  VBOND_HD void store(double* to) const { std::memcpy(to, &v, sizeof v); }

  friend VBOND_HD Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
  friend VBOND_HD Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
  friend VBOND_HD Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
  friend VBOND_HD Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  friend VBOND_HD Pack operator-(const Pack& a) { return Pack(-a.v); }
  /// Lane by lane; b where a lane is NaN in either.
  friend VBOND_HD Pack max(const Pack& a, const Pack& b) { return Pack(a.v > b.v ? a.v : b.v); }
  friend VBOND_HD Pack sqrt(const Pack& a) {
    Native root;
    for (std::size_t l = 0; l < W; ++l) root[l] = __builtin_sqrt(a.v[l]);
    return Pack(root);
  }
};

/// One stage of a transposition: exchanges the blocks of S x S numbers that lie off the diagonal in two rows.
template <std::size_t S, std::size_t W, std::size_t... Lane>
VBOND_HD void exchange_blocks(Pack<W>& upper, Pack<W>& lower, std::index_sequence<Lane...>) {
  const auto u = upper.v, l = lower.v;
  upper.v = __builtin_shufflevector(u, l, ((Lane & S) == 0 ? Lane : W + Lane - S)...);
  lower.v = __builtin_shufflevector(u, l, ((Lane & S) == 0 ? Lane + S : W + Lane)...);
}

/// Transposes a square of W x W numbers.
template <std::size_t S = 1, std::size_t W>
VBOND_HD void transpose(Pack<W>* row) {
  if constexpr (S < W) {
    for (std::size_t k = 0; k < W; ++k)
      if ((k & S) == 0) exchange_blocks<S>(row[k], row[k + S], std::make_index_sequence<W>());
    transpose<2 * S>(row);
  }
}

}  // namespace vbond
