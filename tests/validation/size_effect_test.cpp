// Notched plates of a triangular lattice torn at rest: the size effect of brittle and of softening bonds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "fracture_bodies.hpp"
#include "static_bodies.hpp"

namespace vbond {
namespace {

using testing::fixed;
using testing::fracture;
using testing::Specimen;
using testing::Walked;

/// A plate of width `spacing` times n and 1.3 times as high, with a notch from its left edge over a quarter
/// of its width, between two rows of particles half way up.
struct Plate {
  Specimen specimen;
  std::vector<ParticleId> bottom, top;
};
Plate notched_plate(int n, double spacing, const BondRecipe& recipe) {
  const double height = std::sqrt(0.75);
  const int half = 3 * n / 4;
  std::vector<Vec3d> r;
  Plate plate;
  for (int row = -half; row < half; ++row)
    for (int k = 0; k < n; ++k) {
      if (row == -half) plate.bottom.push_back(ParticleId{r.size()});
      if (row == half - 1) plate.top.push_back(ParticleId{r.size()});
      r.push_back(spacing * Vec3d{k + (row % 2 == 0 ? 0.0 : 0.5), (row + 0.5) * height, 0});
    }
  plate.specimen = testing::particles_at(r, 0.4 * spacing);
  const auto in_row = static_cast<std::size_t>(n);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(r.size(), i + in_row + 2); ++j) {
      if (norm(r[j] - r[i]) > 1.01 * spacing) continue;
      const bool notched = r[i].y * r[j].y < 0 && r[i].x + r[j].x < 0.5 * n * spacing;
      if (!notched) testing::bond(plate.specimen, i, j, recipe);
    }
  return plate;
}

/// Stiffnesses of bonds of this length in a plate of one material: c_A and c_D stay, c_B goes as the square.
BondRecipe plate_bond(double spacing) {
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.35, 0.03 * sq(spacing), 0.03 * sq(spacing)};
  recipe.n_2 = Vec3d{0, 0, 1};
  return recipe;
}

constexpr double stress = 1e-3;  // strength of a bond per spacing: strains stay of this size

BondRecipe brittle(double spacing) {
  BondRecipe recipe = plate_bond(spacing);
  const double none = testing::unbreakable;
  recipe.rules.strength = linear_strength(stress * spacing, none, none, none);
  return recipe;
}
/// opening: at which nothing is left, the same for every spacing: so is the energy of a crack's area.
BondRecipe soft(double spacing, double opening) {
  BondRecipe recipe = plate_bond(spacing);
  recipe.rules.softening = {stress * spacing, opening};
  return recipe;
}

StaticStage tearing(const Plate& p, double elongation, int steps, double drop) {
  StaticStage stage = testing::static_stage(
      StageKind::fracture, {fixed(p.top, {false, true, false, false, false, false}, {0, elongation, 0}),
                            fixed(p.bottom, {false, true, false, false, false, false}),
                            fixed({p.bottom.front()}, {true, true, false, false, false, false}),
                            fixed(testing::everybody(p.specimen), testing::in_plane)});
  stage.steps = steps;
  stage.fracture.load_drop = drop;
  return stage;
}

/// How the peak stress falls from one width to one twice as large, as a power of the width.
std::vector<double> powers(const BondRecipe& recipe, int steps, const std::vector<int>& widths) {
  std::vector<double> found;
  double before = 0.0;
  for (const int n : widths) {
    const Plate plate = notched_plate(n, 1.0, recipe);
    const Walked w = testing::walk(plate.specimen, tearing(plate, 4e-3 * n, steps, 0.05));
    const double peak = fracture(w).peak_load / n;
    if (before > 0.0) found.push_back(std::log2(peak / before));
    before = peak;
  }
  return found;
}

// Measured: -0.4336, -0.4701, -0.4865; -0.463 over the factor of 8. What is missing falls by half with each
// doubling, as it must where the stress near the tip is averaged over a fixed length.
TEST(SizeEffect, OfBrittleBondsGoesToTheSquareRoot) {
  const std::vector<double> p = powers(brittle(1.0), 1, {8, 16, 32, 64});
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[0], -0.434, 0.01);
  for (std::size_t k = 1; k < p.size(); ++k) {
    EXPECT_LT(p[k], p[k - 1]);
    EXPECT_LT(std::abs(p[k] + 0.5), 0.65 * std::abs(p[k - 1] + 0.5));
  }
  EXPECT_NEAR(p.back(), -0.5, 0.02);
}

