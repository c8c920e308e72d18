// Bodies that several processes set up together, each with its own bonds alone. Threads stand for them.
#include "vbond/setup/own_bonds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "dynamics/processes.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/part_bonds.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::test {
namespace {

Case parsed(const std::string& text) {
  return parse_case(text, "case.toml");
}

constexpr const char* block = R"(
[[specimen]]
kind = "block"
cells = [5, 3, 3]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

/// All at once that has an order, a draw or a memory: a second set, some of it by chance, of bonds that may
/// break, with a prestrain beyond what they bear without flowing; particles that touch where they are not
/// bonded.
constexpr const char* mixed = R"(
[[specimen]]
kind = "block"
cells = [6, 3, 2]
radius = 0.72
mass = 1.0
[[bonds]]
name = "edges"
distance = 1.1
theory = "bernoulli-euler"
E = 31.8
nu = 0.2
section = {shape = "circle", diameter = 0.2}
[[bonds]]
name = "diagonals"
distance = 1.5
share = 0.6
seed = 7
prestrain = 0.01
stiffness = {c_A = 3.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
yield = {axial_force = 0.01, isotropic = {axial = 0.5}}
strength = {criterion = "linear", axial_force = 0.05, shear_force = 0.05, bending_moment = 0.05, torque = 0.05, weibull = {modulus = 2, seed = 3}}
[contact]
law = "linear"
k = 0.5
pairs = "unbonded"
[[velocities]]
kind = "gaussian"
magnitude = 1e-3
[[stage]]
duration = "3 T0"
)";

constexpr const char* flat_joints = R"(
[[specimen]]
kind = "block"
cells = [4, 3, 2]
radius = 0.5
mass = 1.0
[[bonds]]
distance = 1.1
flat_joint = {radial = 2, around = 4}
theory = "parallel"
k_n = 30.0
k_s = 10.0
section = {shape = "circle", diameter = 0.8}
[[stage]]
duration = "3 T0"
)";

constexpr const char* listed = R"(
[[specimen]]
kind = "block"
cells = [4, 2, 2]
radius = 0.4
mass = 1.0
[[bonds]]
pairs = [[5, 4], [0, 1], [9, 8], [2, 6], [15, 14], [11, 10], [3, 7]]
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

constexpr const char* periodic = R"(
[cell]
a = [4, 0, 0]
b = [0.3, 3, 0]
c = [0, 0, 3]
[[specimen]]
kind = "block"
cells = [4, 3, 3]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.2
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

/// What a process has, and what it has sent for it.
struct Made {
  Built built;
  StepBound bound;
  Stage stage;
  State whole;
  SharedByBonds shared;
  std::size_t gathered = 0;
};

std::vector<Made> made_by(const Case& c, std::size_t processes) {
  testing::Meeting meeting(processes);
  std::vector<Made> made(processes);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < processes; ++k)
    threads.emplace_back([&, k] {
      const testing::Process process(meeting, k);
      Made& m = made[k];
      m.built =
          build(c, 1,
                {.all = process,
                 .meet = [] {},
                 .spread =
                     [&](const Model& model, const State&, const PerParticle<std::uint32_t>& bonds, double) {
                       std::vector<ParticleId> own;  // scattered, so that names are, too
                       for (const ParticleId p : bonds.ids())
                         if ((p.value * 7 + p.value / 3) % processes == k) own.push_back(p);
                       EXPECT_EQ(bonds.size(), model.particles());
                       return own;
                     }});
      const Built& b = m.built;
      m.bound = step_bound(b.model, b.body());
      State state = b.state;
      m.stage = build_stage(c, b.model, 0, state, {}, 1, b.own);
      m.gathered = process.largest_gather;
      if (!b.own) return;
      m.shared = shared_by(*b.own);
      m.whole = with_all_bonds(state, b.own->part, m.shared, process);
    });
  for (std::thread& t : threads) t.join();
  return made;
}

class OwnBonds : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(, OwnBonds,
                         ::testing::Values(std::pair("Mixed", mixed), std::pair("FlatJoints", flat_joints),
                                           std::pair("Listed", listed), std::pair("Periodic", periodic)),
                         [](const auto& p) { return std::string(p.param.first); });

