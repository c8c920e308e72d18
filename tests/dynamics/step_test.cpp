// The step loop against the plain loop, against itself with other threads and instruction sets, and with NaN.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <deque>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "random_pose.hpp"
#include "rods.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/bond_sums.hpp"

namespace vbond {
namespace {

/// A bond set that differs from the paper's in every number.
BondRecipe other_bond() {
  BondRecipe recipe;
  recipe.law = &bond_law<Evm>;
  recipe.parameters = GivenCoefficients{{0.7, 0.05, 0.03, 0.02}};
  recipe.attachment = Attachment::given;
  recipe.R_i = 0.2;
  recipe.R_j = 0.1;
  return recipe;
}

/// A crumpled sheet of n x n particles: bonds of two laws, of lengths that differ, some made between
/// particles that were turned already, in any order and direction.
testing::Specimen crumpled_sheet(std::size_t n, unsigned seed) {
  testing::PoseSource random(seed);
  std::vector<Vec3d> r;
  for (std::size_t x = 0; x < n; ++x)
    for (std::size_t y = 0; y < n; ++y)
      r.push_back(Vec3d{static_cast<double>(x), static_cast<double>(y), 0} + random.vector(0.1));
  testing::Specimen s = testing::particles_at(r);
  for (std::size_t k = 0; k < n; ++k) s.state.q[ParticleId{k * k}] = random.rotation(3.0);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < n * n; ++k) {
    if (k % n + 1 < n) pairs.emplace_back(k, k + 1);
    if (k + n < n * n) pairs.emplace_back(k + n, k);
  }
  std::shuffle(pairs.begin(), pairs.end(), std::mt19937(seed));
  for (const auto& [i, j] : pairs) {
    const double kind = random.uniform(0, 1);
    testing::bond(s, i, j,
                  kind < 0.2   ? other_bond()
                  : kind < 0.3 ? testing::papers_bond(&bond_law<Evm>)
                               : testing::papers_bond());
  }
  for (const ParticleId p : s.state.r.ids()) {
    s.state.r[p] += random.vector(0.2);
    s.state.q[p] = random.rotation(1.2) * s.state.q[p];
    s.state.v[p] = random.vector(0.1);
    s.state.omega[p] = random.vector(0.5);
  }
  return s;
}

/// Largest difference of a force or moment from those of the plain loop, over the largest of them. The same
/// sums in another order, and coefficients that many bonds share known to 4 roundings: at most 1e-13, a
/// hundred times that.
double difference_from_plain_loop(const Simulation& run) {
  const std::size_t n = run.model().particles();
  Loads plain{PerParticle<Vec3d>(n), PerParticle<Vec3d>(n)};
  add_bond_loads(run.state(), plain);
  const Loads fast = run.loads();
  double largest = 0.0, difference = 0.0;
  for (const ParticleId p : plain.F.ids()) {
    largest = std::max({largest, norm(plain.F[p]), norm(plain.M[p])});
    difference = std::max({difference, norm(fast.F[p] - plain.F[p]), norm(fast.M[p] - plain.M[p])});
  }
  return difference / largest;
}

RC_GTEST_PROP(Simulation, LoadsAreThoseOfThePlainLoop, (unsigned seed)) {
  const testing::Specimen s = crumpled_sheet(*rc::gen::inRange<std::size_t>(2, 25), seed);
  const Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
  RC_ASSERT(difference_from_plain_loop(run) <= 1e-13);
  const Energies e = bond_energies(s.state), f = run.energies();
  RC_ASSERT(std::abs(f.U_L - e.U_L) <= 1e-13 * e.U_L);
  RC_ASSERT(std::abs(f.U_B - e.U_B) <= 1e-13 * e.U_B);
  RC_ASSERT(std::abs(f.U_T - e.U_T) <= 1e-13 * e.U_T);
}

RC_GTEST_PROP(Survey, NamesEveryBondOutOfRange, (unsigned seed)) {
  const testing::Specimen s = crumpled_sheet(*rc::gen::inRange<std::size_t>(2, 25), seed);
  const Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
  const std::vector<BondId>& deformed = run.survey().deformed;
  RC_ASSERT(std::is_sorted(deformed.begin(), deformed.end()));
  const std::set<BondId> named(deformed.begin(), deformed.end());
  RC_ASSERT(named.size() == deformed.size());
  for (const BondId b : s.state.bonds.ids()) {
    const Bond& bond = s.state.bonds[b];
    const BondShape shape = bond_shape(bond_pose(bond, s.state), bond.R_i, bond.R_j);
    const bool out = bond_range(bond, shape) != BondRange::good || shape.length < 0.5 * bond.a;
    RC_ASSERT(!out || named.count(b) == 1);
  }
}

TEST(Survey, NamesNoBondOfABodyAtRest) {
  const testing::Specimen s = testing::straight_rod(50);
  EXPECT_TRUE(Simulation(s.model, testing::plain_stage(0.01, 1e9), s.state).survey().deformed.empty());
}

/// The same with some bonds between particles far apart.
testing::Specimen tied_sheet(std::size_t n, unsigned seed) {
  testing::Specimen s = crumpled_sheet(n, seed);
  std::mt19937 random(seed);
  for (int k = 0; k < 5; ++k) testing::bond(s, random() % (n * n), random() % (n * n), other_bond());
  return s;
}

// Blocks move when bonds first reach them: loads at the end of a step are those of the places at its end.
TEST(Simulation, LoadsAfterAStepAreThoseOfThePlainLoop) {
  const testing::Specimen s = tied_sheet(80, 2);
  for (const int threads : {1, 2}) {
    Simulation run(s.model, testing::plain_stage(0.005, 1e9), s.state, threads);
    ASSERT_EQ(run.times().threads, threads);
    for (int k = 0; k < 3; ++k) {
      run.step();
      EXPECT_LE(difference_from_plain_loop(run), 1e-13) << threads << " threads, step " << k + 1;
    }
  }
}

// A sheet large enough for four threads, with everything that adds to loads and books.
// With contacts all blocks move before the bonds, without them most just before the bonds that reach them.
class AnyNumberOfThreads : public ::testing::TestWithParam<ContactLaw> {};
INSTANTIATE_TEST_SUITE_P(, AnyNumberOfThreads, ::testing::Values(ContactLaw::paper_hertz, ContactLaw::none),
                         [](const auto& law) { return law.index == 0 ? "WithContacts" : "WithoutContacts"; });
TEST_P(AnyNumberOfThreads, GivesTheSameBits) {
  constexpr std::size_t side = 110;
  static_assert(3 * side * side > 4 * least_part);
  testing::Specimen s = tied_sheet(side, 1);
  for (Vec3d& v : s.state.v) v = 0.1 * v;
  s.model.contact = {GetParam(), ContactPairs::unbonded, 1.0, 1.0, 0, 0};
  for (double& R : s.model.radius) R = 0.72;  // of particles a diagonal apart some touch
  Stage stage = testing::plain_stage(0.005, 1e9);
  const std::vector<char> anyone(s.model.particles(), 1);
  stage.bonding = {BondingRule{
      "diagonals",
      anyone,
      anyone,
      1.0,
      testing::papers_bond(),
  }};
  stage.insist = true;
  stage.b_translation = 0.01;
  stage.b_rotation = 0.001;
  stage.gravity = {0, 0, -1e-3};
  std::vector<ParticleId> edge, middle;
  for (std::size_t k = 0; k < side; ++k)
    edge.push_back(ParticleId{k}), middle.push_back(ParticleId{(k + 1) * side / 2});
  stage.supports = {testing::held(edge, testing::clamped, {1e-3, 0, 0})};
  stage.loads = {PointLoad{"middle", middle, {0, 0, 1e-2}, {1e-3, 0, 0}, {{{0, 0}, {1, 1}}}}};
  stage.strain = StrainProgram{s.model.groups[0].particles, {0, 1, 0}, {0, 50, 0}, 1e-4, 0.02};
  struct Outcome {
    State state;
    Survey survey;
    Loads loads;
    int threads;
  };
  const auto after = [&](int threads) {
    Simulation run(s.model, stage, s.state, threads);
    for (int k = 0; k < 12; ++k) run.step();
    return Outcome{run.state(), run.survey(), run.loads(), run.times().threads};
  };
  const Outcome one = after(1);
  EXPECT_FALSE(one.state == s.state);
  EXPECT_EQ(one.survey.energies.contact > 0.0, GetParam() != ContactLaw::none);
  EXPECT_GT(one.state.bonds.size(), s.state.bonds.size());
  EXPECT_NE(one.state.books.work_loads, 0.0);
  EXPECT_NE(one.state.books.work_supports, 0.0);
  EXPECT_GT(one.state.books.dissipated, 0.0);
  for (const int threads : {2, 3, 4}) {
    const Outcome more = after(threads);
    EXPECT_TRUE(one.state == more.state) << threads << " threads";
    EXPECT_TRUE(one.loads.F == more.loads.F && one.loads.M == more.loads.M) << threads << " threads";
    EXPECT_EQ(more.threads, threads);
    EXPECT_EQ(one.survey.energies.total(), more.survey.energies.total()) << threads << " threads";
    EXPECT_EQ(one.survey.energies.contact, more.survey.energies.contact) << threads << " threads";
    EXPECT_TRUE(one.survey.deformed == more.survey.deformed) << threads << " threads";
  }
}

/// Rows of a few particles that stand, move and are loaded anyhow.
struct RandomRows {
  std::vector<PoseRow> pose;
  std::vector<MotionRow> motion;
  std::vector<LoadRow> load;
  std::vector<InverseInertia> per;
  std::vector<Decay> decay;
};

RandomRows random_rows(std::size_t n, double fastest, unsigned seed) {
  testing::PoseSource random(seed);
  RandomRows rows;
  for (std::size_t k = 0; k < n; ++k) {
    rows.pose.push_back({random.vector(3.0), 0, random.rotation(3.0)});
    rows.motion.push_back({random.vector(1.0), 0, random.vector(fastest), 0});
    rows.load.push_back({random.vector(1.0), 0, random.vector(1.0), 0});
    rows.per.push_back({random.uniform(0.5, 2), random.uniform(0.5, 2)});
    rows.decay.push_back(
        {random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0, 1), random.uniform(0, 1)});
  }
  return rows;
}

