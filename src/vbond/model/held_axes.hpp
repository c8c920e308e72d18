#pragma once
#include <array>
#include <optional>
#include <vector>

#include "vbond/core/vec3.hpp"

namespace vbond {

/// Degrees of freedom of a particle: translations along three axes, then rotations about three. The axes are
/// x, y, z of the world unless a support has others (HeldAxes).
using HeldDofs = std::array<bool, 6>;

/// All of them.
inline constexpr HeldDofs all_held{true, true, true, true, true, true};

/// Three perpendicular unit vectors, right-handed.
using Triad = std::array<Vec3d, 3>;
inline constexpr Triad world_axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

/// The axes of degrees of freedom where they are not those of the world.
struct HeldAxes {
  Triad along = world_axes;  ///< of translations
  Triad about = world_axes;  ///< of rotations
  /// Of degree of freedom 0 to 5.
  const Vec3d& of(std::size_t dof) const { return dof < 3 ? along[dof] : about[dof - 3]; }
  friend bool operator==(const HeldAxes&, const HeldAxes&) = default;
};

/// The axes of degrees of freedom: `axes`, or those of the world where it is nullptr.
inline const Vec3d& axis_of(const HeldAxes* axes, std::size_t dof) {
  return axes != nullptr ? axes->of(dof) : world_axes[dof % 3];
}

/// Which degrees of freedom are held, and along and about which axes.
struct HeldDirections {
  HeldDofs held{};
  std::optional<HeldAxes> axes = {};  ///< absent: those of the world
};

/// What is held by these axes of the world, and besides along and about these directions. Directions may be
/// of any length but 0, and at any angle to each other: what they span is held. Directions that span nothing
/// new (within 1e-9) change nothing; three that span space are the axes of the world.
HeldDirections held_directions(const HeldDofs& named, const std::vector<Vec3d>& along,
                               const std::vector<Vec3d>& about);

/// The part of a translation or rotation that is along, or about, held axes.
Vec3d held_part(const HeldDirections& d, const Vec3d& v, bool is_rotation);

/// Triad in which each of some directions, which are held by different supports, is one axis; nothing if two
/// of them are neither parallel nor perpendicular (within 1e-9). Triad of the world if all directions are
/// such.
std::optional<Triad> common_axes(const std::vector<Vec3d>& held);

/// Whether they are perpendicular unit vectors and right-handed, within 1e-9.
bool are_right_handed(const Triad& axes);

/// Whether two unit vectors are parallel, either way, within 1e-9.
bool are_parallel(const Vec3d& a, const Vec3d& b);

}  // namespace vbond
