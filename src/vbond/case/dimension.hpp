#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace vbond::keys {

/// Powers of length, mass, time and angle, with the words for it in messages and in the key reference. Angles
/// are told apart although a radian is 1: a frequency is no angular velocity, an angle no Poisson's ratio.
struct Dimension {
  int length = 0, mass = 0, time = 0, angle = 0;
  const char* name = "";     ///< e.g. "force/length"
  const char* example = "";  ///< a number with a unit, e.g. "5 N/m"
  bool per_angle = false;    ///< may also be given per radian
  friend constexpr bool operator==(const Dimension& a, const Dimension& b) {
    return a.length == b.length && a.mass == b.mass && a.time == b.time && a.angle == b.angle;
  }
};

inline constexpr Dimension pure{0, 0, 0, 0, "number", "1"};
inline constexpr Dimension angle{0, 0, 0, 1, "angle", "10 deg"};
inline constexpr Dimension length{1, 0, 0, 0, "length", "0.5 mm"};
inline constexpr Dimension wave_number{-1, 0, 0, 0, "1/length", "200 m^-1"};
inline constexpr Dimension area{2, 0, 0, 0, "area", "2 mm^2"};
inline constexpr Dimension volume{3, 0, 0, 0, "length^3", "1 mm^3"};
inline constexpr Dimension area_moment{4, 0, 0, 0, "length^4", "3 mm^4"};
inline constexpr Dimension mass{0, 1, 0, 0, "mass", "2 g"};
inline constexpr Dimension density{-3, 1, 0, 0, "mass/length^3", "7800 kg/m^3"};
inline constexpr Dimension inertia{2, 1, 0, 0, "mass*length^2", "1e-9 kg*m^2"};
inline constexpr Dimension duration{0, 0, 1, 0, "time", "20 us"};
inline constexpr Dimension velocity{1, 0, -1, 0, "length/time", "10 mm/s"};
inline constexpr Dimension angular_velocity{0, 0, -1, 1, "angle/time", "10 deg/s"};
inline constexpr Dimension frequency{0, 0, -1, 0, "frequency", "10 Hz"};
inline constexpr Dimension acceleration{1, 0, -2, 0, "length/time^2", "9.81 m/s^2"};
inline constexpr Dimension force{1, 1, -2, 0, "force", "5 N"};
inline constexpr Dimension moment{2, 1, -2, 0, "force*length", "1e-3 N*m"};
inline constexpr Dimension turning_stiffness{2, 1, -2, 0, "force*length", "1e-3 N*m/rad", true};
inline constexpr Dimension energy{2, 1, -2, 0, "energy", "1e-6 J"};
inline constexpr Dimension stress{-1, 1, -2, 0, "force/length^2", "2 GPa"};
inline constexpr Dimension stiffness{0, 1, -2, 0, "force/length", "5 N/m"};
inline constexpr Dimension surface_energy{0, 1, -2, 0, "energy/length^2", "0.1 J/m^2"};
inline constexpr Dimension stiffness_per_area{-2, 1, -2, 0, "force/length^3", "5 N/m^3"};
inline constexpr Dimension damping{0, 1, -1, 0, "force*time/length", "0.1 N*s/m"};
inline constexpr Dimension rotary_damping{2, 1, -1, 0, "force*length*time", "1e-6 N*m*s", true};

/// True if a quantity of dimension `got` may stand where `wanted` is: also a moment per radian for a moment,
/// as bending and torsional stiffnesses are mostly given.
constexpr bool fits(const Dimension& got, const Dimension& wanted) {
  return got == wanted || (wanted.per_angle && got == Dimension{wanted.length, wanted.mass, wanted.time, -1});
}

/// A number with its unit, in SI base units (m, kg, s, rad); a multiple of T_0 is left as such.
struct Quantity {
  double value = 0;
  Dimension dimension;
  bool in_T_0 = false;
  bool has_unit = false;
};

/// Why a text is no quantity.
struct UnitMistake {
  std::string rule, way_out;
};

/// Reads "2 GPa", "1e-3 N*m", "7800 kg/m^3", "10 deg", "10 T0". A unit is a product and quotient, from left
/// to right, of names with an SI prefix and a whole power. Decimal prefixes are exact: "20 us" is the double
/// 2e-5.
std::variant<Quantity, UnitMistake> parse_quantity(std::string_view text);

/// The dimension in base units, such as `kg m^-1 s^-2`, with the name of the quantity if it has one.
std::string to_text(const Dimension& d);

}  // namespace vbond::keys
