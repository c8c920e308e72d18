#pragma once
#include <array>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/detail/matrix.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Numbers the degrees of freedom that supports leave free. Every unknown is a length: a translation, or a
/// small turn about an axis of the world times the length scale of the body. So all components of the
/// unbalanced load are forces and all of the tangent are force/length. The free ones of a particle follow
/// each other.
class Unknowns {
 public:
  static constexpr int held = -1;

  /// length > 0: turns are multiplied by it.
  Unknowns(std::size_t particles, const std::vector<StaticSupport>& supports, double length);

  int size() const { return static_cast<int>(place_.size()); }
  /// The unknown of degree of freedom 0..5 (x, y, z, turns about x, y, z) of a particle, or `held`.
  int of(ParticleId p, int dof) const { return number_[p][static_cast<std::size_t>(dof)]; }
  struct Place {
    ParticleId particle;
    int dof;
  };
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
  PerParticle<std::array<int, 6>> number_;
  std::vector<Place> place_;
  double length_;
};

}  // namespace vbond
