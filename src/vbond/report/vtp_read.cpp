#include "vbond/report/vtp_read.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/zlib_blocks.hpp"
#include "vbond/report/detail/scanner.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view tail = "\n  </AppendedData>\n</VTKFile>\n";

constexpr std::size_t most_inflated = 1032;  // times its size can deflate shrink a text, and no more

std::size_t size_of(std::string_view type, const Scanner& s) {
  if (type == "Float64" || type == "Int64") return 8;
  if (type == "Float32" || type == "Int32") return 4;
  if (type == "UInt8") return 1;
  s.refuse();
}

/// The text before the arrays: some 5000 bytes.
std::string read_head(std::FILE* f, const fs::path& path) {
  constexpr std::string_view marker = "<AppendedData encoding=\"raw\">\n   _";
  std::string text(1 << 14, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), f));
  require_read(f, path);
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

  void read() {
    s_.expect(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"");
    f_.compressed_ = s_.take(" compressor=\"vtkZLibDataCompressor\"");
    s_.expect(
        ">\n  <PolyData>\n    <FieldData>\n"
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
    if (s_.take("      <DataArray type=\"Int64\" Name=\"points_of_all_parts\" NumberOfTuples=\"1\" "
                "format=\"ascii\">")) {
      f_.points_of_all_parts_ = s_.number<std::size_t>();
      s_.expect("</DataArray>\n");
    }
    read_cell();
    s_.expect("    </FieldData>\n    <Piece NumberOfPoints=\"");
    f_.points_ = count();
    s_.expect("\" NumberOfVerts=\"");
    const std::size_t verts = count();
    s_.expect("\" NumberOfLines=\"");
    const std::size_t lines = count();
    s_.expect("\" NumberOfStrips=\"0\" NumberOfPolys=\"");
    const std::size_t polys = count();
    s_.expect("\">\n      <PointData>\n");
    if ((verts > 0) + (lines > 0) + (polys > 0) > 1) s_.refuse();
    f_.cells_ = verts + lines + polys;
    read_arrays();
    set_stored_sizes();
  }

 private:
  Vec3d vector() {
    Vec3d x;
    x.x = s_.number<double>(), s_.expect(" ");
    x.y = s_.number<double>(), s_.expect(" ");
    x.z = s_.number<double>();
    if (!is_finite(x)) s_.refuse();
    return x;
  }

  /// That of a periodic body.
  void read_cell() {
    if (!s_.take("      <DataArray type=\"Float64\" Name=\"cell\" NumberOfComponents=\"3\" "
                 "NumberOfTuples=\"3\" format=\"ascii\">"))
      return;
    FrameCell& cell = f_.cell_.emplace();
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) s_.expect(" ");
      cell.edges[k] = vector();
    }
    s_.expect(
        "</DataArray>\n      <DataArray type=\"Float64\" Name=\"cell_corner\" NumberOfComponents=\"3\" "
        "NumberOfTuples=\"1\" format=\"ascii\">");
    cell.corner = vector();
    s_.expect(
        "</DataArray>\n      <DataArray type=\"UInt8\" Name=\"cell_periodic\" NumberOfComponents=\"3\" "
        "NumberOfTuples=\"1\" format=\"ascii\">");
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) s_.expect(" ");
      cell.periodic[k] = s_.take("1");
      if (!cell.periodic[k]) s_.expect("0");
    }
    s_.expect("</DataArray>\n");
  }

  /// As many bytes the arrays of the file can have at most.
  std::size_t most_bytes() const { return f_.compressed_ ? most_inflated * f_.size_ : f_.size_; }

  /// Each of them takes a byte at least: more than that the file cannot have.
  std::size_t count() {
    const auto n = s_.number<std::size_t>();
    if (n > most_bytes()) f_.refuse_size();
    return n;
  }

  /// Each array reaches to the next one, the last to the tail. Of one that is not compressed that is known.
  void set_stored_sizes() {
    const std::size_t end = f_.size_ - tail.size();
    for (std::size_t k = 0; k < f_.arrays_.size(); ++k) {
      Array& a = f_.arrays_[k];
      const std::size_t next = k + 1 < f_.arrays_.size() ? f_.arrays_[k + 1].offset : end;
      if (next <= a.offset) f_.refuse_size();
      a.stored = next - a.offset;
      if (!f_.compressed_ && a.stored != sizeof(std::uint64_t) + a.size) f_.refuse_size();
    }
  }

  void read_arrays() {
    while (!s_.take("      </PointData>\n      <CellData>\n")) array(Per::point, f_.points_);
    while (!s_.take("      </CellData>\n      <Points>\n")) array(Per::cell, f_.cells_);
    array(Per::point, f_.points_);
    s_.expect("      </Points>\n");
    f_.corners_ = s_.take("      <Lines>\n") ? 2 : s_.take("      <Polys>\n") ? 3 : 1;
    if (f_.corners_ == 1) s_.expect("      <Verts>\n");
    array(Per::end, f_.corners_ * f_.cells_);
    array(Per::end, f_.cells_);
    constexpr const char* ends[] = {"      </Verts>\n", "      </Lines>\n", "      </Polys>\n"};
    s_.expect(ends[f_.corners_ - 1]);
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
    const auto offset = s_.number<std::size_t>();
    if (offset > f_.size_ || (f_.arrays_.empty() && offset != 0)) s_.refuse();
    a.offset = text_size_ + offset;
    s_.expect("\"");
    if (s_.take(">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">")) {
      a.unit = s_.until('<');
      s_.expect("/InformationKey>\n        </DataArray>\n");
    } else {
      s_.expect("/>\n");
    }
    const std::size_t bytes_of_one = size_of(a.type, s_);
    if (a.components == 0) s_.refuse();
    if (tuples > most_bytes() / bytes_of_one / a.components) f_.refuse_size();
    a.size = tuples * a.components * bytes_of_one;
    f_.arrays_.push_back(std::move(a));
  }

  Scanner s_;
  std::size_t text_size_;
  VtpInput& f_;
};

