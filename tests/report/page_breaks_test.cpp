// What the report page holds of bonds that break.
#include <gtest/gtest.h>

#include <cmath>

#include "page_reader.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/report/page.hpp"
#include "vbond/report/vtp_read.hpp"

namespace vbond::page::page_breaks_test {
namespace {

using test::array_of;
using test::Chain;
using test::Folder;
using test::json_of;
using test::one_line;
constexpr std::size_t particles = 4, bonds = 3, frames = 4;

/// A chain whose second bond is broken by shear from the third frame on, and flies apart.
struct Film {
  Folder folder;
  explicit Film(FrameFormat format, BreakMode mode = BreakMode::shear) {
    Chain chain(particles);
    FrameWriter writer(folder.path(), false, {}, format);
    for (std::size_t f = 0; f < frames; ++f) {
      State s = chain.state;
      s.clock.step = s.clock.stage_step = static_cast<std::int64_t>(10 * f);
      const auto x = static_cast<double>(f);
      s.r[ParticleId{0}].x -= 0.01 * x;
      s.r[ParticleId{2}].x += 7.0 * x * x, s.r[ParticleId{3}].x += 7.0 * x * x;
      s.q[ParticleId{3}] = rotation_of(Vec3d{0.2 * x, 0, 0.1 * x});
      s.bonds[BondId{1}].broken = f >= 2;
      s.bonds[BondId{1}].mode = f >= 2 ? mode : BreakMode::none;
      writer.write(chain.model, s);
    }
  }
  std::vector<FrameFiles> files() const {
    return listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
  }
  Report report(SequenceKind kind) const {
    Report r;
    r.sequences.push_back(read_sequence({kind, "", "", "", files()}, r.body));
    r.stage_of_frame.assign(frames, "pull");
    return r;
  }
};

std::vector<std::string> field_keys(const nlohmann::json& sequence) {
  std::vector<std::string> keys;
  for (const auto& field : sequence["bond_fields"]) keys.push_back(field["key"]);
  return keys;
}

const std::vector<std::string> keys_of_all{"elongation", "bend", "twist", "U_L", "U_B", "U_T"};

TEST(PageBreaks, CausesFragmentsAndLoadsAreThoseOfTheFrames) {
  const Film film({.breaks = true});
  Report report = film.report(SequenceKind::run);
  report.units = UnitSystem::si;
  const std::string html = report_page(one_line, report, {});
  const auto s = json_of(html)["sequences"][0];
  EXPECT_EQ(array_of(html, s["bond_broken"]), (std::vector<double>{0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 2, 0}));
  EXPECT_EQ(array_of(html, s["fragment"]),
            (std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0}));  // 2, 3 are heavier
  std::vector<std::string> keys = keys_of_all;
  for (const char* more : {"utilisation", "axial_force", "shear_force", "bending_moment", "torque"})
    keys.emplace_back(more);
  EXPECT_EQ(field_keys(s), keys);
  for (std::size_t k = fields_of_all_runs; k < fields_with_breaks; ++k) {
    const auto& field = s["bond_fields"][k];
    const std::vector<double> back = array_of(html, field["array"]);
    for (std::size_t f = 0; f < frames; ++f) {
      const std::vector<double> written =
          VtpInput(film.files()[f].bonds).scalars(VtpInput::Per::cell, bond_fields[k].array);
      for (std::size_t b = 0; b < bonds; ++b)
        EXPECT_NEAR(back[f * bonds + b], written[b], 0.51 * field["array"]["step"].get<double>())
            << field["key"] << " of bond " << b << " in frame " << f;
    }
  }
  EXPECT_EQ(s["bond_fields"][7]["unit"], "N");
  EXPECT_EQ(s["bond_fields"][9]["unit"], "N m");
  EXPECT_TRUE(s["bond_fields"][7]["signed"]);
}

TEST(PageBreaks, TheShapeOfABrokenBondTakesNoPartInTheScales) {
  const Film film({.breaks = true});
  const Report report = film.report(SequenceKind::run);
  const Sequence& s = report.sequences[0];
  // whole, the bond was longer by 7 in the second frame; broken, it is by up to 63
  EXPECT_NEAR(s.fields[0].low + 255.0 * s.fields[0].step, 7.0, 0.1);
  for (std::size_t k = 0; k < fields_with_breaks; ++k)
    EXPECT_NEAR(s.fields[k].low + s.fields[k].step * s.frames[3].fields[k][1], 0.0, 0.51 * s.fields[k].step)
        << bond_fields[k].key;
  EXPECT_EQ(s.frames[3].range[1], 0);
}

TEST(PageBreaks, WhatHasBecomeOfBondsThatFlowIsShownWhereFramesTellIt) {
  const Film film({.breaks = true, .flow = true}), no_breaks({.flow = true}), without({});
  const auto keys = [](const Film& f, SequenceKind kind) {
    return field_keys(json_of(report_page(one_line, f.report(kind), {}))["sequences"][0]);
  };
  EXPECT_EQ(keys(film, SequenceKind::run).size(), bond_field_count);
  EXPECT_EQ(keys(film, SequenceKind::run).back(), "damage");
  std::vector<std::string> expected = keys_of_all;
  for (std::size_t k = fields_with_breaks; k < bond_field_count; ++k)
    expected.emplace_back(bond_fields[k].key);
  EXPECT_EQ(keys(no_breaks, SequenceKind::run), expected);
  EXPECT_EQ(keys(no_breaks, SequenceKind::mode), keys_of_all);
  std::vector<FrameFiles> mixed = no_breaks.files();
  mixed[1] = without.files()[1];
  Body body;
  EXPECT_FALSE(read_sequence({SequenceKind::run, "", "", "", mixed}, body).flows);
}

TEST(PageBreaks, RunsWithoutStrengthHaveNoneOfIt) {
  const Film film({});
  const std::string html = report_page(one_line, film.report(SequenceKind::run), {});
  const auto j = json_of(html), s = j["sequences"][0];
  EXPECT_EQ(field_keys(s), keys_of_all);
  for (const char* key : {"bond_broken", "fragment"}) EXPECT_FALSE(s.contains(key)) << key;
  EXPECT_FALSE(j.contains("breaks"));
}

TEST(PageBreaks, NothingIsSaidOfFragmentsWhileTheBodyIsWhole) {
  const Film film({.breaks = true});
  Report report;
  report.sequences.push_back(
      read_sequence({SequenceKind::run, "", "", "", {film.files()[0], film.files()[1]}}, report.body));
  report.stage_of_frame.assign(2, "pull");
  const auto s = json_of(report_page(one_line, report, {}))["sequences"][0];
  EXPECT_EQ(field_keys(s).size(), fields_with_breaks);
  for (const char* key : {"bond_broken", "fragment"}) EXPECT_FALSE(s.contains(key)) << key;
}

TEST(PageBreaks, AModeHasBrokenBondsButNoLoads) {
  const Film film({.breaks = true});
  const auto s = json_of(report_page(one_line, film.report(SequenceKind::mode), {}))["sequences"][0];
  EXPECT_EQ(field_keys(s), keys_of_all);
  EXPECT_TRUE(s.contains("bond_broken"));
}

TEST(PageBreaks, MixedFramesAreShownWithoutBreaks) {
  const Film with({.breaks = true}), without({});
  std::vector<FrameFiles> mixed = with.files();
  mixed[1] = without.files()[1];
  Body body;
  const Sequence s = read_sequence({SequenceKind::run, "", "", "", mixed}, body);
  EXPECT_FALSE(s.may_break);
  EXPECT_FALSE(s.has_field(fields_of_all_runs));
  EXPECT_TRUE(s.frames[3].broken.empty());
  EXPECT_TRUE(s.frames[3].fields[fields_of_all_runs].empty());
}

TEST(PageBreaks, AnUnknownCauseIsRefused) {
  const Film film({.breaks = true}, static_cast<BreakMode>(7));
  Body body;
  try {
    read_sequence({SequenceKind::run, "", "", "", film.files()}, body);
    ADD_FAILURE() << "accepted";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("a bond broke in no way"), std::string::npos) << e.what();
  }
}

