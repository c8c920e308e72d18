// The V-model's loads with vbond::Vec3d and with Eigen::Vector3d: one formula, two vector types, each as a
// plain loop over packed poses and as a vector loop over a structure of arrays. See
// docs/decisions/vectors.md.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdlib>
#include <random>
#include <vector>

#include "vbond/core/quat.hpp"
#include "vbond/physics/vmodel.hpp"

namespace {

using vbond::sq;
using vbond::Vec3d;

template <class A, class B>
double dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.dot(b);
}
template <class A, class B>
Eigen::Vector3d cross(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a.cross(b);
}
template <class A>
double norm(const Eigen::MatrixBase<A>& a) {
  return a.norm();
}

template <class V>
struct Pose {
  V r_ij, n_i[3], n_j[3];
};
template <class V>
struct Loads {
  V F, M_ij, M_ji;
};

/// bond_loads of physics/vmodel.hpp with the vector type left open. Forced inline and unrolled: a call or an
/// inner loop inside a vector loop keeps g++ 12 from vectorising it.
template <class V>
[[gnu::always_inline]] inline Loads<V> v_model_loads(const vbond::VModel<double>& m, const Pose<V>& b) {
  const V D_ij = b.r_ij + m.R_j * b.n_j[0] - m.R_i * b.n_i[0];
  const double D = norm(D_ij);
  const double per_D = 1.0 / D;
  const V d = per_D * D_ij;

  const double c_i = dot(d, b.n_i[0]), c_j = dot(d, b.n_j[0]), s1 = dot(b.n_i[0], b.n_j[0]);
  const V n_i1_across = b.n_i[0] - c_i * d, n_j1_across = b.n_j[0] - c_j * d;
  V F = m.B1 * (D - m.a) * d - (m.B3 * per_D) * (c_i * n_i1_across + c_j * n_j1_across);
  V M_ij = cross(b.n_i[0], m.B2 * s1 * b.n_j[0] + m.B3 * c_i * d);
  V M_ji = cross(b.n_j[0], m.B2 * s1 * b.n_i[0] + m.B3 * c_j * d);
#pragma GCC unroll 2
  for (int k = 1; k < 3; ++k) {
    const double s1k = dot(b.n_i[k], b.n_j[k]), s2k = dot(d, b.n_i[k]), s3k = -dot(d, b.n_j[k]);
    const double p = s1k + s2k * s3k, q2 = 1.0 + sq(s2k), q3 = 1.0 + sq(s3k);
    const double U1k = -0.5 * m.B4 * p * q2 * q3;
    const double U2k = -0.5 * m.B4 * p * q3 * (s3k * q2 + p * s2k);
    const double U3k = -0.5 * m.B4 * p * q2 * (s2k * q3 + p * s3k);
    F += per_D * (U2k * (b.n_i[k] - s2k * d) - U3k * (b.n_j[k] + s3k * d));
    M_ij += cross(U1k * b.n_j[k] + U2k * d, b.n_i[k]);
    M_ji += cross(U1k * b.n_i[k] - U3k * d, b.n_j[k]);
  }
  return {F, M_ij + m.R_i * cross(b.n_i[0], F), M_ji - m.R_j * cross(b.n_j[0], F)};
}

// Poses and loads fill a good part of the L2 cache, as in a block of a real run.
constexpr std::size_t count = 2048;
const vbond::VModel<double> slender{1.0, 0.3, 0.4, 1.0, -0.005, 0.015, 0.00208333};

std::vector<vbond::BondPose<double>> random_poses() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-0.3, 0.3);
  const auto turned = [&](const vbond::Quatd& q, const Vec3d& n) { return vbond::rotate(q, n); };
  std::vector<vbond::BondPose<double>> poses(count);
  for (auto& b : poses) {
    const vbond::Quatd q_i = vbond::rotation_of({u(random), u(random), u(random)});
    const vbond::Quatd q_j = vbond::rotation_of({u(random), u(random), u(random)});
    b.r_ij = {1.7 + u(random), u(random), u(random)};
    const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    const Vec3d at_i[3] = {x, y, z}, at_j[3] = {-x, y, z};
    for (int k = 0; k < 3; ++k) b.n_i[k] = turned(q_i, at_i[k]), b.n_j[k] = turned(q_j, at_j[k]);
  }
  return poses;
}