/// Random bonds between rows; of the last pack only some lanes count, of some the threads differ.
template <class P>
std::vector<P> random_packs(std::size_t count, std::size_t rows, unsigned seed) {
  testing::PoseSource random(seed);
  const auto row = [&] {
    return static_cast<std::uint32_t>(random.uniform(0, static_cast<double>(rows) - 1e-9));
  };
  std::vector<P> packs(count);
  for (P& p : packs)
    for (std::size_t l = 0; l < pack_bonds; ++l) {
      p.i[l] = row();
      do p.j[l] = row();
      while (p.j[l] == p.i[l]);
      const auto put = [&](double(&to)[4][pack_bonds]) {
        const Quatd q = random.rotation(3.0);
        to[0][l] = q.w, to[1][l] = q.x, to[2][l] = q.y, to[3][l] = q.z;
      };
      p.a[l] = random.uniform(0.5, 2);
      if constexpr (std::is_same_v<P, FullPack>) {
        p.R_i[l] = random.uniform(0, 0.3), p.R_j[l] = random.uniform(0, 0.3);
        for (auto& B : p.coefficients) B[l] = random.uniform(0, 1);
        put(p.frame_i), put(p.frame_j);
      } else {
        p.scale[l] = random.uniform(0.5, 2);
        put(p.frame);
      }
    }
  return packs;
}

