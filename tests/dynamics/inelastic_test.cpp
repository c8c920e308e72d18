// Bonds that damp, remember and break, by laws of these tests: what carries such laws in the step loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "inelastic_laws.hpp"
#include "random_pose.hpp"
#include "rods.hpp"
#include "vbond/dynamics/neighbours.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/step_bound.hpp"

namespace vbond {
namespace {

using testing::brittle_law;
using testing::damped_law;
using testing::Specimen;

nlohmann::json reference(const std::string& id) {
  std::ifstream file(VBOND_TEST_DATA "/damping.json");
  const nlohmann::json all = nlohmann::json::parse(file);
  for (const auto& c : all["cases"])
    if (c["id"] == id) return c;
  return {};
}
Vec3d vector(const nlohmann::json& j) {
  return {j[0], j[1], j[2]};
}
Quatd turned(const nlohmann::json& j) {
  const double w = j[0], x = j[1], y = j[2], z = j[3], n = std::sqrt(w * w + x * x + y * y + z * z);
  return {w / n, x / n, y / n, z / n};
}

/// A recipe by stiffnesses c_A, c_D, c_B, c_T, and the coefficients that do not follow from them.
BondRecipe recipe_of(const BondLaw& law, const BondStiffness<double>& c, const std::vector<double>& given) {
  BondRecipe recipe;
  recipe.law = &law;
  recipe.parameters = c;
  std::copy(given.begin(), given.end(), recipe.given.begin() + 4);
  return recipe;
}
constexpr BondStiffness<double> slender{1.0, 0.03, 0.0025, 1.0 / 480};
BondRecipe damped(double part) {
  return recipe_of(damped_law, slender, {0.2 * part, 0.02 * part, 0.01 * part, 0.001 * part});
}
/// Flows at N/eta, breaks at the strength.
BondRecipe brittle(double per_eta, double strength) {
  return recipe_of(brittle_law, slender, {per_eta, 1.0 / strength});
}

/// A sheet of n x n particles, each bonded to its neighbours along both axes, bonds of these kinds in turn,
/// moved and turning at random; its particles overlap where they are not bonded, if they are close.
Specimen sheet(std::size_t n, const std::vector<BondRecipe>& kinds, double speed, unsigned seed) {
  std::vector<Vec3d> r;
  for (std::size_t x = 0; x < n; ++x)
    for (std::size_t y = 0; y < n; ++y) r.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  Specimen s = testing::particles_at(r, 0.55);
  std::size_t k = 0;
  for (std::size_t x = 0; x < n; ++x)
    for (std::size_t y = 0; y < n; ++y) {
      if (x + 1 < n) testing::bond(s, x * n + y, (x + 1) * n + y, kinds[k++ % kinds.size()]);
      if (y + 1 < n) testing::bond(s, x * n + y, x * n + y + 1, kinds[k++ % kinds.size()]);
    }
  testing::Dice dice(seed);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
    s.state.omega[p] = {dice(-speed, speed), dice(-speed, speed), dice(-speed, speed)};
  }
  return s;
}
std::size_t broken_in(const State& s) {
  return static_cast<std::size_t>(
      std::count_if(s.bonds.begin(), s.bonds.end(), [](const Bond& b) { return b.broken; }));
}

// ---- damping ----------------------------------------------------------------------------------------

TEST(DampedBond, HasTheLoadsOfTheReference) {
  const nlohmann::json c = reference("DA1");
  for (const auto& e : c["expected"]) {
    const double a = e["a"], R_i = e["R_i"], R_j = e["R_j"];
    const testing::Damped<double> law{a,         R_i,      R_j,      e["B"][0], e["B"][1], e["B"][2],
                                      e["B"][3], e["g_A"], e["g_D"], e["g_B"],  e["g_T"]};
    const Quatd q_i = turned(e["q_i_wxyz_unnormalised"]), q_j = turned(e["q_j_wxyz_unnormalised"]);
    const BondPose<double> pose =
        bond_pose(BondFrames<double>{}, between(vector(e["r_i"]), vector(e["r_j"])), q_i, q_j);
    const BondRates<double> rates{vector(e["v_j"]) - vector(e["v_i"]), vector(e["w_i"]), vector(e["w_j"])};
    const BondLoads<double> l = bond_damping(law, pose, bond_axis(pose, R_i, R_j), rates);
    EXPECT_LT(norm(l.F - vector(e["F_damp_on_i"])), 1e-12);
    EXPECT_LT(norm(l.M_ij - vector(e["M_damp_i"])), 1e-12);
    EXPECT_LT(norm(l.M_ji - vector(e["M_damp_j"])), 1e-12);
    EXPECT_NEAR(-power_taken(l, rates), e["power"], 1e-12);
  }
}

TEST(DampedBond, NeverGivesPowerAndBalances) {
  testing::PoseSource random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const testing::Damped<double> law{1.0,
                                      random.uniform(0, 0.4),
                                      random.uniform(0, 0.4),
                                      1,
                                      0.1,
                                      0.1,
                                      0.1,
                                      random.uniform(0, 1),
                                      random.uniform(0, 1),
                                      random.uniform(0, 1),
                                      random.uniform(0, 1)};
    const BondPose<double> pose = random.pair(1.0 + law.R_i + law.R_j, 0.3, 2.0).pose();
    const BondRates<double> rates{random.vector(1.0), random.vector(1.0), random.vector(1.0)};
    const BondLoads<double> l = bond_damping(law, pose, bond_axis(pose, law.R_i, law.R_j), rates);
    EXPECT_GE(power_taken(l, rates), 0.0);
    EXPECT_LT(norm(l.M_ij + l.M_ji - cross(pose.r_ij, l.F)), 1e-13 * 10);  // some 100 roundings of order one
  }
}

