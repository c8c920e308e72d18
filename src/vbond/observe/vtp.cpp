#include "vbond/observe/vtp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>

#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/zlib_blocks.hpp"

namespace vbond {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");
static_assert(sizeof(Vec3d) == 3 * sizeof(double), "a Vec3d is written as three doubles");
static_assert(sizeof(Image) == 3 * sizeof(std::int32_t), "an Image is written as three whole numbers");

namespace {

/// The bytes of an array as they stand in a file: their number, then themselves; or in blocks.
std::string stored(std::string_view bytes, bool compressed) {
  if (compressed) return in_zlib_blocks(bytes);
  const std::uint64_t size = bytes.size();
  std::string out(sizeof size, '\0');
  std::memcpy(out.data(), &size, sizeof size);
  return out.append(bytes);
}

/// Throws IoError for a number that is too large: it would become infinite without a word.
std::vector<float> in_single_precision(const std::string& name, const double* values, std::size_t count) {
  std::vector<float> single(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (std::isfinite(values[k]) && std::abs(values[k]) > std::numeric_limits<float>::max())
      throw IoError(
          fmt::format("frames: {:g} of array \"{}\" is too large for single precision\n"
                      "  set output.frames.precision = \"float64\" in the case",
                      values[k], name));
    single[k] = static_cast<float>(values[k]);
  }
  return single;
}

std::string field_data_of(const FrameCell& cell) {
  const auto& [a, b, c] = cell.edges;
  const Vec3d& o = cell.corner;
  return fmt::format(
      "      <DataArray type=\"Float64\" Name=\"cell\" NumberOfComponents=\"3\" NumberOfTuples=\"3\" "
      "format=\"ascii\">{} {} {} {} {} {} {} {} {}</DataArray>\n"
      "      <DataArray type=\"Float64\" Name=\"cell_corner\" NumberOfComponents=\"3\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{} {} {}</DataArray>\n"
      "      <DataArray type=\"UInt8\" Name=\"cell_periodic\" NumberOfComponents=\"3\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{:d} {:d} {:d}</DataArray>\n",
      a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, o.x, o.y, o.z, cell.periodic[0], cell.periodic[1],
      cell.periodic[2]);
}

const double* numbers_of(const std::vector<Vec3d>& vectors) {
  return reinterpret_cast<const double*>(vectors.data());
}

}  // namespace

template <class T>
VtpFile::Array VtpFile::array(const std::string& name, const char* type, int components,
                              const std::vector<T>& values, const std::string& unit) const {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  return {name, type, components, unit, stored(bytes, format_.compressed)};
}

VtpFile::Array VtpFile::reals(const std::string& name, int components, const double* values,
                              std::size_t count, const std::string& unit) const {
  if (format_.single_precision)
    return array(name, "Float32", components, in_single_precision(name, values, count), unit);
  const std::string_view bytes(reinterpret_cast<const char*>(values), count * sizeof(double));
  return {name, "Float64", components, unit, stored(bytes, format_.compressed)};
}

VtpFile::Array VtpFile::integers(const std::string& name, const std::vector<std::int64_t>& values,
                                 const std::string& unit) const {
  const bool fit = !format_.long_integers && std::all_of(values.begin(), values.end(), [](std::int64_t x) {
    return x == static_cast<std::int64_t>(static_cast<std::int32_t>(x));
  });
  if (!fit) return array(name, "Int64", 1, values, unit);
  return array(name, "Int32", 1, std::vector<std::int32_t>(values.begin(), values.end()), unit);
}

VtpFile VtpFile::of_cells(Topology topology, const std::vector<Vec3d>& points,
                          const std::vector<std::int64_t>& corners_of_cells, std::int64_t corners,
                          FrameFormat format) {
  std::vector<std::int64_t> offsets(corners_of_cells.size() / static_cast<std::size_t>(corners));
  for (std::size_t k = 0; k < offsets.size(); ++k) offsets[k] = corners * static_cast<std::int64_t>(k + 1);
  VtpFile f(format);
  f.topology_ = topology;
  f.points_ = points.size();
  f.cells_ = offsets.size();
  f.coordinates_ = f.reals("Points", 3, numbers_of(points), 3 * points.size());
  f.connectivity_ = f.integers("connectivity", corners_of_cells);
  f.offsets_ = f.integers("offsets", offsets);
  return f;
}

VtpFile VtpFile::of_points(const std::vector<Vec3d>& points, FrameFormat format) {
  std::vector<std::int64_t> each(points.size());
  std::iota(each.begin(), each.end(), 0);
  return of_cells(Topology::verts, points, each, 1, format);
}

VtpFile VtpFile::of_lines(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& ends,
                          FrameFormat format) {
  return of_cells(Topology::lines, points, ends, 2, format);
}

VtpFile VtpFile::of_triangles(const std::vector<Vec3d>& points,
                              const std::vector<std::array<std::int64_t, 3>>& triangles, FrameFormat format) {
  std::vector<std::int64_t> corners;
  for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return of_cells(Topology::polys, points, corners, 3, format);
}

void VtpFile::add_point_data(const std::string& name, const std::vector<double>& values,
                             const std::string& unit) {
  point_data_.push_back(reals(name, 1, values.data(), values.size(), unit));
}
void VtpFile::add_point_data(const std::string& name, const std::vector<Vec3d>& values,
                             const std::string& unit) {
  point_data_.push_back(reals(name, 3, numbers_of(values), 3 * values.size(), unit));
}
void VtpFile::add_point_data(const std::string& name, const std::vector<std::int64_t>& values,
                             const std::string& unit) {
  point_data_.push_back(integers(name, values, unit));
}
void VtpFile::add_point_data(const std::string& name, const std::vector<Image>& values,
                             const std::string& unit) {
  point_data_.push_back(array(name, "Int32", 3, values, unit));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<double>& values,
                            const std::string& unit) {
  cell_data_.push_back(reals(name, 1, values.data(), values.size(), unit));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<Vec3d>& values,
                            const std::string& unit) {
  cell_data_.push_back(reals(name, 3, numbers_of(values), 3 * values.size(), unit));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<std::int64_t>& values,
                            const std::string& unit) {
  cell_data_.push_back(integers(name, values, unit));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<std::uint8_t>& values,
                            const std::string& unit) {
  cell_data_.push_back(array(name, "UInt8", 1, values, unit));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<Image>& values,
                            const std::string& unit) {
  cell_data_.push_back(array(name, "Int32", 3, values, unit));
}

std::vector<const VtpFile::Array*> VtpFile::in_file_order() const {
  std::vector<const Array*> all;
  for (const Array& a : point_data_) all.push_back(&a);
  for (const Array& a : cell_data_) all.push_back(&a);
  for (const Array* a : {&coordinates_, &connectivity_, &offsets_}) all.push_back(a);
  return all;
}

std::string VtpFile::head(double time, std::int64_t step, std::optional<double> load_factor) const {
  std::size_t offset = 0;
  const auto declare = [&offset](const Array& a) {
    const std::string tag = fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"",
        a.type, a.name, a.components, offset);
    offset += a.stored.size();
    if (a.unit.empty()) return tag + "/>\n";
    return tag + fmt::format(
                     ">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}"
                     "</InformationKey>\n        </DataArray>\n",
                     a.unit);
  };
  const auto count = [this](Topology topology) { return topology == topology_ ? cells_ : 0; };
  const char* cells = topology_ == Topology::verts   ? "Verts"
                      : topology_ == Topology::lines ? "Lines"
                                                     : "Polys";
  std::string x = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n"
      "  <PolyData>\n    <FieldData>\n",
      format_.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "");
  x += fmt::format(
      "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
      "{}</DataArray>\n"
      "      <DataArray type=\"Int64\" Name=\"Step\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
      time, step);
  if (load_factor)
    x += fmt::format(
        "      <DataArray type=\"Float64\" Name=\"load_factor\" NumberOfTuples=\"1\" format=\"ascii\">"
        "{}</DataArray>\n",
        *load_factor);
  if (points_of_all_parts_)
    x += fmt::format(
        "      <DataArray type=\"Int64\" Name=\"points_of_all_parts\" NumberOfTuples=\"1\" format=\"ascii\">"
        "{}</DataArray>\n",
        *points_of_all_parts_);
  if (cell_) x += field_data_of(*cell_);
  x += fmt::format(
      "    </FieldData>\n    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
      points_, count(Topology::verts), count(Topology::lines), count(Topology::polys));
  x += "      <PointData>\n";
  for (const Array& a : point_data_) x += declare(a);
  x += "      </PointData>\n      <CellData>\n";
  for (const Array& a : cell_data_) x += declare(a);
  x += "      </CellData>\n      <Points>\n";
  x += declare(coordinates_);  // one at a time: each takes the offset that the last one left
  x += fmt::format("      </Points>\n      <{}>\n", cells);
  x += declare(connectivity_);
  x += declare(offsets_);
  x +=
      fmt::format("      </{}>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _", cells);
  return x;
}

