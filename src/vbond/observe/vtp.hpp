#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/observe/frame_format.hpp"
#include "vbond/observe/in_cell.hpp"

namespace vbond {

/// A VTK XML PolyData file (.vtp) with its arrays appended as raw little-endian binary, 64-bit headers;
/// integers take 32 bits where they fit. Format: "VTK file formats", XML section, of the VTK user's guide;
/// ParaView 5.11 reads it. All that adds an array throws IoError for a number that is finite, but not in
/// single precision.
class VtpFile {
 public:
  enum class Topology : std::uint8_t { verts, lines, polys };

  /// One vertex cell per point.
  static VtpFile of_points(const std::vector<Vec3d>& points, FrameFormat format = {});
  /// One line cell per pair of point indices; ends holds i, j, i, j, ...
  static VtpFile of_lines(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& ends,
                          FrameFormat format = {});
  /// One cell per triangle of point indices.
  static VtpFile of_triangles(const std::vector<Vec3d>& points,
                              const std::vector<std::array<std::int64_t, 3>>& triangles,
                              FrameFormat format = {});

  /// The unit of the positions: its label becomes VTK's key UNITS_LABEL. An empty one is left out.
  void set_unit_of_points(const std::string& unit) { coordinates_.unit = unit; }

  /// Field data: `points_of_all_parts`, of a file that is a part of a frame.
  void set_points_of_all_parts(std::int64_t points) { points_of_all_parts_ = points; }
  /// Field data: `cell` (a, b and c), `cell_corner`, `cell_periodic` (1: yes).
  void set_cell(const FrameCell& cell) { cell_ = cell; }

  /// Per point.
  void add_point_data(const std::string& name, const std::vector<double>& values,
                      const std::string& unit = {});
  void add_point_data(const std::string& name, const std::vector<Vec3d>& values,
                      const std::string& unit = {});
  void add_point_data(const std::string& name, const std::vector<std::int64_t>& values,
                      const std::string& unit = {});
  /// Three whole numbers of 32 bits.
  void add_point_data(const std::string& name, const std::vector<Image>& values,
                      const std::string& unit = {});
  /// Per cell.
  void add_cell_data(const std::string& name, const std::vector<double>& values,
                     const std::string& unit = {});
  void add_cell_data(const std::string& name, const std::vector<Vec3d>& values, const std::string& unit = {});
  void add_cell_data(const std::string& name, const std::vector<std::int64_t>& values,
                     const std::string& unit = {});
  void add_cell_data(const std::string& name, const std::vector<std::uint8_t>& values,
                     const std::string& unit = {});
  void add_cell_data(const std::string& name, const std::vector<Image>& values, const std::string& unit = {});

  /// Writes the file under a temporary name and renames it. time goes to TimeValue, step to Step, and the
  /// load factor of a balance to load_factor. Throws IoError.
  void write(const std::filesystem::path& path, double time, std::int64_t step,
             std::optional<double> load_factor = {}) const;
  /// The list (.pvtp) of files beside it that are pieces of one body and have the arrays of this file, in
  /// this order and of these types. Throws IoError.
  void write_list(const std::filesystem::path& path, const std::vector<std::string>& pieces) const;

 private:
  struct Array {
    std::string name;
    const char* type = "";
    int components = 1;
    std::string unit;
    std::string stored;  ///< as it stands in the file: sizes and bytes
  };
  explicit VtpFile(FrameFormat format) : format_(format) {}
  template <class T>
  Array array(const std::string& name, const char* type, int components, const std::vector<T>& values,
              const std::string& unit = {}) const;
  Array reals(const std::string& name, int components, const double* values, std::size_t count,
              const std::string& unit = {}) const;
  Array integers(const std::string& name, const std::vector<std::int64_t>& values,
                 const std::string& unit = {}) const;
  /// Cells of `corners` points each.
  static VtpFile of_cells(Topology topology, const std::vector<Vec3d>& points,
                          const std::vector<std::int64_t>& corners_of_cells, std::int64_t corners,
                          FrameFormat format);
  std::string head(double time, std::int64_t step, std::optional<double> load_factor) const;
  std::vector<const Array*> in_file_order() const;

  FrameFormat format_;
  std::optional<FrameCell> cell_;
  std::optional<std::int64_t> points_of_all_parts_;
  std::size_t points_ = 0, cells_ = 0;
  Topology topology_ = Topology::verts;
  Array coordinates_, connectivity_, offsets_;
  std::vector<Array> point_data_, cell_data_;
};

}  // namespace vbond