/// With rules: Morse's stretching, damping, and a strength that some bonds are past; or bonds that flow in
/// all ways.
BondType type_with_rules(const BondLaw& law, Criterion criterion, bool flows) {
  static std::deque<BondRules> rules;
  BondRules& r = rules.emplace_back();
  r.stretch.form = StretchForm::morse;
  r.stretch.alpha = 0.7;
  r.strength = linear_strength(0.02, 0.03, 0.01, 0.02);
  r.strength.criterion = criterion;
  r.strength.friction = r.strength.compression = 0.1;
  r.damped = true;
  if (flows) {
    r.stretch = {};
    r.yield.limit = {0.1, 0.06, 0.05, 0.06};  // flow far past lower limits may be lost
    r.yield.compression = 0.3;
    r.yield.isotropic = {0.1, 0.2, 0.1, 0.1};
    r.yield.kinematic = {0.2, 0.0, 0.3, 0.1};
    r.creep = {0.05, 3};
    r.softening = {0.05, 3.0};
  }
  return {&law, &r, true, true, 1.0, 0.1, 0.2, {1.0, -0.1, 0.3, 0.2, 0.1, 0.4, 0.3, 0.2, 0.1}};
}

/// As random_packs makes them, with short offsets in front where the law has some: long ones deform a bond so
/// far that its flow may be lost.
template <class P>
std::vector<P> packs_of(const BondLaw& law, std::size_t count, std::size_t rows, unsigned seed) {
  std::vector<P> packs = random_packs<P>(count, rows, seed);
  if constexpr (std::is_same_v<P, FullPack>) {
    if (law.has_offsets)
      for (P& p : packs) {
        double offsets[offset_coefficients][pack_bonds];
        std::copy_n(&p.coefficients[most_coefficients - offset_coefficients][0],
                    offset_coefficients * pack_bonds, &offsets[0][0]);
        for (std::size_t k = most_coefficients; k-- > offset_coefficients;)
          std::copy_n(p.coefficients[k - offset_coefficients], pack_bonds, p.coefficients[k]);
        for (std::size_t k = 0; k < offset_coefficients; ++k)
          for (std::size_t l = 0; l < pack_bonds; ++l) p.coefficients[k][l] = 0.1 * offsets[k][l];
      }
  }
  return packs;
}

