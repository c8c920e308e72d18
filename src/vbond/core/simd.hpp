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
  VBOND_HD explicit Pack(double s) : v(s - Native{}) {}  // no operation: s - 0 is s, also of -0
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
  friend VBOND_HD Pack larger(const Pack& a, const Pack& b) { return Pack(a.v > b.v ? a.v : b.v); }
  friend VBOND_HD Pack where_greater(const Pack& a, const Pack& b, const Pack& x, const Pack& y) {
    return Pack(a.v > b.v ? x.v : y.v);
  }
  friend VBOND_HD bool any_greater(const Pack& a, const Pack& b) {
    bool any = false;
    for (std::size_t l = 0; l < W; ++l) any |= a.v[l] > b.v[l];
    return any;
  }
  friend VBOND_HD Pack sqrt(const Pack& a) {
    Native root;
    for (std::size_t l = 0; l < W; ++l) root[l] = __builtin_sqrt(a.v[l]);
    return Pack(root);
  }
  friend VBOND_HD Pack atan2(const Pack& y, const Pack& x) {
    Native angle;
    for (std::size_t l = 0; l < W; ++l) angle[l] = __builtin_atan2(y.v[l], x.v[l]);
    return Pack(angle);
  }
};

/// One stage of a transposition: exchanges the blocks of S x S numbers that lie off the diagonal in two rows.
template <std::size_t S, std::size_t W, std::size_t... Lane>
VBOND_HD void exchange_blocks(Pack<W>& upper, Pack<W>& lower, std::index_sequence<Lane...>) {
  const auto u = upper.v, l = lower.v;
  upper.v = __builtin_shufflevector(u, l, ((Lane & S) == 0 ? Lane : W + Lane - S)...);
  lower.v = __builtin_shufflevector(u, l, ((Lane & S) == 0 ? Lane + S : W + Lane)...);
}

/// From W rows of four numbers to four columns of W numbers, and back. Rows lie in the registers as they come
/// from memory: with four lanes x[k] is row k; with eight, rows k and k + 4 side by side; with two, x[k] is
/// row k, and x[2 + k] its other two numbers. Columns: number k of row l is lane l of x[k].
template <std::size_t W>
VBOND_HD void transpose_halves(Pack<W> (&x)[4]) {
  constexpr auto all = std::make_index_sequence<W>();
  exchange_blocks<1>(x[0], x[1], all);
  exchange_blocks<1>(x[2], x[3], all);
  if constexpr (W > 2) {
    exchange_blocks<2>(x[0], x[2], all);
    exchange_blocks<2>(x[1], x[3], all);
  }
}

/// Transposes a square of W x W numbers.
template <std::size_t W>
VBOND_HD void transpose(Pack<W>* row) {
  transpose_parts<W>(row);
}

}  // namespace vbond
