#include <functional>

#include "cases.hpp"
#include "vbond/core/random.hpp"
#include "vbond/model/mistakes.hpp"

namespace vbond::test {
namespace {

VelocitySpec velocity(VelocityKind kind, double magnitude) {
  VelocitySpec v;
  v.place = {"case.toml", 80, 1};
  v.group = {"all", {}};
  v.kind = kind;
  v.magnitude = magnitude;
  return v;
}

Case many_particles() {
  return case_of(BlockSpecimen{Lattice::simple_cubic, {20, 20, 20}, 1.0, {}});
}

// For N = 8000 samples the standard error of a mean of squares is its standard deviation / sqrt(N): a disc
// has <rho^2> = 1/2 +- 0.29/89, a ball <r^2> = 3/5 +- 0.26/89, a Gaussian <x^2> = 1 +- 1.41/89 per
// component. Five standard errors, with a seed that is fixed.
TEST(Velocities, AreSpreadAsNamed) {
  const std::tuple<VelocityKind, double, double> kinds[] = {{VelocityKind::circle, 0.5, 5 * 0.29 / 89},
                                                            {VelocityKind::ball, 0.6, 5 * 0.26 / 89},
                                                            {VelocityKind::gaussian, 3.0, 5 * 2.45 / 89}};
  for (const auto& [kind, expected, tolerance] : kinds) {
    Case c = many_particles();
    c.velocities = {velocity(kind, 2.0)};
    c.velocities[0].normal = {0, 3, 4};
    const Built b = build(c);
    double sum = 0.0, largest = 0.0;
    for (const Vec3d& v : b.state.v) {
      sum += norm2(v) / 4.0;
      largest = std::max(largest, norm(v));
      if (kind == VelocityKind::circle) {
        EXPECT_NEAR(dot(v, Vec3d{0, 0.6, 0.8}), 0.0, 1e-15);
      }
    }
    EXPECT_NEAR(sum / 8000.0, expected, tolerance);
    if (kind != VelocityKind::gaussian) {
      EXPECT_LE(largest, 2.0 * (1.0 + 1e-15));
    }
  }
}

TEST(Velocities, AddUpAndChosenComponentsAreZeroed) {
  Case c = paper_rod();
  VelocitySpec given = velocity(VelocityKind::given, 0.0);
  given.velocity = {1, 2, 3};
  given.angular_velocity = {0, 0, 5};
  VelocitySpec more = given;
  more.group.value = "ends";
  more.zero = {false, false, true};
  c.velocities = {given, more};
  const Built b = build(c);
  EXPECT_EQ(b.state.v[ParticleId{5}], (Vec3d{1, 2, 3}));
  EXPECT_EQ(b.state.v[ParticleId{9}], (Vec3d{2, 4, 0}));
  EXPECT_EQ(b.state.omega[ParticleId{9}], (Vec3d{0, 0, 10}));
}

// A body that turns about its centre of mass: the momentum is M V whatever the masses, the distances keep.
TEST(Velocities, OfARigidBodyAreThoseOfItsCentreOfMassAndItsRotation) {
  Case c = case_of(ListedSpecimen{{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {1, 1, 1}}});
  c.specimens.push_back(specimen(ListedSpecimen{{{5, 5, 5}}}, "heavy"));
  c.specimens[1].mass = 7.0;
  VelocitySpec rigid = velocity(VelocityKind::rigid, 0.0);
  rigid.velocity = {1, -2, 3};
  rigid.angular_velocity = {0.5, -0.25, 2};
  c.velocities = {rigid};
  const Built b = build(c);
  Vec3d momentum;
  for (const ParticleId p : b.model.mass.ids()) {
    momentum += b.model.mass[p] * b.state.v[p];
    EXPECT_EQ(b.state.omega[p], rigid.angular_velocity);
    const Vec3d d = b.state.r[p] - b.state.r[ParticleId{0}], dv = b.state.v[p] - b.state.v[ParticleId{0}];
    EXPECT_LT(norm(dv - cross(rigid.angular_velocity, d)), 1e-14) << "particle " << p.value;
  }
  EXPECT_LT(norm(momentum - 11.0 * rigid.velocity), 1e-13);  // roundings of a sum of five
}

TEST(Velocities, FollowTheirSeed) {
  Case c = paper_rod();
  c.velocities = {velocity(VelocityKind::ball, 1.0)};
  const Built first = build(c);
  EXPECT_EQ(first.state.v, build(c).state.v);
  c.velocities[0].seed = 2;
  EXPECT_NE(first.state.v, build(c).state.v);
}

// The 10000th number of mt19937_64 with its default seed is fixed by the C++ standard, [rand.predef]:
// 9981545732273789042. Its upper 53 bits make the number.
TEST(RandomNumbers, AreThoseOfTheStandardsGenerator) {
  Random random(5489);
  for (int k = 0; k < 9999; ++k) random.uniform();
  EXPECT_EQ(random.uniform(), std::ldexp(static_cast<double>(9981545732273789042ull >> 11), -53));
}

TEST(Groups, AreFoundByRegionWithItsBoundary) {
  Case c = paper_rod();
  const SourcePlace place{"case.toml", 7, 1};
  c.groups = {{place, "box", BoxRegion{{2, 0, 0}, {4, 0, 0}}},
              {place, "ball", SphereRegion{{9, 0, 0}, 1.0}},
              {place, "plane", PlaneRegion{{0, 0, 0}, {2, 0, 0}, 1.5}},
              {place, "list", IndexList{7, 1}}};
  const Built b = build(c);
  EXPECT_EQ(numbers(b.model, "box"), (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(numbers(b.model, "ball"), (std::vector<std::size_t>{8, 9}));
  EXPECT_EQ(numbers(b.model, "plane"), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(numbers(b.model, "list"), (std::vector<std::size_t>{1, 7}));
}

TEST(Groups, MistakesAreReportedTogether) {
  Case c = paper_rod();
  const SourcePlace place{"case.toml", 7, 1};
  c.groups = {{place, "empty", BoxRegion{{2, 1, 0}, {4, 1, 0}}},
              {place, "ends", IndexList{1}},
              {place, "far", IndexList{1, 10}},
              {place, "twice", IndexList{1, 1}}};
  const std::string error = text_of_error(c);
  for (const char* part :
       {"group \"empty\" has no particles", "a second group of the name \"ends\"",
        "group \"far\": there is no particle 10", "group \"twice\" lists particle 1 twice"})
    EXPECT_TRUE(contains(error, part)) << part << "\nnot in\n" << error;
}

TEST(Particles, CannotBeAtTheSamePlace) {
  Case c = paper_rod();
  c.specimens.push_back(specimen(ListedSpecimen{{{20, 0, 0}, {3, 0, 0}}}, "probe"));
  EXPECT_TRUE(
      contains(text_of_error(c), "case.toml:3:1: particles 3 and 11 are at the same place (1 such pairs)"));
}

TEST(Particles, TooNearForTheSizeOfTheCaseAreToldSo) {
  Case c = paper_rod();
  c.specimens.push_back(specimen(ListedSpecimen{{{1e15, 0, 0}}}, "probe"));
  EXPECT_TRUE(contains(text_of_error(c), "particles 0 and 1 are 1 apart in a case that is 1e+15 wide"))
      << text_of_error(c);
}

// All pairs of these are 2e10: the count ends at a thousand, and the test with it.
TEST(Build, TellsOfManyParticlesAtOnePlaceWithoutCountingAllPairs) {
  Case c = case_of(ListedSpecimen{std::vector<Vec3d>(200'000, Vec3d{1, 2, 3})});
  EXPECT_TRUE(
      contains(text_of_error(c), "particles 0 and 1 are at the same place (1000 such pairs at least)"));
}

TEST(NaturalTime, OutOfRangeIsRefusedWithItsNumbers) {
  Case c = paper_rod();
  std::get<TheoryParameters>(c.bonds[0].recipe.parameters).material.E = 1e-320;
  const std::string error = text_of_error(c);
  EXPECT_TRUE(contains(error, "case.toml:10:1: T0 = inf")) << error;
  EXPECT_TRUE(contains(error, "here m = 1 and the first bond has c_A = ")) << error;
}

TEST(Particles, NeedMassInertiaAndFinitePositions) {
  Case c = paper_rod();
  c.specimens[0].radius = 0.0;
  EXPECT_TRUE(contains(text_of_error(c), "inertia = 0")) << text_of_error(c);
  c.specimens[0].inertia = 0.064;
  EXPECT_EQ(text_of_error(c), "");
  c.specimens[0].mass.reset();
  EXPECT_TRUE(contains(text_of_error(c), "has no mass"));
  c.specimens[0].density = 1.0;
  EXPECT_TRUE(contains(text_of_error(c), "a density needs a positive radius"));
  c.specimens[0].mass = 1.0;
  EXPECT_TRUE(contains(text_of_error(c), "mass is given more than once"));
  EXPECT_TRUE(contains(text_of_error(case_of(ListedSpecimen{{{0, NAN, 0}}})), "its position is not finite"));
}

// m/5 (b^2 + c^2), m/12 (b^2 + c^2), m/12 (3 R^2 + l^2) and m/2 R^2.
TEST(Particles, HaveTheInertiaOfSolidsOrATensor) {
  const ParticleId p{1};
  const auto principal = [&](const std::function<void(SpecimenSpec&)>& change) {
    Case c = case_of(ListedSpecimen{{{0, 0, 0}, {9, 0, 0}}});
    c.specimens[0].mass = 6.0;
    change(c.specimens[0]);
    const Model model = build(c).model;
    EXPECT_TRUE(mistakes_in(model).empty());
    EXPECT_EQ(model.is_top(p), !model.principal.empty());
    return model.principal.empty() ? PrincipalInertia{Vec3d{1, 1, 1} * model.inertia[p], {}}
                                   : model.principal[p];
  };
  const auto solid = [&](const auto& shape) {
    return principal([&](SpecimenSpec& s) { s.solid = SolidSpec{shape}; }).moments;
  };
  const auto expect_near = [](const Vec3d& found, const Vec3d& expected) {
    EXPECT_LT(norm(found - expected), 1e-13) << found.x << " " << found.y << " " << found.z;
  };
  expect_near(solid(EllipsoidSolid{{1, 2, 3}}), 1.2 * Vec3d{13, 10, 5});
  expect_near(solid(BoxSolid{{1, 2, 3}}), 0.5 * Vec3d{13, 10, 5});
  expect_near(solid(CylinderSolid{{2, 3}}), {10.5, 10.5, 12});
  expect_near(solid(EllipsoidSolid{{0.5, 0.5, 0.5}}), Vec3d{1, 1, 1} * 0.6);
  expect_near(principal([](SpecimenSpec& s) { s.principal_inertia = {3, 4, 5}; }).moments, {3, 4, 5});

  // a tensor that was turned: columns of R diag(3, 4, 5) R^T
  const Quatd R = rotation_of({0.3, -1.2, 0.7});
  const auto column = [&](const Vec3d& e) { return angular_momentum({3, 4, 5}, R, e); };
  const Vec3d x = column({1, 0, 0}), y = column({0, 1, 0}), z = column({0, 0, 1});
  const PrincipalInertia found =
      principal([&](SpecimenSpec& s) { s.inertia_tensor = {x.x, y.y, z.z, x.y, x.z, y.z}; });
  for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    expect_near(angular_momentum(found.moments, found.axes, e), column(e));
  expect_near(principal([](SpecimenSpec& s) { s.inertia_tensor = {2, 2, 2, 0, 0, 0}; }).moments, {2, 2, 2});
}

TEST(Particles, OfAFileMayHaveThreeMomentsEach) {
  const TemporaryFile file("points.csv", "x,y,z,inertia_x,inertia_y,inertia_z\n0,0,0,2,2,2\n1,0,0,2,3,4\n");
  Case c = case_of(CsvSpecimen{{file.path(), {"case.toml", 4, 1}}});
  c.specimens[0].array = {{2, {10, 0, 0}}};
  const Model model = build(c).model;
  for (const std::size_t k : {0u, 1u, 2u, 3u}) EXPECT_EQ(model.is_top(ParticleId{k}), k % 2 == 1) << k;
  EXPECT_EQ(model.principal[ParticleId{3}].moments, (Vec3d{2, 3, 4}));
  c.specimens[0].inertia = 1.0;
  EXPECT_TRUE(contains(text_of_error(c), "inertia is given more than once")) << text_of_error(c);
  const TemporaryFile flat("flat.csv", "x,y,z,inertia_x,inertia_y,inertia_z\n1,0,0,2,3,6\n");
  const std::string error = text_of_error(case_of(CsvSpecimen{{flat.path(), {"case.toml", 4, 1}}}));
  EXPECT_TRUE(contains(error, "its particle 0: moments of inertia 2, 3, 6")) << error;
  const TemporaryFile two("two.csv", "x,y,z,inertia_x,inertia_y\n1,0,0,2,3\n");
  EXPECT_TRUE(contains(text_of_error(case_of(CsvSpecimen{{two.path(), {"case.toml", 4, 1}}})),
                       "inertia_x, inertia_y, inertia_z are not all there"));
}

TEST(Supports, OfTopsHoldTheirTurnsInWhole) {
  Case c = case_of(ListedSpecimen{{{0, 0, 0}}});
  c.specimens[0].principal_inertia = {3, 4, 5};
  c.time.step = {CaseTime{0.1, false}, {}};
  SupportSpec support;
  support.place = {"case.toml", 30, 1};
  support.group = {"all", {}};
  support.held = {true, true, true, true, false, false};
  c.stages[0].supports = {support};
  const std::string error = text_of_error(c);
  EXPECT_TRUE(contains(error, "case.toml:30:1: particle 0 of group \"all\"")) << error;
  c.stages[0].supports[0].held = {true, true, true, true, true, false};
  EXPECT_EQ(text_of_error(c), "");
}

TEST(Particles, NeedARadiusForContactsAndSurfaceBonds) {
  Case c = paper_rod();
  c.specimens[0].radius = 0.0;
  c.specimens[0].inertia = 0.064;
  c.contact.law = ContactLaw::paper_hertz;
  EXPECT_TRUE(contains(text_of_error(c),
                       "case.toml:3:1: contact: particle 0 has radius 0\n  contacts need radii > 0"));
  c.contact.law = ContactLaw::none;
  c.bonds[0].recipe.attachment = Attachment::surfaces;
  EXPECT_TRUE(contains(text_of_error(c), "a bond between surfaces needs radii > 0"));
}

TEST(Case, WithoutSpecimenIsRefused) {
  Case c;
  c.file = "case.toml";
  EXPECT_EQ(text_of_error(c).rfind("case.toml: the case has no specimen\n", 0), 0u) << text_of_error(c);
}

}  // namespace
}  // namespace vbond::test
