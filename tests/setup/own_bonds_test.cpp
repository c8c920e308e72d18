// Bodies that several processes set up together, each with its own bonds alone. Threads stand for them.
#include "vbond/setup/own_bonds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "dynamics/processes.hpp"
#include "own_bonds_cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/gather.hpp"
#include "vbond/dynamics/part_bonds.hpp"
#include "vbond/model/step_bound.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::test {
namespace {

Case parsed(const std::string& text) {
  return parse_case(text, "case.toml");
}

/// What a process has, and what it has sent for it.
struct Made {
  Built built;
  StepBound bound;
  Stage stage;
  State whole;
  SharedByBonds shared;
  Order order;
  PartBonds part;
  std::size_t gathered = 0;
};

/// Of scattered particles, so that names are, too: what each knows are both ends of its bonds, and one more.
ParticleId next(ParticleId p, std::size_t particles) {
  return ParticleId{(p.value + 1) % particles};
}
bool is_of(ParticleId p, std::size_t process, std::size_t processes) {
  return (p.value * 7 + p.value / 3) % processes == process;
}
Order order_of(const Built& b, std::size_t process, std::size_t processes) {
  Holding holding{.own = {}, .early = {}, .ghosts = {}, .others_in_one_row = true};
  const auto ghost = [&](ParticleId p) {
    if (!is_of(p, process, processes)) holding.ghosts.push_back({p, {}});
  };
  for (const ParticleId p : b.model.mass.ids())
    if (is_of(p, process, processes)) holding.own.push_back(p), ghost(next(p, b.model.particles()));
  for (const Bond& bond : b.state.bonds) ghost(bond.j);
  std::sort(holding.ghosts.begin(), holding.ghosts.end());
  holding.ghosts.erase(std::unique(holding.ghosts.begin(), holding.ghosts.end()), holding.ghosts.end());
  PerParticle<Vec3d> r(b.model.particles());  // some of which the process does not know: they stand anywhere
  for (const ParticleId p : r.ids())
    if (b.model.r_0.holds_all() || b.model.r_0.holds(p)) r[p] = b.model.r_0[p];
  return part_of(spatial_order(r), holding);
}

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
                       std::vector<ParticleId> own;
                       for (const ParticleId p : bonds.ids())
                         if (is_of(p, k, processes)) own.push_back(p);
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
      gather_particles(m.whole, own_particles(*b.own), process);
      m.order = order_of(b, k, processes);
      SharedByBonds shared;
      m.part = keep_known_bonds(*b.own, state, m.order, shared);
    });
  for (std::thread& t : threads) t.join();
  return made;
}