/// DA2: two free particles in large motion, dissipated and kinetic energy at t = 30.
struct DampedRun {
  double kinetic, dissipated, balance, away;
};
DampedRun damped_pair(double dt) {
  const auto c = reference("DA2");
  Specimen s = testing::particles_at({{0, 0, 0}, {1.2, 0, 0}}, 0.1);
  // masses 1 and inertias 0.064: omega0^2 = 2 c_A / m of stretching, 2 c_T / Theta of torsion
  const auto& g = c["setup"]["g"];
  BondRecipe recipe =
      recipe_of(damped_law, {1.0, 0.03, 0.0025, 0.0020833333333333333}, {g[0], g[1], g[2], g[3]});
  recipe.attachment = Attachment::given, recipe.R_i = recipe.R_j = 0.1;
  recipe.n_2 = Vec3d{0, 1, 0};
  testing::bond(s, 0, 1, recipe);
  s.state.v = {{.02, .05, -.03}, {-.04, .02, .06}};
  s.state.omega = {{.2, -.1, .3}, {.1, .25, -.2}};
  Simulation run(s.model, testing::plain_stage(dt, 30.0), s.state);
  run.run();
  const auto& e = c["expected"]["run"];
  const Energies U = run.energies();
  return {U.kinetic() - e["E_kin"].get<double>(), run.books().dissipated - e["dissipated"].get<double>(),
          std::abs(U.total() + run.books().dissipated - run.books().at_start),
          norm(run.state().v[ParticleId{0}] - vector(e["v_i"]))};
}

// Rates of half a step ago make the motion of damped bonds first-order accurate: the error is some dt C v'/2.
// What is booked as dissipated is the work that damping does in the kicks, so that the books close as they do
// without damping: to second order.
TEST(DampedBond, ConvergesToTheReferenceToFirstOrderAndItsBooksToSecond) {
  const DampedRun coarse = damped_pair(0.05), fine = damped_pair(0.025), finest = damped_pair(0.0125);
  EXPECT_LT(finest.away, 3e-4);
  EXPECT_NEAR(coarse.away / fine.away, 2.0, 0.1);
  EXPECT_NEAR(fine.away / finest.away, 2.0, 0.05);
  EXPECT_NEAR(coarse.dissipated / fine.dissipated, 2.0, 0.2);
  EXPECT_GT(coarse.balance / fine.balance, 3.5);
  EXPECT_GT(fine.balance / finest.balance, 3.5);
}

