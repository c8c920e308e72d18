#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "material_cases.hpp"
#include "statics/walks.hpp"
#include "validation/cases.hpp"
#include "vbond/physics/laws.hpp"

/// Bodies that break at rest.
namespace vbond::testing {

inline constexpr double unbreakable = 1e30;

/// A bond of these stiffnesses that breaks by its tension alone.
inline BondRecipe breakable(const BondStiffness<double>& c, double tension) {
  BondRecipe recipe;
  recipe.law = &bond_law<WithRules<VModel>::Law>;
  recipe.parameters = c;
  recipe.rules.strength = linear_strength(tension, unbreakable, unbreakable, unbreakable);
  return recipe;
}

/// Two particles one apart, joined by bonds of stiffness 1 with these strengths: a bundle between grips that
/// do not turn.
inline Specimen bundle(const std::vector<double>& strengths) {
  Specimen s = particles_at({{0, 0, 0}, {1, 0, 0}}, 0.1);
  for (const double tension : strengths) bond(s, 0, 1, breakable({1.0, 0.1, 0.01, 0.01}, tension));
  return s;
}

inline Support clamp(std::size_t particle) {
  return fixed({ParticleId{particle}}, clamped);
}

/// The second particle of a bundle pulled by a force along x, which is all that it is free to do.
inline StaticStage pulled_bundle(double force) {
  return static_stage(StageKind::fracture,
                      {clamp(0), fixed({ParticleId{1}}, {false, true, true, true, true, true})},
                      {pushed(1, {force, 0, 0})});
}
/// The same drawn out; free to twist.
inline StaticStage drawn_bundle(double displacement) {
  return static_stage(
      StageKind::fracture,
      {clamp(0), fixed({ParticleId{1}}, {true, true, true, false, true, true}, {displacement, 0, 0})});
}

inline const FractureResult& fracture(const Walked& w) {
  return w.result.fracture;
}
inline std::vector<std::size_t> broken_bonds(const FractureResult& f) {
  std::vector<std::size_t> all;
  for (const BrokenBond& b : f.breaks) all.push_back(b.use.bond.value);
  return all;
}

/// The books close, and those of each break with those of the next.
inline void expect_books_close(const FractureResult& f) {
  EXPECT_LT(std::abs(f.books.error()), 1e-9);
  double released = 0.0;
  for (const BrokenBond& b : f.breaks) {
    released += b.released;
    EXPECT_NEAR(f.books.initial + b.work, b.stored + released, 1e-9 * f.books.largest);
  }
  EXPECT_NEAR(released, f.books.released, 1e-12 * f.books.largest);
}

}  // namespace vbond::testing
