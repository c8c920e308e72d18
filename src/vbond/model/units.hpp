#pragma once
#include "vbond/model/model.hpp"

namespace vbond {

/// In SI, and in reduced units, where a = m = c_A = 1. Empty: a pure number, a count or a number of
/// something.
struct Unit {
  const char* si;
  const char* reduced;
  const char* in(UnitSystem system) const { return system == UnitSystem::si ? si : reduced; }
};

namespace unit {
inline constexpr Unit none{"", ""};
inline constexpr Unit length{"m", "a"}, time{"s", "sqrt(m/c_A)"}, mass{"kg", "m"}, inertia{"kg m^2", "m a^2"};
inline constexpr Unit velocity{"m/s", "a sqrt(c_A/m)"}, angular_velocity{"rad/s", "rad sqrt(c_A/m)"};
inline constexpr Unit force{"N", "a c_A"}, moment{"N m", "a^2 c_A"}, energy{"J", "a^2 c_A"};
inline constexpr Unit momentum{"kg m/s", "a sqrt(m c_A)"};
inline constexpr Unit angular_momentum{"kg m^2/s", "a^2 sqrt(m c_A)"};
inline constexpr Unit stiffness{"N/m", "c_A"}, stress{"Pa", "c_A/a"};
inline constexpr Unit area{"m^2", "a^2"};
inline constexpr Unit volume{"m^3", "a^3"}, density{"kg/m^3", "m/a^3"};
inline constexpr Unit angle{"rad", "rad"}, degrees{"deg", "deg"};
}  // namespace unit

}  // namespace vbond
