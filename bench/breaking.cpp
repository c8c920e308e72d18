// What breaking costs: a block of brittle bonds that is pulled apart, beside the same block whose bonds do
// not break. Usage: breaking [edge = 60] [steps = 1000] [threads = 1]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "inelastic_laws.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/make_bond.hpp"

namespace vbond {
namespace {

struct Body {
  Model model;
  State state;
};

/// A cube of particles that stretches uniformly; strengths are spread so that bonds break all the time.
Body block(std::size_t edge, double weakest) {
  std::vector<Vec3d> r;
  const auto number = [edge](std::size_t x, std::size_t y, std::size_t z) {
    return (z * edge + y) * edge + x;
  };
  for (std::size_t k = 0; k < edge * edge * edge; ++k)
    r.push_back({double(k % edge), double(k / edge % edge), double(k / edge / edge)});
  Body b{equal_particles(r, 1.0, 0.064, 0.4), {}};
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.law = &testing::brittle_law;
  recipe.parameters = BondStiffness<double>{1.0, 0.03, 0.0025, 1.0 / 480};
  std::uint32_t random = 1;
  const auto bond = [&](std::size_t i, std::size_t j) {
    random = random * 1664525u + 1013904223u;
    recipe.given[5] = 1.0 / (weakest * (1.0 + 16.0 * (random >> 8) * 0x1p-24));
    b.state.bonds.push_back(*make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                       bond_site(b.model, b.state, ParticleId{j})));
  };
  for (std::size_t z = 0; z < edge; ++z)
    for (std::size_t y = 0; y < edge; ++y)
      for (std::size_t x = 0; x < edge; ++x) {
        if (x + 1 < edge) bond(number(x, y, z), number(x + 1, y, z));
        if (y + 1 < edge) bond(number(x, y, z), number(x, y + 1, z));
        if (z + 1 < edge) bond(number(x, y, z), number(x, y, z + 1));
      }
  b.model.contact = {.law = ContactLaw::paper_hertz, .pairs = ContactPairs::unbonded, .c_H = 0.1};
  const Vec3d middle = 0.5 * double(edge - 1) * Vec3d{1, 1, 1};
  for (const ParticleId p : b.state.r.ids()) b.state.v[p] = 2e-3 * (b.state.r[p] - middle);
  return b;
}

std::pair<double, std::size_t> run(std::size_t edge, int steps, int threads, double weakest) {
  Body b = block(edge, weakest);
  Stage stage;
  stage.dt = 0.02;
  Simulation run(b.model, stage, std::move(b.state), threads);
  run.step();
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) run.step();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t broken = 0;
  for (const Bond& bond : run.state().bonds) broken += bond.broken;
  return {seconds, broken};
}

}  // namespace
}  // namespace vbond

int main(int count, char** arguments) {
  const auto number = [&](int k, int otherwise) { return count > k ? std::atoi(arguments[k]) : otherwise; };
  const int edge = number(1, 60), steps = number(2, 1000), threads = number(3, 1);
  for (int round = 0; round < 3; ++round) {
    const auto [whole, none] = vbond::run(static_cast<std::size_t>(edge), steps, threads, 1e9);
    const auto [breaking, broken] = vbond::run(static_cast<std::size_t>(edge), steps, threads, 0.004);
    std::printf("%zu broken: %.3f s; %zu broken: %.3f s, ratio %.3f\n", none, whole, broken, breaking,
                breaking / whole);
    std::fflush(stdout);
  }
}
