#include <gtest/gtest.h>
// after gtest.h, which it needs
#include <rapidcheck/gtest.h>

#include <cstdio>
#include <functional>

#include "cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/random.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/setup/bonds.hpp"

namespace vbond::test {
namespace {

std::vector<std::array<std::uint32_t, 2>> pairs_of(const State& s) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const Bond& b : s.bonds) pairs.push_back({b.i.value, b.j.value});
  return pairs;
}

using PairNumbers = std::vector<std::array<std::uint32_t, 2>>;

// Positions on a coarse grid make pairs at exactly the distance, points in the same place and cells on
// their very boundary frequent; the rest is spread at random, flat or long bodies among them.
RC_GTEST_PROP(DistanceSelection, EqualsBruteForce, ()) {
  const auto n = *rc::gen::inRange<std::size_t>(1, 60);
  const auto on_grid = *rc::gen::arbitrary<bool>();
  const auto distance = static_cast<double>(*rc::gen::inRange(1, 8)) * 0.25;
  const auto thin = *rc::gen::elementOf(std::vector<double>{0.0, 1e-3, 1.0, 1e4});
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  std::vector<Vec3d> r;
  std::vector<char> in_a, in_b;
  for (std::size_t k = 0; k < n; ++k) {
    const auto coordinate = [&] {
      const double x = 6.0 * random.uniform() - 3.0;
      return on_grid ? 0.25 * std::floor(4.0 * x) : x;
    };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    r.push_back({x, y, thin * z});
    in_a.push_back(random.uniform() < 0.7);
    in_b.push_back(random.uniform() < 0.5);
  }
  std::vector<Pair> expected;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (((in_a[i] && in_b[j]) || (in_a[j] && in_b[i])) && norm2(r[j] - r[i]) <= distance * distance)
        expected.push_back({ParticleId{i}, ParticleId{j}});
  RC_ASSERT(pairs_within(r, distance, in_a, in_b) == expected);
}

TEST(DistanceSelection, StopsAtTheMostThatThereMayBe) {
  const std::vector<Vec3d> r{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<char> all(3, 1);
  EXPECT_EQ(pairs_within(r, 5.0, all, all, 3.0).size(), 3u);
  EXPECT_THROW(pairs_within(r, 5.0, all, all, 2.0), std::length_error);
}

TEST(Bonds, JoinNeighboursOfARodInOrder) {
  const Built b = build(paper_rod());
  ASSERT_EQ(b.state.bonds.size(), 9u);
  for (const BondId id : b.state.bonds.ids()) {
    EXPECT_EQ(b.state.bonds[id].i.value, id.value);
    EXPECT_EQ(b.state.bonds[id].j.value, id.value + 1);
  }
}

// The paper's B1..B4 for d/a = 0.2, nu = 0.2: (1, -0.005, 0.015, 1/480), and T_0 = 2 pi.
TEST(Bonds, OfThePapersRodHaveItsParameters) {
  const Built b = build(paper_rod());
  const Bond& bond = b.state.bonds[BondId{4}];
  EXPECT_NEAR(bond.coefficients[0], 1.0, 1e-15);
  EXPECT_NEAR(bond.coefficients[1], -0.005, 1e-16);
  EXPECT_NEAR(bond.coefficients[2], 0.015, 1e-16);
  EXPECT_NEAR(bond.coefficients[3], 1.0 / 480.0, 1e-17);
  EXPECT_DOUBLE_EQ(b.model.T_0, 2.0 * std::numbers::pi);
}

// Two bonds, of lengths 1 and 2. A Bernoulli-Euler bond of twice the length has half c_A; with a reference
// length both have the same B1..B4.
TEST(Bonds, TakeTheirParametersAtTheirOwnLengthOrAtOneForAll) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}});
  c.bonds.push_back(bonds_within(2.5));
  const Built own = build(c);
  EXPECT_DOUBLE_EQ(own.state.bonds[BondId{0}].coefficients[0],
                   2.0 * own.state.bonds[BondId{1}].coefficients[0]);
  c.bonds[0].recipe.reference_length = 1.0;
  const Built one = build(c);
  const Bond &s = one.state.bonds[BondId{0}], &l = one.state.bonds[BondId{1}];
  EXPECT_EQ(l.a, 2.0);
  EXPECT_EQ(s.coefficients, l.coefficients);
}

