#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "temporary_folder.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond::test {

/// A folder of its own for a test, gone when the test is over.
class Folder : public TemporaryFolder {
 public:
  Folder() : TemporaryFolder(name()) {}

 private:
  static std::string name() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    static int made = 0;  // a test may have several
    return std::string("vbond_observe_") + test->test_suite_name() + "_" + test->name() + "_" +
           std::to_string(++made);
  }
};

inline std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path;
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void put_content(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    lines.push_back(text.substr(at, end - at));
  return lines;
}

/// A chain of particles along x at spacing 1, each with its own mass and radius, bonded in a row:
/// the paper's rod (B of a Bernoulli-Euler rod of diameter 0.2, nu = 0.2).
struct Chain {
  Model model;
  State state;

  explicit Chain(std::size_t n = 3) {
    model.T_0 = 6.25;
    for (std::size_t k = 0; k < n; ++k) {
      const auto x = static_cast<double>(k);
      model.mass.push_back(1.0 + 0.1 * x);
      model.inertia.push_back(0.064 + 0.01 * x);
      model.radius.push_back(0.3 + 0.01 * x);
      model.r_0.push_back({x, 0, 0});
      state.r.push_back({x, 0, 0});
      state.v.push_back({0.1 * x, -0.2, 1.0 / 3.0});
      state.q.push_back({});
      state.omega.push_back({0.0, 0.5, x / 7.0});
    }
    model.groups.push_back({"all", {}});
    for (const ParticleId p : model.mass.ids()) model.groups[0].particles.push_back(p);
    BondRecipe recipe;
    recipe.parameters = GivenCoefficients{{1.0, -0.005, 0.015, 0.00208333}};
    for (std::size_t k = 0; k + 1 < n; ++k) {
      const ParticleId i{k}, j{k + 1};
      recipe.set = static_cast<std::uint16_t>(k);
      recipe.law = k % 2 == 0 ? &bond_law<VModel> : &bond_law<Evm>;
      state.bonds.push_back(*make_bond(recipe, {i, state.r[i], state.q[i], model.radius[i]},
                                       {j, state.r[j], state.q[j], model.radius[j]}));
    }
    at_step(1200);
  }

  void at_step(std::int64_t step) {
    state.clock.step = state.clock.stage_step = step;
    state.clock.dt = 0.1;  // not a binary number: times are not round
  }

  /// Turns particle k about an axis through its centre by an angle.  [rad]
  void turn(std::size_t k, const Vec3d& axis, double angle) {
    const ParticleId p{k};
    state.q[p] = rotation_of(angle * axis) * state.q[p];
  }
};

}  // namespace vbond::test