class OwnBonds : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(, OwnBonds,
                         ::testing::Values(std::pair("Mixed", mixed), std::pair("FlatJoints", flat_joints),
                                           std::pair("Listed", listed), std::pair("Periodic", periodic),
                                           std::pair("Turning", turning)),
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
  const std::size_t kinds = std::max(shared.laws.size(), shared.rules.size());
  if (GetParam().second == mixed) {  // else there would be nothing to lose
    EXPECT_FALSE(whole.state.bond_history.empty());
    EXPECT_NE(whole.state.books.dissipated, 0.0);
    EXPECT_FALSE(whole.notes.empty());
    EXPECT_GE(shared.rules.size(), 2u);
  }
  if (GetParam().second == turning) {
    EXPECT_EQ(stage.critical, 0.5 / 50.0);
    EXPECT_EQ(
        std::count_if(begun.omega.begin(), begun.omega.end(), [](const Vec3d& w) { return norm(w) == 50.0; }),
        3);
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
      EXPECT_EQ(s.bonds.values().capacity(), s.bonds.size());
      // a bound and its words; both ends of a bond of each kind; pairs, and no bonds
      EXPECT_LT(m.gathered, 200u + 600u * kinds + 32u * bonds);
      ASSERT_EQ(own.part.names.size(), s.bonds.size());
      EXPECT_EQ(own.whole, bonds);
      for (const BondId k : s.bonds.ids()) {
        EXPECT_TRUE(s.bonds[k] == whole.state.bonds[own.part.names[k]]);
        EXPECT_TRUE(history_of_bond(s, k) == history_of_bond(whole.state, own.part.names[k]));
      }
      std::vector<BondEnds> others;  // of which an end is known here
      PerParticle<std::uint32_t> bonds_of(whole.model.particles(), 0);
      for (const BondId k : whole.state.bonds.ids()) {
        const Bond& b = whole.state.bonds[k];
        ++bonds_of[b.i], ++bonds_of[b.j];
        if (!m.order.has(b.i) && (m.order.knows(b.i) || m.order.knows(b.j)))
          others.push_back({k, b.i, b.j, image_of_j(b)});
      }
      EXPECT_TRUE(own.bonds == bonds_of);
      for (const ParticleId p : own.own.ids()) EXPECT_EQ(own.own[p] != 0, m.order.has(p));
      EXPECT_TRUE(m.part.names == own.part.names);
      EXPECT_EQ(m.part.others.size(), others.size());
      EXPECT_TRUE(std::equal(m.part.others.begin(), m.part.others.end(), others.begin(), others.end(),
                             [](const BondEnds& a, const BondEnds& b) {
                               return a.name == b.name && a.i == b.i && a.j == b.j && a.image_j == b.image_j;
                             }));
      EXPECT_TRUE(m.whole == begun);
      std::vector<ParticleId> asked_for = own_particles(own);
      for (const Bond& b : s.bonds) asked_for.push_back(b.j);
      EXPECT_TRUE(*s.q.held() == IdSet<ParticleId>(s.q.size(), asked_for));
      EXPECT_TRUE(s.q.held() == s.v.held() && s.q.held() == s.omega.held());
      s.q.held()->for_each([&](ParticleId p) {
        EXPECT_EQ(s.q[p], begun.q[p]);
        EXPECT_EQ(s.v[p], begun.v[p]);
        EXPECT_EQ(s.omega[p], begun.omega[p]);
      });
      const PerParticle<Vec3d>& first = m.built.model.r_0;
      if (may_keep_own_first_places(c)) {
        EXPECT_TRUE(*first.held() == *s.q.held());
        first.held()->for_each([&](ParticleId p) { EXPECT_EQ(first[p], whole.model.r_0[p]); });
      } else {
        EXPECT_EQ(first, whole.model.r_0);
      }
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

/// A run that goes on: bonds that have broken since hold nobody.
TEST(OwnBondsOf, ParticlesThatHaveLostSomeCountThoseThatHold) {
  const Case c = parsed(block);
  const auto is_broken = [](BondId name) { return name.value % 3 == 0; };
  State whole = build(c, 1).state;
  for (const BondId k : whole.bonds.ids()) whole.bonds[k].broken = is_broken(k);
  std::vector<Made> made = made_by(c, 2);
  testing::Meeting meeting(2);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      const testing::Process process(meeting, k);
      State& state = made[k].built.state;
      BondsFromSetUp& own = *made[k].built.own;
      own.all = &process;
      for (const BondId b : state.bonds.ids()) state.bonds[b].broken = is_broken(own.part.names[b]);
      count_bonds_of_each(own, state);
      own.all = nullptr;
    });
  for (std::thread& t : threads) t.join();
  for (const Made& m : made) EXPECT_EQ(m.built.own->bonds, BodyPart(whole).bonds_of_each());
}

TEST(OwnBondsOf, CasesThatAskForTheWholeBodyAreNotCutUp) {
  EXPECT_TRUE(may_keep_own_bonds(parsed(mixed)));
  const auto without = [](const std::function<void(Case&)>& change) {
    Case c = parsed(block);
    EXPECT_TRUE(may_keep_own_bonds(c));
    change(c);
    return !may_keep_own_bonds(c);
  };
  EXPECT_FALSE(without([](Case& c) { c.stages.push_back(c.stages[0]); }));
  EXPECT_TRUE(
      without([](Case& c) { c.stages.push_back(c.stages[0]), c.stages[1].pressures.emplace_back(); }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].kind = StageKind::equilibrium; }));
  EXPECT_TRUE(without([](Case& c) {
    c.cell.emplace();
    c.stages[0].supports.emplace_back().rigid = true;
  }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].when = BondTime::stage; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].when = BondTime::approach; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].recipe.capsule = true; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].recipe.expansion = 1e-5; }));
  EXPECT_TRUE(without([](Case& c) { c.bonds[0].select.value = AtCrossings{0.1}; }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].pressures.emplace_back(); }));
  EXPECT_TRUE(without([](Case& c) { c.sources.emplace_back(); }));
}

TEST(OwnBondsOf, CasesWithRigidGroupsHaveTheMotionOfAll) {
  Case c = parsed(block);
  EXPECT_TRUE(may_keep_own_motion(c));
  c.stages[0].supports.emplace_back();
  EXPECT_TRUE(may_keep_own_motion(c));
  c.stages[0].supports[0].rigid = true;
  EXPECT_FALSE(may_keep_own_motion(c));
  EXPECT_TRUE(may_keep_own_bonds(c));
  c.stages[0].supports.clear();
  c.sources.emplace_back();
  EXPECT_FALSE(may_keep_own_motion(c));
}

