#include "vbond/observe/vtp_read.hpp"

#include <cstring>
#include <string_view>
#include <system_error>

#include "vbond/core/error.hpp"
#include "vbond/observe/detail/scanner.hpp"
#include "vbond/observe/frames.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view tail = "\n  </AppendedData>\n</VTKFile>\n";

std::size_t size_of(std::string_view type, const Scanner& s) {
  if (type == "Float64" || type == "Int64") return 8;
  if (type == "UInt8") return 1;
  s.refuse();
}

/// The text before the arrays: some 3000 bytes.
std::string read_head(std::FILE* f, const fs::path& path) {
  constexpr std::string_view marker = "<AppendedData encoding=\"raw\">\n   _";
  std::string text(1 << 14, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), f));
  const std::size_t at = text.find(marker);
  if (at == std::string::npos) throw IoError(path.string() + ": is not a .vtp file of vbond");
  text.resize(at + marker.size());
  return text;
}

}  // namespace

/// Reads what VtpFile::head has written, in its order.
class VtpInput::Head {
 public:
  Head(const std::string& text, VtpInput& file) : s_(text, file.path_), text_size_(text.size()), f_(file) {}

  /// Returns where the last array ends.
  std::size_t read() {
    s_.expect(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        "  <PolyData>\n    <FieldData>\n"
        "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">");
    f_.time_ = s_.number<double>();
    s_.expect(
        "</DataArray>\n      <DataArray type=\"Int64\" Name=\"Step\" NumberOfTuples=\"1\" format=\"ascii\">");
    f_.step_ = s_.number<std::int64_t>();
    s_.expect("</DataArray>\n");
    if (s_.take("      <DataArray type=\"Float64\" Name=\"load_factor\" NumberOfTuples=\"1\" "
                "format=\"ascii\">")) {
      f_.load_factor_ = s_.number<double>();
      s_.expect("</DataArray>\n");
    }
    s_.expect("    </FieldData>\n    <Piece NumberOfPoints=\"");
    f_.points_ = s_.number<std::size_t>();
    s_.expect("\" NumberOfVerts=\"");
    const auto verts = s_.number<std::size_t>();
    s_.expect("\" NumberOfLines=\"");
    const auto lines = s_.number<std::size_t>();
    s_.expect("\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n");
    if (verts > 0 && lines > 0) s_.refuse();
    f_.cells_ = verts + lines;
    read_arrays();
    return text_size_ + offset_;
  }

 private:
  void read_arrays() {
    while (!s_.take("      </PointData>\n      <CellData>\n")) array(f_.points_);
    while (!s_.take("      </CellData>\n      <Points>\n")) array(f_.cells_);
    array(f_.points_);
    s_.expect("      </Points>\n");
    const bool lines = s_.take("      <Lines>\n");
    if (!lines) s_.expect("      <Verts>\n");
    array(lines ? 2 * f_.cells_ : f_.cells_);
    array(f_.cells_);
    s_.expect(lines ? "      </Lines>\n" : "      </Verts>\n");
    s_.expect("    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _");
    if (s_.at() != text_size_) s_.refuse();
  }

  void array(std::size_t tuples) {
    Array a;
    s_.expect("        <DataArray type=\"");
    a.type = s_.until('"');
    s_.expect(" Name=\"");
    a.name = s_.until('"');
    s_.expect(" NumberOfComponents=\"");
    a.components = s_.number<std::size_t>();
    s_.expect("\" format=\"appended\" offset=\"");
    if (s_.number<std::size_t>() != offset_) s_.refuse();
    s_.expect("\"/>\n");
    a.size = tuples * a.components * size_of(a.type, s_);
    a.offset = text_size_ + offset_;
    offset_ += sizeof(std::uint64_t) + a.size;
    f_.arrays_.push_back(std::move(a));
  }

  Scanner s_;
  std::size_t text_size_, offset_ = 0;
  VtpInput& f_;
};

VtpInput::VtpInput(const fs::path& path) : path_(path), file_(open_file(path, "rb")) {
  const std::string head = read_head(file_.get(), path_);
  check_size(Head(head, *this).read());
}

void VtpInput::check_size(std::size_t end_of_arrays) const {
  std::error_code e;
  if (fs::file_size(path_, e) != end_of_arrays + tail.size() || e)
    throw IoError(path_.string() + ": is cut short or damaged: its size is not what its head says");
}

template <class T>
std::vector<T> VtpInput::read(const std::string& name, const char* type, std::size_t components) const {
  for (const Array& a : arrays_) {
    if (a.name != name) continue;
    if (a.type != type || a.components != components) break;
    std::uint64_t size = 0;
    std::vector<T> values(a.size / sizeof(T));
    if (std::fseek(file_.get(), static_cast<long>(a.offset), SEEK_SET) != 0 ||
        std::fread(&size, sizeof size, 1, file_.get()) != 1 || size != a.size ||
        std::fread(values.data(), 1, a.size, file_.get()) != a.size)
      throw IoError(path_.string() + ": is damaged at array \"" + name + '"');
    return values;
  }
  throw IoError(path_.string() + ": has no array \"" + name + "\" of type " + type +
                "; was it written by another version of vbond?");
}

std::vector<double> VtpInput::scalars(const std::string& name) const {
  return read<double>(name, "Float64", 1);
}
std::vector<Vec3d> VtpInput::vectors(const std::string& name) const {
  return read<Vec3d>(name, "Float64", 3);
}
std::vector<std::int64_t> VtpInput::integers(const std::string& name) const {
  return read<std::int64_t>(name, "Int64", 1);
}
std::vector<std::uint8_t> VtpInput::bytes(const std::string& name) const {
  return read<std::uint8_t>(name, "UInt8", 1);
}

std::vector<ListedFrame> read_pvd(const fs::path& path) {
  const std::string content = read_all(path), empty = pvd_list({});
  const std::size_t head = empty.find("  </Collection>");
  Scanner s(content, path);
  s.expect(std::string_view(empty).substr(0, head));
  std::vector<ListedFrame> frames;
  while (s.take("    <DataSet timestep=\"")) {
    ListedFrame frame;
    frame.time = s.number<double>();
    s.expect("\" part=\"0\" file=\"");
    frame.file = path.parent_path() / s.until('"');
    s.expect("/>\n");
    frames.push_back(std::move(frame));
  }
  s.expect(std::string_view(empty).substr(head));
  if (!s.at_end()) s.refuse();
  return frames;
}

}  // namespace vbond