VtpInput::VtpInput(const fs::path& path) : path_(path) {
  const File file = open_file(path, "rb");
  std::error_code e;
  size_ = fs::file_size(path_, e);
  if (e) throw IoError("cannot read " + path_.string() + ": " + e.message());
  const std::string head = read_head(file.get(), path_);
  if (size_ < head.size() + tail.size()) refuse_size();
  Head(head, *this).read();
  std::string end(tail.size(), '\0');
  if (std::fseek(file.get(), -static_cast<long>(tail.size()), SEEK_END) != 0 ||
      std::fread(end.data(), 1, end.size(), file.get()) != end.size() || end != tail) {
    require_read(file.get(), path_);
    refuse_size();
  }
}

void VtpInput::refuse_size() const {
  throw IoError(path_.string() + ": is cut short or damaged: its size is not what its head says");
}

void VtpInput::refuse_damaged(const Array& a) const {
  throw IoError(path_.string() + ": is damaged at array \"" + a.name + '"');
}

void VtpInput::refuse_array(Per per, const std::string& name, const char* type) const {
  throw IoError(path_.string() + ": has no array \"" + name + "\" of type " + type + " for each " +
                (per == Per::point  ? "point"
                 : per == Per::cell ? "cell"
                                    : "end of a cell") +
                "; was it written by another version of vbond?");
}

const VtpInput::Array* VtpInput::find(Per per, const std::string& name, std::size_t components) const {
  const auto is_it = [&name](const Array& a) { return a.name == name; };
  const auto at = std::find_if(arrays_.begin(), arrays_.end(), is_it);
  const bool found = at != arrays_.end() && at->per == per && at->components == components &&
                     std::none_of(at + 1, arrays_.end(), is_it);
  return found ? &*at : nullptr;
}

/// What stands in the file, counted from the beginning of the array's own bytes.
std::string VtpInput::bytes_at(std::FILE* f, const Array& a, std::size_t from, std::size_t size) const {
  if (from > a.stored || size > a.stored - from) refuse_damaged(a);
  std::string bytes(size, '\0');
  if (std::fseek(f, static_cast<long>(a.offset + from), SEEK_SET) != 0 ||
      std::fread(bytes.data(), 1, size, f) != size) {
    require_read(f, path_);
    refuse_damaged(a);
  }
  return bytes;
}

void VtpInput::read_plain(std::FILE* f, const Array& a, std::vector<char>& to) const {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes_at(f, a, 0, sizeof size).data(), sizeof size);
  if (size != a.size) refuse_damaged(a);
  to.resize(a.size);
  if (std::fread(to.data(), 1, a.size, f) != a.size) {
    require_read(f, path_);
    refuse_damaged(a);
  }
}

