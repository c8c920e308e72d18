#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/observe/frame_format.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/observe/spool.hpp"
#include "vbond/observe/vtp_array.hpp"

namespace vbond {

/// A VTK XML PolyData file (.vtp) with its arrays appended as raw little-endian binary, 64-bit headers.
/// Format: "VTK file formats", XML section, of the VTK user's guide; ParaView 5.11 reads it. Points, cells
/// and values are added at once or some at a time, and wait until the file is written. All that adds some
/// throws IoError for a number that is finite, but not in single precision.
class VtpFile {
 public:
  enum class Topology : std::uint8_t { verts, lines, polys };

  /// A file of vertices, lines or triangles, to which points and cells are added. Numbers take 32 bits, or
  /// 64 if the format asks for long integers. beside: a path in whose folder arrays wait once they take much
  /// room, as that of the file; none: in memory.
  explicit VtpFile(Topology topology, FrameFormat format, const std::filesystem::path& beside = {});
  void add_points(std::span<const Vec3d> points) { coordinates_.append(points); }
  /// corners: the points of one cell after the other.
  void add_cells(std::span<const std::int64_t> corners);
  /// An array to which a value of each point, or cell, is to be appended. It stays where it is.
  template <class T>
  VtpArray& begin_point_data(const std::string& name, const std::string& unit = {}) {
    return point_data_.emplace_back(array<T>(name, unit, format_.long_integers));
  }
  template <class T>
  VtpArray& begin_cell_data(const std::string& name, const std::string& unit = {}) {
    return cell_data_.emplace_back(array<T>(name, unit, format_.long_integers));
  }

  /// One vertex cell per point. Here and below integers take 32 bits where they fit.
  static VtpFile of_points(const std::vector<Vec3d>& points, FrameFormat format = {});
  /// One line cell per pair of point indices; ends holds i, j, i, j, ...
  static VtpFile of_lines(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& ends,
                          FrameFormat format = {});
  /// One cell per triangle of point indices.
  static VtpFile of_triangles(const std::vector<Vec3d>& points,
                              const std::vector<std::array<std::int64_t, 3>>& triangles,
                              FrameFormat format = {});

  /// The unit of the positions.
  void set_unit_of_points(const std::string& unit) { coordinates_.set_unit(unit); }

  /// Field data: `points_of_all_parts`, of a file that is a part of a frame.
  void set_points_of_all_parts(std::int64_t points) { points_of_all_parts_ = points; }
  /// Field data: `cell` (a, b and c), `cell_corner`, `cell_periodic` (1: yes).
  void set_cell(const FrameCell& cell) { cell_ = cell; }

  /// Per point: reals, vectors, integers, or images, which take three whole numbers of 32 bits.
  template <class T>
  void add_point_data(const std::string& name, const std::vector<T>& values, const std::string& unit = {}) {
    point_data_.push_back(filled(name, values, unit));
  }
  /// Per cell: reals, vectors, integers of 64 or 8 bits, or images.
  template <class T>
  void add_cell_data(const std::string& name, const std::vector<T>& values, const std::string& unit = {}) {
    cell_data_.push_back(filled(name, values, unit));
  }

  /// Writes the file under a temporary name and renames it. time goes to TimeValue, step to Step, and the
  /// load factor of a balance to load_factor. Throws IoError.
  void write(const std::filesystem::path& path, double time, std::int64_t step,
             std::optional<double> load_factor = {}) const;
  /// The list (.pvtp) of files beside it that are pieces of one body and have the arrays of this file, in
  /// this order and of these types. Throws IoError.
  void write_list(const std::filesystem::path& path, const std::vector<std::string>& pieces) const;

 private:
  /// Cells of integers that take 32 bits where they fit.
  static VtpFile of_cells(Topology topology, const std::vector<Vec3d>& points,
                          const std::vector<std::int64_t>& corners, FrameFormat format);
  /// Of double, Vec3d, std::int64_t, std::uint8_t or Image.
  template <class T>
  VtpArray array(const std::string& name, const std::string& unit, bool long_integers) const;
  template <class T>
  VtpArray filled(const std::string& name, const std::vector<T>& values, const std::string& unit) const;
  static bool fit_in_32_bits(std::span<const std::int64_t> values);
  std::vector<const VtpArray*> in_file_order() const;
  std::string head(const std::vector<VtpArray::Ends>& ends, double time, std::int64_t step,
                   std::optional<double> load_factor) const;

  FrameFormat format_;
  std::shared_ptr<Spool> spool_;
  std::optional<FrameCell> cell_;
  std::optional<std::int64_t> points_of_all_parts_;
  Topology topology_;
  VtpArray coordinates_, connectivity_, offsets_;
  std::deque<VtpArray> point_data_, cell_data_;
};

template <class T>
VtpArray VtpFile::array(const std::string& name, const std::string& unit, bool long_integers) const {
  using Type = VtpArray::Type;
  constexpr bool is_real = std::is_same_v<T, double> || std::is_same_v<T, Vec3d>;
  constexpr bool is_byte = std::is_same_v<T, std::uint8_t>, is_image = std::is_same_v<T, Image>;
  static_assert(is_real || is_byte || is_image || std::is_same_v<T, std::int64_t>);
  const Type type = is_real   ? (format_.single_precision ? Type::Float32 : Type::Float64)
                    : is_byte ? Type::UInt8
                              : (is_image || !long_integers ? Type::Int32 : Type::Int64);
  return {name, type, std::is_same_v<T, Vec3d> || is_image ? 3 : 1, unit, format_.compressed, spool_};
}

template <class T>
VtpArray VtpFile::filled(const std::string& name, const std::vector<T>& values,
                         const std::string& unit) const {
  bool long_integers = format_.long_integers;
  if constexpr (std::is_same_v<T, std::int64_t>) long_integers = long_integers || !fit_in_32_bits(values);
  VtpArray a = array<T>(name, unit, long_integers);
  a.append(values);
  return a;
}

}  // namespace vbond