TEST(Bonds, MadeBetweenTurnedParticlesAreUnstressed) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}, {0.6, 1.1, -0.3}, {1.3, 0.2, 0.9}}});
  BondSpec bonds = bonds_within(3.0);
  bonds.when = BondTime::stage;
  bonds.stages = {{"run", {"case.toml", 13, 1}}};
  bonds.recipe.attachment = Attachment::given;
  bonds.recipe.R_i = 0.3, bonds.recipe.R_j = 0.1;
  for (const BondLaw* law : bond_laws()) {
    bonds.recipe.law = law;
    c.bonds = {bonds};
    Built b = build(c);
    EXPECT_TRUE(b.state.bonds.empty()) << "these bonds belong to the stage";
    b.state.q = {rotation_of({0.4, -1.1, 2.0}), rotation_of({-2.0, 0.3, 0.7}), rotation_of({1.0, 1.0, -0.5})};
    build_stage(c, b.model, 0, b.state);
    ASSERT_EQ(b.state.bonds.size(), 3u);
    for (const Bond& bond : b.state.bonds) {
      const auto pose = bond_pose(bond, b.state);
      // products of unit vectors are off by a few 1e-16, and c_A = 1: energies are second order in that
      // except for the constant, loads first order
      const BondEnergy<double> U = law->energy(bond, pose, no_history);
      EXPECT_NEAR(U.U_L + U.U_B + U.U_T, 0.0, 1e-16);
      const BondLoads<double> loads = law->loads(bond, pose, no_history);
      EXPECT_LT(norm(loads.F) + norm(loads.M_ij) + norm(loads.M_ji), 5e-15);
    }
  }
}

