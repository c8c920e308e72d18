#pragma once
#include <array>

#include "vbond/core/quat.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/physics/top.hpp"

namespace vbond {

/// How the particles of a grip lie about its pivot, as it took hold: what it weighs, and what drag does to
/// it.
struct GripMass {
  double mass = 0;
  std::array<double, 6> inertia{};  ///< xx, yy, zz, xy, xz, yz about the pivot, world axes as it took hold
  std::array<double, 6> drag{};     ///< the same of rotation under drag  [force*length*time]
  double drag_translation = 0;      ///< [force*time/length]
  Vec3d drag_lever;                 ///< sum of drag of translation times arm  [force*time]

  /// A particle of this mass and inertia about its centre, with these coefficients of drag.
  void add(const Vec3d& arm, double m, double theta, double b_translation, double b_rotation);
};

struct GripRates {
  Vec3d v, omega;
};

/// What drag takes in half a step.  [energy]
struct GripDrag {
  double lost = 0;             ///< of the free motion
  double against_support = 0;  ///< of the motion that the support keeps up
};

/// The motion of a grip along, and about, what its support leaves free: a rigid body, as leap-frog moves it.
/// Translations are along axes of the world; turns are none, about one axis of the world, or all.
class FreeGrip {
 public:
  enum class Turns { held, about_axis, freely };

  /// half: of a step  [time]
  FreeGrip(const HeldDofs& held, const GripMass& mass, double half);
  FreeGrip() = default;

  Turns turns() const { return turns_; }
  double mass() const { return mass_; }
  /// Components of a vector along free translations, and about free turns.
  Vec3d free_part(const Vec3d& v) const;
  Vec3d free_turn(const Vec3d& v) const;

  /// Angular velocity of an angular momentum, as the grip has turned.
  Vec3d rate(const Quatd& turn, const Vec3d& spin) const;
  /// Angular momentum of free turns from that of the particles.
  Vec3d spin_of(const Vec3d& L) const { return free_turn(L); }
  /// Where it has turned to without torque in a time.
  Quatd turned(const Quatd& turn, const Vec3d& spin, double time) const;
  double energy(const Quatd& turn, const Vec3d& velocity, const Vec3d& spin) const;
  /// Drag over half a step, beside what the support prescribes. Where masses differ, its resultant does not
  /// pass through the centre of mass: a shift turns the grip, and a turn shifts it. That is solved exactly
  /// for the grip as it stands; without it shift and turn about an axis are solved exactly each by itself,
  /// free turns by the midpoint rule.
  GripDrag slow_down(const Quatd& turn, const GripRates& prescribed, Vec3d& velocity, Vec3d& spin) const;

 private:
  Vec3d axis() const;
  /// Force and moment of drag against these rates of the whole grip, without their sign.
  GripRates drag_of(const Quatd& turn, const GripRates& rates) const;
  GripDrag slow_down_coupled(const Quatd& turn, const GripRates& prescribed, Vec3d& velocity,
                             Vec3d& spin) const;

  std::array<bool, 3> free_{};
  Turns turns_ = Turns::held;
  HeldDofs held_{};
  double mass_ = 0, about_axis_ = 0, drag_ = 0, half_ = 0;
  Vec3d drag_lever_;  // in the grip's axes
  bool coupled_ = false;
  std::array<Vec3d, 3> drag_of_turns_{};  // rows of a matrix, in the grip's axes
  PrincipalInertia inertia_{};
  double decay_ = 1, decay_about_axis_ = 1;
  std::array<Vec3d, 3> decay_of_turns_{};  // rows of a matrix, in the grip's axes: omega after from before
};

}  // namespace vbond
