// Loops of solutions with a factor in single precision. This file is compiled once per instruction set, with
// its own namespace VBOND_SINGLE and vectors of VBOND_LANES doubles. Each number comes out of the same
// operations in the same order whatever these are.
#include <cstring>

#include "vbond/statics/detail/single_kernel.hpp"

namespace vbond::VBOND_SINGLE {
namespace {

constexpr int lanes = VBOND_LANES;
using Doubles [[gnu::vector_size(lanes * sizeof(double))]] = double;
using Floats [[gnu::vector_size(lanes * sizeof(float))]] = float;

inline Doubles loaded(const double* from) {
  Doubles v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline Doubles loaded(const float* from) {
  Floats v;
  std::memcpy(&v, from, sizeof v);
  return __builtin_convertvector(v, Doubles);
}

template <int width, int sides>
void forward(const StripOfFactor& L, double* x, std::ptrdiff_t stride) {
  const int height = filled_up(L.height);
  Doubles of_column[width][sides];
  for (int s = 0; s < sides; ++s) {
    double* own = x + s * stride;
    for (int j = 0; j < width; ++j) {
      for (int k = 0; k < j; ++k) own[j] -= static_cast<double>(L.corner[widest_strip * k + j]) * own[k];
      own[j] /= static_cast<double>(L.corner[widest_strip * j + j]);
      of_column[j][s] = own[j] - Doubles{};
    }
  }
  double* under = x + width;
  for (int i = 0; i < height; i += sum_parts)
    for (int part = 0; part < sum_parts; part += lanes) {
      const float* below = L.below + std::ptrdiff_t{i} * width + part;
      Doubles l[width];
      for (int j = 0; j < width; ++j) l[j] = loaded(below + sum_parts * j);
      for (int s = 0; s < sides; ++s) {
        double* at = under + s * stride + i + part;
        Doubles v = loaded(at);
        for (int j = 0; j < width; ++j) v -= l[j] * of_column[j][s];
        std::memcpy(at, &v, sizeof v);
      }
    }
}

/// No processor sees that strips are read from the last to the first.
template <int width>
void fetch_ahead(const float* from) {
  constexpr int line = 64 / sizeof(float);
  for (int k = 0; k < width * sum_parts; k += line) __builtin_prefetch(from + k);
}

template <int width, int sides>
void backward(const StripOfFactor& L, double* x, std::ptrdiff_t stride) {
  constexpr int vectors = sum_parts / lanes;
  const int height = filled_up(L.height);
  Doubles sums[width][sides][vectors] = {};
  const double* under = x + width;
  for (int i = 0; i < height; i += sum_parts)
    for (int part = 0; part < vectors; ++part) {
      const float* below = L.below + std::ptrdiff_t{i} * width + part * lanes;
      if (part == 0 && L.next != nullptr) fetch_ahead<width>(L.next + std::ptrdiff_t{i} * width);
      Doubles v[sides];
      for (int s = 0; s < sides; ++s) v[s] = loaded(under + s * stride + i + part * lanes);
      for (int j = 0; j < width; ++j) {
        const Doubles l = loaded(below + sum_parts * j);
        for (int s = 0; s < sides; ++s) sums[j][s][part] += l * v[s];
      }
    }
  for (int s = 0; s < sides; ++s) {
    double* own = x + s * stride;
    for (int j = width; j-- > 0;) {
      double parts[sum_parts];
      std::memcpy(parts, sums[j][s], sizeof parts);
      for (int half = sum_parts / 2; half > 0; half /= 2)
        for (int k = 0; k < half; ++k) parts[k] += parts[k + half];
      own[j] -= parts[0];
      for (int k = j + 1; k < width; ++k)
        own[j] -= static_cast<double>(L.corner[widest_strip * j + k]) * own[k];
      own[j] /= static_cast<double>(L.corner[widest_strip * j + j]);
    }
  }
}

template <int sides>
void subtract_product(const double* Z, std::ptrdiff_t rows, int rank, const double* part, double* X,
                      std::ptrdiff_t stride) {
  std::ptrdiff_t i = 0;
  for (; i + lanes <= rows; i += lanes) {
    Doubles sum[sides] = {};
    for (int k = 0; k < rank; ++k) {
      const Doubles z = loaded(Z + k * stride + i);
      for (int s = 0; s < sides; ++s) sum[s] += z * part[k * sides + s];
    }
    for (int s = 0; s < sides; ++s) {
      const Doubles x = loaded(X + s * stride + i) - sum[s];
      std::memcpy(X + s * stride + i, &x, sizeof x);
    }
  }
  for (; i < rows; ++i)
    for (int s = 0; s < sides; ++s) {
      double sum = 0.0;
      for (int k = 0; k < rank; ++k) sum += Z[k * stride + i] * part[k * sides + s];
      X[s * stride + i] -= sum;
    }
}

}  // namespace

extern const SingleKernel kernel;
const SingleKernel kernel{
    {{forward<1, 1>, forward<1, 2>, forward<1, 3>, forward<1, 4>},
     {forward<2, 1>, forward<2, 2>, forward<2, 3>, forward<2, 4>},
     {forward<3, 1>, forward<3, 2>, forward<3, 3>, forward<3, 4>},
     {forward<4, 1>, forward<4, 2>, forward<4, 3>, forward<4, 4>}},
    {{backward<1, 1>, backward<1, 2>, backward<1, 3>, backward<1, 4>},
     {backward<2, 1>, backward<2, 2>, backward<2, 3>, backward<2, 4>},
     {backward<3, 1>, backward<3, 2>, backward<3, 3>, backward<3, 4>},
     {backward<4, 1>, backward<4, 2>, backward<4, 3>, backward<4, 4>}},
    {subtract_product<1>, subtract_product<2>, subtract_product<3>, subtract_product<4>}};

}  // namespace vbond::VBOND_SINGLE
