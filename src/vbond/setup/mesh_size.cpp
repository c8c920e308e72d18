#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "vbond/setup/mesh_file.hpp"
#include "vbond/setup/text_file.hpp"

/// Whether the numbers at the head of a file fit its length. Formats: STL as 3D Systems wrote it down (1989);
/// PLY by G. Turk (1994).
namespace vbond {
namespace {

constexpr std::size_t stl_head = 84, stl_triangle = 50;

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}

/// The next word; empty at the end.
std::string_view next_word(std::string_view& text) {
  constexpr const char* blanks = " \t\r\n\v\f";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return text = {};
  const std::size_t end = std::min(text.find_first_of(blanks, first), text.size());
  const std::string_view word = text.substr(first, end - first);
  text.remove_prefix(end);
  return word;
}

std::string mistake_in_ascii_stl(std::string_view text) {
  std::size_t facets = 0, ends = 0, corners = 0;
  bool closed = false;
  next_word(text);  // solid
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
    if (word == "facet") ++facets;
    if (word == "vertex") ++corners;
    if (word == "endfacet") ++ends;
    closed = word == "endsolid" || (closed && word != "facet");
  }
  if (facets == 0) return "it has no triangles";
  if (ends != facets || corners != 3 * facets)
    return fmt::format("it is not whole: {} times facet, {} times endfacet, {} times vertex", facets, ends,
                       corners);
  return closed ? "" : "it is cut off: there is no endsolid";
}

std::string mistake_in_stl(std::string_view content) {
  const bool has_head = content.size() >= stl_head;
  const std::uint64_t triangles = has_head ? little_endian(content.substr(80, 4)) : 0;
  const std::uint64_t needed = stl_head + stl_triangle * triangles;
  // Assimp 5.2 reckons in 32 bits and would take the file for a binary one.
  const bool wraps = needed != content.size() && static_cast<std::uint32_t>(needed) == content.size();
  std::string_view text = content;
  if (!wraps && next_word(text) == "solid" && !(has_head && needed == content.size()))
    return mistake_in_ascii_stl(content);
  if (!has_head)
    return fmt::format("its {} bytes are less than the head of a binary STL file", content.size());
  if (triangles == 0) return "it has no triangles";
  if (needed != content.size())
    return fmt::format("it claims {} triangles, which take {} bytes, and has {}", triangles, needed,
                       content.size());
  return "";
}

struct PlyProperty {
  std::size_t size = 0, count_size = 0;  ///< in bytes; of a list: its elements and its count
};
struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t ply_size(std::string_view type) {
  struct Type {
    const char *name, *other;
    std::size_t size;
  };
  static constexpr std::array types{Type{"char", "int8", 1},     Type{"uchar", "uint8", 1},
                                    Type{"short", "int16", 2},   Type{"ushort", "uint16", 2},
                                    Type{"int", "int32", 4},     Type{"uint", "uint32", 4},
                                    Type{"float", "float32", 4}, Type{"double", "float64", 8}};
  for (const Type& t : types)
    if (type == t.name || type == t.other) return t.size;
  return 0;
}

/// Walks through a PLY file as far as its length says whether it is whole.
class PlyWalk {
 public:
  explicit PlyWalk(std::string_view content) : rest_(content) {}

  std::string mistake() {
    if (std::string wrong = read_head(); !wrong.empty()) return wrong;
    std::uint64_t faces = 0;
    for (const PlyElement& e : elements_) {
      if (e.name == "face") faces += e.count;
      std::uint64_t least = 0;  // bytes of one row
      for (const PlyProperty& p : e.properties)
        least += ascii_ ? 2 : p.count_size > 0 ? p.count_size : p.size;
      if (e.properties.empty() && e.count > 0) return "an element of it has no properties";
      if (e.count > rest_.size() / std::max<std::uint64_t>(least, 1) + 1)
        return fmt::format("it claims {} rows of at least {} bytes, and {} bytes are left", e.count, least,
                           rest_.size());
      for (std::uint64_t row = 0; row < e.count; ++row) {
        if (ascii_ && !begins_row())
          return fmt::format("it is cut off: row {} of {} is not there", row + 1, e.count);
        if (std::string wrong = ascii_ ? mistake_in_row(e, words_of(line())) : ""; !wrong.empty())
          return fmt::format("row {} of {} of element {} {}", row + 1, e.count, e.name, wrong);
        if (!ascii_ && !pass(e))
          return fmt::format("it is cut off: row {} of {} is not whole", row + 1, e.count);
      }
    }
    return faces == 0 ? "it has no triangles" : "";
  }