TEST(DampedBond, KeepsMomentumAndAngularMomentum) {
  const Specimen s = sheet(12, {damped(1.0), testing::papers_bond()}, 0.05, 3);
  const auto momenta = [&](const State& state) {
    Vec3d P, L;
    for (const ParticleId p : state.r.ids()) {
      P += s.model.mass[p] * state.v[p];
      L += s.model.mass[p] * cross(state.r[p], state.v[p]) + s.model.inertia[p] * state.omega[p];
    }
    return std::pair{P, L};
  };
  Simulation run(s.model, testing::plain_stage(0.2, 100.0), s.state);
  run.run();
  const auto [P, L] = momenta(s.state);
  const auto [P_end, L_end] = momenta(run.state());
  // 144 particles, 500 steps, r up to 20: some 1e5 roundings of 1e-16 of numbers of order one
  EXPECT_LT(norm(P_end - P), 1e-12);
  EXPECT_LT(norm(L_end - L), 1e-11);
  EXPECT_GT(run.books().dissipated, 0.3 * run.books().at_start);
  EXPECT_LT(std::abs(run.balance_error()), 5e-3);
}

/// Kinetic energy of a free chain of ten after many steps, over that at the start.
double growth(const std::vector<double>& g, double dt, int steps) {
  Specimen s = testing::straight_rod(10, recipe_of(damped_law, slender, g));
  testing::Dice dice(11);
  for (const ParticleId p : s.state.r.ids()) {
    s.state.v[p] = {dice(-1e-9, 1e-9), dice(-1e-9, 1e-9), dice(-1e-9, 1e-9)};
    s.state.omega[p] = {dice(-1e-9, 1e-9), dice(-1e-9, 1e-9), dice(-1e-9, 1e-9)};
  }
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  const double before = run.energies().kinetic();
  for (int k = 0; k < steps; ++k) run.step();
  return run.energies().kinetic() / before;
}

// DA4: the true limits of a chain of ten, and the bound of one bond, which must not be above them.
TEST(DampedBond, IsStableUpToItsLimitAndTheBoundIsJustBelow) {
  const nlohmann::json c = reference("DA4");
  for (const auto& row : c["expected"]["rows"]) {
    const std::vector<double> g = row["g"];
    const double limit = row["dt_limit_true"], bound = row["dt_bound"];
    const Specimen s = testing::straight_rod(10, recipe_of(damped_law, slender, g));
    EXPECT_NEAR(step_bound(s.model, s.state).dt, bound, 1e-9 * bound);
    EXPECT_LT(growth(g, 0.999 * limit, 4000), 30.0) << "g_A = " << g[0];
    EXPECT_GT(growth(g, 1.003 * limit, 4000), 1e3) << "g_A = " << g[0];
  }
}

// ---- what bonds remember ----------------------------------------------------------------------------

// One bond pulled apart to a fixed length relaxes like a Maxwell body: N = c_A u exp(-c_A t/eta).
TEST(RememberingBond, RelaxesAndBooksWhatItDissipates) {
  const double per_eta = 0.01, u = 0.02, dt = 0.05, t = 100.0;
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}});
  testing::bond(s, 0, 1, brittle(per_eta, 1e9));
  s.state.r[ParticleId{1}].x += u;
  Stage stage = testing::plain_stage(dt, t);
  stage.supports = {testing::held({ParticleId{0}, ParticleId{1}}, testing::clamped)};
  Simulation run(s.model, stage, s.state);
  run.run();
  const double N = mean_axial_force(run.part(), s.model.groups[0].particles);
  EXPECT_NEAR(N, u * std::exp(-per_eta * t), u * per_eta * dt);  // (1 - x)^n for exp(-n x), x = 5e-4
  EXPECT_NEAR(run.state().bond_history[BondId{0}][0], u - N, 1e-15);
  EXPECT_NEAR(run.books().dissipated, 0.5 * (u * u - N * N), 1e-15);
  EXPECT_LT(std::abs(run.balance_error()), 1e-12);
}

