#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/model/bond_law.hpp"
#include "vbond/physics/pose.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// One bond: its constants, and whether it is broken. What it remembers, if anything, is in State.
struct Bond {
  ParticleId i, j;
  const BondLaw* law = &bond_law<VModel>;  ///< never null
  double a = 0, R_i = 0, R_j = 0;          ///< length at rest, attachment distances  [length]
  Coefficients coefficients{};             ///< of the law, in the order of its fields, in their units
  Quatd frame_i, frame_j;                  ///< the bond's frame in the body frames of i and j, see BondFrames
  std::uint32_t set = 0;                   ///< which bond set of the case made it
  bool broken = false;                     ///< keeps its id, and does nothing any more

  friend bool operator==(const Bond&, const Bond&) = default;
};

/// Where a bond of this shape stands in the range of its law; a broken one has none to leave.
inline BondRange bond_range(const Bond& b, const BondShape& s) {
  return b.broken ? BondRange::good : b.law->range(b, s);
}

/// The sum of the coefficients that are energies, without signs: the energy of a bond near rest is a
/// difference of terms of this size.  [energy]
inline double angular_scale(const Bond& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < b.law->fields.size(); ++k)
    if (b.law->fields[k].dimension == force_times_length) sum += std::abs(b.coefficients[k]);
  return sum;
}

/// The pose of a bond, its axes turned into the world frame.
inline BondPose<double> bond_pose(const Bond& b, const Vec3d& r_i, const Quatd& q_i, const Vec3d& r_j,
                                  const Quatd& q_j) {
  return bond_pose(BondFrames<double>{b.frame_i, b.frame_j}, r_i, q_i, r_j, q_j);
}

/// All coefficients of the law as given, in the order of its fields.
struct GivenCoefficients {
  Coefficients values{};
};

enum class BondTheory : std::uint8_t { bernoulli_euler, timoshenko, short_cylinder };

/// Elastic constants and section; kappa is used by Timoshenko only.
struct TheoryParameters {
  BondTheory theory = BondTheory::bernoulli_euler;
  Material material{};
  Section section{};
  double kappa = 0;  ///< shear coefficient, > 0
};

/// Where a bond is fastened: at the centres, at the surfaces, or at given distances from the centres.
enum class Attachment : std::uint8_t { centres, surfaces, given };

/// How to make a bond between any two particles: everything but the particles.
struct BondRecipe {
  const BondLaw* law = &bond_law<VModel>;  ///< never null
  std::variant<GivenCoefficients, BondStiffness<double>, TheoryParameters> parameters;
  Coefficients given{};  ///< besides stiffnesses or theory: coefficients that do not follow from them
  Attachment attachment = Attachment::centres;
  double R_i = 0, R_j = 0;  ///< only with Attachment::given  [length]
  /// If set, coefficients are worked out once at this length and are the same for all bonds of the set
  /// (the paper's shell); if not, at each bond's own length.  [length]
  std::optional<double> reference_length;
  /// n_2 is this direction made normal to the bond. Without it, or if it is within 1e-6 rad of the
  /// bond: the coordinate axis least aligned with the bond, the first of equals.
  std::optional<Vec3d> n_2;
  std::uint32_t set = 0;
};

}  // namespace vbond