/// Block by block, so that a forged size takes no more memory than there are blocks for.
void VtpInput::read_blocks(std::FILE* f, const Array& a, std::vector<char>& to) const {
  ZlibHead head;
  const std::string numbers = bytes_at(f, a, 0, ZlibHead::fixed);
  for (std::size_t k = 0; std::uint64_t * x : {&head.blocks, &head.block_size, &head.last_size})
    std::memcpy(x, numbers.data() + sizeof *x * k++, sizeof *x);
  if (!fits(head, a.size, a.stored)) refuse_damaged(a);
  head.compressed.resize(head.blocks);
  const std::string sizes = bytes_at(f, a, ZlibHead::fixed, head.blocks * sizeof(std::uint64_t));
  if (!sizes.empty()) std::memcpy(head.compressed.data(), sizes.data(), sizes.size());
  std::size_t from = head.head_size();
  for (std::uint64_t k = 0; k < head.blocks; ++k) {
    const std::string block = bytes_at(f, a, from, head.compressed[k]);
    const std::size_t done = to.size(), size = head.size_of(k);
    if (size > most_inflated * block.size()) refuse_damaged(a);
    to.resize(done + size);
    if (!inflate_block(block, to.data() + done, size)) refuse_damaged(a);
    from += block.size();
  }
  if (from != a.stored) refuse_damaged(a);
}

template <class T, class Stored>
std::vector<T> VtpInput::values_of(const Array& a) const {
  const File file = open_file(path_, "rb");
  std::vector<char> bytes;
  compressed_ ? read_blocks(file.get(), a, bytes) : read_plain(file.get(), a, bytes);
  std::vector<Stored> values(a.size / sizeof(Stored));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  if constexpr (std::is_same_v<T, Stored>)
    return values;
  else
    return std::vector<T>(values.begin(), values.end());
}

std::vector<double> VtpInput::reals(Per per, const std::string& name, std::size_t components) const {
  const Array* a = find(per, name, components);
  if (a && a->type == "Float64") return values_of<double, double>(*a);
  if (a && a->type == "Float32") return values_of<double, float>(*a);
  refuse_array(per, name, "Float64 or Float32");
}

std::vector<double> VtpInput::scalars(Per per, const std::string& name) const {
  return reals(per, name, 1);
}
std::vector<Vec3d> VtpInput::vectors(Per per, const std::string& name) const {
  const std::vector<double> x = reals(per, name, 3);
  std::vector<Vec3d> vectors(x.size() / 3);
  for (std::size_t k = 0; k < vectors.size(); ++k) vectors[k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
  return vectors;
}
std::vector<Image> VtpInput::images(Per per, const std::string& name) const {
  const Array* a = find(per, name, 3);
  if (!a || a->type != "Int32") refuse_array(per, name, "Int32, three numbers each,");
  const std::vector<std::int32_t> x = values_of<std::int32_t, std::int32_t>(*a);
  std::vector<Image> images(x.size() / 3);
  for (std::size_t k = 0; k < images.size(); ++k) images[k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
  return images;
}
std::vector<std::int64_t> VtpInput::integers(Per per, const std::string& name) const {
  const Array* a = find(per, name, 1);
  if (a && a->type == "Int64") return values_of<std::int64_t, std::int64_t>(*a);
  if (a && a->type == "Int32") return values_of<std::int64_t, std::int32_t>(*a);
  refuse_array(per, name, "Int64 or Int32");
}
std::vector<std::uint8_t> VtpInput::bytes(Per per, const std::string& name) const {
  const Array* a = find(per, name, 1);
  if (a && a->type == "UInt8") return values_of<std::uint8_t, std::uint8_t>(*a);
  refuse_array(per, name, "UInt8");
}

bool VtpInput::has(Per per, const std::string& name) const {
  return std::any_of(arrays_.begin(), arrays_.end(),
                     [&](const Array& a) { return a.per == per && a.name == name; });
}

std::string VtpInput::unit(const std::string& name) const {
  for (const Array& a : arrays_)
    if (a.name == name) return a.unit;
  return {};
}

}  // namespace vbond