// ---- bonds that break -------------------------------------------------------------------------------

// A chain of three is pulled; the weaker bond breaks when its tension passes the strength, and its energy is
// released.
TEST(BreakingBond, LeavesItsEnergyInTheBooksAndIsReported) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  testing::bond(s, 0, 1, brittle(0.0, 1.0));
  testing::bond(s, 1, 2, brittle(0.0, 0.01));
  s.state.v[ParticleId{2}].x = 0.001;
  Stage stage = testing::plain_stage(0.01, 200.0);
  stage.supports = {testing::held({ParticleId{2}}, testing::clamped, {0.001, 0, 0}),
                    testing::held({ParticleId{0}}, testing::clamped)};
  Simulation run(s.model, stage, s.state);
  run.run();
  const State& end = run.state();
  EXPECT_FALSE(end.bonds[BondId{0}].broken);
  EXPECT_TRUE(end.bonds[BondId{1}].broken);
  ASSERT_EQ(run.events().size(), 1u);
  EXPECT_EQ(run.events()[0].kind, BondEvent::Kind::broken);
  EXPECT_EQ(run.events()[0].bond, BondId{1});
  // u = strength / c_A, passed by at most one step's way
  EXPECT_NEAR(run.events()[0].energy, 0.5 * 0.01 * 0.01, 0.01 * 0.001 * 0.01 * 2);
  EXPECT_EQ(run.books().released, run.events()[0].energy);
  EXPECT_LT(std::abs(run.balance_error()), 1e-5);  // leap-frog's own, dt^2
}

// Each observer sees each event once, whenever it looks.
TEST(BreakingBond, IsAnEventThatObserversSeeOnce) {
  struct Counter : Observer {
    std::vector<BondId> seen;
    void observe(const Simulation& run) override {
      for (const BondEvent& e : run.events()) seen.push_back(e.bond);
    }
    std::int64_t steps_to_next_look(const Clock&) const override { return 7; }
  };
  Specimen s = testing::straight_rod(9, brittle(0.0, 1e-3));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = 1e-3 * static_cast<double>(p.value * p.value);
  Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state);
  const auto counter = std::make_shared<Counter>();
  run.add_observer(counter);
  for (int k = 0; k < 7 * 100; ++k) run.step();
  EXPECT_GT(broken_in(run.state()), 2u);
  EXPECT_EQ(counter->seen.size(), broken_in(run.state()));
}

// What breaks in a step acts no more in the next: a body whose bonds are all broken flies apart straight on.
TEST(BreakingBond, ActsNoMoreAfterTheStepInWhichItBroke) {
  Specimen s = testing::straight_rod(9, brittle(0.0, 1e-3));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = 0.1 * static_cast<double>(p.value);
  Simulation run(s.model, testing::plain_stage(0.05, 1e9), s.state);
  while (broken_in(run.state()) < 8) run.step();
  const State first = run.state();
  run.step(), run.step();
  for (const ParticleId p : first.r.ids()) EXPECT_LT(norm(run.state().v[p] - first.v[p]), 1e-16 * 10);
}

