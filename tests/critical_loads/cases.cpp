#include "cases.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "drawing.hpp"

namespace vbond::campaign {
namespace {

struct Share {
  double weight;
  BodyPlan (*draw)(Dice&);
};
constexpr Share shares[] = {
    {0.15, column},     {0.20, arch},    {0.09, shallow_arch}, {0.06, portal},
    {0.05, lees_frame}, {0.09, ring},    {0.04, helix},        {0.06, bent_cantilever},
    {0.06, ribbon},     {0.10, lattice}, {0.05, dome},         {0.03, plane_truss},
    {0.02, star}};

BodyPlan draw_body(Dice& dice) {
  double left = dice(0.0, 1.0);
  for (const Share& s : shares) {
    if (left < s.weight) return s.draw(dice);
    left -= s.weight;
  }
  return star(dice);
}

double largest_extent(const BodyPlan& plan) {
  double most = 0.0;
  for (const Vec3d& r : plan.r) most = std::max(most, norm(r - plan.r[0]));
  return most;
}

/// Moves all particles at random, by a part of the body's size that may be as small as rounding. Those of a
/// plane body stay in the plane.
void make_imperfect(Dice& dice, BodyPlan& plan) {
  const double size = largest_extent(plan), amplitude = size * dice.ratio(1e-12, 1e-3);
  plan.offset.clear();
  for (std::size_t k = 0; k < plan.r.size(); ++k) {
    const double x = dice(-1, 1), y = dice(-1, 1), z = plan.in_plane ? 0.0 : dice(-1, 1);
    plan.offset.push_back(amplitude * Vec3d{x, y, z});
  }
  const auto& c = plan.sets[0].stiffness;
  const double thickness = std::sqrt(c.c_B / c.c_A);
  plan.imperfection = amplitude / thickness;
  plan.closed_form.reset();
  plan.what += fmt::format(", imperfect by {:.2g} of its size, {:.2g} of its thickness", amplitude / size,
                           plan.imperfection);
}

void place_in_space(Dice& dice, BodyPlan& plan) {
  if (plan.turning != Turning::by_right_angles && dice.chance(0.4)) {
    const bool about_z = plan.turning == Turning::about_z;
    const double a = dice(-2, 2), b = dice(-2, 2), c = dice(-2, 2);
    turn(plan, rotation_of(about_z ? Vec3d{0, 0, c} : Vec3d{a, b, c}));
    plan.what += ", askew";
  }
  const int times = dice.chance(0.4) ? dice.whole(1, 2) : 0;
  for (int k = 0; k < times; ++k) permute_axes(plan);
}

}  // namespace

RandomCase random_case(unsigned seed, int number) {
  Dice dice(seed * 1000003u + static_cast<unsigned>(number));
  RandomCase c;
  c.number = number;
  c.plan = draw_body(dice);
  if (dice.chance(0.25) && !c.plan.must_be_straight) make_imperfect(dice, c.plan);
  place_in_space(dice, c.plan);
  if (dice.chance(0.2)) {
    const double length = std::pow(10.0, dice.whole(-9, 9)), force = std::pow(10.0, dice.whole(-9, 9));
    change_units(c.plan, length, force);
    c.plan.what += fmt::format(", lengths {:.0e}, forces {:.0e}", length, force);
  }
  c.count = dice.whole(1, 6);
  c.first_step = dice.ratio(1e-4, 1.0);
  c.largest_step = dice.chance(0.3) ? largest_extent(c.plan) * dice.ratio(1e-2, 1.0) : 0.0;
  return c;
}

}  // namespace vbond::campaign
