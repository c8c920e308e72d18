#pragma once
#include <optional>
#include <vector>

namespace vbond::labtest {

/// Principal stresses at the peak of a triaxial test, pressure positive: s1 along the axis, s3 all round.
/// [force/length^2]
struct PeakStresses {
  double s3 = 0, s1 = 0;
};

/// s1 = 2 c sqrt(N) + N s3 with N = (1 + sin phi)/(1 - sin phi), by least squares of s1.
struct MohrCoulomb {
  double slope = 0;     ///< N
  double ucs = 0;       ///< s1 without pressure, by the line  [force/length^2]
  double phi = 0;       ///< [rad]
  double cohesion = 0;  ///< c  [force/length^2]
  double r2 = 0;        ///< part of the variance of s1 that the line explains
};
/// Absent with fewer than two pressures, or if the line does not rise or has no positive s1 at s3 = 0.
std::optional<MohrCoulomb> mohr_coulomb(const std::vector<PeakStresses>& peaks);

/// Of intact rock: (s1 - s3)^2 = m_i s_ci s3 + s_ci^2, by least squares of the left side (Hoek and Brown
/// 1980).
struct HoekBrown {
  double m_i = 0;
  double s_ci = 0;  ///< uniaxial compressive strength  [force/length^2]
  double r2 = 0;    ///< part of the variance of (s1 - s3)^2 that it explains
};
/// Absent with fewer than two pressures, or if s_ci^2 or m_i would not be positive.
std::optional<HoekBrown> hoek_brown(const std::vector<PeakStresses>& peaks);

}  // namespace vbond::labtest
