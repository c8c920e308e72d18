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

/// How all particles move in a wave: the real and the imaginary part.
struct WaveShape {
  Shape in_phase, out_of_phase;
};

/// Numbers the degrees of freedom that supports leave free. Every unknown is a length: a translation along,
/// or a small turn about, an axis of the particle, times the length scale of the body. The axes are those of
/// the world, but of particles that are held along or about slanted ones. So all components of the unbalanced
/// load are forces and all of the tangent are force/length. The free ones of a particle follow each other.
///
/// The particles of a rigid support that is free in part move as one body: with the degrees of freedom of its
/// pivot, which have the numbers of its first particle.
///
/// Components of the deformation gradient of a periodic cell that give way to a stress come last, times a
/// length of the cell's own, as if they were the degrees of freedom of one more particle, the cell's node.
///
/// Turns that nothing drives or resists are no unknowns: the particle stays as it is.
class Unknowns {
 public:
  static constexpr int held = -1;

  /// Which of the cell's components (model/cell_drive.hpp) are unknown, and the length they count by.
  struct Cell {
    std::array<bool, 6> free{};
    double length = 1.0;
    bool any() const { return free != std::array<bool, 6>{}; }
  };

  struct Place {
    ParticleId particle;
    int dof;
  };
  /// length > 0: turns are multiplied by it. idle: turns that nothing drives or resists, held or not, by
  /// particles, then by dof; of no rigid support that is free in part.
  Unknowns(std::size_t particles, const std::vector<Support>& supports, double length, const Cell& cell,
           const std::vector<Place>& idle = {});
  Unknowns(std::size_t particles, const std::vector<Support>& supports, double length)
      : Unknowns(particles, supports, length, {{}, 1.0}) {}

  int size() const { return static_cast<int>(place_.size()); }
  /// The unknown of degree of freedom 0..5 (along its axes, turns about its axes) of a particle, or `held`.
  int of(ParticleId p, int dof) const { return number_[p][static_cast<std::size_t>(dof)]; }
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
  /// The particle that has the numbers of the degrees of freedom that move this one: itself, or the first of
  /// its rigid support.
  ParticleId carrier(ParticleId p) const { return carried_.empty() ? p : carried_[p].by; }
  /// From the pivot to a particle of a rigid support that is free in part; else nullptr.  [length]
  const Vec3d* arm(ParticleId p) const {
    return carried_.empty() || !carried_[p].has_arm ? nullptr : &carried_[p].arm;
  }
  /// Where it points has changed.
  void set_arm(ParticleId p, const Vec3d& arm) { carried_[p].arm = arm; }
  /// What these unknowns move a particle by.
  Movement movement(ParticleId p, const Vector& x) const {
    const Vec3d* d = arm(p);
    if (d == nullptr) return along_own(p, x);
    Movement m = along_own(carrier(p), x);
    m.shift += cross(m.turn, *d) / length_;
    return m;
  }
  /// Movements, or forces, along the degrees of freedom that have the numbers of this particle.
  Movement along_own(ParticleId p, const Vector& x) const {
    Movement m;
    for (int dof = 0; dof < 6; ++dof)
      if (const int k = of(p, dof); k != held) add(p, dof, x[k], m);
    return m;
  }
  /// Adds a force and a moment over the length scale on a particle to the components of unknowns.
  void add_load(ParticleId p, Movement load, Vector& to) const {
    if (const Vec3d* d = arm(p)) {
      load.turn += cross(*d, load.shift) / length_;
      p = carrier(p);
    }
    for (int dof = 0; dof < 6; ++dof)
      if (const int k = of(p, dof); k != held) to[k] += along(p, dof, load);
  }
  Place place(int unknown) const { return place_[static_cast<std::size_t>(unknown)]; }
  bool is_turn(int unknown) const { return place(unknown).dof >= 3 && !is_of_cell(unknown); }
  double length() const { return length_; }

  /// Turns that supports leave free and that nothing drives or resists: motions that meet no stiffness.
  const std::vector<Place>& free_turns() const { return free_turns_; }
  bool is_free_turn(ParticleId p, int dof) const;
  /// Of which particles they are: "particle 5", "particles 5, 7, 9 and 12 more".
  std::string names_of_free_turns() const;

  /// Particles, and the cell's node if there is one.
  std::size_t nodes() const { return number_.size(); }
  ParticleId cell_node() const { return ParticleId{particles_}; }
  bool has_cell() const { return nodes() > particles_; }
  bool is_of_cell(int unknown) const { return place(unknown).particle == cell_node(); }
  /// The unknown of a component of the cell, or `held`.
  int of_cell(std::size_t component) const { return has_cell() ? number_[cell_node()][component] : held; }
  double cell_length() const { return cell_length_; }
  /// E.g. "rotation about x of particle 5".
  std::string name(int unknown) const;
  /// The unknowns of which x has the largest components, at most three, in words.
  std::string names_of_largest(const Vector& x) const;
  /// x as movements of the particles, scaled as Shape says.
  Shape shape(const Vector& x) const { return shape(x, Vector::Zero(x.size())).in_phase; }
  /// The same of a complex motion, whose two parts are scaled together.
  WaveShape shape(const Vector& real, const Vector& imaginary) const;

 private:
  struct Carried {
    ParticleId by;
    bool has_arm = false;
    Vec3d arm;
  };
  void carry(const Support& grip);

  ParticleAxes axes_;
  PerParticle<std::array<int, 6>> number_;
  std::vector<Place> place_;
  PerParticle<Carried> carried_;   // empty where no rigid support is free in part
  std::vector<Place> free_turns_;  // by particles, then by dof
  std::size_t particles_;
  double length_, cell_length_;
};

}  // namespace vbond