/// What building a rod of this spacing says, with bonds that soften from s_c = 1 on, E = 100, G_f = 0.01:
/// they must be shorter than 2 E G_f/s_c^2 = 2.
std::string softening_rod(double spacing, BondTime when) {
  Case c = case_of(RodSpecimen{4, spacing, {}, {1, 0, 0}});
  BondSpec bonds = bonds_within(1.1 * spacing);
  bonds.when = when;
  bonds.recipe.parameters = TheoryParameters{BondTheory::bernoulli_euler, {100.0, 0.2}, circle(0.2), 0};
  bonds.softening = SofteningSpec{{"case.toml", 12, 1}, 1.0, 0.01, {}};
  bonds.recipe.rules.softening = {circle(0.2).A * 1.0, 2.0 * 0.01 / 1.0};
  c.bonds = {bonds};
  try {
    Built b = build(c);
    build_stage(c, b.model, 0, b.state);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

/// What is said of a rod, 1 between particles of radius 0.4, whose bonds touch as capsules.
std::string capsule_rod(double radius, const ContactModel& contact, BondTime when) {
  Case c = paper_rod();
  c.contact = contact;
  BondSpec bonds = c.bonds[0];
  bonds.recipe.capsule = true, bonds.recipe.capsule_radius = radius;
  bonds.when = when;
  c.bonds = {bonds};
  try {
    Built b = build(c);
    build_stage(c, b.model, 0, b.state);
  } catch (const CaseError& e) {
    EXPECT_EQ(e.problems()[0].place.line, bonds.place.line);
    return e.what();
  }
  return "";
}

TEST(Capsules, ThatCannotBeAreRefusedWithAWayOut) {
  ContactModel hertz{.law = ContactLaw::hertz, .E = 100.0, .nu = 0.2};
  for (const BondTime when : {BondTime::start, BondTime::approach}) {
    const auto says = [when](double radius, const ContactModel& contact, const char* rule,
                             const char* way_out) {
      const std::string said = capsule_rod(radius, contact, when);
      EXPECT_NE(said.find(rule), std::string::npos) << said;
      EXPECT_NE(said.find(way_out), std::string::npos) << said;
    };
    EXPECT_EQ(capsule_rod(0.3, hertz, when), "");
    EXPECT_EQ(capsule_rod(0.0, hertz, when), "");  // that of the particles
    says(1.2, hertz, "smaller than the distance of its two particles", "use capsule_radius below");
    says(0.3, {}, "nothing touches in this case", "add [contact]");
    ContactModel walls_only = hertz, sticky = hertz;
    walls_only.pairs = ContactPairs::none;
    says(0.3, walls_only, "nothing touches in this case", "pairs = \"unbonded\"");
    sticky.adhesion = AdhesionForm::jkr, sticky.surface.work_of_adhesion = 0.1;
    says(0.3, sticky, "capsules do not adhere", "leave contact.adhesion out");
  }
}

TEST(Capsules, HaveTheSmallerRadiusOfTheirParticlesUnlessItIsGiven) {
  Case c = paper_rod();
  c.contact = {.law = ContactLaw::hertz, .E = 100.0, .nu = 0.2};
  c.bonds[0].recipe.capsule = true;
  EXPECT_EQ(capsule_of(build(c).state.bonds[BondId{0}]), c.specimens[0].radius);
  c.bonds[0].recipe.capsule_radius = 0.25;
  EXPECT_EQ(capsule_of(build(c).state.bonds[BondId{8}]), 0.25);
}

TEST(Bonds, ThatSoftenMustNotSnapBack) {
  EXPECT_EQ(softening_rod(1.9, BondTime::start), "");
  EXPECT_EQ(softening_rod(1.8, BondTime::approach), "");
  for (const BondTime when : {BondTime::start, BondTime::approach}) {
    const std::string refused = softening_rod(2.1, when);
    EXPECT_NE(refused.find("case.toml:12:1: "), std::string::npos) << refused;
    EXPECT_NE(refused.find("2 E G_f/s_c^2"), std::string::npos) << refused;
    EXPECT_NE(refused.find("bonds shorter than 2,"), std::string::npos) << refused;
  }
}

/// What is said of a rod whose bonds have this prestrain and may break or flow.
std::string prestrained_rod(double prestrain, const BondRules& rules, BondTime when) {
  Case c = paper_rod();
  c.bonds[0].when = when;
  c.bonds[0].recipe.prestrain = prestrain, c.bonds[0].recipe.rules = rules;
  return text_of_error(c);
}

// With c_A = 1 the loads of a prestrain e are N = e/(1 + e) at a distance of 1. Half of what breaks the bond
// is taken, twice as much refused, whatever the criterion; a bond that flows may be strong enough.
TEST(Bonds, ThatTheirPrestrainBreaksAreRefused) {
  const Section s = circle(0.2);
  const double e = 0.02, N = e / (1.0 + e), sigma = N / s.A;
  using Make = std::function<Strength(double)>;  // of a strength this many times what the prestrain takes
  const std::vector<std::pair<double, Make>> criteria{
      {e, [&](double x) { return stress_strength(s, x * sigma, 1e9); }},
      {e, [&](double x) { return fibre_strength(s, x * sigma, 1e9); }},
      {e, [&](double x) { return mohr_coulomb_strength(s, 1e9, 0.1, x * sigma); }},
      {e, [&](double x) { return linear_strength(x * N, 1.0, 1.0, 1.0); }},
      {e, [&](double x) { return quadratic_strength(x * N, 1.0, 1.0, 1.0); }},
      {e, [&](double x) { return energy_strength(x * 0.5 * N * N, 1.0); }},
      {e, [&](double x) { return elongation_strength(x * e); }},
      {-e, [&](double x) { return stress_strength(s, 1e9, 1e9, 1.0, x * sigma); }},
      {-e, [&](double x) { return fibre_strength(s, 1e9, 1e9, x * sigma); }}};
  for (const BondTime when : {BondTime::start, BondTime::approach})
    for (std::size_t k = 0; k < criteria.size(); ++k) {
      const auto& [prestrain, strength] = criteria[k];
      BondRules rules;
      rules.strength = strength(2.0);
      EXPECT_EQ(prestrained_rod(prestrain, rules, when), "") << k;
      rules.strength = strength(0.5);
      const std::string error = prestrained_rod(prestrain, rules, when);
      EXPECT_TRUE(contains(error, "case.toml:10:1: bonds \"bonds\": prestrain = ")) << k << error;
      EXPECT_TRUE(contains(error, "broken as it is made\n  use a prestrain nearer to 0")) << k << error;
      if (k > 3) continue;
      rules.yield.limit.axial = rules.yield.compression = 0.25 * N;
      EXPECT_EQ(prestrained_rod(prestrain, rules, when), "") << k;
    }
}

// Of Weibull strengths the part 1 - exp(-(1/4)^2) = 6.06 % is below a quarter of their scale, to four
// standard errors of a thousand.
TEST(Bonds, ThatAreByChanceWeakerThanTheirPrestrainAreTold) {
  const double e = 0.02, N = e / (1.0 + e);
  Case c = paper_rod();
  std::get<RodSpecimen>(c.specimens[0].shape).particles = 1001;
  c.bonds[0].recipe.prestrain = e;
  c.bonds[0].recipe.rules.strength = linear_strength(4.0 * N, 1.0, 1.0, 1.0);
  EXPECT_TRUE(build(c).notes.empty());
  c.bonds[0].recipe.weibull = {2.0, 0, 0, 1};
  for (const BondTime when : {BondTime::start, BondTime::approach}) {
    c.bonds[0].when = when;
    if (when == BondTime::approach) c.bonds[0].select.value = WithinDistance{1.0};
    const std::vector<std::string> notes = build(c).notes;
    ASSERT_EQ(notes.size(), 1u);
    int weak = 0;
    double part = 0;
    if (when == BondTime::start)
      EXPECT_EQ(std::sscanf(notes[0].c_str(), "bonds \"bonds\": %d of 1000 are weaker", &weak), 1)
          << notes[0];
    else
      EXPECT_EQ(std::sscanf(notes[0].c_str(), "bonds \"bonds\": some %lf %% at the distance", &part), 1)
          << notes[0];
    EXPECT_NEAR(0.1 * weak + part, 6.06, 3.02);
  }
}

TEST(Capsules, OfARuleAreThoseOfItsLargestPair) {
  const auto said = [](double larger) {
    Case c = case_of(ListedSpecimen{{{0, 0, 0}, {3, 0, 0}}});
    c.specimens.push_back(specimen(ListedSpecimen{{{30, 0, 0}, {33, 0, 0}}}, "large"));
    c.specimens[1].radius = larger;
    c.specimens.push_back(specimen(ListedSpecimen{{{60, 0, 0}}}, "huge"));
    c.specimens[2].radius = 5.0;
    c.contact = {.law = ContactLaw::hertz, .E = 100.0, .nu = 0.2};
    c.bonds = {bonds_within(1.5)};
    c.bonds[0].when = BondTime::approach;
    c.bonds[0].recipe.capsule = true;
    return text_of_error(c);
  };
  EXPECT_EQ(said(1.4), "");  // one particle alone may be thicker: its capsules have the smaller radius
  const std::string error = said(1.6);
  EXPECT_TRUE(contains(error, "case.toml:10:1: bonds \"bonds\": capsules of radius 1.6 at a distance of 1.5"))
      << error;
}

TEST(Bonds, OfPairsComeInOrderWhateverTheOrderGiven) {
  Case c = case_of(RodSpecimen{4, 1.0, {}, {1, 0, 0}});
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = ListedPairs{{{3, 2}, {0, 2}, {1, 0}}};
  c.bonds = {bonds};
  EXPECT_EQ(pairs_of(build(c).state), (PairNumbers{{0, 1}, {0, 2}, {2, 3}}));
}

TEST(Bonds, OfAFileComeInOrder) {
  const TemporaryFile file("pairs.csv", "j,i\n3,2\n1,0\n");
  Case c = case_of(RodSpecimen{4, 1.0, {}, {1, 0, 0}});
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = PairsFile{file.path()};
  c.bonds = {bonds};
  EXPECT_EQ(pairs_of(build(c).state), (PairNumbers{{0, 1}, {2, 3}}));
}

TEST(Bonds, ByDistancePassOverPairsThatAreBonded) {
  Case c = paper_rod();
  c.bonds.push_back(bonds_within(2.1));
  const Built b = build(c);
  EXPECT_EQ(b.state.bonds.size(), 9u + 8u);
  EXPECT_EQ(b.state.bonds[BondId{8}].set, 0u);
  EXPECT_EQ(b.state.bonds[BondId{9}].set, 1u);
}

// Particles of a rod lie at rounded multiples of its spacing.
TEST(Bonds, ByADistanceThatIsTheSpacingJoinAllNeighbours) {
  for (const double spacing : {0.0125, 0.001, 0.1, 1.0 / 3.0, 0.7}) {
    Case c = case_of(RodSpecimen{41, spacing, {0.3, -2.0, 1.7}, {1, 0, 0}});
    c.bonds = {bonds_within(spacing)};
    EXPECT_EQ(build(c).state.bonds.size(), 40u) << spacing;
    c.bonds = {bonds_within(spacing * (1.0 - 1e-8))};
    EXPECT_TRUE(contains(text_of_error(c), "no pair is within")) << spacing;
  }
}

TEST(Bonds, ByDistanceJoinOnlyTheTwoGroups) {
  Case c = case_of(RodSpecimen{4, 1.0, {}, {1, 0, 0}});
  c.groups = {{{"case.toml", 7, 1}, "left", IndexList{0, 1}},
              {{"case.toml", 8, 1}, "right", IndexList{3, 2}}};
  c.bonds = {bonds_within(1.1)};
  c.bonds[0].between[0].value = "right";
  c.bonds[0].between[1].value = "left";
  EXPECT_EQ(pairs_of(build(c).state), (PairNumbers{{1, 2}}));
}

TEST(Bonds, WithoutLengthAreRefusedWithAllThatMatters) {
  Case c = paper_rod();
  c.specimens[0].radius = 0.5;  // touching
  c.bonds[0].recipe.attachment = Attachment::surfaces;
  const std::string error = text_of_error(c);
  EXPECT_TRUE(contains(error, "particles 0 and 1 are 1 apart with R_i = 0.5, R_j = 0.5 (and 8 more)"))
      << error;
  EXPECT_TRUE(contains(error, "bond at the centres")) << error;
}

TEST(Bonds, OfWrongPairsAreAllReported) {
  Case c = paper_rod();
  BondSpec bonds = bonds_within(1.0);
  bonds.name = "cross";
  bonds.select.value = ListedPairs{{{0, 1}, {2, 2}, {3, 10}, {4, 6}, {6, 4}}};
  c.bonds.push_back(bonds);
  const std::string error = text_of_error(c);
  for (const char* part :
       {"pair 0, 1\n  the pair is bonded already", "pair 2, 2\n  a bond joins two different",
        "there is no particle 10\n  particles are numbered 0 to 9", "pair 6, 4\n  the pair is there twice"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
}

TEST(Bonds, ByDistanceSayHowFarTheNearestAre) {
  Case c = paper_rod();
  c.bonds[0].select.value = WithinDistance{0.7};
  const std::string error = text_of_error(c);
  EXPECT_TRUE(contains(error, "no pair is within 0.7")) << error;
  EXPECT_TRUE(contains(error, "the nearest are 1 apart")) << error;
}

TEST(Bonds, ByDistanceNeedAPositiveOne) {
  Case c = paper_rod();
  c.bonds[0].select.value = WithinDistance{-1.1};
  EXPECT_TRUE(contains(text_of_error(c), "distance = -1.1\n  must be > 0"));
}

TEST(Bonds, WhoseRestIsNoMinimumAreRefused) {
  Case c = paper_rod();
  c.bonds[0].recipe.parameters = GivenCoefficients{{1.0, -0.01, 0.015, 0.002}};  // c_B = -0.0025
  EXPECT_TRUE(contains(text_of_error(c), "c_B = -0.0025"));
}

TEST(Bonds, OfAStageAreMadeOnceEvenIfItIsBuiltAgain) {
  Case c = case_of(RodSpecimen{3, 1.0, {}, {1, 0, 0}});
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = ListedPairs{{{0, 1}, {1, 2}}};
  bonds.when = BondTime::stage;
  bonds.stages = {{"run", {"case.toml", 13, 1}}};
  c.bonds = {bonds};
  Built b = build(c);
  build_stage(c, b.model, 0, b.state);
  build_stage(c, b.model, 0, b.state);  // as when a run stopped before its first step is resumed
  EXPECT_EQ(b.state.bonds.size(), 2u);
}

// Two that press and rub on each other are bonded as a stage begins: what their contact had stored is gone.
TEST(Bonds, OfAStageBookWhatContactsHadStored) {
  const Case c = parse_case(
      "[[specimen]]\nkind = \"list\"\nradius = 1\nmass = 1\npositions = [[0, 0, 0], [1.99, 0, 0]]\n"
      "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.25\ntangential = \"mindlin\"\nfriction = 0.5\npairs = "
      "\"unbonded\"\n"
      "[[bonds]]\ndistance = 2\nwhen = \"stage\"\nstages = [\"run\"]\n"
      "stiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}\n"
      "[[stage]]\nname = \"run\"\nduration = 1\n[time]\nstep = 0.01\n",
      "case.toml");
  Built b = build(c);
  const double a = std::sqrt(0.5 * 0.01), E = 100 / (2 * (1 - 0.25 * 0.25)), G = 100 / 2.5 / (2 * (2 - 0.25));
  b.state.contact_history = {{ParticleId{0}, ParticleId{1}, {0, 0.01, 0, a}, 0.0}};
  build_stage(c, b.model, 0, b.state);
  ASSERT_EQ(b.state.bonds.size(), 1u);
  const double pressed = 8.0 / 15.0 * E * a * 0.01 * 0.01, rubbed = 0.01 * 0.01 / (2 * 8 * G * a);
  EXPECT_NEAR(b.state.books.lost[Loss::bonding], pressed + rubbed, 1e-13);
}

}  // namespace
}  // namespace vbond::test
