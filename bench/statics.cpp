// Equilibrium of cubic blocks, clamped below and pushed aside above: time and memory against those of one
// factor of CHOLMOD; or one solver alone, for the balance, six modes, or the first critical load of a block
// pressed from above. Usage: statics [direct|multigrid|automatic [balance|modes|buckling]] [particles along
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
  Support below{"below", {}, {true, true, true, true, true, true}, {}, {}};
  PointLoad above{"above", {}, {1e-3, 0, 0}};
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

/// One kind of stage alone; the largest memory is that of the process so far.
void measure_stage(std::size_t n, const std::string& kind, LinearSolver solver) {
  Block b = cube(n);
  b.stage.newton.solver = solver;
  b.stage.count = 6;
  if (kind == "modes") {
    b.stage.kind = StageKind::modes;
    b.stage.loads.clear();
  } else if (kind == "buckling") {
    b.stage.kind = StageKind::buckling;
    b.stage.count = 1;
    b.stage.loads[0].force = {0, 0, -1};
  }
  const double before = peak_memory(), start = seconds();
  const StaticOutcome rest = run_static_stage(b.model, b.stage, std::move(b.state), {});
  const StaticResult& r = rest.result;
  const double value = !r.modes.empty()            ? r.modes.back().omega2
                       : !r.critical_loads.empty() ? r.critical_loads[0].load_factor
                                                   : r.smallest_eigenvalue.value_or(0.0);
  fmt::print("{:9} {:>10} {:>10} {:10} {:10} {:18.12g} {:9.2f} {:9.2f} {:9.2f}\n", n * n * n, r.solver,
             r.ended, r.iterations, r.solver_iterations, value, seconds() - start, before, peak_memory());
  std::fflush(stdout);
}

int measure_stages(const std::string& solver, int argc, char** argv) {
  const LinearSolver by = solver == "multigrid" ? LinearSolver::multigrid
                          : solver == "direct"  ? LinearSolver::direct
                                                : LinearSolver::automatic;
  std::string kind = argc > 2 ? argv[2] : "";
  const bool named = kind == "balance" || kind == "modes" || kind == "buckling";
  if (!named) kind = "balance";
  fmt::print("{:>9} {:>10} {:>10} {:>10} {:>10} {:>18} {:>9} {:>9} {:>9}\n", "particles", "solver", "ended",
             "Newton's", "solver's", "eigenvalue or load", "s", "GiB before", "GiB peak");
  for (int k = named ? 3 : 2; k < argc; ++k) measure_stage(std::stoul(argv[k]), kind, by);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "multigrid" || first == "direct" || first == "automatic")
    return measure_stages(first, argc, argv);
  fmt::print("{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9}\n", "particles", "unknowns",
             "assemble", "analyse", "factor", "factor", "peak", "iterations", "balance", "ratio", "peak");
  fmt::print("{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9}\n", "", "", "s", "s", "s",
             "GiB", "GiB", "", "s", "", "GiB");
  for (int k = 1; k < argc; ++k) measure(std::stoul(argv[k]));
}
