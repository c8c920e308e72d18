#include "vbond/statics/detail/single_factor.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

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

SingleFactor::SingleFactor(std::shared_ptr<Crew> crew) : crew_(std::move(crew)), local_(crew_->count()) {}

void SingleFactor::take(const FactorBlocks& blocks, const std::vector<std::size_t>& at,
                        const double* values) {
  blocks_ = blocks;
  strips_.clear();
  first_strip_.clear();
  stride_ = 0;
  std::size_t size = 0;
  for (int b = 0; b < blocks_.number(); ++b) {
    const auto [first, width, height] = blocks_.block(b);
    first_strip_.push_back(strips_.size());
    for (int column = 0; column < width; column += widest_strip) {
      const int w = std::min(widest_strip, width - column);
      strips_.push_back({b, column, w, size});
      size += size_of_strip(w, height - column - w);
    }
    stride_ = std::max<std::ptrdiff_t>(stride_, filled_up(height) + sum_parts);
  }
  first_strip_.push_back(strips_.size());
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
      const double* under = column + s.column + s.width;
      float* to = corner + corner_size + sum_parts * j;
      for (int i = 0; i < below; i += sum_parts)
        std::transform(under + i, under + std::min(i + sum_parts, below), to + std::ptrdiff_t{i} * s.width,
                       single);
    }
  }
  parts_ = branches_of(blocks_);
  copy_top();
  for (std::vector<double>& local : local_) local.assign(static_cast<std::size_t>(stride_) * most_sides, 0.0);
}

/// Rows of branches that are columns of the top get numbers in the copy that each branch has of these.
void SingleFactor::copy_top() {
  const int n = blocks_.columns();
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  top_columns_.clear();
  std::vector<int> place(at(n), -1);
  for (const int b : parts_.top)
    for (int k = blocks_.first[at(b)]; k < blocks_.first[at(b) + 1]; ++k) {
      place[at(k)] = static_cast<int>(top_columns_.size());
      top_columns_.push_back(k);
    }
  length_ = n;
  by_size_.clear();
  for (const FactorBranches::Branch& branch : parts_.branches) {
    for (int k = blocks_.from[at(branch.first)]; k < blocks_.from[at(branch.last)]; ++k)
      if (int& row = blocks_.rows[at(k)]; place[at(row)] >= 0)
        row = static_cast<int>(length_) + place[at(row)];
    length_ += std::ssize(top_columns_);
    by_size_.push_back(by_size_.size());
  }
  std::stable_sort(by_size_.begin(), by_size_.end(), [this](std::size_t s, std::size_t t) {
    return parts_.branches[s].size > parts_.branches[t].size;
  });
}

/// Calls work(branch, scratch) for all of them at once.
template <class Work>
void SingleFactor::for_branches(Work work) const {
  std::atomic<std::size_t> next = 0;
  crew_->for_each([&](std::size_t thread) {
    for (std::size_t k; (k = next++) < by_size_.size();) work(by_size_[k], local_[thread].data());
  });
}

namespace {

/// What a block needs of the sides, each `length` long, and back.
struct RowsOfBlock {
  const int* rows;
  int height, sides;
  std::ptrdiff_t length, stride;

  void fetch(const double* x, double* local) const {
    for (int s = 0; s < sides; ++s) {
      const double* from = x + s * length;
      double* to = local + s * stride;
      for (int i = 0; i < height; ++i) to[i] = from[rows[i]];
      std::fill_n(to + height, sum_parts, 0.0);  // not NaN, as zeros are multiplied with it
    }
  }
  void put(const double* local, int number, double* x) const {
    for (int s = 0; s < sides; ++s) {
      const double* from = local + s * stride;
      double* to = x + s * length;
      for (int i = 0; i < number; ++i) to[rows[i]] = from[i];
    }
  }
};

/// The first `width` numbers of each side, which are `length` apart.
bool are_all_zero(const double* x, int width, int sides, std::ptrdiff_t length) {
  for (int s = 0; s < sides; ++s)
    if (std::any_of(x + s * length, x + s * length + width, [](double number) { return number != 0.0; }))
      return false;
  return true;
}

}  // namespace

