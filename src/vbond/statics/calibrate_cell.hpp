#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

#include "vbond/statics/homogenise.hpp"

namespace vbond {

/// Which factor the stiffnesses of bending and torsion follow.
enum class BendingFollows : std::uint8_t {
  area,    ///< c_B that of c_A, c_T that of c_D: bonds with stiffnesses per area, k_n and k_s
  normal,  ///< both that of c_A
  shear,   ///< both that of c_D
};

/// Of Hill's average: the isotropic material that the body is on average over directions.
struct ElasticTarget {
  double E = 0;   ///< > 0  [force/length^2]
  double nu = 0;  ///< > -1, < 0.5
};

/// By what the stiffnesses of all bonds are to be multiplied.
struct StiffnessFactors {
  double normal = 1;  ///< c_A
  double shear = 1;   ///< c_D
};

struct CalibratedCell {
  StiffnessFactors factors;
  Homogenised found;   ///< of the body with these factors, made to check them
  int iterations = 0;  ///< bodies that were homogenised to find them
};

/// Poisson's ratio cannot be had, whatever the ratio of shear to normal stiffness.
class OutOfReach : public std::runtime_error {
 public:
  OutOfReach(const std::string& what, double nearest_nu, const StiffnessFactors& factors)
      : std::runtime_error(what), nu(nearest_nu), nearest(factors) {}
  double nu;                 ///< the nearest that there is
  StiffnessFactors nearest;  ///< with E as asked for
};

/// What each of the four stiffnesses is multiplied by.
BondStiffness<double> multipliers(const StiffnessFactors& factors, BendingFollows bending);

/// The same bonds with their stiffnesses multiplied.
State with_factors(State state, const StiffnessFactors& factors, BendingFollows bending);

/// The factors with which a periodic body, whose bonds are at rest, has these constants, to 1e-10. Newton's
/// method on the logarithm of shear over normal stiffness, by the exact derivative of nu, kept between ratios
/// that are known to be too small and too large; E follows, as it goes with all stiffnesses alike. Ratios
/// from 1e-6 to 1e4 of that of the body as given are looked at: beyond, OutOfReach. Throws what homogenise()
/// with derivatives throws, NoEquilibrium also if rounding does not let it come that near, and
/// std::invalid_argument for a target that no material has, and where all c_A or all c_D are 0.
CalibratedCell calibrate_cell(const Model& model, const State& state, const ElasticTarget& target,
                              BendingFollows bending, const NewtonSettings& newton = {});

}  // namespace vbond