template <class P>
void expect_same_bonds(PackLoops<P> BondLoops::*loops, const BondType& type, std::size_t in_last_pack) {
  const BondLaw& law = *type.law;
  constexpr std::size_t n = 40;
  const RandomRows rows = random_rows(n, 1.0, 5);
  const std::vector<P> packs = packs_of<P>(law, 9, n, 7);
  std::vector<PackLanes> lanes(packs.size(), PackLanes{all_lanes, all_lanes, all_lanes});
  lanes[3].to_i = 0x5a, lanes[3].to_j = 0x3c;  // of another thread
  for (std::size_t lane = in_last_pack; lane < pack_bonds; ++lane) lanes[8].remove(lane);
  PackRun<P> run{packs.data(), lanes.data(), packs.size(), &type};
  std::vector<LoadRow> first_load;
  std::vector<double> first_history;
  double first_dissipated = 0.0;
  std::vector<std::uint8_t> first_broken;
  BondEnergies first;
  std::vector<std::uint8_t> first_look;
  for (const StepKernel* kernel : available_kernels()) {
    std::vector<LoadRow> load = rows.load, damping = rows.load;
    std::vector<std::uint8_t> broken(packs.size());
    BondSweep sweep{rows.pose.data(), load.data(), rows.motion.data(), damping.data()};
    sweep.broken = broken.data();
    sweep.dt = 0.1;
    std::vector<double> history(packs.size() * law.history.size() * pack_bonds);
    run.history = history.data();
    for (int step = 0; step < (law.remembers() ? 3 : 1); ++step)
      (bond_loops(law, *kernel).*loops).add_loads(run, sweep);
    BondEnergies sum;
    std::vector<std::uint8_t> look(packs.size());
    (bond_loops(law, *kernel).*loops).survey(run, rows.pose.data(), sum, look.data());
    for (const LoadRow& row : load)  // sums over rows take with them what no particle has
      EXPECT_TRUE(row.unused_1 == 0.0 && row.unused_2 == 0.0) << kernel->name;
    if (first_load.empty()) {
      first_load = load, first = sum, first_look = look, first_broken = broken, first_history = history;
      first_dissipated = sweep.dissipated;
      continue;
    }
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_TRUE(load[k].F == first_load[k].F && load[k].M == first_load[k].M)
          << kernel->name << ", row " << k;
    EXPECT_TRUE(sum.U_L == first.U_L && sum.U_B == first.U_B && sum.U_T == first.U_T) << kernel->name;
    EXPECT_EQ(look, first_look) << kernel->name;
    EXPECT_EQ(broken, first_broken) << kernel->name;
    EXPECT_EQ(history, first_history) << kernel->name;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sweep.dissipated), std::bit_cast<std::uint64_t>(first_dissipated));
  }
  if (!type.breakable) return;
  const auto any = [](std::uint8_t lanes_broken) { return lanes_broken != 0; };
  EXPECT_TRUE(std::any_of(first_broken.begin(), first_broken.end(), any)) << "no bond broke";
}

