#include <algorithm>
#include <cstddef>

#include "vbond/setup/mesh_file.hpp"

/// What a file of triangles says besides its places and faces is left out before Assimp sees it: texture
/// coordinates that a face names and the file does not have would be errors, and many comments, objects or
/// materials would take a time that grows with their square.
namespace vbond {
namespace {

constexpr const char* blanks = " \t\r\v\f";

/// The next line, without its end; OBJ files go on with it where it ends with a backslash.
std::string next_line(std::string_view& text, bool goes_on) {
  std::string line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!part.empty() && part.back() == '\r') part.remove_suffix(1);
    const bool more = goes_on && !part.empty() && part.back() == '\\';
    if (more) part.remove_suffix(1);
    line += part;
    if (!more) break;
    line += ' ';
  }
  return line;
}

std::string_view first_word(std::string_view line) {
  const std::size_t first = line.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_first_of(blanks, first) - first);
}

/// The corners of a face, line or point without their texture coordinates and normals: 7/1/2 becomes 7.
void append_corners(std::string_view line, std::string& to) {
  bool after_slash = false;
  for (const char c : line) {
    if (std::string_view(blanks).find(c) != std::string_view::npos) after_slash = false;
    if (c == '/') after_slash = true;
    if (!after_slash) to += c;
  }
}

std::string plain_obj(std::string_view content) {
  std::string plain;
  while (!content.empty()) {
    const std::string all = next_line(content, true);
    const std::string_view line = std::string_view(all).substr(0, all.find('#')), what = first_word(line);
    if (what == "v")
      plain += line;
    else if (what == "f" || what == "l" || what == "p")
      append_corners(line, plain);
    else
      continue;
    plain += '\n';
  }
  return plain;
}

std::string plain_ply(std::string_view content) {
  std::string plain;
  while (!content.empty()) {
    const std::string line = next_line(content, false);
    const std::string_view what = first_word(line);
    if (what.empty() || what == "comment" || what == "obj_info") continue;
    plain += line;
    plain += '\n';
    if (what == "end_header") break;
  }
  plain += content;
  return plain;
}

}  // namespace

std::string places_and_faces(std::string content, MeshFormat format) {
  switch (format) {
    case MeshFormat::stl: break;
    case MeshFormat::obj: return plain_obj(content);
    case MeshFormat::ply: return plain_ply(content);
  }
  return content;
}

}  // namespace vbond
