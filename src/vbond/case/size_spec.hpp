#pragma once
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

/// How lengths are distributed, of whatever is made in numbers; see case.hpp.
namespace vbond {

struct UniformSizes {
  double min = 0, max = 0;  ///< [length]
};
/// Cut off at min and max, where these are given: none is beyond, and the others keep their ratios.
struct NormalSizes {
  double mean = 0, deviation = 0;  ///< of the distribution that is not cut off  [length]
  std::optional<double> min, max;  ///< [length]
};
struct LognormalSizes {
  double median = 0;               ///< [length]
  double deviation = 0;            ///< of the natural logarithm
  std::optional<double> min, max;  ///< [length]
};
enum class ShareOf : std::uint8_t { number, size };
struct SizeTable {
  std::vector<double> values;  ///< [length]
  std::vector<double> shares;  ///< of each value, in any unit
  ShareOf by = ShareOf::number;
};

struct SizeSpec {
  std::variant<UniformSizes, NormalSizes, LognormalSizes, SizeTable> form;
};

}  // namespace vbond
