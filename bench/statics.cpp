// Equilibrium of cubic blocks, clamped below and pushed aside above: time and memory against those of one
// factor of CHOLMOD; or by a solver alone, as multigrid. Usage: statics [direct|multigrid] [particles along
// an edge]...
#include <fmt/core.h>
#include <sys/resource.h>

#include <ctime>
#include <string>
#include <utility>

#include "vbond/model/make_bond.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/statics.hpp"

namespace {

using namespace vbond;
/// Processor time so far: everything here is one thread, and other work on the machine shall not count.
double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Gibibytes resident at most so far.
double peak_memory() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_maxrss) / 0x1p20;
}

struct Block {
  Model model;
  State state;
  StaticStage stage;
};

/// n^3 particles one apart, neighbours bonded with c_A = 1, c_D = 0.5, c_B = 0.1, c_T = 0.05.
Block cube(std::size_t n) {
  std::vector<Vec3d> r;
  for (std::size_t z = 0; z < n; ++z)
    for (std::size_t y = 0; y < n; ++y)
      for (std::size_t x = 0; x < n; ++x)
        r.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
  Block b{equal_particles(r, 1.0, 0.1, 0.5), {}, {}};
  b.state = at_rest(b.model);
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.5, 0.1, 0.05};
  const auto bond = [&](std::size_t i, std::size_t j) {
    b.state.bonds.push_back(make_bond(recipe, bond_site(b.model, b.state, ParticleId{i}),
                                      bond_site(b.model, b.state, ParticleId{j}))
                                .value());
  };
  StaticSupport below{"below", {}, {true, true, true, true, true, true}, {}, {}};
  StaticLoad above{"above", {}, {1e-3, 0, 0}, {}, false};
  for (std::size_t k = 0; k < r.size(); ++k) {
    const std::size_t x = k % n, y = k / n % n, z = k / (n * n);
    if (x + 1 < n) bond(k, k + 1);
    if (y + 1 < n) bond(k, k + n);
    if (z + 1 < n) bond(k, k + n * n);
    if (z == 0) below.particles.push_back(ParticleId{k});
    if (z + 1 == n) above.particles.push_back(ParticleId{k});
  }
  b.stage.name = "block";
  b.stage.supports = {below};
  b.stage.loads = {above};
  return b;
}

void measure(std::size_t n) {
  Block b = cube(n);
  double analysis = 0, factor = 0, assembly = 0, gigabytes = 0;
  int unknowns = 0;
  {
    const StaticBody body(b.model, b.stage, b.state);
    unknowns = body.unknowns().size();
    body.tangent();
    const StaticBody again(b.model, b.stage, b.state);
    double start = seconds();
    again.tangent();
    assembly = seconds() - start;
    Factor f;
    start = seconds();
    f.analyse(body.tangent());
    analysis = seconds() - start;
    gigabytes = f.bytes() / 0x1p30;
    start = seconds();
    f.factor_definite(body.tangent());
    factor = seconds() - start;
  }
  const double memory_of_factor = peak_memory();
  const double start = seconds();
  const StaticOutcome rest = run_static_stage(b.model, b.stage, std::move(b.state), {});
  const double all = seconds() - start;
  fmt::print("{:9} {:9} {:9.3f} {:9.3f} {:9.3f} {:9.2f} {:9.2f} {:10} {:9.3f} {:9.1f} {:9.2f}\n", n * n * n,
             unknowns, assembly, analysis, factor, gigabytes, memory_of_factor, rest.result.iterations, all,
             all / (analysis + factor), peak_memory());
  std::fflush(stdout);
}

/// The balance alone; the largest memory is that of the process so far.
void measure_balance(std::size_t n, LinearSolver solver) {
  Block b = cube(n);
  b.stage.newton.solver = solver;
  const double before = peak_memory(), start = seconds();
  const StaticOutcome rest = run_static_stage(b.model, b.stage, std::move(b.state), {});
  const StaticResult& r = rest.result;
  fmt::print("{:9} {:>10} {:10} {:9} {:13.8g} {:9.2f} {:9.2f} {:9.2f}\n", n * n * n, r.solver, r.iterations,
             r.unstable.value_or(-1), r.smallest_eigenvalue.value_or(0.0), seconds() - start, before,
             peak_memory());
  std::fflush(stdout);
}

int measure_balances(LinearSolver solver, int argc, char** argv) {
  fmt::print("{:>9} {:>10} {:>10} {:>9} {:>13} {:>9} {:>9} {:>9}\n", "particles", "solver", "iterations",
             "unstable", "eigenvalue", "s", "GiB before", "GiB peak");
  for (int k = 2; k < argc; ++k) measure_balance(std::stoul(argv[k]), solver);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "multigrid") return measure_balances(LinearSolver::multigrid, argc, argv);
  if (first == "direct") return measure_balances(LinearSolver::direct, argc, argv);
  fmt::print("{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9}\n", "particles", "unknowns",
             "assemble", "analyse", "factor", "factor", "peak", "iterations", "balance", "ratio", "peak");
  fmt::print("{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9}\n", "", "", "s", "s", "s",
             "GiB", "GiB", "", "s", "", "GiB");
  for (int k = 1; k < argc; ++k) measure(std::stoul(argv[k]));
}