TEST(PageBreaks, FramesTakeAsMuchRoomAsIsSaid) {
  for (const bool breaks : {false, true}) {
    const Film film({.breaks = breaks});
    const Report report = film.report(SequenceKind::run);
    const QuantisedFrame& f = report.sequences[0].frames[3];
    std::size_t bytes =
        2 * f.displacement.size() + f.speed.size() + f.range.size() + f.broken.size() + 2 * f.fragment.size();
    for (const auto& field : f.fields) bytes += field.size();
    EXPECT_EQ(bytes_of_frame(film.files()[3]), bytes);
  }
}

TEST(PageBreaks, TheListSaysWhatVbondBreaksSays) {
  Report r;
  r.units = UnitSystem::si;
  BreakTold b{.bond = 12,
              .i = 7,
              .j = 8,
              .step = 40,
              .time = 0.125,
              .criterion = "stress",
              .mode = "bending",
              .failure = {0.25, 0, 0.75, 0, 0, 1.0},
              .limit = 12e6,
              .energy = 2.5e-4};
  r.breaks = {{b}, 240, {{"bending", 240}}};
  const auto j = json_of(report_page(one_line, r, {}))["breaks"];
  EXPECT_EQ(j["count"], 240);
  EXPECT_EQ(j["words"], in_words(r.breaks));
  ASSERT_EQ(j["first"].size(), 1U);
  const auto& row = j["first"][0];
  EXPECT_EQ(row["cause"], "N/A + M_b r/J = 3 + 9 = 12 of 12 MPa");
  EXPECT_NE(in_words(b, r.units).find(row["cause"].get<std::string>()), std::string::npos);
  EXPECT_EQ(row["mode"], 3);
  EXPECT_EQ(row["bond"], 12);
  EXPECT_EQ(row["j"], 8);
  EXPECT_EQ(row["step"], 40);
  EXPECT_EQ(row["when"], "t = 0.125 s");
  EXPECT_EQ(row["energy"], 2.5e-4);
  r.breaks.first[0].at_rest = true, r.breaks.first[0].load_factor = 0.75;
  EXPECT_EQ(json_of(report_page(one_line, r, {}))["breaks"]["first"][0]["when"], "load factor 0.75");
}

TEST(PageBreaks, CausesHaveTheNumbersOfTheFrames) {
  for (const BreakMode mode : {BreakMode::tension, BreakMode::shear, BreakMode::bending, BreakMode::torsion,
                               BreakMode::compression, BreakMode::other})
    EXPECT_EQ(break_mode(vbond::to_text(mode)), mode);
  EXPECT_EQ(break_mode("?"), BreakMode::other);
}

}  // namespace
}  // namespace vbond::page::page_breaks_test