 private:
  std::string_view line() {
    const std::size_t end = rest_.find('\n');
    std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  std::string read_head() {
    if (line() != "ply") return "it does not begin with the line ply";
    constexpr int most = 1000;  // Assimp takes a time that grows with the square of this number
    for (int lines = 0; !rest_.empty();) {
      const std::vector<std::string_view> words = words_of(line());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (++lines > most) return fmt::format("its head has more than {} lines besides comments", most);
      if (words[0] == "end_header") return "";
      if (words[0] == "format" && words.size() > 1) {
        ascii_ = words[1] == "ascii";
        big_endian_ = words[1] == "binary_big_endian";
      } else if (words[0] == "element" && words.size() == 3) {
        const auto count = to_integer(words[2]);
        if (!count || *count < 0) return fmt::format("it claims \"{}\" rows", words[2]);
        elements_.push_back({words[1], static_cast<std::uint64_t>(*count), {}});
      } else if (words[0] == "property" && !elements_.empty() && read_property(words)) {
        continue;
      } else {
        return fmt::format("its head has a line that begins with \"{}\"", words[0]);
      }
    }
    return "it is cut off: there is no end_header";
  }

  bool read_property(const std::vector<std::string_view>& words) {
    PlyProperty p;
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) return false;
    p.size = ply_size(words[list ? 3 : 1]);
    p.count_size = list ? ply_size(words[2]) : 0;
    elements_.back().properties.push_back(p);
    return p.size > 0 && (!list || (p.count_size > 0 && p.count_size <= 4));
  }

  bool skip(std::uint64_t bytes) {
    if (bytes > rest_.size()) return false;
    rest_.remove_prefix(bytes);
    return true;
  }

  /// Goes to the next line that is not empty; false if there is none.
  bool begins_row() {
    const std::size_t first = rest_.find_first_not_of(" \t\r\n\v\f");
    if (first == std::string_view::npos) return false;
    const std::size_t end = rest_.substr(0, first).rfind('\n');
    rest_.remove_prefix(end == std::string_view::npos ? 0 : end + 1);
    return true;
  }

  /// A row stands on a line of its own; Assimp reads another one wrongly, and says nothing.
  static std::string mistake_in_row(const PlyElement& e, const std::vector<std::string_view>& words) {
    std::size_t needed = 0;
    for (const PlyProperty& p : e.properties) {
      ++needed;
      if (p.count_size == 0 || needed > words.size()) continue;
      const auto count = to_integer(words[needed - 1]);
      if (!count || *count < 0 || *count > 0xFFFFFFFF)
        return fmt::format("has a list of \"{}\" numbers", words[needed - 1]);
      needed += static_cast<std::size_t>(*count);
    }
    if (words.size() == needed) return "";
    return fmt::format("has {} numbers on its line, which is too {}: {} belong there", words.size(),
                       words.size() < needed ? "few" : "many", needed);
  }

  /// Goes past one row of a binary file; false if the file ends in it.
  bool pass(const PlyElement& e) {
    return std::all_of(e.properties.begin(), e.properties.end(), [&](const PlyProperty& p) {
      if (p.count_size == 0) return skip(p.size);
      if (p.count_size > rest_.size()) return false;
      std::uint64_t count = 0;
      for (std::size_t k = 0; k < p.count_size; ++k)
        count = count << 8 | static_cast<unsigned char>(rest_[big_endian_ ? k : p.count_size - 1 - k]);
      return skip(p.count_size) && skip(count * p.size);
    });
  }

  std::string_view rest_;
  bool ascii_ = false, big_endian_ = false;
  std::vector<PlyElement> elements_;
};

}  // namespace

std::string mistake_in_size(std::string_view content, MeshFormat format) {
  if (content.empty()) return "it is empty";
  switch (format) {
    case MeshFormat::stl: return mistake_in_stl(content);
    case MeshFormat::ply: return PlyWalk(content).mistake();
    case MeshFormat::obj: break;  // claims nothing
  }
  return "";
}

}  // namespace vbond
