#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// The numbers of the report page as one binary block: quantised, differences from frame to frame, byte by
/// byte. web/FORMAT.md has the other side.
namespace vbond::page {

/// Where an array lies in the block and how its numbers are got back: value = low + step * q for u8 and u16.
struct PackedArray {
  std::size_t offset = 0;  ///< bytes, a multiple of 4
  const char* type = "u8";
  std::size_t count = 0;
  std::vector<double> low, step;  ///< one, or one per component; none of f32 and u32
  std::size_t delta = 0;          ///< elements of one frame, from which differences are taken; 0: none are
};

/// Numbers from low to high as the integers 0 to levels. All equal: step 0.
struct Range {
  double low = 0, step = 0;
};

/// Differences of numbers up to this are numbers.
constexpr double largest_shown = 1e300;

/// The span of numbers seen so far.
struct Span {
  double low = 0, high = 0;
  bool any = false;
  /// Throws std::domain_error for a number that is not finite or above largest_shown, with words for it.
  void add(double x);
};

/// Steps between the ends of a range, of values in one byte and in two.
inline constexpr double levels_of_8_bits = 255.0, levels_of_16_bits = 65535.0;

/// The range that covers a span in `levels` steps. Signed: zero is one of its values, in the middle.
Range range_of(const Span& span, double levels, bool is_signed);

/// The nearest integer of the range; x must lie in it.
std::uint16_t quantised(const Range& range, double x);

class Block {
 public:
  /// Elements k >= delta are stored as differences from element k - delta, modulo 2^8.
  PackedArray add(const std::vector<std::uint8_t>& q, const Range& range, std::size_t delta);
  /// The same modulo 2^16; all low bytes, then all high bytes. One range per component.
  PackedArray add(const std::vector<std::uint16_t>& q, std::span<const Range> ranges, std::size_t delta);
  PackedArray add(const std::vector<float>& values);
  PackedArray add(const std::vector<std::uint32_t>& values);

  const std::string& bytes() const { return bytes_; }

 private:
  PackedArray begin(const char* type, std::size_t count);
  std::string bytes_;
};

/// A gzip stream of these bytes.
std::string gzip(const std::string& bytes);

std::string base64(const std::string& bytes);

/// A number of this file as a block holds it. Throws IoError if it is not finite, or too large.
float as_float(double x, const std::filesystem::path& file);

}  // namespace vbond::page
