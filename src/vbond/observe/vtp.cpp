#include "vbond/observe/vtp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "vbond/observe/files.hpp"

namespace vbond {

namespace {

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

/// How many points each cell has.
std::size_t corners_of(VtpFile::Topology topology) {
  return topology == VtpFile::Topology::verts ? 1 : topology == VtpFile::Topology::lines ? 2 : 3;
}

}  // namespace

bool VtpFile::fit_in_32_bits(std::span<const std::int64_t> values) {
  return std::all_of(values.begin(), values.end(), [](std::int64_t x) {
    return x == static_cast<std::int64_t>(static_cast<std::int32_t>(x));
  });
}

VtpFile::VtpFile(Topology topology, FrameFormat format, const std::filesystem::path& beside)
    : format_(format),
      spool_(std::make_shared<Spool>(beside)),
      topology_(topology),
      coordinates_(array<Vec3d>("Points", {}, false)),
      connectivity_(array<std::int64_t>("connectivity", {}, format.long_integers)),
      offsets_(array<std::int64_t>("offsets", {}, format.long_integers)) {}

void VtpFile::add_cells(std::span<const std::int64_t> corners) {
  const std::size_t of_each = corners_of(topology_);
  std::vector<std::int64_t> ends(corners.size() / of_each);
  for (std::size_t k = 0; k < ends.size(); ++k)
    ends[k] = static_cast<std::int64_t>(of_each * (offsets_.values() + k + 1));
  connectivity_.append(corners);
  offsets_.append(ends);
}

VtpFile VtpFile::of_cells(Topology topology, const std::vector<Vec3d>& points,
                          const std::vector<std::int64_t>& corners, FrameFormat format) {
  VtpFile f(topology, format);
  f.add_points(points);
  const auto last = static_cast<std::int64_t>(corners.size());
  const bool long_ones = format.long_integers;
  f.connectivity_ = f.array<std::int64_t>("connectivity", {}, long_ones || !fit_in_32_bits(corners));
  f.offsets_ = f.array<std::int64_t>("offsets", {}, long_ones || !fit_in_32_bits({&last, 1}));
  f.add_cells(corners);
  return f;
}

VtpFile VtpFile::of_points(const std::vector<Vec3d>& points, FrameFormat format) {
  std::vector<std::int64_t> each(points.size());
  std::iota(each.begin(), each.end(), 0);
  return of_cells(Topology::verts, points, each, format);
}

VtpFile VtpFile::of_lines(const std::vector<Vec3d>& points, const std::vector<std::int64_t>& ends,
                          FrameFormat format) {
  return of_cells(Topology::lines, points, ends, format);
}

VtpFile VtpFile::of_triangles(const std::vector<Vec3d>& points,
                              const std::vector<std::array<std::int64_t, 3>>& triangles, FrameFormat format) {
  std::vector<std::int64_t> corners;
  for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return of_cells(Topology::polys, points, corners, format);
}

std::vector<const VtpArray*> VtpFile::in_file_order() const {
  std::vector<const VtpArray*> all;
  for (const VtpArray& a : point_data_) all.push_back(&a);
  for (const VtpArray& a : cell_data_) all.push_back(&a);
  for (const VtpArray* a : {&coordinates_, &connectivity_, &offsets_}) all.push_back(a);
  return all;
}

std::string VtpFile::head(const std::vector<VtpArray::Ends>& ends, double time, std::int64_t step,
                          std::optional<double> load_factor) const {
  std::uint64_t offset = 0;
  auto ends_of_next = ends.begin();
  const auto declare = [&](const VtpArray& a) {  // in the order of the file
    const std::string tag = fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"",
        a.type(), a.name(), a.components(), offset);
    offset += a.size(*ends_of_next++);
    if (a.unit().empty()) return tag + "/>\n";
    return tag + fmt::format(
                     ">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}"
                     "</InformationKey>\n        </DataArray>\n",
                     a.unit());
  };
  const auto count = [this](Topology topology) { return topology == topology_ ? offsets_.values() : 0; };
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
      coordinates_.values(), count(Topology::verts), count(Topology::lines), count(Topology::polys));
  x += "      <PointData>\n";
  for (const VtpArray& a : point_data_) x += declare(a);
  x += "      </PointData>\n      <CellData>\n";
  for (const VtpArray& a : cell_data_) x += declare(a);
  x += "      </CellData>\n      <Points>\n";
  x += declare(coordinates_);
  x += fmt::format("      </Points>\n      <{}>\n", cells);
  x += declare(connectivity_);
  x += declare(offsets_);
  x +=
      fmt::format("      </{}>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _", cells);
  return x;
}

void VtpFile::write(const std::filesystem::path& path, double time, std::int64_t step,
                    std::optional<double> load_factor) const {
  const std::vector<const VtpArray*> arrays = in_file_order();
  std::vector<VtpArray::Ends> ends;
  for (const VtpArray* a : arrays) ends.push_back(a->ends());
  Replacement file(path);
  file.write(head(ends, time, step, load_factor));
  for (std::size_t k = 0; k < arrays.size(); ++k) arrays[k]->write(ends[k], file);
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.publish(Sync::none);
}

void VtpFile::write_list(const std::filesystem::path& path, const std::vector<std::string>& pieces) const {
  const auto declare = [](const VtpArray& a) {
    const std::string tag = fmt::format("      <PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"",
                                        a.type(), a.name(), a.components());
    if (a.unit().empty()) return tag + "/>\n";
    return tag + fmt::format(
                     "><InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>"
                     "</PDataArray>\n",
                     a.unit());
  };
  std::string x =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PPolyData GhostLevel=\"0\">\n    <PPointData>\n";
  for (const VtpArray& a : point_data_) x += declare(a);
  x += "    </PPointData>\n    <PCellData>\n";
  for (const VtpArray& a : cell_data_) x += declare(a);
  x += "    </PCellData>\n    <PPoints>\n" + declare(coordinates_) + "    </PPoints>\n";
  for (const std::string& piece : pieces) x += fmt::format("    <Piece Source=\"{}\"/>\n", piece);
  replace_file(path, x + "  </PPolyData>\n</VTKFile>\n", Sync::none);
}

}  // namespace vbond
