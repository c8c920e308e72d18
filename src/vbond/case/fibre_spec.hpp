#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "vbond/case/size_spec.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/vec3.hpp"

/// Chopped fibres as the user asks for them; see case.hpp.
namespace vbond {

/// How the lines from the first to the last particle of fibres are distributed over the directions.
enum class FibreOrientation : std::uint8_t {
  isotropic,
  planar,  ///< all normal to one axis, and in this plane evenly
  tensor   ///< angular central Gaussian, with this mean of p p
};

struct FibreBox {
  Vec3d min, max;  ///< [length]
};

struct FibresSpecimen {
  std::optional<std::int64_t> fibres;  ///< exactly one of these two
  std::optional<double> volume_share;  ///< of pi/4 diameter^2 length in the vessel
  SourcePlace amount;                  ///< where that is said
  std::optional<double> length;        ///< of all, along the fibre; exactly one of these two  [length]
  std::optional<SizeSpec> lengths;     ///< along the fibre
  double diameter = 0;                 ///< [length]
  double spacing = 0;               ///< of particles, as nearly as a whole number of bonds allows  [length]
  double gap = 0;                   ///< between surfaces of fibres, at least  [length]
  std::optional<double> curl;       ///< distance of the ends over the length; at most one of these two
  std::optional<double> curvature;  ///< [1/length]
  FibreOrientation orientation = FibreOrientation::isotropic;
  Vec3d normal{0, 0, 1};           ///< planar: any length but zero
  std::array<double, 6> tensor{};  ///< xx, yy, zz, xy, xz, yz; their trace is 1
  std::optional<FibreBox> box;     ///< fibres are in it as a whole
  std::optional<FibreBox> layer;   ///< the same along z; sideways their middles are in it
  std::uint64_t seed = 1;
};  ///< without box and layer: in the cell of the case

}  // namespace vbond
