#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace vbond::test {

/// A reader of the part of .vtp that vbond writes, made from the format's description and sharing
/// nothing with the writer: it scans attributes, then follows the offsets into the appended bytes.
class VtpReader {
 public:
  struct Array {
    std::string section, type;
    std::size_t components = 1;
    std::string bytes;

    template <class T>
    std::vector<T> as() const {
      std::vector<T> values(bytes.size() / sizeof(T));
      if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
      return values;
    }
  };

  explicit VtpReader(const std::string& file) {
    const std::string marker = "<AppendedData encoding=\"raw\">";
    const std::size_t appended = file.find(marker);
    const std::size_t underscore = file.find('_', appended);
    EXPECT_NE(appended, std::string::npos);
    EXPECT_NE(underscore, std::string::npos);
    const std::string xml = file.substr(0, appended);
    const std::string root = tag_at(xml, xml.find("<VTKFile"));
    EXPECT_EQ(attribute(root, "type"), "PolyData");
    EXPECT_EQ(attribute(root, "byte_order"), "LittleEndian");
    EXPECT_EQ(attribute(root, "header_type"), "UInt64");
    const std::string piece = tag_at(xml, xml.find("<Piece"));
    points = std::stoull(attribute(piece, "NumberOfPoints"));
    verts = std::stoull(attribute(piece, "NumberOfVerts"));
    lines = std::stoull(attribute(piece, "NumberOfLines"));
    read_arrays(xml, file, underscore + 1);
  }

  std::size_t points = 0, verts = 0, lines = 0;
  std::map<std::string, Array> arrays;         ///< appended, by name
  std::map<std::string, std::string> in_text;  ///< ascii, by name
  std::string after_arrays;                    ///< what follows the last appended array

 private:
  static std::string tag_at(const std::string& xml, std::size_t at) {
    return xml.substr(at, xml.find('>', at) - at);
  }
  static std::string attribute(const std::string& tag, const std::string& name) {
    const std::string key = " " + name + "=\"";
    const std::size_t at = tag.find(key);
    if (at == std::string::npos) return {};
    const std::size_t from = at + key.size();
    return tag.substr(from, tag.find('"', from) - from);
  }

  void read_arrays(const std::string& xml, const std::string& file, std::size_t base) {
    const std::vector<std::string> sections{"FieldData", "PointData", "CellData", "Points", "Verts", "Lines"};
    std::string section;
    std::size_t next_offset = 0;
    for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
      for (const std::string& s : sections)
        if (xml.compare(at, s.size() + 2, "<" + s + ">") == 0) section = s;
      if (xml.compare(at, 10, "<DataArray") != 0) continue;
      const std::string tag = tag_at(xml, at);
      const std::string name = attribute(tag, "Name");
      if (attribute(tag, "format") == "ascii") {
        const std::size_t from = xml.find('>', at) + 1;
        in_text[name] = xml.substr(from, xml.find('<', from) - from);
        continue;
      }
      const std::size_t offset = std::stoull(attribute(tag, "offset"));
      EXPECT_EQ(offset, next_offset) << name << ": arrays must follow each other without a gap";
      std::uint64_t size = 0;
      ASSERT_LE(base + offset + sizeof size, file.size()) << name;
      std::memcpy(&size, file.data() + base + offset, sizeof size);
      ASSERT_LE(base + offset + sizeof size + size, file.size()) << name;
      const std::string components = attribute(tag, "NumberOfComponents");
      arrays[name] = {section, attribute(tag, "type"), components.empty() ? 1 : std::stoull(components),
                      file.substr(base + offset + sizeof size, size)};
      next_offset = offset + sizeof size + size;
    }
    after_arrays = file.substr(base + next_offset);
  }
};

}  // namespace vbond::test