// Rows up to the next multiple of eight may be taken with the last one, those after it never.
TEST(StepKernel, KicksAndMovesRangesThatEndAnywhere) {
  const RandomRows start = random_rows(40, 0.1, 9);
  for (const StepKernel* kernel : available_kernels()) {
    const auto moved = [&](std::size_t last) {
      RandomRows rows = start;
      kernel->kick({8, last}, 0.01, rows.per.data(), rows.load.data(), rows.motion.data());
      kernel->drift({8, last}, 0.01, rows.motion.data(), rows.pose.data());
      return rows;
    };
    const RandomRows all = moved(40);
    for (std::size_t last = 9; last < 40; ++last) {
      const RandomRows rows = moved(last);
      for (std::size_t k = 0; k < 40; ++k) {
        if (k >= last && k < filled_up(last)) continue;
        const RandomRows& as = k < last ? all : start;
        EXPECT_TRUE(rows.pose[k].r == as.pose[k].r && rows.pose[k].q == as.pose[k].q) << kernel->name;
        EXPECT_TRUE(rows.motion[k].v == as.motion[k].v && rows.motion[k].omega == as.motion[k].omega);
      }
    }
  }
}

// Every lane rounds as a scalar does, and no kernel fuses a multiplication with an addition.
TEST(StepKernel, GivesTheSameBitsWithEveryInstructionSet) {
  const std::vector<const StepKernel*> kernels = available_kernels();
  if (kernels.size() < 2)
    GTEST_SKIP() << "nothing to compare: this machine can execute " << kernels.front()->name << " only";
  for (const StepKernel* k : kernels) std::printf("compared: %s\n", k->name);
  const auto expect_same = [](const BondType& type) {
    for (const std::size_t in_last_pack : {5, 4, 1, 0}) {  // more than half of it, half, less, none
      if (!type.law->has_offsets) expect_same_bonds<CompactPack>(&BondLoops::compact, type, in_last_pack);
      expect_same_bonds<FullPack>(&BondLoops::full, type, in_last_pack);
    }
  };
  for (const BondLaw* law : bond_laws()) {
    expect_same({law, &no_rules, false, false, 1.0, 0.1, 0.2, {1.0, -0.1, 0.3, 0.2, 0.1, 0.4}});
    for (int c = 1; c <= static_cast<int>(Criterion::elongation) && law->has_rules; ++c)
      expect_same(type_with_rules(*law, static_cast<Criterion>(c), law->remembers()));
  }
  for (const double fastest : {0.1, 100.0}) {  // turning little, and by more than the series is good for; 24
                                               // rows: an odd number of eights
    const RandomRows start = random_rows(48, fastest, 7);
    const auto moved = [&start](const StepKernel& kernel) {
      RandomRows rows = start;
      const double way2 = kernel.drift({8, 32}, 0.01, rows.motion.data(), rows.pose.data());
      double largest2 = 0.0;
      for (std::size_t k = 8; k < 32; ++k) largest2 = std::max(largest2, norm2(0.01 * start.motion[k].v));
      EXPECT_GE(way2, largest2) << kernel.name;
      EXPECT_LE(way2, 3.0 * largest2) << kernel.name;
      const double lost = kernel.slow_down({8, 32}, rows.decay.data(), rows.motion.data());
      double expected = 0.0, size = 0.0;  // of 144 products, which are summed in another order
      for (std::size_t k = 8; k < 32; ++k) {
        const Vec3d &v = rows.motion[k].v, &omega = rows.motion[k].omega;
        expected += dot(rows.load[k].F, v) + dot(rows.load[k].M, omega);
        size += norm(rows.load[k].F) * norm(v) + norm(rows.load[k].M) * norm(omega);
      }
      const double power = kernel.power({8, 32}, rows.load.data(), rows.motion.data());
      EXPECT_NEAR(power, expected, 144 * 1.1e-16 * 2.0 * size) << kernel.name;
      std::vector<MotionRow> without = rows.motion;
      double twice_power = 0.0;
      EXPECT_EQ(kernel.kick_damped({8, 32}, 0.01, rows.per.data(), rows.load.data(), rows.motion.data(),
                                   rows.load.data(), twice_power),
                0.0)
          << kernel.name;
      EXPECT_NEAR(twice_power, power + kernel.power({8, 32}, rows.load.data(), rows.motion.data()),
                  144 * 1.1e-16 * 8.0 * size)  // of twice as many products, of rates that have grown
          << kernel.name;
      EXPECT_EQ(kernel.kick({8, 32}, 0.01, rows.per.data(), rows.load.data(), without.data()), 0.0)
          << kernel.name;
      for (std::size_t k = 8; k < 32; ++k)
        EXPECT_TRUE(without[k].v == rows.motion[k].v && without[k].omega == rows.motion[k].omega);
      return std::pair{rows, lost + power + twice_power};
    };
    const auto [first, first_lost] = moved(*kernels.front());
    for (const StepKernel* kernel : kernels) {
      const auto [rows, lost] = moved(*kernel);
      EXPECT_EQ(lost, first_lost) << kernel->name;
      for (std::size_t k = 0; k < rows.pose.size(); ++k) {
        EXPECT_TRUE(rows.pose[k].r == first.pose[k].r && rows.pose[k].q == first.pose[k].q) << kernel->name;
        EXPECT_TRUE(rows.motion[k].v == first.motion[k].v && rows.motion[k].omega == first.motion[k].omega)
            << kernel->name;
        const bool outside = k < 8 || k >= 32;
        EXPECT_EQ(rows.pose[k].r == start.pose[k].r, outside);
        if (!outside) {  // the definition, to rounding
          EXPECT_LT(norm(rotate(rows.pose[k].q, {1, 0, 0}) -
                         rotate(rotation_of(0.01 * start.motion[k].omega) * start.pose[k].q, {1, 0, 0})),
                    1e-15 * 4);
        }
      }
    }
  }
}