TEST(OwnBondsOf, CasesThatAskWhereOthersStoodAtFirstKnowThat) {
  const auto without = [](const std::function<void(Case&)>& change) {
    Case c = parsed(block);
    EXPECT_TRUE(may_keep_own_first_places(c));
    change(c);
    return !may_keep_own_first_places(c);
  };
  EXPECT_TRUE(without([](Case& c) { c.contact.law = ContactLaw::hertz; }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].strain.emplace(); }));
  EXPECT_TRUE(without([](Case& c) { c.output.stresses.emplace_back(); }));
  EXPECT_TRUE(without([](Case& c) { c.stages[0].supports.emplace_back().rigid = true; }));
}

/// Which of two processes has the lower half of the particles; what each tells, or nothing.
std::vector<std::string> told_by_two(const Case& c) {
  testing::Meeting meeting(2);
  std::vector<std::string> each(2);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < 2; ++k)
    threads.emplace_back([&, k] {
      const testing::Process process(meeting, k);
      try {
        const Built b = build(c, 1,
                              {.all = process,
                               .meet = [] {},
                               .spread =
                                   [k](const Model& m, const State&, const auto&, double) {
                                     std::vector<ParticleId> own;
                                     for (const ParticleId p : m.mass.ids())
                                       if (p.value * 2 / m.particles() == k) own.push_back(p);
                                     return own;
                                   }});
        each[k] = b.own ? "own bonds" : "all bonds";
      } catch (const CaseError& e) {
        each[k] = e.what();
      }
    });
  for (std::thread& t : threads) t.join();
  return each;
}

std::string told_by_one(const Case& c) {
  try {
    build(c, 1);
  } catch (const CaseError& e) {
    return e.what();
  }
  return {};
}

/// What is wrong is told as of one process, on all of them.
TEST(OwnBondsOf, ACaseThatIsWrongIsToldAsOfTheWholeBody) {
  Case c = parsed(mixed);
  c.bonds[1].recipe.prestrain = 0.5;  // more than it bears
  c.velocities.emplace_back().group = {"nobody", {"case.toml", 30, 1}};
  const std::string told = told_by_one(c);
  ASSERT_NE(told, "");
  EXPECT_EQ(told_by_two(c), (std::vector<std::string>{told, told}));
}

constexpr const char* two_blocks = R"(
[[specimen]]
name = "left"
kind = "block"
cells = [4, 2, 2]
radius = 0.4
mass = 1.0
[[specimen]]
name = "right"
kind = "block"
cells = [4, 2, 2]
origin = [10, 0, 0]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.1
attach = "surfaces"
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[contact]
law = "linear"
k = 0.5
[[stage]]
duration = "3 T0"
)";

/// Also what one process alone has found: bonds without length, particles that overlap, in either half.
TEST(OwnBondsOf, AMistakeThatOneProcessFindsIsToldByAll) {
  const Case sound = parsed(two_blocks);
  EXPECT_EQ(told_by_two(sound), (std::vector<std::string>{"own bonds", "own bonds"}));
  for (const std::size_t half : {0u, 1u}) {
    Case c = sound;
    c.specimens[half].radius = 0.55;  // a = 1 - 2 R
    std::string told = told_by_one(c);
    EXPECT_NE(told.find("no length is left"), std::string::npos);
    EXPECT_EQ(told_by_two(c), (std::vector<std::string>{told, told}));
    c.specimens[half].radius = 1.0;  // diagonals overlap by 2 R - sqrt 2
    c.bonds[0].recipe.attachment = Attachment::centres;
    told = told_by_one(c);
    EXPECT_NE(told.find("overlap by"), std::string::npos) << told;
    EXPECT_EQ(told_by_two(c), (std::vector<std::string>{told, told}));
  }
  Case c = sound;
  std::get<WithinDistance>(c.bonds[0].select.value).distance = 0.5;  // none is so near
  const std::string told = told_by_one(c);
  EXPECT_NE(told.find("no pair is within"), std::string::npos);
  EXPECT_EQ(told_by_two(c), (std::vector<std::string>{told, told}));
}

/// A set whose pairs are all bonded already is no mistake; the whole body is then made by each.
TEST(OwnBondsOf, ASetThatBondsNothingIsNoMistake) {
  Case c = parsed(two_blocks);
  c.bonds.push_back(c.bonds[0]);
  c.bonds[1].name = "again";
  EXPECT_EQ(told_by_one(c), "");
  EXPECT_EQ(told_by_two(c), (std::vector<std::string>{"all bonds", "all bonds"}));
}

}  // namespace
}  // namespace vbond::test