// A bond that breaks between particles that overlap switches their contact on; its energy is taken from what
// the bond releases.
double contact_balance(double dt) {
  Specimen s = testing::particles_at({{0, 0, 0}, {1, 0, 0}}, 0.6);
  s.model.contact = {.law = ContactLaw::paper_hertz, .pairs = ContactPairs::unbonded, .c_H = 0.1};
  testing::bond(s, 0, 1, brittle(0.0, 1e-4));
  s.state.v[ParticleId{1}].x = 0.001;
  Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
  while (run.events().empty()) run.step();
  EXPECT_GT(run.energies().contact, 0.0);
  EXPECT_LT(run.books().released, 0.0);  // 0.04 (0.2)^(5/2) of contact against 5e-9 of the bond
  while (run.clock().time() < 10.0) run.step();
  EXPECT_EQ(run.energies().contact, 0.0);
  return std::abs(run.energies().total() + run.books().released - run.books().at_start);
}
TEST(BreakingBond, MakesAContactOfThePair) {
  // the books close to second order: what is left is leap-frog's own, of a contact energy of 7e-4
  const double coarse = contact_balance(0.02), fine = contact_balance(0.01);
  EXPECT_LT(fine, 2e-6);
  EXPECT_GT(coarse / fine, 3.0);
}

// Broken bonds are sorted out lazily, and bonds are made again under new numbers.
TEST(BreakingBond, KeepsItsNumberAndThePairCanBeBondedAgain) {
  Specimen s = testing::straight_rod(40, brittle(0.0, 0.02));
  for (const ParticleId p : s.state.r.ids()) s.state.v[p].x = p.value % 2 == 0 ? -0.08 : 0.08;
  Stage stage = testing::plain_stage(0.05, 1e9);
  BondingRule rule;
  rule.name = "again";
  rule.in_a.assign(40, 1), rule.in_b.assign(40, 1);
  rule.distance = 0.98;
  rule.recipe = brittle(0.0, 1e9);
  stage.bonding = {rule};
  Simulation run(s.model, stage, s.state);
  for (int k = 0; k < 400; ++k) run.step();
  const State& end = run.state();
  EXPECT_GE(broken_in(end), 19u);
  EXPECT_GT(end.bonds.size(), 39u + 19u);
  for (std::size_t k = 0; k < 39; ++k) {
    EXPECT_EQ(end.bonds[BondId{k}].i, ParticleId{k});
    EXPECT_EQ(end.bonds[BondId{k}].j, ParticleId{k + 1});
  }
  EXPECT_LT(std::abs(run.balance_error()), 3e-3);  // leap-frog's own: (omega dt)^2 / 4
}