// With bonds that soften down to five times their elongation at the peak stress the zone that softens is a
// part of the small plates: they carry more than brittle ones, and the power comes to -1/2 later. Measured:
// -0.3599, -0.4270, -0.4657; -0.4175 over the factor of 8. What is missing falls by half here, too.
TEST(SizeEffect, OfSofteningBondsComesLater) {
  const std::vector<double> p = powers(soft(1.0, 5e-3), 40, {8, 16, 32, 64});
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[0], -0.36, 0.01);
  for (std::size_t k = 1; k < p.size(); ++k) {
    EXPECT_LT(p[k], p[k - 1]);
    EXPECT_LT(std::abs(p[k] + 0.5), 0.65 * std::abs(p[k - 1] + 0.5));
  }
}

// ---- one softening plate, three spacings ----------------------------------------------------------------

/// A plate `width` wide and 5/3 sqrt(3/4) times as high, n spacings across, with a notch from its left edge
/// over a third of its width between the two middle rows. Rows have n + 1 particles and n in turn, so that 2
/// n bonds cross between any two of them, a third of which the notch cuts: n is an odd multiple of 3.
Plate even_plate(int n, double width, double opening) {
  const double spacing = width / n, height = std::sqrt(0.75);
  const int gaps = 5 * n / 3;
  std::vector<Vec3d> r;
  Plate plate;
  for (int row = 0; row <= gaps; ++row) {
    const bool shifted = row % 2 == 1;
    for (int k = 0; k < (shifted ? n : n + 1); ++k) {
      if (row == 0) plate.bottom.push_back(ParticleId{r.size()});
      if (row == gaps) plate.top.push_back(ParticleId{r.size()});
      r.push_back(spacing * Vec3d{k + (shifted ? 0.5 : 0.0), (row - 0.5 * gaps) * height, 0});
    }
  }
  plate.specimen = testing::particles_at(r, 0.4 * spacing);
  const auto in_row = static_cast<std::size_t>(n);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(r.size(), i + in_row + 3); ++j) {
      const bool notched = r[i].y * r[j].y < 0 && 0.5 * (r[i].x + r[j].x) < width / 3;
      if (norm(r[j] - r[i]) < 1.01 * spacing && !notched)
        testing::bond(plate.specimen, i, j, soft(spacing, opening));
    }
  return plate;
}

/// Load per width against elongation.
struct LoadCurve {
  std::vector<double> elongation, load;
  double at(double x) const {
    const auto after = std::upper_bound(elongation.begin(), elongation.end(), x) - elongation.begin();
    if (after == 0 || after == std::ssize(elongation)) return load.back();
    const auto k = static_cast<std::size_t>(after);
    const double part = (x - elongation[k - 1]) / (elongation[k] - elongation[k - 1]);
    return load[k - 1] + part * (load[k] - load[k - 1]);
  }
  double peak() const { return *std::max_element(load.begin(), load.end()); }
};

LoadCurve curve_of(int n, double width, double opening, double elongation) {
  const Plate plate = even_plate(n, width, opening);
  StaticStage stage = tearing(plate, elongation, 60, 0.9);
  LoadCurve curve;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    curve.elongation.push_back(p.load_factor * elongation);
    curve.load.push_back(p.reaction(plate.top).force.y / width);
  };
  run_static_stage(plate.specimen.model, stage, plate.specimen.state, hooks);
  return curve;
}

// Up to where the first of them snaps back, at 0.0236; measured: 0.0215 and 0.0121 of the peak, there; peaks
// differ by 1.0e-3 and 2e-4.
TEST(SizeEffect, OfASofteningPlateDoesNotComeFromItsSpacing) {
  constexpr double width = 12.0, opening = 0.02, elongation = 0.06;
  constexpr int looks = 300;
  std::vector<LoadCurve> curves;
  for (const int n : {9, 15, 21}) curves.push_back(curve_of(n, width, opening, elongation));
  for (std::size_t k = 0; k < 2; ++k) {
    const LoadCurve &coarse = curves[k], &fine = curves[2];
    const double last = std::min(coarse.elongation.back(), fine.elongation.back());
    EXPECT_GT(last, 0.023);  // past the peak, when a quarter of it is lost
    EXPECT_LT(fine.at(last), 0.75 * fine.peak());
    double largest = 0.0;
    for (int look = 1; look <= looks; ++look)
      largest = std::max(largest, std::abs(coarse.at(last * look / looks) - fine.at(last * look / looks)));
    EXPECT_LT(largest, 0.05 * fine.peak()) << k;
    EXPECT_NEAR(coarse.peak() / fine.peak(), 1.0, 2e-3) << k;
  }
}

}  // namespace
}  // namespace vbond