// One particle in any row may turn by just under or just over what the series is good for.
TEST(StepKernel, TurnsByAnyAngle) {
  for (const StepKernel* kernel : available_kernels())
    for (const double angle : {0.999, 1.001, 10.0})
      for (std::size_t fast = 0; fast < 16; ++fast) {
        RandomRows rows = random_rows(16, 0.1, 8);
        const RandomRows start = rows;
        rows.motion[fast].omega = (angle * std::sqrt(small_rotation_limit2) / 0.01) * Vec3d{0, 0, 1};
        kernel->drift({0, 16}, 0.01, rows.motion.data(), rows.pose.data());
        for (std::size_t k = 0; k < 16; ++k) {
          const Quatd q = renormalised(rotation_of(0.01 * rows.motion[k].omega) * start.pose[k].q);
          EXPECT_TRUE(rows.pose[k].q == q) << kernel->name << ", row " << k << ", fast " << fast;
        }
      }
}

// What a load does at the end of a step is what it does at the start of the next, to the last bit: a run that
// is resumed takes it from there.
TEST(Simulation, TakesLoadsOfTheSameTimeWhenItIsContinued) {
  const testing::Specimen s = testing::straight_rod(3);
  Stage stage = testing::plain_stage(0.0123, 1e9);
  stage.loads = {PointLoad{"end", {ParticleId{2}}, {1e-3, 0, 0}, {0, 1e-3, 0}, {{{0, 0}, {7.7, 1.3}}}}};
  Simulation run(s.model, stage, s.state);
  for (int n = 0; n < 200; ++n) {
    run.step();
    const Loads here = run.loads(), resumed = Simulation(s.model, stage, run.state()).loads();
    ASSERT_TRUE(here.F == resumed.F && here.M == resumed.M) << "step " << n;
  }
}

