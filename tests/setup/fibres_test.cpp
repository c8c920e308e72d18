#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "plain_fibres.hpp"
#include "vbond/setup/fibres/orientation.hpp"
#include "vbond/setup/fibres/size_draw.hpp"

namespace vbond::fibres_test {
namespace {

using plain_fibres::chains_of;
using plain_fibres::contour;
using plain_fibres::fibres;
using plain_fibres::least_distance;

std::string refusal(const std::string& keys, const std::string& before = "", const std::string& after = "") {
  try {
    build(fibres(keys, before, after));
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}
bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::string layer =
    "length = 10\ndiameter = 0.2\nspacing = 0.5\nlayer = { min = [0, 0, 0], max = [40, 40, 2] }\nmass = 1\n";

// ---- directions ---------------------------------------------------------------------------------

/// The integral of orientation.hpp by Simpson's rule over x = s/(1 + s), lambda of order 1.
Vec3d tensor_by_quadrature(const Vec3d& l) {
  const int n = 20000;
  Vec3d sum;
  for (int k = 0; k <= n; ++k) {
    // x = 1 - y^2 takes the root at the far end away
    const double y = double(k) / n, weight = (k == 0 || k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) / (3.0 * n);
    // s = (1 - y^2)/y^2; ds = 2/y^3 dy; 1 + lambda s = (y^2 + lambda (1 - y^2))/y^2
    const auto q = [&](double lambda) { return y * y + lambda * (1.0 - y * y); };
    const double root = std::sqrt(q(l.x) * q(l.y) * q(l.z));  // times y^-3
    // 1/2 lambda y^2/q * y^3/root * 2/y^3
    const double f = weight * y * y / root;
    sum += f * Vec3d{l.x / q(l.x), l.y / q(l.y), l.z / q(l.z)};
  }
  return sum;
}

TEST(FibreDirections, TensorOfTheDistributionIsItsIntegral) {
  for (const Vec3d& lambda : {Vec3d{1, 1, 1}, {1, 0.5, 0.25}, {3, 1, 1}, {0.05, 1, 0.6}}) {
    const Vec3d is = orientation_of_variances(lambda), by_quadrature = tensor_by_quadrature(lambda);
    EXPECT_NEAR(is.x + is.y + is.z, 1.0, 1e-13);
    EXPECT_LT(norm(is - by_quadrature), 1e-10) << lambda.x << " " << lambda.y << " " << lambda.z;
  }
  EXPECT_LT(norm(orientation_of_variances({4, 1, 0}) - Vec3d{2.0 / 3.0, 1.0 / 3.0, 0}), 1e-15);
}

TEST(FibreDirections, VariancesAreFoundForEveryTensor) {
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    // from even to one part in 1e6
    const auto part = [&] { return std::exp(-14.0 * random.uniform() * random.uniform()); };
    Vec3d a{part(), part(), part()};
    a = a / (a.x + a.y + a.z);
    const Vec3d again = orientation_of_variances(variances_of_orientation(a));
    EXPECT_LT(std::abs(again.x / a.x - 1) + std::abs(again.y / a.y - 1) + std::abs(again.z / a.z - 1), 1e-10)
        << a.x << " " << a.y << " " << a.z;
  }
}

// Of n directions a component of the tensor scatters by 0.3/sqrt(n) at most (that of x^2 in a plane is
// sqrt(1/8)); five times that is not exceeded by 6 times 4 numbers.
TEST(FibreDirections, ManyOfThemHaveTheTensorThatWasAskedFor) {
  FibresSpecimen spec;
  const int n = 200000;
  const auto judge = [&](const OrientationTensor& wanted) {
    const DirectionDraw draw(spec);
    Random random(7);
    std::vector<Vec3d> p;
    for (int k = 0; k < n; ++k) p.push_back(draw.draw(random));
    const OrientationTensor is = mean_dyad(p);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(is[k], wanted[k], 5 * 0.36 / std::sqrt(n)) << k;
    for (const Vec3d& e : p) ASSERT_NEAR(norm(e), 1.0, 1e-14);
  };
  judge({1.0 / 3, 1.0 / 3, 1.0 / 3, 0, 0, 0});
  spec.orientation = FibreOrientation::planar;
  spec.normal = {0, 2, 0};
  judge({0.5, 0, 0.5, 0, 0, 0});
  spec.orientation = FibreOrientation::tensor;
  spec.tensor = {0.5, 0.3, 0.2, 0.1, -0.05, 0.02};
  judge(spec.tensor);
  spec.tensor = {0.5, 0.5, 0, 0.5, 0, 0};  // aligned along x + y
  judge(spec.tensor);
}

// They are stretched until their mean is right: to rounding for twenty as for a thousand.
TEST(FibreDirections, OfAFewTheTensorIsExact) {
  FibresSpecimen spec;
  spec.orientation = FibreOrientation::tensor;
  for (const OrientationTensor& wanted : {OrientationTensor{0.5, 0.3, 0.2, 0.1, -0.05, 0.02},
                                          {0.7, 0.3, 0, 0, 0, 0},
                                          {1.0 / 3, 1.0 / 3, 1.0 / 3, 0, 0, 0}}) {
    spec.tensor = wanted;
    for (const std::size_t n : {20u, 1000u}) {
      Random random(n);
      const OrientationTensor is = mean_dyad(DirectionDraw(spec).draw(n, random));
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(is[k], wanted[k], 1e-12) << n << " " << k;
    }
  }
}

// ---- lengths ------------------------------------------------------------------------------------

/// The largest difference of the distribution of the sizes from the asked one.
double off(std::vector<double> sizes, double (*below)(double)) {
  std::sort(sizes.begin(), sizes.end());
  double most = 0.0;
  for (std::size_t k = 0; k < sizes.size(); ++k)
    for (const std::size_t m : {k, k + 1})
      most = std::max(most, std::abs(below(sizes[k]) - double(m) / double(sizes.size())));
  return most;
}

// One of each n-th part: the curve is off by 1/n at most.
TEST(FibreLengths, HaveTheDistributionThatWasAskedFor) {
  Random random(1);
  const std::size_t n = 200;
  SizeSpec spec;
  spec.form = LognormalSizes{5.0, 0.4, {}, {}};
  EXPECT_LE(off(SizeDraw(spec, 1e-3).draw(n, random),
                [](double x) { return 0.5 * std::erfc(-std::log(x / 5.0) / 0.4 / std::numbers::sqrt2); }),
            1.0 / n + 1e-12);
  EXPECT_NEAR(SizeDraw(spec, 1e-3).mean(), 5.0 * std::exp(0.5 * 0.4 * 0.4), 1e-4);
  spec.form = NormalSizes{10.0, 3.0, 8.0, 11.0};  // cut off: erfc is not linear between its bounds
  EXPECT_LE(off(SizeDraw(spec, 1e-3).draw(n, random),
                [](double x) {
                  const auto part = [](double y) {
                    return std::erfc(-(y - 10.0) / 3.0 / std::numbers::sqrt2);
                  };
                  return (part(x) - part(8.0)) / (part(11.0) - part(8.0));
                }),
            1.0 / n + 1e-12);
  spec.form = UniformSizes{2.0, 6.0};
  EXPECT_LE(off(SizeDraw(spec, 1.0).draw(n, random), [](double x) { return (x - 2.0) / 4.0; }),
            1.0 / n + 1e-12);
}

TEST(FibreLengths, OfATableGoByNumberOrByLength) {
  Random random(1);
  SizeSpec spec;
  spec.form = SizeTable{{10, 2}, {1, 3}, ShareOf::number};
  std::vector<double> sizes = SizeDraw(spec, 1.0).draw(400, random);
  EXPECT_EQ(std::count(sizes.begin(), sizes.end(), 10.0), 100);
  std::get<SizeTable>(spec.form).by = ShareOf::size;  // numbers as 1/10 to 3/2
  sizes = SizeDraw(spec, 1.0).draw(400, random);
  EXPECT_EQ(std::count(sizes.begin(), sizes.end(), 10.0), 25);
  EXPECT_FALSE(std::is_sorted(sizes.begin(), sizes.end())) << "the order is by chance";
}

TEST(FibreLengths, BelowTheSpacingAreNotDrawn) {
  const Built b =
      build(fibres("fibres = 60\nlengths = { normal = { mean = 3, deviation = 2 } }\ndiameter = 0.1\n"
                   "spacing = 1\nbox = { min = [0, 0, 0], max = [20, 20, 20] }\nmass = 1\n"));
  for (const auto& p : chains_of(b).points) EXPECT_GE(contour(p), 1.0);
  EXPECT_TRUE(
      contains(refusal("fibres = 6\nlengths = { normal = { mean = 3, deviation = 0.1, max = 0.5 } }\n"
                       "diameter = 0.1\nspacing = 1\nbox = { min = [0, 0, 0], max = [9, 9, 9] }\nmass = 1"),
               "nothing is left of its lengths"));
}

// ---- fibres -------------------------------------------------------------------------------------

TEST(Fibres, OfALayerDoNotCross) {
  const Built b = build(
      fibres("fibres = 1000\nlength = 10\ndiameter = 0.2\nspacing = 0.5\ncurl = 0.95\ngap = 0.01\nmass = 1\n"
             "orientation = \"tensor\"\norientation_tensor = [0.49, 0.49, 0.02, 0, 0, 0]\n"
             "layer = { min = [0, 0, 0], max = [60, 60, 3] }\n"));
  const auto chains = chains_of(b);
  ASSERT_EQ(chains.points.size(), 1000u);
  EXPECT_EQ(b.model.particles(), 1000u * 21u);
  EXPECT_EQ(b.state.bonds.size(), 1000u * 20u);
  EXPECT_EQ(b.model.find_group("ends")->particles.size(), 2000u);
  EXPECT_EQ(b.model.find_group("mat.first")->particles.size(), 1000u);
  const double least = least_distance(chains, 0.5);
  EXPECT_GE(least, 0.21 - 1e-12);
  double xx = 0.0, zz = 0.0, outside = 0.0;
  for (const auto& p : chains.points) {
    const Vec3d ends = p.back() - p.front();
    // an arc of equal segments: its length and its curl are those that were asked for, to rounding
    EXPECT_NEAR(contour(p), 10.0, 1e-9);
    EXPECT_NEAR(norm(ends) / 10.0, 0.95, 1e-9);
    xx += sq(ends.x) / norm2(ends) / 1000, zz += sq(ends.z) / norm2(ends) / 1000;
    for (const Vec3d& r : p) {
      EXPECT_GE(r.z, 0.1 - 1e-12);
      EXPECT_LE(r.z, 2.9 + 1e-12);
      outside += r.x < 0.0 || r.x > 60.0;
    }
  }
  // steep ones do not fit, and some were turned as they were pushed apart
  EXPECT_NEAR(xx, 0.49, 0.01);
  EXPECT_GT(zz, 0.005);
  EXPECT_LT(zz, 0.02);
  EXPECT_GT(outside, 100) << "sideways they stick out";
  const auto told = [&](const std::string& what) {
    return std::any_of(b.notes.begin(), b.notes.end(),
                       [&](const std::string& n) { return contains(n, what); });
  };
  char text[80];
  std::snprintf(text, sizeof text, "orientation of ends xx %.4f", xx);
  EXPECT_TRUE(told(text)) << text;
  std::snprintf(text, sizeof text, "surfaces are %.6g apart at least, 0.01 asked for", least - 0.2);
  EXPECT_TRUE(told(text)) << text;
  EXPECT_TRUE(told("1000 fibres of 21000 particles, volume share 0.0290888, length 10 to 10"));
  ASSERT_EQ(b.figures.size(), 1u);
  EXPECT_EQ(b.figures[0].specimen, "mat");
  EXPECT_EQ(b.figures[0].figures[0], (std::pair<std::string, std::vector<double>>{"fibres", {1000.0}}));
}

TEST(Fibres, ThatAllFindAFreePlaceHaveTheTensorThatWasAskedFor) {
  const Built b = build(fibres("fibres = 100\norientation = \"planar\"\n" + layer));
  double xx = 0.0, zz = 0.0;
  for (const auto& p : chains_of(b).points) {
    const Vec3d e = normalised(p.back() - p.front());
    xx += e.x * e.x / 100, zz += e.z * e.z / 100;
  }
  EXPECT_NEAR(xx, 0.5, 1e-12);
  EXPECT_LT(zz, 1e-25);
}

TEST(Fibres, AreTheSameEveryTimeAndOthersWithAnotherSeed) {
  const std::string keys = "fibres = 50\n" + layer;
  const Built a = build(fibres(keys + "orientation = \"planar\"\n")),
              b = build(fibres(keys + "orientation = \"planar\"\n")),
              other = build(fibres(keys + "orientation = \"planar\"\nseed = 2\n"));
  EXPECT_EQ(a.model.r_0.values(), b.model.r_0.values());
  EXPECT_NE(a.model.r_0.values(), other.model.r_0.values());
}

const std::string cell = "[cell]\na = [12, 0, 0]\nb = [0, 12, 0]\nc = [3, 0, 12]\ncorner = [-5, 0, 1]\n";
const std::string felt =
    "lengths = { lognormal = { median = 5, deviation = 0.4, max = 25 } }\ndiameter = 0.3\nspacing = 0.6\n"
    "gap = 0.02\ncurvature = 0.1\norientation = \"tensor\"\norientation_tensor = [0.6, 0.3, 0.1, 0.05, 0, "
    "0]\n"
    "mass = 1\n";

TEST(Fibres, OfACellGoThroughItsFacesAndDoNotCross) {
  const Built b = build(fibres("volume_share = 0.05\n" + felt, cell));
  const auto chains = chains_of(b);
  ASSERT_GT(chains.points.size(), 100u);
  double length = 0.0;
  for (const auto& p : chains.points) {
    length += contour(p);
    const double n = double(p.size() - 1), turn = 0.1 * contour(p) / n;  // of each joint
    EXPECT_NEAR(norm(p.back() - p.front()), contour(p) / n * std::sin(0.5 * n * turn) / std::sin(0.5 * turn),
                1e-9);
  }
  const double V = 12.0 * 12.0 * 12.0,
               each = 0.25 * std::numbers::pi * 0.09 * length / double(chains.points.size());
  EXPECT_NEAR(each * double(chains.points.size()) / V, 0.05, 0.02 * 0.05);
  EXPECT_GE(least_distance(chains, 0.5), 0.32 - 1e-12);
  EXPECT_GT(std::count_if(b.state.bonds.begin(), b.state.bonds.end(),
                          [](const Bond& k) { return !image_of_j(k).is_itself(); }),
            50);
  for (const Vec3d& r : b.model.r_0) {  // of the corner: parts of the edges
    EXPECT_GE(r.z, 1.0);
    EXPECT_LT(r.z, 13.0);
    EXPECT_GE(r.y, 0.0);
    EXPECT_LT(r.y, 12.0);
  }
}

// By chance alone this is not reached; what is pushed apart keeps its shape.
TEST(Fibres, ThatFindNoFreePlaceArePushedApart) {
  const std::string planar =
      "volume_share = 0.08\nlength = 4\ndiameter = 0.2\nspacing = 0.5\ncurl = 0.9\norientation = "
      "\"planar\"\n"
      "layer = { min = [0, 0, 0], max = [10, 10, 3] }\nmass = 1\n";
  const Built b = build(fibres(planar));
  EXPECT_TRUE(std::any_of(b.notes.begin(), b.notes.end(), [](const std::string& n) {
    return contains(n, "more were added and all pushed apart");
  }));
  const auto chains = chains_of(b);
  EXPECT_GE(least_distance(chains, 0.5), 0.2 - 1e-12);
  for (const auto& p : chains.points) {
    EXPECT_NEAR(norm(p.back() - p.front()), 0.9 * 4.0, 1e-9);
    EXPECT_NEAR(contour(p), 4.0, 1e-9);
    EXPECT_NEAR(p.back().z, p.front().z, 1e-12) << "planar ones turn in their plane only";
    Vec3d middle;
    for (const Vec3d& r : p) middle = middle + r / double(p.size());
    EXPECT_GE(std::min(middle.x, middle.y), -1e-9);
    EXPECT_LE(std::max(middle.x, middle.y), 10 + 1e-9);
  }
}

TEST(Fibres, InABoxAreWhollyInIt) {
  const Built b =
      build(fibres("fibres = 80\nlength = 5\ndiameter = 0.4\nspacing = 1\nmass = 1\n"
                   "box = { min = [-3, 0, 2], max = [3, 7, 10] }\n"));
  for (const Vec3d& r : b.model.r_0)
    for (const auto& [x, low, high] : {std::tuple{r.x, -3.0, 3.0}, {r.y, 0.0, 7.0}, {r.z, 2.0, 10.0}}) {
      EXPECT_GE(x, low + 0.2 - 1e-12);
      EXPECT_LE(x, high - 0.2 + 1e-12);
    }
  EXPECT_GE(least_distance(chains_of(b), 1.0), 0.4 - 1e-12);
}

TEST(Fibres, WeighAsTheirCylinders) {
  const Built b =
      build(fibres("fibres = 20\nlength = 6\ndiameter = 0.4\nspacing = 1\ndensity = 3\n"
                   "box = { min = [0, 0, 0], max = [20, 20, 20] }\n"));
  double mass = 0.0;
  for (const double m : b.model.mass) mass += m;
  const double one = 3 * std::numbers::pi * 0.04;  // of a length of 1
  EXPECT_NEAR(mass, 20 * 6 * one, 1e-12 * mass);
  EXPECT_DOUBLE_EQ(b.model.mass[ParticleId{0}], 0.5 * one);
  EXPECT_DOUBLE_EQ(b.model.mass[ParticleId{1}], one);
  EXPECT_DOUBLE_EQ(b.model.inertia[ParticleId{1}], one * (0.04 / 4 + 1.0 / 12));
  EXPECT_EQ(b.model.radius[ParticleId{5}], 0.2);
}

TEST(FibreGroups, AreNamedByNumbersAlsoOfCopies) {
  const std::string keys =
      "fibres = 5\nlength = 3\ndiameter = 0.2\nspacing = 1\nmass = 1\n"
      "box = { min = [0, 0, 0], max = [9, 9, 9] }\narray = [{ count = 2, step = [20, 0, 0] }]\n";
  const Built b = build(
      fibres(keys, "", "[groups.two]\nfibres = [1, 8]\n[groups.free]\nintersection = [\"two\", \"ends\"]\n"));
  const auto numbers = [&](const char* name) {
    std::vector<std::size_t> n;
    for (const ParticleId p : b.model.find_group(name)->particles) n.push_back(p.value);
    return n;
  };
  EXPECT_EQ(numbers("two"), (std::vector<std::size_t>{4, 5, 6, 7, 32, 33, 34, 35}));
  EXPECT_EQ(numbers("free"), (std::vector<std::size_t>{4, 7, 32, 35}));
  EXPECT_TRUE(contains(refusal(keys, "", "[groups.none]\nfibres = [10]\n"), "there is no fibre 10"));
  EXPECT_TRUE(contains(refusal(keys, "", "[groups.none]\nfibres = [10]\n"), "numbered 0 to 9"));
}

// ---- what is refused ----------------------------------------------------------------------------

TEST(Fibres, ThatDoNotFitAreRefusedWithWhatDoes) {
  const std::string keys =
      "length = 4\ndiameter = 0.5\nspacing = 1\norientation = \"planar\"\nmass = 1\n"
      "layer = { min = [0, 0, 0], max = [8, 8, 1.2] }\n";
  const std::string text = refusal("fibres = 90\n" + keys);
  ASSERT_TRUE(contains(text, "case.toml:4:1: specimen \"mat\": 90 fibres were not brought apart")) << text;
  const std::size_t at = text.find("use fibres = ");
  ASSERT_NE(at, std::string::npos) << text;
  const int possible = std::stoi(text.substr(at + 13));
  EXPECT_GT(possible, 10);
  EXPECT_LT(possible, 90);
  const Built b = build(fibres("fibres = " + std::to_string(possible) + "\n" + keys));
  EXPECT_GE(least_distance(chains_of(b), 1.0), 0.5 - 1e-12);
}

TEST(Fibres, NeedAVesselThatHoldsThem) {
  const std::string keys = "fibres = 3\nlength = 5\ndiameter = 0.2\nspacing = 1\nmass = 1\n";
  EXPECT_TRUE(contains(refusal(keys), "there is no place for the fibres"));
  EXPECT_TRUE(
      contains(refusal(keys + "box = { min = [0, 0, 0], max = [2, 2, 2] }\n"), "does not fit in between"));
  const std::string small = "[cell]\na = [3, 0, 0]\nb = [0, 3, 0]\nc = [0, 0, 3]\n";
  EXPECT_TRUE(
      contains(refusal(keys + "orientation = \"tensor\"\norientation_tensor = [1, 0, 0, 0, 0, 0]\n", small),
               "meets its own image"));
  EXPECT_TRUE(contains(refusal(keys + "turn = { angle = 0.1 }\n", small), "turned or copied"));
  EXPECT_TRUE(contains(refusal(keys + "layer = { min = [0, 0, 0], max = [2, 2, 2] }\n", small),
                       "a layer in a case with a cell"));
  EXPECT_TRUE(contains(refusal(keys + "box = { min = [0, 0, 0], max = [2, 2, 4] }\n", small),
                       "reaches beyond the cell"));
  EXPECT_TRUE(contains(refusal("fibres = 1\nlength = 6\ndiameter = 0.2\nspacing = 2\nmass = 1\n", small),
                       "must be shorter than half of that"));
  EXPECT_TRUE(contains(refusal("volume_share = 1e-6\nlength = 5\ndiameter = 0.2\nspacing = 1\nmass = 1\n"
                               "box = { min = [0, 0, 0], max = [20, 20, 20] }\n"),
                       "is no fibre"));
}

TEST(Fibres, MayNotMeetThemselves) {
  const std::string keys =
      "fibres = 3\nlength = 9\ndiameter = 0.2\nmass = 1\nbox = { min = [0, 0, 0], max = [30, 30, 30] }\n";
  EXPECT_TRUE(contains(refusal(keys + "spacing = 0.5\ncurvature = 0.7\n"), "meets itself"));
  EXPECT_TRUE(contains(refusal(keys + "spacing = 9\ncurl = 0.9\n"), "has one bond and is straight"));
}

TEST(FibreKeys, MistakesAreToldAllAtOnceWithTheirLines) {
  try {
    fibres(
        "fibres = 3\nvolume_share = 0.1\nlength = 0.5\ndiameter = 2\nspacing = 1\ncurl = 0.9\n"
        "curvature = 0.1\norientation = \"tensor\"\norientation_tensor = [0.5, 0.3, 0.1, 0, 0, 0]\nradius = "
        "1\n");
    FAIL() << "was accepted";
  } catch (const CaseError& e) {
    std::vector<std::uint32_t> lines;
    for (const Problem& p : e.problems()) lines.push_back(p.place.line);
    EXPECT_EQ(lines, (std::vector<std::uint32_t>{3, 5, 8, 10, 12, 13})) << e.what();
  }
}

}  // namespace
}  // namespace vbond::fibres_test
