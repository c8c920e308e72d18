#include "vbond/observe/vtp.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "vbond/observe/files.hpp"

namespace vbond {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");
static_assert(sizeof(Vec3d) == 3 * sizeof(double), "a Vec3d is written as three doubles");

template <class T>
VtpFile::Array VtpFile::array(const std::string& name, const char* type, int components,
                              const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const char*>(values.data());
  return {name, type, components, std::string(bytes, bytes + values.size() * sizeof(T))};
}

VtpFile VtpFile::of_points(const std::vector<Vec3d>& points) {
  std::vector<std::int64_t> each(points.size()), ends(points.size());
  std::iota(each.begin(), each.end(), 0);
  std::iota(ends.begin(), ends.end(), 1);
  VtpFile f;
  f.points_ = f.cells_ = points.size();
  f.coordinates_ = array("Points", "Float64", 3, points);
  f.connectivity_ = array("connectivity", "Int64", 1, each);
  f.offsets_ = array("offsets", "Int64", 1, ends);
  return f;
}

VtpFile VtpFile::of_lines(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& ends) {
  std::vector<std::int64_t> offsets(ends.size() / 2);
  for (std::size_t k = 0; k < offsets.size(); ++k) offsets[k] = static_cast<std::int64_t>(2 * (k + 1));
  VtpFile f;
  f.topology_ = Topology::lines;
  f.points_ = points.size();
  f.cells_ = offsets.size();
  f.coordinates_ = array("Points", "Float64", 3, points);
  f.connectivity_ = array("connectivity", "Int64", 1, ends);
  f.offsets_ = array("offsets", "Int64", 1, offsets);
  return f;
}

void VtpFile::add_point_data(const std::string& name, const std::vector<double>& values) {
  point_data_.push_back(array(name, "Float64", 1, values));
}
void VtpFile::add_point_data(const std::string& name, const std::vector<Vec3d>& values) {
  point_data_.push_back(array(name, "Float64", 3, values));
}
void VtpFile::add_point_data(const std::string& name, const std::vector<std::int64_t>& values) {
  point_data_.push_back(array(name, "Int64", 1, values));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<double>& values) {
  cell_data_.push_back(array(name, "Float64", 1, values));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<std::int64_t>& values) {
  cell_data_.push_back(array(name, "Int64", 1, values));
}
void VtpFile::add_cell_data(const std::string& name, const std::vector<std::uint8_t>& values) {
  cell_data_.push_back(array(name, "UInt8", 1, values));
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
        "offset=\"{}\"/>\n",
        a.type, a.name, a.components, offset);
    offset += sizeof(std::uint64_t) + a.bytes.size();
    return tag;
  };
  const char* cells = topology_ == Topology::verts ? "Verts" : "Lines";
  std::string x =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PolyData>\n    <FieldData>\n";
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
  x += fmt::format(
      "    </FieldData>\n    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
      points_, topology_ == Topology::verts ? cells_ : 0, topology_ == Topology::lines ? cells_ : 0);
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
  for (const Array* a : in_file_order()) {
    const std::uint64_t size = a->bytes.size();
    char header[sizeof size];
    std::memcpy(header, &size, sizeof size);
    file.write({header, sizeof header});
    file.write(a->bytes);
  }
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.publish(Sync::none);
}

}  // namespace vbond