TEST(Simulation, ShowsTheVelocitiesThatSupportsGiveAsAStageBegins) {
  const testing::Specimen s = testing::straight_rod(3);
  Stage stage = testing::plain_stage(0.01, 1e9);
  stage.supports = {testing::held({ParticleId{1}}, testing::translations, {0.5, 0, 0})};
  EXPECT_EQ(Simulation(s.model, stage, s.state).state().v[ParticleId{1}], (Vec3d{0.5, 0, 0}));
}

// A number that is none, put anywhere into a body, ends the run within two steps; with a bond it has reached
// the loads by then.
RC_GTEST_PROP(Simulation, NeverHidesANaN, (unsigned seed)) {
  testing::Specimen s = crumpled_sheet(12, seed);
  testing::PoseSource random(seed);
  const ParticleId p{static_cast<std::size_t>(random.uniform(0, 143.9))};
  const double bad = random.uniform(0, 1) < 0.5 ? std::numeric_limits<double>::quiet_NaN()
                                                : std::numeric_limits<double>::infinity();
  double* const places[] = {&s.state.r[p].x, &s.state.q[p].w,     &s.state.q[p].z,
                            &s.state.v[p].y, &s.state.omega[p].z, &s.state.omega[p].x};
  *places[static_cast<std::size_t>(random.uniform(0, 5.999))] = bad;
  const auto two_steps = [&s] {
    Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
    run.step();
    run.step();
  };
  RC_ASSERT_THROWS_AS(two_steps(), Diverged);
}

