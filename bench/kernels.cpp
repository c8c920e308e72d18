// What one bond or one contact costs when its numbers lie in L1: laws and energies as scalars, and the
// V-model in packs with each instruction set that this processor has. per_bond is the time of one of them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "instruction_sets.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/hertz.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond_bench {

// kernels_pack.cpp, once per instruction set
namespace baseline {
void loads_of_poses(const double* law, const double* pose, std::size_t packs, double* loads);
void loads_of_ends(const double* law, const double* ends, std::size_t packs, double* loads);
}  // namespace baseline
namespace avx2 {
void loads_of_poses(const double* law, const double* pose, std::size_t packs, double* loads);
void loads_of_ends(const double* law, const double* ends, std::size_t packs, double* loads);
}  // namespace avx2
namespace avx512 {
void loads_of_poses(const double* law, const double* pose, std::size_t packs, double* loads);
void loads_of_ends(const double* law, const double* ends, std::size_t packs, double* loads);
}  // namespace avx512

namespace {

using vbond::BondFrames;
using vbond::BondPose;
using vbond::Quatd;
using vbond::Vec3d;

constexpr std::size_t count = 64;  // bonds: 22 + 9 numbers of each are 16 kB, half of a small L1

/// A bond of length 1 whose particles are turned and displaced a little.
struct Sample {
  BondFrames<double> frames;
  Quatd q_i, q_j;
  Vec3d r_i, r_j;
  BondPose<double> pose() const { return vbond::bond_pose(frames, vbond::between(r_i, r_j), q_i, q_j); }
};

std::vector<Sample> samples() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-0.1, 0.1);
  const auto turn = [&] { return vbond::rotation_of({u(random), u(random), u(random)}); };
  std::vector<Sample> all(count);
  for (Sample& s : all) {
    s.frames = {turn(), turn()};
    s.q_i = turn(), s.q_j = turn();
    s.r_i = {u(random), u(random), u(random)};
    s.r_j = {1.0 + u(random), u(random), u(random)};
  }
  return all;
}

constexpr vbond::BondStiffness<double> slender = {.c_A = 1.0, .c_D = 0.03, .c_B = 0.0025, .c_T = 0.0020833};
const auto v_model = vbond::VModel<double>::from(slender, 1.0, 0.0, 0.0);
const auto evm = vbond::Evm<double>::from(slender, 1.0, 0.0, 0.0);

void report(benchmark::State& state) {
  state.counters["per_bond"] =
      benchmark::Counter(static_cast<double>(count),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// One call of `evaluate` per sample, as a plain loop.
template <class In, class Evaluate>
void loop(benchmark::State& state, const std::vector<In>& in, Evaluate evaluate) {
  std::vector<decltype(evaluate(in[0]))> out(in.size());
  for (auto _ : state) {
    for (std::size_t n = 0; n < in.size(); ++n) out[n] = evaluate(in[n]);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

void add_scalars() {
  std::vector<BondPose<double>> poses;
  for (const Sample& s : samples()) poses.push_back(s.pose());
  const auto add = [](const char* name, const auto& in, auto evaluate) {
    benchmark::RegisterBenchmark(name,
                                 [in, evaluate](benchmark::State& state) { loop(state, in, evaluate); });
  };
  using Pose = BondPose<double>;
  add("v_model/loads/scalar", poses, [](const Pose& b) { return bond_loads(v_model, b); });
  add("v_model/loads_from_ends/scalar", samples(),
      [](const Sample& s) { return bond_loads(v_model, s.pose()); });
  add("v_model/energy/scalar", poses, [](const Pose& b) { return bond_energy(v_model, b); });
  add("evm/loads/scalar", poses, [](const Pose& b) { return bond_loads(evm, b); });
  add("evm/energy/scalar", poses, [](const Pose& b) { return bond_energy(evm, b); });

  std::vector<double> overlaps;
  for (std::size_t n = 0; n < count; ++n) overlaps.push_back(1e-3 * static_cast<double>(n));
  const auto touch = vbond::paper_hertz(1.0, 1.0);
  add("contact/force/scalar", overlaps, [touch](double delta) { return contact_force(touch, delta); });
}

using PackLoop = void (*)(const double*, const double*, std::size_t, double*);

/// Rows of `width` numbers, pack after pack, from the numbers of each sample.
template <class Numbers>
std::vector<double> rows(std::size_t width, Numbers numbers) {
  std::vector<double> all;
  const std::vector<Sample> bonds = samples();
  for (std::size_t first = 0; first < count; first += width) {
    const std::size_t height = numbers(bonds[0]).size();
    for (std::size_t k = 0; k < height; ++k)
      for (std::size_t l = 0; l < width; ++l) all.push_back(numbers(bonds[first + l])[k]);
  }
  return all;
}

std::vector<double> numbers_of_pose(const Sample& s) {
  const BondPose<double> b = s.pose();
  std::vector<double> all;
  for (const Vec3d& a : {b.r_ij, b.n_i[0], b.n_i[1], b.n_i[2], b.n_j[0], b.n_j[1], b.n_j[2]})
    all.insert(all.end(), {a.x, a.y, a.z});
  return all;
}

std::vector<double> numbers_of_ends(const Sample& s) {
  std::vector<double> all;
  for (const Quatd& q : {s.frames.i, s.frames.j, s.q_i, s.q_j}) all.insert(all.end(), {q.w, q.x, q.y, q.z});
  for (const Vec3d& r : {s.r_i, s.r_j}) all.insert(all.end(), {r.x, r.y, r.z});
  return all;
}

/// A benchmark whose kernels disagree measures nothing: stops unless the pack gives the scalar's bits.
void check(std::size_t width, const std::vector<double>& loads) {
  const std::vector<Sample> bonds = samples();
  for (std::size_t n = 0; n < count; ++n) {
    const auto expected = bond_loads(v_model, bonds[n].pose());
    std::size_t k = n / width * 9 * width + n % width;
    for (const Vec3d& a : {expected.F, expected.M_ij, expected.M_ji})
      for (const double component : {a.x, a.y, a.z}) {
        if (loads[k] != component) std::abort();
        k += width;
      }
  }
}

void add_packs(const std::string& set, std::size_t width, PackLoop of_poses, PackLoop of_ends) {
  const auto add = [&](const std::string& name, PackLoop evaluate, const std::vector<double>& in) {
    benchmark::RegisterBenchmark((name + "/" + set).c_str(), [=](benchmark::State& state) {
      const double law[] = {v_model.a,  v_model.R_i, v_model.R_j, v_model.B1,
                            v_model.B2, v_model.B3,  v_model.B4};
      std::vector<double> loads(9 * count);
      evaluate(law, in.data(), count / width, loads.data());
      check(width, loads);
      for (auto _ : state) {
        evaluate(law, in.data(), count / width, loads.data());
        benchmark::ClobberMemory();
      }
      report(state);
    });
  };
  add("v_model/loads", of_poses, rows(width, numbers_of_pose));
  add("v_model/loads_from_ends", of_ends, rows(width, numbers_of_ends));
}

}  // namespace
}  // namespace vbond_bench

int main(int argc, char** argv) {
  using namespace vbond_bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_scalars();
  add_packs("baseline", 2, baseline::loads_of_poses, baseline::loads_of_ends);
  if (has_avx2()) add_packs("avx2", 4, avx2::loads_of_poses, avx2::loads_of_ends);
  if (has_avx512()) add_packs("avx512", 8, avx512::loads_of_poses, avx512::loads_of_ends);
  benchmark::RunSpecifiedBenchmarks();
}
