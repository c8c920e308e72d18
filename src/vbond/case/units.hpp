#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace vbond::keys {

/// Powers of length, mass and time, with the words for it in messages and in the key reference.
struct Dimension {
  int length = 0, mass = 0, time = 0;
  const char* name = "";     ///< e.g. "force/length"
  const char* example = "";  ///< a number with a unit, e.g. "5 N/m"
  friend constexpr bool operator==(const Dimension& a, const Dimension& b) {
    return a.length == b.length && a.mass == b.mass && a.time == b.time;
  }
};

inline constexpr Dimension pure{0, 0, 0, "number", "1"};
inline constexpr Dimension angle{0, 0, 0, "angle", "10 deg"};
inline constexpr Dimension length{1, 0, 0, "length", "0.5 mm"};
inline constexpr Dimension area{2, 0, 0, "area", "2 mm^2"};
inline constexpr Dimension area_moment{4, 0, 0, "length^4", "3 mm^4"};
inline constexpr Dimension mass{0, 1, 0, "mass", "2 g"};
inline constexpr Dimension density{-3, 1, 0, "mass/length^3", "7800 kg/m^3"};
inline constexpr Dimension inertia{2, 1, 0, "mass*length^2", "1e-9 kg*m^2"};
inline constexpr Dimension duration{0, 0, 1, "time", "20 us"};
inline constexpr Dimension velocity{1, 0, -1, "length/time", "10 mm/s"};
inline constexpr Dimension angular_velocity{0, 0, -1, "angle/time", "10 deg/s"};
inline constexpr Dimension acceleration{1, 0, -2, "length/time^2", "9.81 m/s^2"};
inline constexpr Dimension force{1, 1, -2, "force", "5 N"};
inline constexpr Dimension moment{2, 1, -2, "force*length", "1e-3 N*m"};
inline constexpr Dimension energy{2, 1, -2, "energy", "1e-6 J"};
inline constexpr Dimension stress{-1, 1, -2, "force/length^2", "2 GPa"};
inline constexpr Dimension stiffness{0, 1, -2, "force/length", "5 N/m"};
inline constexpr Dimension damping{0, 1, -1, "force*time/length", "0.1 N*s/m"};
inline constexpr Dimension rotary_damping{2, 1, -1, "force*length*time", "1e-6 N*m*s"};

/// A number with its unit, in SI base units (m, kg, s, rad); a multiple of T_0 is left as such.
struct Quantity {
  double value = 0;
  Dimension dimension;
  bool in_T_0 = false;
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
