#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "vbond/model/time_function.hpp"

/// What a stage does to the cell. F is the deformation gradient of the cell against the one of the model,
/// whose edges it turns into those of now. Its six components, xx, yy, zz, yz, xz, xy, are its symmetric
/// ones, or if the cell says so those of the upper triangle; the others are 0, so that the cell cannot turn.
namespace vbond {

inline constexpr std::array<const char*, 6> cell_component_names{"xx", "yy", "zz", "yz", "xz", "xy"};
/// Row and column of a component.
inline constexpr std::array<std::array<int, 2>, 6> cell_component_axes{
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

/// What moves one component.
struct CellComponent {
  enum class By : std::uint8_t {
    held,    ///< it stays as the stage finds it
    strain,  ///< it goes with the progress of the stage
    stress,  ///< it gives way until the stress of the body is this
  };
  By by = By::held;
  /// strain: of this component of F per progress [1/time], at rest the change of it until load factor 1;
  /// stress: Cauchy's, tension > 0  [force/length^2], at rest at load factor 1.
  double value = 0;
  TimeFunction factor = {};
};

/// Components that are held by a stress go at the rate (stress asked for - stress of now)/(modulus time), and
/// no faster than `fastest`: stable if modulus time > dt C/2, where C is the modulus of the body while its
/// particles follow the cell.
struct CellServo {
  double modulus = 0;  ///< [force/length^2]
  double time = 0;     ///< [time]
  double fastest = 0;  ///< [1/time]
};

struct CellDrive {
  std::array<CellComponent, 6> component{};
  CellServo servo{};  ///< in motion, where a stress is asked for

  bool any() const {
    for (const CellComponent& c : component)
      if (c.by != CellComponent::By::held) return true;
    return false;
  }
  bool any_stress() const {
    for (const CellComponent& c : component)
      if (c.by == CellComponent::By::stress) return true;
    return false;
  }
};

}  // namespace vbond