TEST(NeighbourList, WithPairsAddedIsTheOneARebuildMakes) {
  testing::Dice dice(4);
  std::vector<PoseRow> pose(300);
  for (PoseRow& p : pose) p.r = {dice(0, 5), dice(0, 5), dice(0, 5)};
  bool leave_out = true;
  const auto odd = [](Row i, Row j) { return (i.value + j.value) % 3 == 1; };
  const NeighbourList::Keep keep = [&](Row i, Row* first, Row* last) {
    return std::remove_if(first, last, [&](Row j) { return leave_out && odd(i, j); });
  };
  const Team team(304, {304, 0, 0}, 1);
  NeighbourList list(PerRow<double>(300, 0.4), 0.1, keep), whole = list;
  list.refresh(pose, team);
  leave_out = false;
  whole.refresh(pose, team);
  for (std::size_t i = 0; i < 300; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (odd(Row{i}, Row{j})) list.add(Row{i}, Row{j});
  for (std::size_t i = 0; i < 300; ++i)
    EXPECT_TRUE(std::ranges::equal(list.of(Row{i}), whole.of(Row{i}))) << i;
}

// ---- the same bits ----------------------------------------------------------------------------------

/// Elastic, damped and brittle bonds in one body, some of which break on the way, and contacts with a memory.
Specimen mixed_body() {
  Specimen s = sheet(100, {testing::papers_bond(), damped(0.5), brittle(0.002, 0.11), damped(1.0)}, 0.12, 9);
  s.model.contact = {.law = ContactLaw::paper_hertz,
                     .pairs = ContactPairs::unbonded,
                     .c_H = 0.05,
                     .k_t = 0.05,
                     .tangential = TangentialForm::linear,
                     .surface = {.friction = 0.5, .restitution = 0.7}};
  return s;
}
Stage mixed_stage() {
  Stage stage = testing::plain_stage(0.2, 60 * 0.2);
  BondingRule rule;
  rule.name = "again";
  rule.in_a.assign(100 * 100, 0), rule.in_b.assign(100 * 100, 1);
  for (std::size_t k = 0; k < rule.in_a.size(); k += 2) rule.in_a[k] = 1;
  rule.distance = 0.96;
  rule.recipe = brittle(0.01, 0.2);
  stage.bonding = {rule};
  return stage;
}

// 10,000 particles: parts for three threads. Also across an end and a resumption at any step, with another
// number of threads, after which contact lists are built anew and broken bonds are no longer in the packs.
TEST(InelasticBonds, GiveTheSameBitsWithAnyThreadsAndAfterAnyResumption) {
  const Specimen s = mixed_body();
  const auto run_on = [&](State state, int threads, int steps) {
    Simulation run(s.model, mixed_stage(), std::move(state), threads);
    EXPECT_EQ(run.times().threads > 1, threads > 1);
    for (int k = 0; k < steps; ++k) run.step();
    return std::move(run).handover().state;
  };
  const State whole = run_on(s.state, 1, 60);
  EXPECT_GT(broken_in(whole), 60u);
  EXPECT_GT(whole.bonds.size(), s.state.bonds.size() + 40);
  EXPECT_GT(whole.books.dissipated, 0.0);
  EXPECT_GT(whole.contact_history.size(), 20u);
  EXPECT_TRUE(run_on(s.state, 2, 60) == whole);
  EXPECT_TRUE(run_on(s.state, 4, 60) == whole);
  for (const int at : {1, 17, 42}) {
    const State middle = run_on(s.state, 2, at);
    EXPECT_TRUE(run_on(middle, 3, 60 - at) == whole) << "resumed at step " << at;
  }
}

// ---- against a time loop of its own -----------------------------------------------------------------

/// The same motion by a plain loop: particles in their own order, bonds one by one, no packs, blocks or
/// threads.
class PlainLoop {
 public:
  PlainLoop(const Specimen& s, double dt)
      : model_(s.model), dt_(dt), state(s.state), history(s.state.bonds.size()) {
    evaluate(state.v, state.omega, false);
  }
  void step() {
    kick(), kick_turns();
    const auto v = state.v, w = state.omega;
    for (const ParticleId p : state.r.ids()) {
      state.r[p] += dt_ * v[p];
      state.q[p] = renormalised(rotation_of(dt_ * w[p]) * state.q[p]);
    }
    evaluate(v, w, true);
    kick(), kick_turns();
    std::vector<BondId> breaking;
    for (const BondId k : state.bonds.ids())
      if (!state.bonds[k].broken && can_break(state.bonds[k]) &&
          state.bonds[k]
                  .law->failure(state.bonds[k], bond_pose(state.bonds[k], state), history[k.value])
                  .utilisation >= 1.0)
        breaking.push_back(k);
    for (const BondId k : breaking) state.bonds[k].broken = true;
    if (!breaking.empty()) evaluate(v, w, false);
  }

 private:
  void kick() {
    for (const ParticleId p : state.r.ids()) state.v[p] += 0.5 * dt_ / model_.mass[p] * F_[p];
  }
  void kick_turns() {
    for (const ParticleId p : state.r.ids()) state.omega[p] += 0.5 * dt_ / model_.inertia[p] * M_[p];
  }
  void evaluate(const PerParticle<Vec3d>& v, const PerParticle<Vec3d>& w, bool advancing) {
    F_.assign(state.r.size(), {}), M_.assign(state.r.size(), {});
    for (const BondId k : state.bonds.ids()) {
      const Bond& b = state.bonds[k];
      if (b.broken) continue;
      const BondPose<double> pose = bond_pose(b, state);
      const BondRates<double> rates{v[b.j] - v[b.i], w[b.i], w[b.j]};
      if (advancing && b.law == &brittle_law)  // u_p' = N / eta, by N before it
        history[k.value][0] += dt_ * b.coefficients[4] * b.coefficients[0] *
                               (norm(bonded_points(pose, b.R_i, b.R_j)) - b.a - history[k.value][0]);
      for (const BondLoads<double>& l :
           {b.law->loads(b, pose, history[k.value]), b.law->damping_loads(b, pose, rates)}) {
        F_[b.i] += l.F, F_[b.j] -= l.F;
        M_[b.i] += l.M_ij, M_[b.j] += l.M_ji;
      }
    }
  }
  const Model& model_;
  double dt_;
  PerParticle<Vec3d> F_, M_;

 public:
  State state;
  std::vector<BondHistory> history;
};

// Random bodies of elastic, damped and brittle bonds in rapid motion, 150 steps: the same bonds break, in the
// same step, and positions agree but for rounding that motion has magnified.
TEST(InelasticBonds, MoveAsInAPlainLoop) {
  std::size_t broken = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    testing::Dice dice(seed);
    const Specimen s = sheet(4 + seed % 4,
                             {brittle(dice(0, 0.02), dice(0.05, 0.3)), damped(dice(0, 2)),
                              testing::papers_bond(), brittle(dice(0, 0.02), dice(0.05, 0.3))},
                             dice(0.02, 0.2), seed);
    const double dt = dice(0.05, 0.25);
    Simulation run(s.model, testing::plain_stage(dt, 1e9), s.state);
    PlainLoop plain(s, dt);
    for (int k = 0; k < 150; ++k) {
      run.step(), plain.step();
      ASSERT_EQ(broken_in(run.state()), broken_in(plain.state)) << "seed " << seed << ", step " << k;
    }
    broken += broken_in(plain.state);
    for (const BondId k : s.state.bonds.ids())
      EXPECT_EQ(run.state().bonds[k].broken, plain.state.bonds[k].broken) << "seed " << seed;
    for (const ParticleId p : s.state.r.ids())
      EXPECT_LT(norm(run.state().r[p] - plain.state.r[p]), 1e-9) << "seed " << seed;
  }
  EXPECT_GT(broken, 100u);
}

