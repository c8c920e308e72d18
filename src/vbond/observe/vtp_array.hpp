#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/observe/spool.hpp"

namespace vbond {

/// One array of a VtpFile, as bytes that stand in the file: their number and themselves, or blocks by zlib.
/// Its values come some at a time, and wait in a spool.
class VtpArray {
 public:
  enum class Type : std::uint8_t { Float32, Float64, Int32, Int64, UInt8 };

  /// components: numbers of a value. unit: its label becomes VTK's key UNITS_LABEL; an empty one is left out.
  VtpArray(std::string name, Type type, int components, std::string unit, bool compressed,
           std::shared_ptr<Spool> spool);

  /// More values. Throws IoError for a number that is finite, but not in single precision, and when the disk
  /// is full; std::logic_error for a value that is not of the array's type, or too large for it.
  void append(std::span<const double> values);
  void append(std::span<const Vec3d> values);
  void append(std::span<const std::int64_t> values);
  void append(std::span<const std::uint8_t> values);
  void append(std::span<const Image> values);

  const std::string& name() const { return name_; }
  const char* type() const;
  int components() const { return components_; }
  const std::string& unit() const { return unit_; }
  void set_unit(const std::string& unit) { unit_ = unit; }
  std::uint64_t values() const { return values_; }

  /// What stands before the blocks that wait, and after them. Good until more values come.
  struct Ends {
    std::string head, tail;
  };
  Ends ends() const;
  /// Bytes in the file.
  std::uint64_t size(const Ends& ends) const { return ends.head.size() + waiting_ + ends.tail.size(); }
  /// Throws IoError.
  void write(const Ends& ends, Replacement& to) const;

 private:
  template <class Stored, class From>
  void append_as(std::span<const From> numbers);
  void append_bytes(std::string_view bytes);
  void require(bool type_is_right) const;

  std::string name_;
  Type type_;
  int components_;
  std::string unit_;
  bool compressed_;
  std::shared_ptr<Spool> spool_;
  std::uint64_t values_ = 0;
  std::uint64_t waiting_ = 0;         // bytes of the blocks
  std::vector<Spool::Piece> blocks_;  // each of zlib_block_size bytes, maybe compressed
  std::string last_;                  // what has come since
};

}  // namespace vbond
