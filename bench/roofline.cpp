// What this machine can do, here and now: arithmetic of one core with each of its instruction sets, and
// bandwidth of one and two threads from L2, L3 and memory. Prints JSON; bench/run sets it beside its figures.
// Each number is the median of `repeats` measurements, with the least and the largest.
#include <sys/sysinfo.h>

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "instruction_sets.hpp"

namespace vbond_bench {

// roofline_loops.cpp, once per instruction set
namespace sse2 {
double multiply_add(std::size_t rounds, double x, double y);
void triad(double* to, const double* b, const double* c, double s, std::size_t count);
}  // namespace sse2
namespace avx2 {
double multiply_add(std::size_t rounds, double x, double y);
void triad(double* to, const double* b, const double* c, double s, std::size_t count);
}  // namespace avx2
namespace avx2_fma {
double multiply_add(std::size_t rounds, double x, double y);
}
namespace avx512 {
double multiply_add(std::size_t rounds, double x, double y);
void triad(double* to, const double* b, const double* c, double s, std::size_t count);
}  // namespace avx512
namespace avx512_fma {
double multiply_add(std::size_t rounds, double x, double y);
}

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr int repeats = 7;
constexpr double long_enough = 0.03;  ///< of one measurement [s]: far above the clock's grain

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Json spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {{"median", values[values.size() / 2]}, {"min", values.front()}, {"max", values.back()}};
}

using MultiplyAdd = double (*)(std::size_t, double, double);
using Triad = void (*)(double*, const double*, const double*, double, std::size_t);

/// [GFlop/s] of one core; a multiply and an add count as two operations, fused or not.
Json arithmetic(MultiplyAdd loop, std::size_t width) {
  const auto timed = [loop](std::size_t rounds) {
    const auto start = Clock::now();
    volatile double kept = loop(rounds, 0.999999, 1e-6);  // stays near 1: no slow tiny numbers
    static_cast<void>(kept);
    return seconds_since(start);
  };
  std::size_t rounds = 1000;
  while (timed(rounds) < long_enough) rounds *= 2;
  const double operations = 28.0 * static_cast<double>(width) * static_cast<double>(rounds);
  std::vector<double> rates;
  for (int r = 0; r < repeats; ++r) rates.push_back(1e-9 * operations / timed(rounds));
  return spread(rates);
}

/// [GB/s] of `threads` threads together, each with three arrays of its own of `count` doubles. Counted is
/// what the loop names, 24 bytes per element; the line that a write brings in first comes on top.
Json bandwidth(Triad loop, std::size_t count, int threads) {
  const double bytes = 24.0 * static_cast<double>(count) * threads;
  std::vector<double> rates;
  std::size_t passes = 1;
  std::barrier together(threads);
  const auto work = [&](int thread) {
    std::vector<double> to(count, 0.0), b(count, 1.0), c(count, 2.0);
    const auto timed = [&](std::size_t n) {
      together.arrive_and_wait();
      const auto start = Clock::now();
      for (std::size_t k = 0; k < n; ++k) loop(to.data(), b.data(), c.data(), 0.5, count);
      together.arrive_and_wait();
      return seconds_since(start);
    };
    timed(1);
    const double one = timed(3) / 3.0;
    if (thread == 0) passes = static_cast<std::size_t>(std::max(1.0, long_enough / one));
    together.arrive_and_wait();  // all read the same number
    for (int r = 0; r < repeats; ++r) {
      const double t = timed(passes);
      if (thread == 0) rates.push_back(1e-9 * bytes * static_cast<double>(passes) / t);
    }
    if (to[count / 2] != 2.0) std::abort();  // the loop must have run
  };
  {
    std::vector<std::jthread> team;
    for (int t = 1; t < threads; ++t) team.emplace_back(work, t);
    work(0);
  }
  return spread(rates);
}

/// Size of the cache at this level as Linux tells it, or `otherwise` where it does not.  [MiB]
double cache_MiB(int level, double otherwise) {
  std::ifstream file("/sys/devices/system/cpu/cpu0/cache/index" + std::to_string(level) + "/size");
  double KiB = 0.0;
  return file >> KiB ? KiB / 1024.0 : otherwise;
}

Json measure() {
  Json all;
  Json& flops = all["gflops_one_core"];
  Triad loop = sse2::triad;
  flops["sse2"]["multiply, add"] = arithmetic(sse2::multiply_add, 2);
  if (has_avx2()) {
    loop = avx2::triad;
    flops["avx2"]["multiply, add"] = arithmetic(avx2::multiply_add, 4);
    flops["avx2"]["fused"] = arithmetic(avx2_fma::multiply_add, 4);
  }
  if (has_avx512()) {
    loop = avx512::triad;
    flops["avx512"]["multiply, add"] = arithmetic(avx512::multiply_add, 8);
    flops["avx512"]["fused"] = arithmetic(avx512_fma::multiply_add, 8);
  }

  const double L2 = cache_MiB(2, 1.0), L3 = cache_MiB(3, 32.0);
  // MiB per thread: well inside L2; past it but, for two threads, in a part of L3 that one may hope to have;
  // and four times L3.
  const std::pair<const char*, double> places[] = {{"L2", 0.5 * L2},
                                                   {"L3", std::max(2.0 * L2, std::min(L3 / 8.0, 16.0))},
                                                   {"memory", std::min(4.0 * L3, 1024.0)}};
  all["caches_MiB"] = {{"L2", L2}, {"L3", L3}};
  for (const auto& [place, MiB] : places) {
    Json& there = all["triad_GB_per_s"][place];
    there["MiB_per_thread"] = MiB;
    const auto count = static_cast<std::size_t>(MiB * 1048576.0 / 24.0);
    for (int threads = 1; threads <= std::min(2, get_nprocs()); ++threads)
      there["threads " + std::to_string(threads)] = bandwidth(loop, count, threads);
  }
  return all;
}

}  // namespace
}  // namespace vbond_bench

int main() {
  std::cout << vbond_bench::measure().dump(2) << '\n';
}
