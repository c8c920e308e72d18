#pragma once
#include <array>

#include "vbond/core/vec3.hpp"

/// What an elastic material does whose constants are known: algebra alone, of no body.
namespace vbond {

/// C or its inverse S, 6 x 6 in Voigt's order xx yy zz yz xz xy, with engineering shear (2 eps_yz).
using Constants = std::array<std::array<double, 6>, 6>;

/// A material that is alike in all directions.
struct IsotropicConstants {
  double K = 0;  ///< bulk modulus  [force/length^2]
  double G = 0;  ///< shear modulus  [force/length^2]
  double E() const { return 9.0 * K * G / (3.0 * K + G); }
  double nu() const { return (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G)); }
};

/// A modulus and the direction it belongs to, of length 1.
struct Directed {
  double value = 0;
  Vec3d along;
};

/// The least and the largest of a quantity over some directions.
struct Extremes {
  Directed least, largest;
};

/// Speeds of plane waves along a direction, with the directions in which particles then move.  [length/time]
using WaveSpeeds = std::array<Directed, 3>;

class ElasticConstants {
 public:
  /// Throws std::invalid_argument unless C is symmetric to 1e-6 of its largest entry and positive definite;
  /// its symmetric part is taken.
  explicit ElasticConstants(const Constants& C);

  const Constants& stiffness() const { return C_; }   ///< [force/length^2]
  const Constants& compliance() const { return S_; }  ///< [length^2/force]

  /// Of a body of many such grains, turned at random: with the same strain in all of them (Voigt), which is
  /// also the isotropic material nearest to C (least squares over the 81 components); with the same stress
  /// (Reuss); and the mean of the two (Hill).
  IsotropicConstants voigt() const;
  IsotropicConstants reuss() const;
  IsotropicConstants hill() const;
  /// What E and nu of hill() change by if C changes by this, to the first order.
  struct Change {
    double E, nu;
  };
  Change hill_change(const Constants& C) const;
  /// 5 G_V/G_R + K_V/K_R - 6: 0 of an isotropic material (Ranganathan & Ostoja-Starzewski, PRL 101 (2008)
  /// 055504).
  double anisotropy() const;

  /// Directions need not be of length 1. std::invalid_argument for one that is 0, and two that are the same.
  double youngs_modulus(const Vec3d& along) const;
  /// By what part of the stretch along the one the body thins along the other, which is made normal to it.
  double poissons_ratio(const Vec3d& along, const Vec3d& across) const;
  double shear_modulus(const Vec3d& a, const Vec3d& b) const;  ///< in their plane; b is made normal to a
  /// The least and the largest shear_modulus(along, m) and poissons_ratio(along, m) over all m across; the
  /// directions are such m. Exact: n being held, 1/G and nu are quadratic in m, and so over the angle t of m
  /// about n they are a + b cos 2t + c sin 2t.  [force/length^2], [1]
  Extremes shear_moduli(const Vec3d& along) const;
  Extremes poissons_ratios(const Vec3d& along) const;
  /// The least and the largest of all directions: of 10,000, and then downhill (1e-8 of the value).
  Directed least_youngs_modulus() const { return extreme(false); }
  Directed largest_youngs_modulus() const { return extreme(true); }
  /// In increasing order, in a body of this density (> 0).
  WaveSpeeds wave_speeds(const Vec3d& along, double density) const;

 private:
  Directed extreme(bool largest) const;

  Constants C_, S_;
};

}  // namespace vbond