/// What a simulation of two bonded particles says to this change.
template <class Change>
std::string refusal(Change change) {
  testing::Specimen s = testing::straight_rod(2);
  Stage stage = testing::plain_stage(0.1, 1);
  change(s, stage);
  try {
    const Simulation run(s.model, stage, s.state);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "none";
}

TEST(Simulation, RefusesWhatDoesNotBelongTogether) {
  using testing::Specimen;
  const auto refuses = [](auto change, const std::string& part) {
    const std::string text = refusal(change);
    EXPECT_NE(text.find(part), std::string::npos) << text << ", not " << part;
  };
  EXPECT_EQ(refusal([](Specimen&, Stage&) {}), "none");
  refuses([](Specimen& s, Stage&) { s.state = {}; }, "begin with at_rest(model)");
  refuses([](Specimen& s, Stage&) { s.state.r.push_back({}); }, "3 entries in particles/r for 2 particles");
  refuses([](Specimen& s, Stage&) { s.state.v.resize(0); }, "0 entries in particles/v");
  refuses([](Specimen& s, Stage&) { s.state.q.resize(0); }, "0 entries in particles/q");
  refuses([](Specimen& s, Stage&) { s.state.omega.resize(0); }, "0 entries in particles/omega");
  refuses([](Specimen& s, Stage&) { s.model.radius.resize(0); }, "mass, inertia, radius and first position");
  refuses([](Specimen& s, Stage&) { s.model.inertia.resize(0); }, "mass, inertia, radius and first position");
  refuses([](Specimen& s, Stage&) { s.model.r_0.resize(0); }, "mass, inertia, radius and first position");
  for (const double dt : {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()})
    refuses([dt](Specimen&, Stage& stage) { stage.dt = dt; }, "stage.dt must be above zero");
  const ParticleId third{2};
  refuses([=](Specimen& s, Stage&) { s.state.bonds[BondId{0}].j = third; },
          "bonds[0].j is particle 2, and there are 2");
  refuses([](Specimen& s, Stage&) { s.state.bonds[BondId{0}].j = ParticleId{0}; },
          "bonds[0] joins a particle with itself");
  refuses([=](Specimen&, Stage& st) { st.supports = {testing::held({third}, testing::clamped)}; },
          "a support names");
  refuses(
      [=](Specimen&, Stage& st) {
        st.loads = {PointLoad{"third", {third}, {}, {}, {}}};
      },
      "a load names");
  refuses(
      [=](Specimen&, Stage& st) {
        st.strain = StrainProgram{{third}, {0, 1, 0}, {}, 1e-4, 0.2};
      },
      "the imposed strain names");
  refuses(
      [=](Specimen&, Stage& st) {
        st.stops.distance = DistanceStop{ParticleId{0}, third, 1.0};
      },
      "the stop at a distance names");
  refuses([=](Specimen&, Stage& st) { st.stops.peak.emplace().particles = {third}; }, "the stop at a peak");
  refuses(
      [](Specimen&, Stage& st) {
        st.bonding = {{"short", {1}, {1}, 1.0, testing::papers_bond()}};
      },
      "a bonding rule must say");
}

// What is kept by reference must outlive the simulation.
static_assert(std::is_constructible_v<Simulation, const Model&, Stage, State>);
static_assert(!std::is_constructible_v<Simulation, Model, Stage, State>);
static_assert(!std::is_constructible_v<Simulation, const Model, Stage, State, int>);
static_assert(!std::is_constructible_v<Contacts, Model, const Order&, const BondIndex&>);
static_assert(!std::is_constructible_v<Contacts, const Model&, Order, const BondIndex&>);
static_assert(!std::is_constructible_v<Contacts, const Model&, const Order&, BondIndex>);

TEST(Survey, FindsBondsThatAreStretchedBeyondTwiceTheirLength) {
  for (const BondLaw* law : bond_laws())
    for (const double length : {1.98, 2.01}) {
      testing::Specimen s = testing::straight_rod(20, testing::papers_bond(law));
      for (std::size_t k = 13; k < 20; ++k) s.state.r[ParticleId{k}].x += length - 1.0;
      const Simulation run(s.model, testing::plain_stage(0.01, 1e9), s.state);
      EXPECT_EQ(run.survey().deformed,
                length > 2.0 ? std::vector<BondId>{BondId{12}} : std::vector<BondId>{});
    }
}

// Of those that turn too far in a step the farthest is told, if bonds or unequal moments of inertia feel it.
TEST(Step, TellsWhoTurnsTooFar) {
  testing::Specimen s = testing::straight_rod(3);
  s.state.bonds.resize(1);  // the third particle is free
  Stage stage = testing::plain_stage(0.1, 1.0);
  const auto fastest = [&] { return Simulation(s.model, stage, s.state).survey().fast_turn; };
  s.state.omega = {{0, 0, 4.9}, {}, {0, 60, 0}};
  EXPECT_FALSE(fastest());
  s.state.omega = {{0, 0, 6}, {0, 7, 0}, {0, 60, 0}};
  ASSERT_TRUE(fastest());
  EXPECT_EQ(fastest()->p, ParticleId{1});
  EXPECT_NEAR(fastest()->angle, 0.7, 1e-15);
  stage.supports = {testing::held({ParticleId{2}}, {})};
  stage.supports[0].rigid = true;
  EXPECT_EQ(fastest()->p, ParticleId{2});  // a group of its own
  stage.supports.clear();
  make_top(s.model, ParticleId{2}, {{0.05, 0.06, 0.07}, {}});
  EXPECT_EQ(fastest()->p, ParticleId{2});
}

}  // namespace
}  // namespace vbond
