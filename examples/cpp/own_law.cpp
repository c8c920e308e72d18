// An elastic bond law of a program's own: the EVM with a force of stretching that hardens, N = B1 u (1 +
// (u/s)^2). Damping, strength and yielding come from the library: a sheet of such bonds is torn; a rod of
// them is pressed until it buckles, and drawn until it yields.
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "vbond/dynamics/law_with_loops.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"
#if HAS_STATICS
#include "vbond/statics/statics.hpp"
#endif

namespace own {

using namespace vbond;

template <Scalar T>
struct Tendon {
  using Number = T;
  T a, R_i, R_j;     // length at rest, attachment distances
  T B1, B2, B3, B4;  // of the EVM
  T per_s2;          // 1/s^2  [1/length^2]

  static constexpr std::string_view name = "tendon", title = "hardening EVM";
  static constexpr double strained_past = 90;  // degrees
  static constexpr std::string_view rest_condition = Evm<T>::rest_condition,
                                    rest_way_out = Evm<T>::rest_way_out;
  static constexpr auto fields() {
    constexpr auto evm = Evm<double>::fields();
    using Field = LawField<Tendon>;
    return std::array{Field{&Tendon::B1, evm[0].info}, Field{&Tendon::B2, evm[1].info},
                      Field{&Tendon::B3, evm[2].info}, Field{&Tendon::B4, evm[3].info},
                      Field{&Tendon::per_s2, {"per_s2", {0, -2}, "hardening", LawInput::given}}};
  }
  static constexpr Tendon from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
    const Evm<T> m = Evm<T>::from(c, a, R_i, R_j);
    return {a, R_i, R_j, m.B1, m.B2, m.B3, m.B4, T(0.0)};
  }
  constexpr Evm<T> evm() const { return {a, R_i, R_j, B1, B2, B3, B4}; }
};

/// What the hardening adds to the EVM.
template <Scalar T>
T stretch_energy(const Tendon<T>& m, const T& D) {
  const T u = D - m.a;
  return stretch_energy(m.evm(), D) + T(0.25) * m.B1 * m.per_s2 * sq(sq(u));
}
template <Scalar T>
T tension(const Tendon<T>& m, const T& D) {
  const T u = D - m.a;
  return m.B1 * u * (T(1.0) + m.per_s2 * sq(u));
}
template <Scalar T>
BondEnergy<T> bond_energy(const Tendon<T>& m, const BondPose<T>& b) {
  BondEnergy<T> U = bond_energy(m.evm(), b);
  U.U_L = stretch_energy(m, norm(bonded_points(b, m.R_i, m.R_j)));
  return U;
}
template <Scalar T>
BondLoads<T> bond_loads(const Tendon<T>& m, const BondPose<T>& b, const BondAxis<T>& axis) {
  return loads_at_tension(m.evm(), b, axis, tension(m, axis.D));
}
template <Scalar T>
constexpr BondStiffness<T> stiffness(const Tendon<T>& m) {
  return stiffness(m.evm());
}
inline BondRange bond_range(const Tendon<double>& m, const BondShape& s) {
  return bond_range(m.evm(), s);
}

const BondLaw tendon = law_with_loops<Tendon>();

/// Particles in a sheet of nx x ny, one apart, bonded to their neighbours. Units: a = m = c_A = 1.
struct Body {
  Model model;
  State state;
};
Body sheet(std::size_t nx, std::size_t ny, const BondRules& rules, double damping = 0.0) {
  BondRecipe recipe;
  recipe.law = &tendon;
  recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {1 / circle(0.2).A, 0.2}, circle(0.2)};
  recipe.given = {0, 0, 0, 0, 4.0};
  recipe.rules = rules;
  if (damping > 0.0) recipe.damping = {DampingBy::ratio, {damping, damping, damping, damping}};
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < nx * ny; ++k)
    r.push_back({static_cast<double>(k % nx), static_cast<double>(k / nx), 0});
  Body b{equal_particles(r, 1.0, 0.064, 0.4), {}};
  b.state = at_rest(b.model);
  const auto bond = [&](std::size_t i, std::size_t j) {
    b.state.bonds.push_back(*make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                       bond_site(b.model, b.state, ParticleId{j})));
  };
  for (std::size_t k = 0; k < nx * ny; ++k) {
    if (k % nx + 1 < nx) bond(k, k + 1);
    if (k + nx < nx * ny) bond(k, k + nx);
  }
  return b;
}

