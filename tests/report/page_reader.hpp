#pragma once
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vbond/report/block.hpp"

namespace vbond::test {

/// The least page that a run can be written into.
constexpr const char* one_line = "<html>\n<!-- run -->\n</html>\n";

/// The way back that the page goes, written from the description of the format.

inline std::vector<double> unpacked(const std::string& block, const page::PackedArray& a) {
  const auto* at = reinterpret_cast<const unsigned char*>(block.data()) + a.offset;
  const std::string type = a.type;
  std::vector<std::uint32_t> q(a.count);
  for (std::size_t k = 0; k < a.count; ++k) {
    q[k] = type == "u8" ? at[k] : at[k] + 256U * at[a.count + k];
    if (a.delta > 0 && k >= a.delta) q[k] = (q[k] + q[k - a.delta]) % (type == "u8" ? 256U : 65536U);
  }
  std::vector<double> values(a.count);
  const std::size_t parts = a.low.size(), part = a.delta > 0 ? a.delta / parts : 1;
  for (std::size_t k = 0; k < a.count; ++k)
    values[k] = a.low[k / part % parts] + a.step[k / part % parts] * q[k];
  return values;
}

inline std::string base64_decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xff);
  }
  return bytes;
}

inline std::string gunzipped(const std::string& packed) {
  z_stream z{};
  EXPECT_EQ(inflateInit2(&z, 15 + 16), Z_OK);
  std::string bytes, chunk(1 << 16, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  z.avail_in = static_cast<uInt>(packed.size());
  int status = Z_OK;
  while (status == Z_OK) {
    z.next_out = reinterpret_cast<Bytef*>(chunk.data());
    z.avail_out = static_cast<uInt>(chunk.size());
    status = inflate(&z, Z_NO_FLUSH);
    bytes.append(chunk.data(), chunk.size() - z.avail_out);
  }
  EXPECT_EQ(status, Z_STREAM_END);
  inflateEnd(&z);
  return bytes;
}

/// What stands in an element of the page, up to its end.
inline std::string element(const std::string& html, const std::string& id) {
  const std::size_t at = html.find("id=\"" + id + "\">");
  EXPECT_NE(at, std::string::npos) << id;
  const std::size_t from = html.find('>', at) + 1;
  return html.substr(from, html.find("</script>", from) - from);
}

inline nlohmann::json json_of(const std::string& html) {
  return nlohmann::json::parse(element(html, "run"));
}

inline std::vector<double> array_of(const std::string& html, const nlohmann::json& j) {
  page::PackedArray a;
  const std::string type = j.at("type").get<std::string>();
  a.offset = j.at("offset").get<std::size_t>();
  a.count = j.at("count").get<std::size_t>();
  const auto all = [](const nlohmann::json& x) {
    return x.is_array() ? x.get<std::vector<double>>() : std::vector<double>{x.get<double>()};
  };
  if (j.contains("low")) a.low = all(j.at("low")), a.step = all(j.at("step"));
  a.delta = j.value("delta", std::size_t{0});
  const std::string block = gunzipped(base64_decoded(element(html, "data")));
  if (type == "f32" || type == "u32") {
    std::vector<double> values(a.count);
    for (std::size_t k = 0; k < a.count; ++k) {
      float f = 0;
      std::uint32_t u = 0;
      std::memcpy(&f, block.data() + a.offset + 4 * k, 4);
      std::memcpy(&u, block.data() + a.offset + 4 * k, 4);
      values[k] = type == "f32" ? static_cast<double>(f) : static_cast<double>(u);
    }
    return values;
  }
  a.type = type == "u8" ? "u8" : "u16";
  return unpacked(block, a);
}

}  // namespace vbond::test
