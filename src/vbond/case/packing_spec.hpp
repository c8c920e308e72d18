#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vbond/case/placed.hpp"
#include "vbond/case/region_spec.hpp"

/// A specimen of packed grains, as the user wrote it; what its numbers mean: packing/pack.hpp.
namespace vbond {

/// The vessel is what all of its tables leave.
struct VesselSpec {
  SourcePlace place;
  Region region;
  CutSpec::Keep keep = CutSpec::Keep::inside;  ///< where grains are
};

struct EqualGrains {
  double radius = 0;
};
struct UniformGrains {
  std::array<double, 2> radii{};  ///< least, largest
};
/// Cut off at the two ends; absent: three standard deviations from the middle.
struct NormalGrains {
  double mean = 0, deviation = 0;
  std::optional<double> from, to;
};
struct LognormalGrains {
  double median = 0, deviation = 0;  ///< the standard deviation of ln R
  std::optional<double> from, to;
};
struct CurveGrains {
  std::vector<double> radii, passing;  ///< passing: from 0 to 1
  bool by_mass = true;
};

struct GrainSpec {
  SourcePlace place;
  std::string name = "grain";  ///< becomes a part
  double share = 1;
  std::variant<EqualGrains, UniformGrains, NormalGrains, LognormalGrains, CurveGrains> sizes;
  std::optional<double> density;  ///< else that of the specimen
};

enum class GrainShares : std::uint8_t { volume, mass, number };
enum class FloatingGrains : std::uint8_t { keep, remove, grow };

struct PackingSpecimen {
  std::vector<GrainSpec> grains;   ///< one at least
  std::vector<VesselSpec> vessel;  ///< none: the cell of the case
  GrainShares share_by = GrainShares::volume;
  std::optional<double> porosity;         ///< one of porosity, particles and jammed; or the last two
  std::optional<std::int64_t> particles;  ///< > 0
  bool jammed = false;
  /// At most, of the smaller radius. None: 1e-3, and grains that are jammed just touch.
  std::optional<double> overlap;
  FloatingGrains floaters = FloatingGrains::keep;
  std::int64_t neighbours = 3;  ///< fewer: a floater
  double gap = 1.05;            ///< within which, a factor of the sum of radii
  std::uint64_t seed = 1;
};

}  // namespace vbond
