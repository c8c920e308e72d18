#pragma once
#include <cstdint>

#include "vbond/physics/strength.hpp"

namespace vbond {

/// By what a bond broke: the largest share of the strength among what governed. other: its law does not say.
enum class BreakMode : std::uint8_t { none, tension, shear, bending, torsion, compression, other };

/// By what, and the stress that was its limit; 0 for criteria that compare no stress.  [force/area]
struct BreakCause {
  BreakMode mode = BreakMode::other;
  double limit = 0;
};

/// failure: of the bond as it broke; N: its axial force, its axial stress if the bonds have sections of their
/// own; factor: of its own strength.
inline BreakCause break_cause(const Strength& s, const Failure<double>& f, double N, double factor) {
  using enum BreakMode;
  const BreakMode pulled = f.bending > f.tension ? bending : tension;
  const BreakMode slid = f.torsion > f.shear ? torsion : shear;
  switch (s.criterion) {
    case Criterion::none: return {};
    case Criterion::elongation: return {tension, 0.0};
    case Criterion::mohr_coulomb:
      if (f.utilisation > f.tension + f.bending) return {slid, s.shear_limit * (factor - s.friction * N)};
      return {pulled, factor * s.tension_limit};
    case Criterion::stress:
    case Criterion::fibre: {
      const double pull = f.tension + f.bending, slide = f.shear + f.torsion;
      if (f.compression > pull && f.compression > slide) return {compression, factor * s.compression_limit};
      return pull >= slide ? BreakCause{pulled, factor * s.tension_limit}
                           : BreakCause{slid, factor * s.shear_limit};
    }
    case Criterion::linear:
    case Criterion::quadratic:
    case Criterion::energy: {
      const double pull = f.bending > f.tension ? f.bending : f.tension;
      const double slide = f.torsion > f.shear ? f.torsion : f.shear;
      return {pull >= slide ? pulled : slid, 0.0};
    }
  }
  return {};
}

}  // namespace vbond
