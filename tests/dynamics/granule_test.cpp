// GR1 and GR2 of the reference: a cube of eight bonded particles that is thrown at a wall, whole and
// breaking.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "material_cases.hpp"
#include "rods.hpp"

namespace vbond::granule_test {
namespace {

using testing::Specimen;

Vec3d vector(const nlohmann::json& x) {
  return {x[0], x[1], x[2]};
}

std::array<double, 4> four(const nlohmann::json& x) {
  return {x[0], x[1], x[2], x[3]};
}

/// The limits of LAMMPS' linear sum for a bond; none if the case has none.
Strength strength_of(const nlohmann::json& setup, std::size_t i, std::size_t j) {
  if (setup["limits"].is_null()) return {};
  bool weak = false;
  for (const auto& pair : setup["weak"]) weak = weak || (pair[0] == i && pair[1] == j);
  const double factor = weak ? 1.0 : setup["factor_others"].get<double>();
  std::array<double, 4> f{};
  for (std::size_t k = 0; k < 4; ++k) f[k] = factor * setup["limits"][k].get<double>();
  return linear_strength(f[0], f[1], f[2], f[3]);
}

/// Particles 4 i + 2 j + l at (+-1/2)^3 in body axes, turned; the lowest one touches the wall z = 0.
Specimen granule(const nlohmann::json& setup) {
  const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Quatd turn = rotation_of(vector(setup["rotvec"]));
  std::vector<Vec3d> r;
  double lowest = 1e9;
  const auto half = [](std::size_t bit) { return bit == 0 ? -0.5 : 0.5; };
  for (std::size_t k = 0; k < 8; ++k) {
    r.push_back(rotate(turn, Vec3d{half(k / 4), half(k / 2 % 2), half(k % 2)}));
    lowest = std::min(lowest, r.back().z);
  }
  for (Vec3d& x : r) x.z += setup["radius"].get<double>() - lowest;
  Specimen s = testing::particles_at(r, setup["radius"], setup["Theta"]);
  for (std::size_t k = 0; k < 8; ++k)
    for (const std::size_t bit : {4u, 2u, 1u}) {
      if ((k & bit) != 0) continue;
      const std::size_t along = bit == 4 ? 0 : bit == 2 ? 1 : 2;
      BondRecipe recipe;
      const auto [c_A, c_D, c_B, c_T] = four(setup["c"]);
      recipe.parameters = BondStiffness<double>{c_A, c_D, c_B, c_T};
      recipe.damping = {DampingBy::coefficients, four(setup["g"])};
      recipe.rules.strength = strength_of(setup, k, k + bit);
      recipe.attachment = Attachment::centres;
      recipe.n_2 = rotate(turn, axes[(along + 1) % 3]);
      testing::bond(s, k, k + bit, recipe);
    }
  s.model.contact = {.law = ContactLaw::paper_hertz, .pairs = ContactPairs::none, .c_H = setup["k_wall"]};
  s.model.walls = {{"wall", PlaneWall{{0, 0, 0}, {0, 0, 1}}, 0, {}}};
  for (Vec3d& v : s.state.v) v = {0, 0, -setup["v0"].get<double>()};
  return s;
}

struct Flight {
  Vec3d v;             // of the centre of mass
  double impulse = 0;  // of the wall
  double imbalance = 0;
  State state;
  std::vector<std::pair<double, BondEvent>> breaks;
};
Flight fly(const nlohmann::json& setup, double dt) {
  const Specimen s = granule(setup);
  Simulation run(s.model, testing::plain_stage(dt, setup["T"]), s.state);
  Flight f;
  double before = 0.0;
  std::size_t seen = 0;
  while (run.clock().stage_time() < setup["T"].get<double>() - 0.5 * dt) {
    run.step();
    const double now = -run.walls()[0].force.z;
    f.impulse += 0.5 * dt * (before + now);
    before = now;
    for (; seen < run.events().size(); ++seen) f.breaks.emplace_back(run.clock().time(), run.events()[seen]);
  }
  f.state = run.state();
  for (const Vec3d& v : f.state.v) f.v += 0.125 * v;
  f.imbalance = run.balance_error();
  return f;
}

// The step errs by (omega dt)^2/24 of the fastest mode's phase; omega^2 dt^2 = 4e-5 here.
TEST(Granule, BouncesOffAWallAsTheReferenceSays) {
  const nlohmann::json reference = testing::material_case("GR1");
  const Flight f = fly(reference["setup"], 2e-3);
  const nlohmann::json& exact = reference["expected"];
  EXPECT_NEAR(f.v.z, exact["v_cm"][2], 1e-5);
  EXPECT_NEAR(f.v.x, 0.0, 1e-12);
  EXPECT_NEAR(f.impulse, exact["wall_impulse"], 1e-4);
  EXPECT_LT(std::abs(f.imbalance), 1e-5);
  for (std::size_t k = 0; k < 8; ++k)
    EXPECT_LT(norm(f.state.r[ParticleId{k}] - vector(exact["positions"][k])), 2e-4) << k;
}

// A bond breaks at the end of the step in which it reaches its strength.
TEST(Granule, BreaksOnAWallAsTheReferenceSays) {
  const nlohmann::json reference = testing::material_case("GR2");
  const double dt = 1e-3;
  const Flight f = fly(reference["setup"], dt);
  const nlohmann::json& exact = reference["expected"];
  ASSERT_EQ(f.breaks.size(), exact["events"].size());
  for (std::size_t k = 0; k < f.breaks.size(); ++k) {
    const auto& [t, event] = f.breaks[k];
    const nlohmann::json& e = exact["events"][k];
    const Bond& b = f.state.bonds[event.bond];
    EXPECT_EQ(b.i.value, e["bond"][0]);
    EXPECT_EQ(b.j.value, e["bond"][1]);
    EXPECT_NEAR(t, e["t"], (1.0 + double(k)) * dt);  // as much as a step late, and so is what follows
    EXPECT_NEAR(event.energy, e["released"], 2e-5);
  }
  EXPECT_NEAR(f.v.z, exact["v_cm"][2], 1e-3);
  EXPECT_NEAR(f.impulse, exact["wall_impulse"], 1e-3 * 8);
}

}  // namespace
}  // namespace vbond::granule_test