void SingleFactor::forward(int b, int sides, double* x, double* local) const {
  const auto [first, width, height] = blocks_.block(b);
  if (are_all_zero(x + first, width, sides, length_)) return;  // few numbers of a side are not
  const auto k = static_cast<std::size_t>(b);
  const RowsOfBlock rows{blocks_.rows.data() + blocks_.from[k], height, sides, length_, stride_};
  rows.fetch(x, local);
  for (std::size_t at = first_strip_[k]; at < first_strip_[k + 1]; ++at) {
    const Strip& s = strips_[at];
    const float* corner = L_.data() + s.at;
    single_kernel().forward[s.width - 1][sides - 1](
        {corner, corner + corner_size, height - s.column - s.width, nullptr}, local + s.column, stride_);
  }
  rows.put(local, height, x);
}

void SingleFactor::backward(int b, int sides, double* x, double* local) const {
  const auto [first, width, height] = blocks_.block(b);
  const auto k = static_cast<std::size_t>(b);
  const RowsOfBlock rows{blocks_.rows.data() + blocks_.from[k], height, sides, length_, stride_};
  rows.fetch(x, local);
  for (std::size_t at = first_strip_[k + 1]; at-- > first_strip_[k];) {
    const Strip& s = strips_[at];
    const float* corner = L_.data() + s.at;
    single_kernel().backward[s.width - 1][sides - 1](
        {corner, corner + corner_size, height - s.column - s.width,
         at > 0 ? L_.data() + strips_[at - 1].at : nullptr},
        local + s.column, stride_);
  }
  rows.put(local, width, x);
}

/// Of sides that lie side by side, length_ from one to the next: x in the order of elimination, side after
/// side, then zeros.
void SingleFactor::solve_some(int sides, double* x) const {
  const auto top = static_cast<std::ptrdiff_t>(top_columns_.size());
  const auto for_copies = [&](std::size_t branch, const auto& visit) {  // of columns of the top
    for (int s = 0; s < sides; ++s) {
      double* of_side = x + s * length_;
      double* copy = of_side + blocks_.columns() + static_cast<std::ptrdiff_t>(branch) * top;
      for (std::ptrdiff_t k = 0; k < top; ++k)
        visit(of_side[top_columns_[static_cast<std::size_t>(k)]], copy[k]);
    }
  };
  for_branches([&](std::size_t t, double* local) {
    for (int b = parts_.branches[t].first; b < parts_.branches[t].last; ++b) forward(b, sides, x, local);
  });
  for (std::size_t t = 0; t < parts_.branches.size(); ++t)
    for_copies(t, [](double& column, double& copy) { column += copy; });
  for (const int b : parts_.top) forward(b, sides, x, local_[0].data());
  for (std::size_t k = parts_.top.size(); k-- > 0;) backward(parts_.top[k], sides, x, local_[0].data());
  for_branches([&](std::size_t t, double* local) {
    for_copies(t, [](double& column, double& copy) { copy = column; });
    for (int b = parts_.branches[t].last; b-- > parts_.branches[t].first;) backward(b, sides, x, local);
  });
}

DenseMatrix SingleFactor::solve(const DenseMatrix& B) const {
  Pulse::solution();
  const Eigen::Index n = B.rows();
  const Eigen::Map<const Eigen::VectorXi> order(blocks_.order.data(), n);
  DenseMatrix x(length_, std::min<Eigen::Index>(B.cols(), most_sides)), X(n, B.cols());
  for (Eigen::Index first = 0; first < B.cols(); first += most_sides) {
    const Eigen::Index sides = std::min<Eigen::Index>(most_sides, B.cols() - first);
    x.bottomRows(length_ - n).setZero();
    for (Eigen::Index s = 0; s < sides; ++s)
      for (Eigen::Index k = 0; k < n; ++k) x(k, s) = B(order[k], first + s);
    solve_some(static_cast<int>(sides), x.data());
    for (Eigen::Index s = 0; s < sides; ++s)
      for (Eigen::Index k = 0; k < n; ++k) X(order[k], first + s) = x(k, s);
  }
  return X;
}

}  // namespace vbond
