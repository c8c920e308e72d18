#pragma once
#include <array>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/holds.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// How a particle moves: a translation, and a small turn times the length scale.
struct Movement {
  Vec3d shift, turn;  ///< [length]
};

/// Numbers the degrees of freedom that supports leave free. Every unknown is a length: a translation along,
/// or a small turn about, an axis of the particle, times the length scale of the body. The axes are those of
/// the world, but of particles that are held along or about slanted ones. So all components of the unbalanced
/// load are forces and all of the tangent are force/length. The free ones of a particle follow each other.
class Unknowns {
 public:
  static constexpr int held = -1;

  /// length > 0: turns are multiplied by it.
  Unknowns(std::size_t particles, const std::vector<StaticSupport>& supports, double length);

  int size() const { return static_cast<int>(place_.size()); }
  /// The unknown of degree of freedom 0..5 (along its axes, turns about its axes) of a particle, or `held`.
  int of(ParticleId p, int dof) const { return number_[p][static_cast<std::size_t>(dof)]; }
  struct Place {
    ParticleId particle;
    int dof;
  };
  /// Of a particle; nullptr: those of the world.
  const HeldAxes* axes(ParticleId p) const { return axes_.get(p); }
  const Vec3d& axis(ParticleId p, int dof) const { return axis_of(axes(p), static_cast<std::size_t>(dof)); }
  /// The component of a movement, or of a force and a moment over the length scale, along a degree of
  /// freedom.
  double along(ParticleId p, int dof, const Movement& m) const {
    const Vec3d& v = dof < 3 ? m.shift : m.turn;
    const HeldAxes* slanted = axes(p);
    return slanted == nullptr ? component(v, dof % 3) : dot(v, slanted->of(static_cast<std::size_t>(dof)));
  }
  void add(ParticleId p, int dof, double x, Movement& to) const {
    Vec3d& v = dof < 3 ? to.shift : to.turn;
    if (const HeldAxes* slanted = axes(p))
      v += x * slanted->of(static_cast<std::size_t>(dof));
    else
      component(v, dof % 3) += x;
  }
  /// What these unknowns move a particle by.
  Movement movement(ParticleId p, const Vector& x) const {
    Movement m;
    for (int dof = 0; dof < 6; ++dof)
      if (const int k = of(p, dof); k != held) add(p, dof, x[k], m);
    return m;
  }
  /// Adds a force and a moment over the length scale on a particle to the components of unknowns.
  void add_load(ParticleId p, const Movement& load, Vector& to) const {
    for (int dof = 0; dof < 6; ++dof)
      if (const int k = of(p, dof); k != held) to[k] += along(p, dof, load);
  }
  Place place(int unknown) const { return place_[static_cast<std::size_t>(unknown)]; }
  bool is_turn(int unknown) const { return place(unknown).dof >= 3; }
  double length() const { return length_; }
  /// E.g. "rotation about x of particle 5".
  std::string name(int unknown) const;
  /// The unknowns of which x has the largest components, at most three, in words.
  std::string names_of_largest(const Vector& x) const;
  /// x as movements of the particles, scaled as Shape says.
  Shape shape(const Vector& x) const;

 private:
  ParticleAxes axes_;
  PerParticle<std::array<int, 6>> number_;
  std::vector<Place> place_;
  double length_;
};

}  // namespace vbond