void VtpFile::write(const std::filesystem::path& path, double time, std::int64_t step,
                    std::optional<double> load_factor) const {
  Replacement file(path);
  file.write(head(time, step, load_factor));
  for (const Array* a : in_file_order()) file.write(a->stored);
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.publish(Sync::none);
}

void VtpFile::write_list(const std::filesystem::path& path, const std::vector<std::string>& pieces) const {
  const auto declare = [](const Array& a) {
    const std::string tag = fmt::format("      <PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"",
                                        a.type, a.name, a.components);
    if (a.unit.empty()) return tag + "/>\n";
    return tag + fmt::format(
                     "><InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>"
                     "</PDataArray>\n",
                     a.unit);
  };
  std::string x =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PPolyData GhostLevel=\"0\">\n    <PPointData>\n";
  for (const Array& a : point_data_) x += declare(a);
  x += "    </PPointData>\n    <PCellData>\n";
  for (const Array& a : cell_data_) x += declare(a);
  x += "    </PCellData>\n    <PPoints>\n" + declare(coordinates_) + "    </PPoints>\n";
  for (const std::string& piece : pieces) x += fmt::format("    <Piece Source=\"{}\"/>\n", piece);
  replace_file(path, x + "  </PPolyData>\n</VTKFile>\n", Sync::none);
}

}  // namespace vbond