TEST_P(OwnBonds, AreThoseOfTheWholeBodyByNameAndNoProcessHasMore) {
  const Case c = parsed(GetParam().second);
  const Built whole = build(c, 1);
  const std::size_t bonds = whole.state.bonds.size();
  State begun = whole.state;
  const Stage stage = build_stage(c, whole.model, 0, begun);
  const StepBound bound = step_bound(whole.model, whole.state);
  SharedByBonds shared;
  for (const Bond& b : whole.state.bonds) shared.add(b);
  if (GetParam().second == mixed) {  // else there would be nothing to lose
    EXPECT_FALSE(whole.state.bond_history.empty());
    EXPECT_NE(whole.state.books.dissipated, 0.0);
    EXPECT_FALSE(whole.notes.empty());
    EXPECT_GE(shared.rules.size(), 2u);
  }
  for (const std::size_t processes : {2u, 3u}) {
    const std::vector<Made> made = made_by(c, processes);
    std::size_t together = 0;
    for (const Made& m : made) {
      ASSERT_TRUE(m.built.own);
      const State& s = m.built.state;
      const BondsFromSetUp& own = *m.built.own;
      together += s.bonds.size();
      EXPECT_GT(s.bonds.size(), 0u);
      EXPECT_LE(s.bonds.values().capacity(),
                s.bonds.size() + 16);  // the cells of a joint that are made first
      EXPECT_LT(m.gathered, 200u);     // a bound and its words
      ASSERT_EQ(own.part.names.size(), s.bonds.size());
      EXPECT_EQ(own.bonds(), bonds);
      for (const BondId k : s.bonds.ids()) {
        EXPECT_TRUE(s.bonds[k] == whole.state.bonds[own.part.names[k]]);
        EXPECT_TRUE(history_of_bond(s, k) == history_of_bond(whole.state, own.part.names[k]));
      }
      std::size_t others = 0;
      own.for_others([&](const BondEnds& e) {
        const Bond& b = whole.state.bonds[e.name];
        EXPECT_TRUE(e.i == b.i && e.j == b.j && e.image_j == b.image_j);
        ++others;
      });
      EXPECT_EQ(others + s.bonds.size(), bonds);
      EXPECT_TRUE(m.whole == begun);
      EXPECT_TRUE(m.shared.laws == shared.laws && m.shared.rules == shared.rules);
      EXPECT_TRUE(s.books == whole.state.books);
      EXPECT_EQ(m.built.model.T_0, whole.model.T_0);
      EXPECT_EQ(m.built.notes, whole.notes);
      EXPECT_EQ(m.bound.dt, bound.dt);
      EXPECT_EQ(m.bound.bond, bound.bond);
      EXPECT_EQ(m.bound.source, bound.source);
      EXPECT_EQ(m.stage.dt, stage.dt);
      EXPECT_EQ(m.stage.critical, stage.critical);
    }
    EXPECT_EQ(together, bonds);
  }
}

TEST(OwnBondsOf, CasesThatAskForTheWholeBodyAreNotCutUp) {
  EXPECT_TRUE(may_keep_own_bonds(parsed(mixed)));
  const auto without = [](const std::function<void(Case&)>& change) {
    Case c = parsed(block);
    EXPECT_TRUE(may_keep_own_bonds(c));
    change(c);
    return !may_keep_own_bonds(c);
  };
  EXPECT_TRUE(without([](Case& c) { c.stages.push_back(c.stages[0]); }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].kind = StageKind::equilibrium; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].when = BondTime::stage; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].when = BondTime::approach; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].recipe.capsule = true; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].recipe.expansion = 1e-5; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].select.value = AtCrossings{0.1}; }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].pressures.emplace_back(); }));
  EXPECT_TRUE(without([](Case& c) { c.sources.emplace_back(); }));
}

/// What is wrong is told as of one process, on all of them.
TEST(OwnBondsOf, ACaseThatIsWrongIsToldAsOfTheWholeBody) {
  Case c = parsed(mixed);
  c.bonds[1].recipe.prestrain = 0.5;  // more than it bears
  c.velocities.emplace_back().group = {"nobody", {"case.toml", 30, 1}};
  std::string told;
  try {
    build(c, 1);
  } catch (const CaseError& e) {
    told = e.what();
  }
  ASSERT_NE(told, "");
  testing::Meeting meeting(2);
  std::vector<std::string> each(2);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      const testing::Process process(meeting, k);
      try {
        build(c, 1,
              {.all = process,
               .meet = [] {},
               .spread = [k](const Model&, const State&, const auto&,
                             double) { return std::vector<ParticleId>{ParticleId{k}}; }});
      } catch (const CaseError& e) {
        each[k] = e.what();
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(each[0], told);
  EXPECT_EQ(each[1], told);
}

}  // namespace
}  // namespace vbond::test
