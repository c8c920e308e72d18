#include "vbond/statics/calibrate_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/cell_constants.hpp"

namespace vbond {
namespace {

constexpr double accuracy = 1e-11;  // of nu

Constants sum(const Constants& a, const Constants& b) {
  Constants C = a;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) C[i][j] += b[i][j];
  return C;
}

/// How C goes with the logarithm of the shear factor alone.
Constants by_shear(const Homogenised& h, BendingFollows bending) {
  const BondStiffness<double> with = multipliers({0.0, 1.0}, bending);
  Constants C{};
  for (const ConstantsBySet& set : h.derivatives) {
    C = sum(C, set.c_D);
    if (with.c_B > 0.0) C = sum(C, set.c_B);
    if (with.c_T > 0.0) C = sum(C, set.c_T);
  }
  return C;
}

/// nu as a function of x = ln(shear / normal) with the normal factor 1.
struct Point {
  double x, nu, slope;
  Homogenised found;
};

void require(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument("calibrate: " + rule);
}

}  // namespace

BondStiffness<double> multipliers(const StiffnessFactors& factors, BendingFollows bending) {
  const auto& [normal, shear] = factors;
  return {normal, shear, bending == BendingFollows::shear ? shear : normal,
          bending == BendingFollows::normal ? normal : shear};
}

State with_factors(State state, const StiffnessFactors& factors, BendingFollows bending) {
  const BondStiffness<double> m = multipliers(factors, bending);
  for (Bond& b : state.bonds) {
    const BondStiffness<double> c = b.law->stiffness(b);
    b.coefficients = b.law->from_stiffness({m.c_A * c.c_A, m.c_D * c.c_D, m.c_B * c.c_B, m.c_T * c.c_T}, b.a,
                                           b.coefficients);
  }
  return state;
}

CalibratedCell calibrate_cell(const Model& model, const State& state, const ElasticTarget& target,
                              BendingFollows bending, const NewtonSettings& newton) {
  constexpr double least_ratio = 1e-6, largest_ratio = 1e4, longest_step = 2.5;
  constexpr int most = 60;
  require(target.E > 0.0 && std::isfinite(target.E), fmt::format("E = {:g}: it must be > 0", target.E));
  require(target.nu > -1.0 && target.nu < 0.5,
          fmt::format("nu = {:g}: that of an elastic material is between -1 and 0.5", target.nu));
  double c_A = 0.0, c_D = 0.0;
  for (const Bond& b : state.bonds)
    if (!b.broken) c_A += b.law->stiffness(b).c_A, c_D += b.law->stiffness(b).c_D;
  require(c_A > 0.0 && c_D > 0.0, "bonds need c_A and c_D > 0: factors are looked for");

  CellConstants cell(model, state, {newton, true});
  int iterations = 0;
  const auto at = [&](double x) {
    Point p{x, 0, 0, cell.found_with(with_factors(cell.state(), {1.0, std::exp(x)}, bending))};
    ++iterations;
    const ElasticConstants C(p.found.C);
    p.nu = C.hill().nu();
    p.slope = C.hill_change(by_shear(p.found, bending)).nu;
    return p;
  };
  const auto factors_at = [&](const Point& p) {
    const double normal = target.E / ElasticConstants(p.found.C).hill().E();
    return StiffnessFactors{normal, normal * std::exp(p.x)};
  };

  double low = std::log(least_ratio), high = std::log(largest_ratio);
  bool known_low = false, known_high = false;  // that nu is too large, or too small, there
  Point now = at(0.0);
  while (std::abs(now.nu - target.nu) > accuracy) {
    if (iterations >= most) break;  // judged below
    // nu falls as shear grows, so that it is too large left of the answer
    const bool above = now.nu > target.nu;
    (above ? low : high) = now.x;
    (above ? known_low : known_high) = true;
    double next = now.x + std::clamp((target.nu - now.nu) / now.slope, -longest_step, longest_step);
    if (!(next > low && next < high)) {
      const double end = above ? high : low;
      next = (above ? known_high : known_low) ? 0.5 * (low + high) : end;
      if (now.x == end)
        throw OutOfReach(
            fmt::format(
                "calibrate: nu = {:g} cannot be had with these bonds: it is {:.6g} at the end of what is "
                "tried, where shear over normal stiffness is {:g} of what the case has",
                target.nu, now.nu, std::exp(now.x)),
            now.nu, factors_at(now));
    }
    if (next == now.x) break;  // no nearer: judged below
    now = at(next);
  }
  CalibratedCell found{factors_at(now), {}, iterations};
  found.found = cell.found_with(with_factors(cell.state(), found.factors, bending));
  const IsotropicConstants is = ElasticConstants(found.found.C).hill();
  if (!(std::abs(is.nu() - target.nu) < 1e-10 && std::abs(is.E() / target.E - 1.0) < 1e-10))
    throw NoEquilibrium("calibrate",
                        fmt::format("E = {:.12g} and nu = {:.12g} come nearest, after {} bodies", is.E(),
                                    is.nu(), found.iterations),
                        "rounding leaves no more where the body is nearly a mechanism: another nu, or more "
                        "neighbours");
  return found;
}

}  // namespace vbond