template <class V>
V as(const Vec3d& a) {
  return V{a.x, a.y, a.z};
}
double xyz(const Vec3d& a, int k) {
  return k == 0 ? a.x : k == 1 ? a.y : a.z;
}
double xyz(const Eigen::Vector3d& a, int k) {
  return a[k];
}

template <class V>
Pose<V> packed(const vbond::BondPose<double>& b) {
  Pose<V> p{as<V>(b.r_ij), {}, {}};
  for (int k = 0; k < 3; ++k) p.n_i[k] = as<V>(b.n_i[k]), p.n_j[k] = as<V>(b.n_j[k]);
  return p;
}

/// A benchmark whose kernels disagree measures nothing: stops unless both agree to rounding.
template <class V>
void check(const vbond::BondPose<double>& b) {
  const auto expected = vbond::bond_loads(slender, b);
  const auto found = v_model_loads(slender, packed<V>(b));
  for (int k = 0; k < 3; ++k)
    if (std::abs(xyz(found.F, k) - xyz(expected.F, k)) > 1e-14 ||
        std::abs(xyz(found.M_ij, k) - xyz(expected.M_ij, k)) > 1e-14 ||
        std::abs(xyz(found.M_ji, k) - xyz(expected.M_ji, k)) > 1e-14)
      std::abort();
}

void report(benchmark::State& state) {
  state.counters["per_bond"] =
      benchmark::Counter(static_cast<double>(count),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class V>
void packed_loop(benchmark::State& state) {
  std::vector<Pose<V>> poses;
  for (const auto& b : random_poses()) check<V>(b), poses.push_back(packed<V>(b));
  std::vector<Loads<V>> loads(count);
  for (auto _ : state) {
    for (std::size_t n = 0; n < count; ++n) loads[n] = v_model_loads(slender, poses[n]);
    benchmark::DoNotOptimize(loads.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class V>
void simd_loop(benchmark::State& state) {
  std::array<std::vector<double>, 21> in;  // r_ij, n_i[0..2], n_j[0..2], component by component
  std::array<std::vector<double>, 9> out;  // F, M_ij, M_ji
  for (auto& column : out) column.resize(count);
  for (const auto& b : random_poses()) {
    const Vec3d all[7] = {b.r_ij, b.n_i[0], b.n_i[1], b.n_i[2], b.n_j[0], b.n_j[1], b.n_j[2]};
    for (std::size_t c = 0; c < 21; ++c) in[c].push_back(xyz(all[c / 3], static_cast<int>(c % 3)));
  }
  const double* x[21];
  double* y[9];
  for (std::size_t c = 0; c < 21; ++c) x[c] = in[c].data();
  for (std::size_t c = 0; c < 9; ++c) y[c] = out[c].data();
  for (auto _ : state) {
#pragma omp simd
    for (std::size_t n = 0; n < count; ++n) {
      const auto vector = [&](int c) { return V{x[c][n], x[c + 1][n], x[c + 2][n]}; };
      const Pose<V> b{vector(0), {vector(3), vector(6), vector(9)}, {vector(12), vector(15), vector(18)}};
      const Loads<V> l = v_model_loads(slender, b);
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        y[k][n] = xyz(l.F, k);
        y[3 + k][n] = xyz(l.M_ij, k);
        y[6 + k][n] = xyz(l.M_ji, k);
      }
    }
    benchmark::DoNotOptimize(y);
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(packed_loop<Vec3d>)->Name("packed/Vec3d");
BENCHMARK(packed_loop<Eigen::Vector3d>)->Name("packed/Eigen");
BENCHMARK(simd_loop<Vec3d>)->Name("simd/Vec3d");
BENCHMARK(simd_loop<Eigen::Vector3d>)->Name("simd/Eigen");

}  // namespace
