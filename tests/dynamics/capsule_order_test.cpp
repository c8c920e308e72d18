// What capsules do does not depend on how particles are numbered.
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "rods.hpp"

namespace vbond {
namespace {

using testing::Specimen;

/// A bar of two particles falls, turning, across a fibre of four, beside one of its particles, with damping
/// and friction; particle k of the body has the number order[k].
Specimen bar_on_a_fibre(const std::vector<std::size_t>& order) {
  const std::vector<Vec3d> places{{-1.5, 0, 0}, {-0.5, 0, 0},        {0.5, 0, 0},
                                  {1.5, 0, 0},  {-0.46, -0.5, 0.45}, {-0.44, 0.45, 0.44}};
  std::vector<Vec3d> r(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) r[order[k]] = places[k];
  Specimen s = testing::particles_at(r, 0.2);
  BondRecipe recipe = testing::papers_bond();
  recipe.capsule = true, recipe.capsule_radius = 0.2;
  for (const std::size_t k : {0u, 1u, 2u, 4u}) testing::bond(s, order[k], order[k + 1], recipe);
  ContactModel& c =
      s.model.contact = {.law = ContactLaw::hertz, .pairs = ContactPairs::unbonded, .E = 20, .nu = 0.3};
  c.tangential = TangentialForm::mindlin, c.surface = {.friction = 0.4, .restitution = 0.4};
  for (const std::size_t k : {4u, 5u}) s.state.v[ParticleId{order[k]}] = {0.15, 0.05, -0.2};
  return s;
}

TEST(CapsulesInAnyOrder, DampAndRubAlike) {
  const auto end_of = [](const std::vector<std::size_t>& order) {
    const Specimen s = bar_on_a_fibre(order);
    Simulation run(s.model, testing::plain_stage(2e-3, 6.0), s.state);
    run.run();
    EXPECT_LT(std::abs(run.balance_error()), 1e-3);
    std::vector<Vec3d> r;
    for (const std::size_t k : order) r.push_back(run.state().r[ParticleId{k}]);
    return std::pair(r, run.books().dissipated);
  };
  std::vector<std::size_t> order(6);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto [r, lost] = end_of(order);
  EXPECT_GT(lost, 1e-3);
  testing::Dice dice(7);
  for (int n = 0; n < 40; ++n) {
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[static_cast<std::size_t>(dice(0.0, static_cast<double>(k)))]);
    const auto [r_n, lost_n] = end_of(order);
    EXPECT_NEAR(lost_n, lost, 1e-6 * lost);
    for (std::size_t k = 0; k < r.size(); ++k) EXPECT_LT(norm(r_n[k] - r[k]), 1e-7) << n << " " << k;
  }
}

}  // namespace
}  // namespace vbond
