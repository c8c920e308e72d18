#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace vbond {

/// Below this many items one thread does the work: some 0.3 ms of bonds. A team that has its cores to itself
/// would pay from 500 items on, but on a machine with other work every barrier then waits for a thread that
/// is not running (a shell of 1300 bonds was seen to take 20 times as long).
inline constexpr std::size_t parallel_from = 4096;

/// Calls f(k) for k = 0 .. n-1, each once; f must write only what belongs to k.
template <class F>
void for_each_index(std::size_t n, [[maybe_unused]] int threads, F f) {
  if (threads == 1 ||
      n < parallel_from) {  // not an if-clause of the pragma: that still sets up a team of one
    for (std::size_t k = 0; k < n; ++k) f(k);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(n); ++k) f(static_cast<std::size_t>(k));
}

/// Calls f(first, count) for pieces of at most `chunk` of the numbers 0 .. n-1, each of which stands for
/// items_each.
template <class F>
void for_each_chunk(std::size_t n, std::size_t items_each, std::size_t chunk, int threads, F f) {
  const std::size_t pieces = (n + chunk - 1) / chunk;
  const auto piece = [&](std::size_t k) { f(k * chunk, std::min(chunk, n - k * chunk)); };
  if (threads == 1 || n * items_each < parallel_from) {
    for (std::size_t k = 0; k < pieces; ++k) piece(k);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(pieces); ++k) piece(static_cast<std::size_t>(k));
}

/// The sum of f(k), added in an order that does not depend on the number of threads.
template <class F>
double sum_over(std::size_t n, int threads, F f) {
  const auto sum_block = [&](std::size_t b) {
    double s = 0.0;
    for (std::size_t k = b * parallel_from; k < std::min(n, (b + 1) * parallel_from); ++k) s += f(k);
    return s;
  };
  if (n <= parallel_from) return sum_block(0);
  std::vector<double> partial((n + parallel_from - 1) / parallel_from);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::ptrdiff_t b = 0; b < static_cast<std::ptrdiff_t>(partial.size()); ++b)
    partial[static_cast<std::size_t>(b)] = sum_block(static_cast<std::size_t>(b));
  double s = 0.0;
  for (const double p : partial) s += p;
  return s;
}

}  // namespace vbond
