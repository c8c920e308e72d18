#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {

enum class BondLaw : std::uint8_t { v_model, evm };

/// One elastic bond. It has no history: these constants and the particles' state say everything.
struct Bond {
  ParticleId i, j;
  BondLaw law = BondLaw::v_model;
  double a = 0, R_i = 0, R_j = 0;         ///< length at rest, attachment distances  [length]
  double B1 = 0, B2 = 0, B3 = 0, B4 = 0;  ///< [force/length], then [force*length]
  Quatd frame_i, frame_j;                 ///< the bond's frame in the body frames of i and j, see BondFrames
  std::uint32_t set = 0;                  ///< which bond set of the case made it

  friend bool operator==(const Bond&, const Bond&) = default;
};

/// Calls f with the bond's law as VModel<double> or Evm<double>: the one place that branches on it.
template <class F>
decltype(auto) visit_law(const Bond& b, F&& f) {
  switch (b.law) {
    case BondLaw::v_model: break;
    case BondLaw::evm: return f(Evm<double>{b.a, b.R_i, b.R_j, b.B1, b.B2, b.B3, b.B4});
  }
  return f(VModel<double>{b.a, b.R_i, b.R_j, b.B1, b.B2, b.B3, b.B4});
}

/// Where a bond of this shape stands in the range of its law.
inline BondRange bond_range(const Bond& b, const BondShape& s) {
  return visit_law(b, [&s](const auto& law) { return bond_range(law, s); });
}

/// The pose of a bond, its axes turned into the world frame.
inline BondPose<double> bond_pose(const Bond& b, const Vec3d& r_i, const Quatd& q_i, const Vec3d& r_j,
                                  const Quatd& q_j) {
  return bond_pose(BondFrames<double>{b.frame_i, b.frame_j}, r_i, q_i, r_j, q_j);
}

/// Four coefficients B1..B4 as given.
struct GivenCoefficients {
  double B1, B2, B3, B4;
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
  BondLaw law = BondLaw::v_model;
  std::variant<GivenCoefficients, BondStiffness<double>, TheoryParameters> parameters;
  Attachment attachment = Attachment::centres;
  double R_i = 0, R_j = 0;  ///< only with Attachment::given  [length]
  /// If set, B1..B4 are worked out once at this length and are the same for all bonds of the set
  /// (the paper's shell); if not, at each bond's own length.  [length]
  std::optional<double> reference_length;
  /// n_2 is this direction made normal to the bond. Without it, or if it is within 1e-6 rad of the
  /// bond: the coordinate axis least aligned with the bond, the first of equals.
  std::optional<Vec3d> n_2;
  std::uint32_t set = 0;
};

}  // namespace vbond
