// The packer of the program and the decoder of the page meet in tests/data/page.html: this test holds the
// packer against it, web/test/fixture.test.mjs the decoder. Both know what its numbers stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "page_reader.hpp"
#include "specimen.hpp"
#include "vbond/report/page.hpp"

namespace vbond::page {
namespace {

constexpr std::size_t particles = 3, bonds = 2;

/// Goes around 2^16 and 2^8 from frame to frame, so that differences do.
std::uint16_t displacement_of(std::size_t frame, std::size_t component, std::size_t particle) {
  return static_cast<std::uint16_t>(30000 * frame + 3001 * component + 17 * particle);
}
std::uint8_t field_of(std::size_t frame, std::size_t field, std::size_t bond) {
  return static_cast<std::uint8_t>(100 * frame + 11 * field + 5 * bond);
}

/// Of four frames: not told in the first, none in the last, and one with a wall in the third.
Contacts known_contacts() {
  Contacts c;
  c.shift = {-0.5, 0x1p-8};
  c.frames.resize(4);
  c.frames[1] = {true, {0}, {2}, {3}, {-1.0, 0.5}, {}};
  c.frames[2] = {true, {0, 1}, {1, 1}, {255, 0}, {2.0, 0x1p-4}, {128, 128, 128, 0, 64, 255}};
  c.frames[3].written = true;
  return c;
}

Sequence sequence(SequenceKind kind, std::size_t frames) {
  Sequence s{.kind = kind,
             .name = kind == SequenceKind::run ? "Run" : "Mode 1 of stage \"<b>\"",
             .note = kind == SequenceKind::run ? "" : "frequency 2 Hz & more",
             .origin = {1e8, 0.25, -3e12},
             .reference = {-1.5F, 0, 0, 0, 0.5F, 0, 1.5F, 0, -0.125F},
             .displacement = {Range{-1.0, 0x1p-10}, Range{0.0, 0x1p-12}, Range{2.0, 0.0}},
             .speed = {0.0, 0x1p-3},
             .fields = {},
             .may_break = kind == SequenceKind::run,
             .frames = {}};
  for (std::size_t k = 0; k < bond_field_count; ++k)
    s.fields[k] = {-static_cast<double>(k), std::ldexp(1.0, -static_cast<int>(k))};
  for (std::size_t f = 0; f < frames; ++f) {
    QuantisedFrame frame;
    frame.step = static_cast<std::int64_t>(10 * f);
    frame.time = 0.5 * static_cast<double>(f);
    const std::size_t exist = f == 0 && kind == SequenceKind::run ? 1 : bonds;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t p = 0; p < particles; ++p) frame.displacement.push_back(displacement_of(f, c, p));
    if (kind == SequenceKind::run)
      for (std::size_t p = 0; p < particles; ++p) frame.speed.push_back(field_of(f, 7, p));
    for (std::size_t k = 0; k < bond_field_count; ++k)
      for (std::size_t b = 0; s.has_field(k) && b < exist; ++b) frame.fields[k].push_back(field_of(f, k, b));
    for (std::size_t b = 0; b < exist; ++b) frame.range.push_back(static_cast<std::uint8_t>((f + b) % 3));
    if (s.may_break) {
      for (std::size_t b = 0; b < exist; ++b)
        frame.broken.push_back(static_cast<std::uint8_t>(b == 1 && f > 1 ? 5 : 0));
      for (std::size_t p = 0; p < particles; ++p)
        frame.fragment.push_back(static_cast<std::uint16_t>(300 * f * p));
    }
    s.frames.push_back(frame);
  }
  if (kind == SequenceKind::run) s.contacts = known_contacts();
  return s;
}

std::string page_of_known_numbers() {
  Report r;
  r.program = "vbond 0.0.0";
  r.title = "</script><script>document.title='run'</script><!-- & \\u003c";
  r.units = UnitSystem::si;
  r.facts = {{"Specimen", "3 particles, 2 bonds"}};
  r.results = {{"<i>", "&amp;"}};
  r.warnings = {{Level::warning, "</SCRIPT>"}};
  r.command = "vbond run resolved.toml";
  r.case_text = "title = \"<!-- run -->\"\n";
  r.history = {{{"step", {0, 10, 20}},
                {"time", {0.0, 0.5, 1.0}},
                {"displacement.1.x", {0.0, -0.5, -1.0}},
                {"axial_force.all", {0.0, NAN, -3.0}}}};
  r.breaks = {{{.bond = 1,
                .i = 1,
                .j = 2,
                .step = 15,
                .time = 0.75,
                .criterion = "stress",
                .mode = "compression",
                .failure = {-0.5, 0, 0, 0, 1.5, 1.5},
                .limit = 2e6,
                .energy = 0.25}},
              1,
              {{"compression", 1}}};
  r.body.radius = {0.25F, 0.5F, 0.75F};
  r.body.bonds = {0, 1, 1, 2};
  r.sequences = {sequence(SequenceKind::run, 4), sequence(SequenceKind::mode, 3)};
  r.stage_of_frame = {"push", "push", "hold", "hold"};
  r.first_shown = 1;
  return report_page("<!doctype html>\n<!-- run -->\n", r, {});
}

/// What a page says, whatever the version of zlib that packed it.
std::pair<nlohmann::json, std::string> content(const std::string& html) {
  return {test::json_of(html), test::gunzipped(test::base64_decoded(test::element(html, "data")))};
}

TEST(PageFixture, IsWhatThePackerWrites) {
  const std::string file = std::string(VBOND_TEST_DATA) + "/page.html";
  if (std::getenv("VBOND_UPDATE_FIXTURE")) test::put_content(file, page_of_known_numbers());
  const auto [packed_json, packed_block] = content(page_of_known_numbers());
  const auto [json, block] = content(test::content_of(file));
  const char* advice =
      "if the format has changed, write the file anew and mend web/test/fixture.test.mjs:\n"
      "  VBOND_UPDATE_FIXTURE=1 build/dev/test_report --gtest_filter='PageFixture.*'";
  EXPECT_EQ(packed_json, json) << advice;
  EXPECT_TRUE(packed_block == block) << advice;
}

}  // namespace
}  // namespace vbond::page