// The loops against the sum over bonds one by one, a step after the rates are those of rest.
TEST(InelasticBonds, AddUpAsTheyDoOneByOne) {
  Specimen s = sheet(20, {testing::papers_bond(), brittle(0.1, 1e9), damped(1.0)}, 0.0, 9);
  testing::PoseSource random(3);
  for (const ParticleId p : s.state.r.ids())
    s.state.r[p] += random.vector(0.1), s.state.q[p] = random.rotation(0.3);
  s.state.bonds[BondId{5}].broken = s.state.bonds[BondId{6}].broken = true;
  s.state.bond_history.assign(s.state.bonds.size(), {0.05});
  const Simulation run(s.model, testing::plain_stage(0.1, 1.0), s.state);
  const std::size_t n = s.model.particles();
  Loads one_by_one{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  add_bond_loads(s.state, one_by_one);
  const Loads loads = run.loads();
  for (const ParticleId p : s.state.r.ids()) {
    EXPECT_LT(norm(loads.F[p] - one_by_one.F[p]), 1e-14);
    EXPECT_LT(norm(loads.M[p] - one_by_one.M[p]), 1e-14);
  }
  const Energies U = bond_energies(s.state);
  EXPECT_NEAR(run.energies().U_L, U.U_L, 1e-12);
  EXPECT_NEAR(run.energies().U_B, U.U_B, 1e-12);
}

}  // namespace
}  // namespace vbond
