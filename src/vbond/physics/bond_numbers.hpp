#pragma once
#include <cstddef>

/// Where the numbers of a bond stand, whatever its law: its coefficients, and what it remembers.
namespace vbond {

/// The most coefficients that a law may have.
inline constexpr std::size_t most_coefficients = 13;
/// The first of a bond with offsets (with_offsets.hpp): o_i2, o_i3, o_j2, o_j3.
inline constexpr std::size_t offset_coefficients = 4;
/// The last of a bond with rules (with_rules.hpp), in this order.
enum class RuleCoefficient : unsigned char { g_A, g_D, g_B, g_T, weakness };
inline constexpr std::size_t rule_coefficients = 5;

/// The most that a bond may remember.
inline constexpr std::size_t most_history = 17;
/// What a bond that flows remembers: the history of a law WithFlow (with_flow.hpp).
namespace memory {
inline constexpr std::size_t stretch = 0, crept = 1;  // what the length at rest has grown by  [length]
inline constexpr std::size_t turn_i = 2, turn_j = 5;  // of the frames: rotation_by_quarter, in their own axes
inline constexpr std::size_t axial = 8, shear = 9, bending = 10, torsion = 11;  // sums of all amounts of flow
inline constexpr std::size_t bent = 12, twisted = 14;  // bending and twist that have flowed, with their signs
inline constexpr std::size_t damage = 15;              // 0 to 1
inline constexpr std::size_t dissipated = 16;          // [energy]
inline constexpr std::size_t count = 17;
}  // namespace memory

}  // namespace vbond
