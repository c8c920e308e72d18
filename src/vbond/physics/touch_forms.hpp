#pragma once
#include <cstdint>

#include "vbond/core/scalar.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/physics/hertz.hpp"

// Two bodies that touch: the forms that their contact may have, its numbers, what they remember of it and
// what it does to them. The formulas: touch.hpp.
namespace vbond {

/// Normal force F of an overlap d >= 0.
enum class NormalForm : std::uint8_t {
  hertz,      ///< 4/3 E* sqrt(R*) d^(3/2)
  one_hertz,  ///< k d^(3/2), one k for all radii: the paper's form
  linear,     ///< k d
};
enum class AdhesionForm : std::uint8_t {
  none,
  jkr,  ///< Johnson, Kendall & Roberts 1971; the contact parts where no equilibrium is left: the least d
  dmt,  ///< Hertz less 2 pi w R*, as long as d > 0
};
enum class TangentialForm : std::uint8_t {
  none,
  mindlin,        ///< k_t = 8 G* a, a = sqrt(R* d); the force falls with a when the contact is relieved
  linear,         ///< one k_t
  mindlin_force,  ///< k_t = 8 G* a; the force stays when a changes: can make energy
  mindlin_displacement,  ///< k_t = 8 G* a times the slip: the force changes as a does: can make energy
};
/// Whether the stiffness across the contact is Mindlin's.
constexpr bool is_mindlin(TangentialForm form) {
  return form != TangentialForm::none && form != TangentialForm::linear;
}
/// Whether a closed path of a contact can give more energy than it took.
constexpr bool can_make_energy(TangentialForm form) {
  return form == TangentialForm::mindlin_force || form == TangentialForm::mindlin_displacement;
}

enum class RollingForm : std::uint8_t {
  none,
  constant,  ///< mu_r R_r F_n against the rolling; at rest as much as stops it within a step
  spring,    ///< k_r theta, at most mu_r R_r F_n (type C of Ai et al. 2011)
};

/// The forms that all contacts of a run share.
struct TouchForms {
  NormalForm normal = NormalForm::hertz;
  AdhesionForm adhesion = AdhesionForm::none;
  TangentialForm tangential = TangentialForm::none;
  RollingForm rolling = RollingForm::none;
  bool attraction = false;  ///< damping may pull bodies together that part; with adhesion it may anyway
  friend constexpr bool operator==(const TouchForms&, const TouchForms&) = default;
};

/// The numbers of two materials.
template <Scalar T>
struct TouchNumbers {
  T stiffness{};           ///< E* [force/area]; one_hertz k [force/length^(3/2)]; linear k [force/length]
  T tangential{};          ///< mindlin 8 G* [force/area]; linear k_t [force/length]
  T damping{};             ///< g of c_n = g sqrt(m* F/d), which a restitution asks for
  T viscous{};             ///< what is added to that c_n  [force*time/length]
  T tangential_damping{};  ///< c_t / c_n
  T friction{};            ///< mu
  T rolling{};             ///< mu_r
  T twisting{};            ///< mu_t, of the moment about the normal
  T rolling_stiffness{};   ///< k_r [force*length]; 0: k_t R_r^2
  T work{};                ///< work of adhesion w  [energy/area]
};

/// Two bodies that touch, i and j; a wall is j, of infinite mass. Vectors in the world frame.
template <Scalar T>
struct Touching {
  Vec3<T> n;         ///< unit normal, from i to j
  T overlap;         ///< d  [length]
  T R;               ///< R*: reduced_radius(); also R_r of rolling  [length]
  T m;               ///< m*: 1/m* = 1/m_i + 1/m_j  [mass]
  T Theta;           ///< of the moments of inertia, likewise  [mass*length^2]
  T l_i, l_j;        ///< distances of the contact from the centres  [length]
  Vec3<T> v;         ///< v_j - v_i of the centres, of a wall where it is touched  [length/time]
  Vec3<T> w_i, w_j;  ///< angular velocities  [rad/time]
};

/// What a contact takes of a body.
template <Scalar T>
struct TouchedBody {
  T R;          ///< radius where it is touched  [length]
  T per_m;      ///< 1/m
  T per_Theta;  ///< 1/Theta
};

/// Two round bodies of which the points r_ij from one another are nearest: the centres of spheres, or points
/// on the axes of capsules. The contact lies in the middle of the overlap.
template <Scalar T>
VBOND_HD Touching<T> round_bodies(const Vec3<T>& r_ij, const TouchedBody<T>& i, const TouchedBody<T>& j,
                                  const Vec3<T>& v, const Vec3<T>& w_i, const Vec3<T>& w_j) {
  const T one(1.0), half(0.5), distance = norm(r_ij), overlap = i.R + j.R - distance;
  return {r_ij / distance,
          overlap,
          reduced_radius(i.R, j.R),
          one / (i.per_m + j.per_m),
          one / (i.per_Theta + j.per_Theta),
          i.R - half * overlap,
          j.R - half * overlap,
          v,
          w_i,
          w_j};
}

/// What two bodies remember of their contact. All zero: they did not touch.
template <Scalar T>
struct TouchHistory {
  Vec3<T> F_t;  ///< elastic part of the tangential force on i  [force]
  T a{};        ///< radius of the contact, > 0 while they touch; without a form that needs it 1  [length]
  Vec3<T> F_d;  ///< the part of the force on i that damps  [force]
  T k_r{};      ///< stiffness of rolling  [force*length]
  Vec3<T> M_r;  ///< moment on i against rolling  [force*length]
  T M_t{};      ///< and against twisting, about n  [force*length]
};

/// Energy that a contact has dissipated, by cause.  [energy]
template <Scalar T>
struct TouchLosses {
  T damping{}, friction{}, rolling{}, adhesion{};

  VBOND_HD T sum() const { return friction + damping + adhesion + rolling; }
  VBOND_HD TouchLosses& operator+=(const TouchLosses& more) {
    damping = damping + more.damping, friction = friction + more.friction;
    rolling = rolling + more.rolling, adhesion = adhesion + more.adhesion;
    return *this;
  }
};

/// Loads: force on i (j feels -F) and the moment on i (on j -M) that comes on top of that of the force.
template <Scalar T>
struct TouchLoads {
  Vec3<T> F;
  Vec3<T> M;
  TouchHistory<T> history;
  TouchLosses<T> lost;  ///< during the step: not less than 0 but for its error
};

}  // namespace vbond
