#pragma once
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "vbond/statics/detail/eigen.hpp"

/// How eigenpairs are looked for until none is missing: what eigen.cpp and critical_factors.cpp share.
namespace vbond {

// Up to here all eigenpairs are found faster densely than a few by iteration (measured).
inline constexpr int largest_dense = 120;
inline bool solve_densely(Eigen::Index n, int count) {
  return n <= largest_dense || 3 * count > n;
}

/// Eigenpairs and the order in which they are wanted: by increasing key.
struct Found {
  std::vector<double> key;
  std::vector<double> value;
  DenseMatrix vectors;

  int size() const { return static_cast<int>(key.size()); }
  void add(double k, double v, const Vector& x) {
    key.push_back(k);
    value.push_back(v);
    vectors.conservativeResize(x.size(), size());
    vectors.col(size() - 1) = x;
  }
  void sort() {
    std::vector<int> order(key.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [this](int a, int b) { return key[std::size_t(a)] < key[std::size_t(b)]; });
    Found sorted;
    sorted.vectors.resize(vectors.rows(), size());
    for (const int k : order) {
      sorted.key.push_back(key[std::size_t(k)]);
      sorted.value.push_back(value[std::size_t(k)]);
      sorted.vectors.col(sorted.size() - 1) = vectors.col(k);
    }
    *this = std::move(sorted);
  }
  int below(double k) const {
    return static_cast<int>(std::count_if(key.begin(), key.end(), [k](double x) { return x < k; }));
  }
  EigenPairs part(int first, int count) const {
    const int n = std::clamp(size() - first, 0, count);
    return {Eigen::Map<const Vector>(value.data() + first, n), vectors.middleCols(first, n), 0};
  }
};

/// What to look for: `count` of `available` pairs, with keys from `from` on, known to `resolution`.
struct Wanted {
  int count, available;
  double from, resolution;
};

/// A key a little beyond `last`, and how many pairs there are below it.
template <class Number>
std::pair<double, int> counted_beyond(double last, double resolution, Number&& number_below) {
  for (double margin = std::max(1e-6 * std::abs(last), resolution);
       margin < 0.1 * std::abs(last) + 1e6 * resolution; margin *= 1.7)
    if (const std::optional<int> number = number_below(last + margin)) return {last + margin, *number};
  throw NoConvergence("eigenvalues: they are too close to each other to be counted");
}

/// Looks for pairs until none is missing among the first ones. look(k, found) adds k more; number_below(key)
/// says how many there are, or nothing where a matrix is singular.
template <class Look, class Number>
EigenPairs find_counted(const Wanted& w, Look&& look, Number&& number_below) {
  Found found;
  int unwanted = 0;
  int missing = std::min(w.count, w.available);
  for (int rounds = 0; missing > 0; ++rounds) {
    if (rounds > w.count + 20)
      throw NoConvergence(fmt::format("eigenvalues: {} are missing that must exist", missing));
    look(missing, found);
    found.sort();
    unwanted = found.below(w.from);
    if (found.size() >= w.available) break;
    const int needed = std::min(w.count + unwanted, w.available);
    const double last = found.key[static_cast<std::size_t>(std::min(needed, found.size()) - 1)];
    const auto [cut, number] = counted_beyond(last, w.resolution, number_below);
    missing = std::max(std::min(number, w.available) - found.below(cut), needed - found.size());
  }
  return found.part(unwanted, w.count);
}

/// The same without counting: it is done when what is found next, normal to all before, lies beyond them.
template <class Look>
EigenPairs find_searched(const Wanted& w, Look&& look) {
  Found found;
  look(std::min(w.count, w.available), found);
  while (found.size() < w.available) {
    found.sort();
    const int unwanted = found.below(w.from), needed = std::min(w.count + unwanted, w.available);
    const double last = found.key[static_cast<std::size_t>(std::min(needed, found.size()) - 1)];
    const bool enough = found.size() >= needed;
    look(1, found);
    if (enough && found.key.back() >= last) break;
  }
  found.sort();
  return found.part(found.below(w.from), w.count);
}

inline double largest_diagonal(const SparseMatrix& A) {
  return Vector(A.diagonal()).cwiseAbs().maxCoeff();
}

}  // namespace vbond
