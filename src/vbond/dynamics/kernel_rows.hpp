// Rows of particles in vector registers, for the sources that are compiled once per instruction set: see
// kernel.cpp on what they may contain.
#pragma once
#if VBOND_LANES >= 4
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>

#include "vbond/core/quat.hpp"
#include "vbond/core/simd.hpp"
#include "vbond/dynamics/rows.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

constexpr std::size_t lanes = VBOND_LANES;
constexpr std::uint32_t one_after_another[rows_at_once] = {0, 1, 2, 3, 4, 5, 6, 7};
using Real = Pack<lanes>;

template <class R>
VBOND_HD const double* numbers(const R* row) {
  return reinterpret_cast<const double*>(row);
}
template <class R>
VBOND_HD double* numbers(R* row) {
  return reinterpret_cast<double*>(row);
}

// ---- half rows: r or q, v or omega, F or M ----------------------------------------------------------

/// Which half of a row, as an offset in numbers.
enum class Half : std::size_t { first = 0, second = 4 };

/// Halves of W rows, not transposed: see transpose_halves().
template <std::size_t W>
using HalvesOf = Pack<W>[4];
using Halves = HalvesOf<lanes>;

#if VBOND_LANES == 8
/// Four numbers from either place. By intrinsics, for then the second four are joined by a load, which does
/// not need the one port that shuffles; compilers take that port for the vector extension's way to say it.
/// (The mask is no mask: without it g++ 12 warns of its own header.)
VBOND_HD Real::Native side_by_side(const double* first, const double* second) {
  return _mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(_mm256_loadu_pd(first)),
                                  _mm256_loadu_pd(second), 1);
}
#endif

template <std::size_t W, class R>
VBOND_HD void load_halves(const R* rows, const std::uint32_t* row, Half half, HalvesOf<W>& x) {
  const std::size_t at = static_cast<std::size_t>(half);
  for (std::size_t k = 0; k < 4; ++k) {
    if constexpr (W < 8) x[k] = Pack<W>::load(numbers(rows + row[k % W]) + at + k / W * W);
#if VBOND_LANES == 8
    else
      x[k].v = side_by_side(numbers(rows + row[k]) + at, numbers(rows + row[k + 4]) + at);
#endif
  }
}

/// From the places of rows i to those of rows j, transposed: coordinate k of lane l in lane l of r_ij[k].
template <std::size_t W>
VBOND_HD void load_between(const PoseRow* pose, const std::uint32_t* i, const std::uint32_t* j,
                           HalvesOf<W>& r_ij) {
  HalvesOf<W> r_i;
  load_halves(pose, i, Half::first, r_i);
  load_halves(pose, j, Half::first, r_ij);
  for (std::size_t k = 0; k < 4; ++k) r_ij[k] = between(r_i[k], r_ij[k]);
  transpose_halves(r_ij);
}

/// Number k of that half of row[l] in lane l of x[k].
template <std::size_t W, class R>
VBOND_HD void load_columns(const R* rows, const std::uint32_t* row, Half half, HalvesOf<W>& x) {
  load_halves(rows, row, half, x);
  transpose_halves(x);
}

template <std::size_t W = lanes, class R>
VBOND_HD Quat<Pack<W>> load_quats(const R* rows, const std::uint32_t* row) {
  HalvesOf<W> q;
  load_columns(rows, row, Half::second, q);
  return {q[0], q[1], q[2], q[3]};
}

// ---- whole rows -------------------------------------------------------------------------------------

/// Row l of those whose halves these are, part after part.
template <std::size_t W>
VBOND_HD void whole_row(const HalvesOf<W>& first, const HalvesOf<W>& second, std::size_t l,
                        Pack<W> (&row)[8 / W]) {
  if constexpr (W == 8) {
    if (l < 4)
      row[0].v = __builtin_shufflevector(first[l].v, second[l].v, 0, 1, 2, 3, W, W + 1, W + 2, W + 3);
    else
      row[0].v =
          __builtin_shufflevector(first[l - 4].v, second[l - 4].v, 4, 5, 6, 7, W + 4, W + 5, W + 6, W + 7);
  } else {
    for (std::size_t part = 0; part < 4 / W; ++part) {
      row[part] = first[part * W + l];
      row[4 / W + part] = second[part * W + l];
    }
  }
}

[[maybe_unused]] VBOND_HD void store_row(const Halves& first, const Halves& second, std::size_t l,
                                         double* to) {
  Real row[8 / lanes];
  whole_row(first, second, l, row);
  for (std::size_t part = 0; part < 8 / lanes; ++part) row[part].store(to + part * lanes);
}

template <std::size_t W>
VBOND_HD void add_row(const HalvesOf<W>& first, const HalvesOf<W>& second, std::size_t l, double* to) {
  Pack<W> row[8 / W];
  whole_row(first, second, l, row);
  for (std::size_t part = 0; part < 8 / W; ++part)
    (Pack<W>::load(to + part * W) + row[part]).store(to + part * W);
}

/// This part of a row of eight that holds x four times, then y.
template <std::size_t W = lanes>
VBOND_HD Pack<W> halves_of(double x, double y, std::size_t part) {
  if constexpr (W == 8)
    return Pack<W>(
        __builtin_shufflevector(Pack<W>(x).v, Pack<W>(y).v, 0, 1, 2, 3, W + 4, W + 5, W + 6, W + 7));
  else
    return Pack<W>(part < 4 ? x : y);
}

/// The lanes in which x >= y, a bit each. (By intrinsics, as compilers go through lanes one by one.)
[[maybe_unused]] VBOND_HD unsigned lanes_at_least(const Real& x, const Real& y) {
#if VBOND_LANES == 8
  return _mm512_cmp_pd_mask(x.v, y.v, _CMP_GE_OQ);
#elif VBOND_LANES == 4
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(x.v, y.v, _CMP_GE_OQ)));
#else
  unsigned mask = 0;
  for (std::size_t l = 0; l < lanes; ++l) mask |= x.v[l] >= y.v[l] ? 1u << l : 0u;
  return mask;
#endif
}

/// The sum of a row's numbers, always in this order.
[[maybe_unused]] VBOND_HD double sum_of_row(const Real (&row)[8 / lanes]) {
  double x[8];
  for (std::size_t part = 0; part < 8; part += lanes) row[part / lanes].store(x + part);
  return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

}  // namespace
}  // namespace vbond::VBOND_KERNEL
