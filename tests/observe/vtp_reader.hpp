#pragma once
#include <gtest/gtest.h>
#include <zlib.h>

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
    std::string unit;        ///< the label that its information key gives
    std::size_t stored = 0;  ///< bytes that it takes in the file

    template <class T>
    std::vector<T> as() const {
      std::vector<T> values(bytes.size() / sizeof(T));
      if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
      return values;
    }
    /// Of 32 or 64 bits.
    std::vector<double> reals() const {
      if (type == "Float64") return as<double>();
      EXPECT_EQ(type, "Float32");
      const auto single = as<float>();
      return {single.begin(), single.end()};
    }
    std::vector<std::int64_t> integers() const {
      if (type == "Int64") return as<std::int64_t>();
      EXPECT_EQ(type, "Int32");
      const auto narrow = as<std::int32_t>();
      return {narrow.begin(), narrow.end()};
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
    const std::string compressor = attribute(root, "compressor");
    EXPECT_TRUE(compressor.empty() || compressor == "vtkZLibDataCompressor") << compressor;
    compressed = !compressor.empty();
    const std::string piece = tag_at(xml, xml.find("<Piece"));
    points = std::stoull(attribute(piece, "NumberOfPoints"));
    verts = std::stoull(attribute(piece, "NumberOfVerts"));
    lines = std::stoull(attribute(piece, "NumberOfLines"));
    polys = std::stoull(attribute(piece, "NumberOfPolys"));
    read_arrays(xml, file, underscore + 1);
  }

  bool compressed = false;
  std::size_t points = 0, verts = 0, lines = 0, polys = 0;
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
    const std::vector<std::string> sections{"FieldData", "PointData", "CellData", "Points",
                                            "Verts",     "Lines",     "Polys"};
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
      const std::string components = attribute(tag, "NumberOfComponents");
      Array a{section, attribute(tag, "type"), components.empty() ? 1 : std::stoull(components), {}, {}, 0};
      compressed ? read_blocks(file, base + offset, a) : read_plain(file, base + offset, a);
      const std::string label = "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">";
      const std::size_t inside = xml.find_first_not_of(" \n", xml.find('>', at) + 1);
      if (tag.back() != '/' && xml.compare(inside, label.size(), label) == 0)
        a.unit = xml.substr(inside + label.size(), xml.find('<', inside + 1) - inside - label.size());
      next_offset = offset + a.stored;
      arrays[name] = std::move(a);
    }
    after_arrays = file.substr(base + next_offset);
  }

  static std::uint64_t number_at(const std::string& file, std::size_t at) {
    std::uint64_t x = 0;
    EXPECT_LE(at + sizeof x, file.size());
    if (at + sizeof x <= file.size()) std::memcpy(&x, file.data() + at, sizeof x);
    return x;
  }
  static void read_plain(const std::string& file, std::size_t at, Array& a) {
    const std::uint64_t size = number_at(file, at);
    a.stored = sizeof size + size;
    ASSERT_LE(at + a.stored, file.size());
    a.bytes = file.substr(at + sizeof size, size);
  }
  static void read_blocks(const std::string& file, std::size_t at, Array& a) {
    const std::uint64_t blocks = number_at(file, at), full = number_at(file, at + 8),
                        last = number_at(file, at + 16);
    std::size_t from = at + 24 + 8 * blocks;
    for (std::uint64_t k = 0; k < blocks; ++k) {
      const std::uint64_t size = number_at(file, at + 24 + 8 * k);
      ASSERT_LE(from + size, file.size());
      std::string block(k + 1 == blocks && last > 0 ? last : full, '\0');
      uLongf room = block.size();
      ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &room,
                           reinterpret_cast<const Bytef*>(file.data() + from), size),
                Z_OK);
      ASSERT_EQ(room, block.size());
      a.bytes += block;
      from += size;
    }
    a.stored = from - at;
  }
};

}  // namespace vbond::test