/// The sheet flies apart from its middle on.
void tear(int threads) {
  BondRules rules;
  rules.strength = linear_strength(0.05, 0.05, 0.05, 0.05);
  Body b = sheet(110, 110, rules, 0.01);
  for (const ParticleId p : b.state.r.ids())
    b.state.v[p] = 0.004 * (b.state.r[p] - Vec3d{54.5, 54.5, 0}) + Vec3d{0, 0, 1e-3 * (p.value % 7)};
  Stage stage;
  stage.dt = 0.2;
  stage.stops.duration = 20;
  Simulation run(b.model, stage, b.state, threads);
  run.run();
  const State& end = run.state();
  const auto sum = std::accumulate(end.r.begin(), end.r.end(), Vec3d{}, [](Vec3d s, const Vec3d& r) {
    return s + Vec3d{r.x * r.x, r.y * r.z, r.z};
  });
  std::size_t broken = 0;
  for (const Bond& bond : end.bonds) broken += bond.broken;
  std::printf("broken %zu of %zu bonds, released %.17g, dissipated %.17g, sums %.17g %.17g %.17g\n", broken,
              end.bonds.size(), run.books().released, run.books().dissipated, sum.x, sum.y, sum.z);
}

#if HAS_STATICS
void press() {
  const Body rod = sheet(10, 1, {});
  StaticStage stage;
  stage.name = "press";
  for (const ParticleId p : rod.model.mass.ids()) {
    const bool first = p.value == 0, last = p.value == 9;  // the x-y plane, and the pins
    stage.supports.push_back({"pins", {p}, {first, first || last, true, true, true, false}, {}, {}});
  }
  stage.loads = {{"end", {ParticleId{9}}, {-1e-4, 0, 0}}};
  stage.count = 1;
  stage.kind = StageKind::equilibrium;
  std::printf("shortened by %.9g\n",
              9.0 - run_static_stage(rod.model, stage, rod.state, {}).state.r[ParticleId{9}].x);
  stage.kind = StageKind::modes;
  std::printf("lowest frequency %.9g\n",
              run_static_stage(rod.model, stage, rod.state, {}).result.modes.at(0).omega);
  stage.kind = StageKind::buckling;
  stage.loads[0].force = {-1, 0, 0};
  std::printf("critical force %.9g\n",
              run_static_stage(rod.model, stage, rod.state, {}).result.critical_loads.at(0).force);
}

/// Each bond flows by (N - N_y)/H, and stretches by the u of N = u (1 + 4 u^2) besides.
void draw() {
  BondRules rules;
  rules.yield.limit.axial = rules.yield.compression = 0.01;
  rules.yield.isotropic.axial = 0.25;
  const Body rod = sheet(10, 1, rules);
  StaticStage stage;
  stage.name = "draw";
  stage.kind = StageKind::equilibrium;
  stage.supports = {{"fixed", {ParticleId{0}}, {true, true, true, true, true, true}, {}, {}}};
  stage.loads = {{"end", {ParticleId{9}}, {0.02, 0, 0}}};
  std::printf("drawn by %.9g\n",
              run_static_stage(rod.model, stage, rod.state, {}).state.r[ParticleId{9}].x - 9.0);
}
#endif

}  // namespace own

int main(int count, char** arguments) {
  own::tear(count > 1 ? std::atoi(arguments[1]) : 1);
#if HAS_STATICS
  own::press();
  own::draw();
#endif
}
