#include "vbond/statics/detail/single_factor.hpp"

#include <algorithm>

#include "vbond/statics/detail/kernel_of_sets.hpp"
#include "vbond/statics/detail/pulse.hpp"
#include "vbond/statics/detail/single_kernel.hpp"

namespace vbond {

namespace single_baseline {
extern const SingleKernel kernel;
}
#if defined(VBOND_VECTOR_KERNELS)
namespace single_avx2 {
extern const SingleKernel kernel;
}
namespace single_avx512 {
extern const SingleKernel kernel;
}
constexpr KernelOfSets<SingleKernel> single_kernels{&single_baseline::kernel, &single_avx2::kernel,
                                                    &single_avx512::kernel};
#else
constexpr KernelOfSets<SingleKernel> single_kernels{&single_baseline::kernel};
#endif

const SingleKernel* single_kernel(int number) {
  return single_kernels.of(number);
}

const SingleKernel& single_kernel() {
  static const SingleKernel& best = single_kernels.best();
  return best;
}

namespace {

constexpr std::size_t corner_size = widest_strip * widest_strip;

std::size_t size_of_strip(int width, int below) {
  return corner_size + static_cast<std::size_t>(width) * static_cast<std::size_t>(filled_up(below));
}

}  // namespace

void SingleFactor::take(const FactorBlocks& blocks, const std::vector<std::size_t>& at,
                        const double* values) {
  blocks_ = blocks;
  strips_.clear();
  stride_ = 0;
  std::size_t size = 0;
  for (int b = 0; b < blocks_.number(); ++b) {
    const auto [first, width, height] = blocks_.block(b);
    for (int column = 0; column < width; column += widest_strip) {
      const int w = std::min(widest_strip, width - column);
      strips_.push_back({b, column, w, size});
      size += size_of_strip(w, height - column - w);
    }
    stride_ = std::max(stride_, filled_up(height) + sum_parts);
  }
  L_.assign(size, 0.0F);
  for (const Strip& s : strips_) {
    const int height = blocks_.block(s.block).height, below = height - s.column - s.width;
    float* corner = L_.data() + s.at;
    for (int j = 0; j < s.width; ++j) {
      const double* column = values + at[static_cast<std::size_t>(s.block)] +
                             static_cast<std::size_t>(s.column + j) * static_cast<std::size_t>(height);
      const auto single = [](double l) { return static_cast<float>(l); };
      std::transform(column + s.column + j, column + s.column + s.width, corner + widest_strip * j + j,
                     single);
      std::transform(column + s.column + s.width, column + height,
                     corner + corner_size + static_cast<std::ptrdiff_t>(j) * filled_up(below), single);
    }
  }
}

/// Of sides that lie side by side: x in the order of elimination, side after side.
void SingleFactor::solve_some(int sides, double* x, double* local) const {
  const SingleKernel& kernel = single_kernel();
  const int n = blocks_.columns();
  const auto rows_of = [this](int b) {
    return blocks_.rows.data() + blocks_.from[static_cast<std::size_t>(b)];
  };
  const auto fetch = [&](int b, int height) {
    const int* rows = rows_of(b);
    for (int s = 0; s < sides; ++s) {
      const double* from = x + static_cast<std::ptrdiff_t>(s) * n;
      double* to = local + static_cast<std::ptrdiff_t>(s) * stride_;
      for (int i = 0; i < height; ++i) to[i] = from[rows[i]];
      std::fill_n(to + height, sum_parts, 0.0);  // not NaN, as zeros are multiplied with it
    }
  };
  const auto put = [&](int b, int number) {
    const int* rows = rows_of(b);
    for (int s = 0; s < sides; ++s) {
      const double* from = local + static_cast<std::ptrdiff_t>(s) * stride_;
      double* to = x + static_cast<std::ptrdiff_t>(s) * n;
      for (int i = 0; i < number; ++i) to[rows[i]] = from[i];
    }
  };
  const auto is_zero = [&](int first, int width) {
    for (int s = 0; s < sides; ++s)
      for (const double *at = x + static_cast<std::ptrdiff_t>(s) * n + first, *end = at + width; at != end;
           ++at)
        if (*at != 0.0) return false;
    return true;
  };
  const auto step = [&](const Strip& s, int height, const auto& steps) {
    const float* corner = L_.data() + s.at;
    steps[s.width - 1][sides - 1]({corner, corner + corner_size, height - s.column - s.width},
                                  local + s.column, stride_);
  };
  for (std::size_t k = 0; k < strips_.size();) {
    const int b = strips_[k].block;
    const auto [first, width, height] = blocks_.block(b);
    if (is_zero(first, width)) {  // of a side with few numbers that are not: nothing comes of these
      while (k < strips_.size() && strips_[k].block == b) ++k;
      continue;
    }
    fetch(b, height);
    for (; k < strips_.size() && strips_[k].block == b; ++k) step(strips_[k], height, kernel.forward);
    put(b, height);
  }
  for (std::size_t k = strips_.size(); k > 0;) {
    const int b = strips_[k - 1].block;
    const auto [first, width, height] = blocks_.block(b);
    fetch(b, height);
    for (; k > 0 && strips_[k - 1].block == b; --k) step(strips_[k - 1], height, kernel.backward);
    put(b, width);
  }
}

DenseMatrix SingleFactor::solve(const DenseMatrix& B) const {
  Pulse::solution();
  const Eigen::Index n = B.rows();
  const Eigen::Map<const Eigen::VectorXi> order(blocks_.order.data(), n);
  DenseMatrix x(n, std::min<Eigen::Index>(B.cols(), most_sides)), X(n, B.cols());
  std::vector<double> local(static_cast<std::size_t>(stride_) * most_sides, 0.0);
  for (Eigen::Index first = 0; first < B.cols(); first += most_sides) {
    const Eigen::Index sides = std::min<Eigen::Index>(most_sides, B.cols() - first);
    for (Eigen::Index s = 0; s < sides; ++s)
      for (Eigen::Index k = 0; k < n; ++k) x(k, s) = B(order[k], first + s);
    solve_some(static_cast<int>(sides), x.data(), local.data());
    for (Eigen::Index s = 0; s < sides; ++s)
      for (Eigen::Index k = 0; k < n; ++k) X(order[k], first + s) = x(k, s);
  }
  return X;
}

}  // namespace vbond
