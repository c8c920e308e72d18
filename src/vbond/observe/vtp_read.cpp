#include "vbond/observe/vtp_read.hpp"

#include <algorithm>
#include <cmath>
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
    f_.points_ = count();
    s_.expect("\" NumberOfVerts=\"");
    const std::size_t verts = count();
    s_.expect("\" NumberOfLines=\"");
    const std::size_t lines = count();
    s_.expect("\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n");
    if (verts > 0 && lines > 0) s_.refuse();
    f_.cells_ = verts + lines;
    read_arrays();
    return text_size_ + offset_;
  }

 private:
  /// Each of them takes a byte at least: more than that the file cannot have.
  std::size_t count() {
    const auto n = s_.number<std::size_t>();
    if (n > f_.size_) f_.refuse_size();
    return n;
  }

  void read_arrays() {
    while (!s_.take("      </PointData>\n      <CellData>\n")) array(Per::point, f_.points_);
    while (!s_.take("      </CellData>\n      <Points>\n")) array(Per::cell, f_.cells_);
    array(Per::point, f_.points_);
    s_.expect("      </Points>\n");
    f_.lines_ = s_.take("      <Lines>\n");
    if (!f_.lines_) s_.expect("      <Verts>\n");
    array(Per::end, f_.lines_ ? 2 * f_.cells_ : f_.cells_);
    array(Per::end, f_.cells_);
    s_.expect(f_.lines_ ? "      </Lines>\n" : "      </Verts>\n");
    s_.expect("    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _");
    if (s_.at() != text_size_) s_.refuse();
  }

  void array(Per per, std::size_t tuples) {
    Array a;
    a.per = per;
    s_.expect("        <DataArray type=\"");
    a.type = s_.until('"');
    s_.expect(" Name=\"");
    a.name = s_.until('"');
    s_.expect(" NumberOfComponents=\"");
    a.components = count();
    s_.expect("\" format=\"appended\" offset=\"");
    if (s_.number<std::size_t>() != offset_) s_.refuse();
    s_.expect("\"/>\n");
    const std::size_t bytes_of_one = size_of(a.type, s_);
    if (a.components == 0) s_.refuse();
    if (tuples > f_.size_ / bytes_of_one / a.components) f_.refuse_size();
    a.size = tuples * a.components * bytes_of_one;
    a.offset = text_size_ + offset_;
    offset_ += sizeof(std::uint64_t) + a.size;
    f_.arrays_.push_back(std::move(a));
  }

  Scanner s_;
  std::size_t text_size_, offset_ = 0;
  VtpInput& f_;
};

VtpInput::VtpInput(const fs::path& path) : path_(path), file_(open_file(path, "rb")) {
  std::error_code e;
  size_ = fs::file_size(path_, e);
  if (e) throw IoError("cannot read " + path_.string() + ": " + e.message());
  const std::string head = read_head(file_.get(), path_);
  if (Head(head, *this).read() + tail.size() != size_) refuse_size();
}

void VtpInput::refuse_size() const {
  throw IoError(path_.string() + ": is cut short or damaged: its size is not what its head says");
}

template <class T>
std::vector<T> VtpInput::read(Per per, const std::string& name, const char* type,
                              std::size_t components) const {
  const auto is_it = [&name](const Array& a) { return a.name == name; };
  const auto at = std::find_if(arrays_.begin(), arrays_.end(), is_it);
  if (at != arrays_.end() && at->per == per && at->type == type && at->components == components &&
      std::none_of(at + 1, arrays_.end(), is_it)) {
    std::uint64_t size = 0;
    std::vector<T> values(at->size / sizeof(T));
    if (std::fseek(file_.get(), static_cast<long>(at->offset), SEEK_SET) != 0 ||
        std::fread(&size, sizeof size, 1, file_.get()) != 1 || size != at->size ||
        std::fread(values.data(), 1, at->size, file_.get()) != at->size)
      throw IoError(path_.string() + ": is damaged at array \"" + name + '"');
    return values;
  }
  throw IoError(path_.string() + ": has no array \"" + name + "\" of type " + type + " for each " +
                (per == Per::point  ? "point"
                 : per == Per::cell ? "cell"
                                    : "end of a cell") +
                "; was it written by another version of vbond?");
}

std::vector<double> VtpInput::scalars(Per per, const std::string& name) const {
  return read<double>(per, name, "Float64", 1);
}
std::vector<Vec3d> VtpInput::vectors(Per per, const std::string& name) const {
  return read<Vec3d>(per, name, "Float64", 3);
}
std::vector<std::int64_t> VtpInput::integers(Per per, const std::string& name) const {
  return read<std::int64_t>(per, name, "Int64", 1);
}
std::vector<std::uint8_t> VtpInput::bytes(Per per, const std::string& name) const {
  return read<std::uint8_t>(per, name, "UInt8", 1);
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
    if (!std::isfinite(frame.time)) s.refuse();
    s.expect("\" part=\"0\" file=\"");
    const fs::path file = s.until('"');
    if (file.is_absolute() || std::find(file.begin(), file.end(), "..") != file.end()) s.refuse();
    frame.file = path.parent_path() / file;
    s.expect("/>\n");
    frames.push_back(std::move(frame));
  }
  s.expect(std::string_view(empty).substr(head));
  if (!s.at_end()) s.refuse();
  return frames;
}

}  // namespace vbond
