#include "vbond/report/page.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "page_reader.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/report/vtp_read.hpp"

namespace vbond::page::page_test {
namespace {

using test::array_of;
using test::Chain;
using test::Folder;
using test::json_of;
using test::one_line;

/// Frames of a chain that moves and bends; its second bond is made after the first frame.
struct Film {
  Folder folder;
  std::vector<State> states;
  Report report;

  explicit Film(std::size_t frames = 5, std::size_t particles = 3, FrameFormat format = {}) {
    Chain chain(particles);
    chain.state.bonds[BondId{0}].a = 0.8;  // a strain is not an elongation
    if (format.capsules) set_capsule(chain.state.bonds[BondId{1}], 0.25);
    FrameWriter writer(folder.path(), false, {}, format);
    for (std::size_t f = 0; f < frames; ++f) {
      const auto x = static_cast<double>(f);
      State s = chain.state;
      s.clock.step = s.clock.stage_step = static_cast<std::int64_t>(10 * f);
      for (const ParticleId p : s.r.ids())
        s.r[p] = s.r[p] + Vec3d{0.01 * x * std::sin(1.7 * p.value + x), -0.02 * x, 1e-5 * x * p.value};
      s.q[ParticleId{0}] = rotation_of(Vec3d{0, 0.3 * x, 0});
      if (f == 0) s.bonds.resize(1);
      writer.write(chain.model, s);
      states.push_back(s);
    }
    SequenceFiles files{SequenceKind::run, "Run", "", "",
                        listed_frames(folder / "particles.pvd", folder / "bonds.pvd")};
    report.sequences.push_back(read_sequence(files, report.body));
    report.stage_of_frame.assign(frames, "push");
    report.history = {{{"step", {}}, {"total", {}}}};
    for (std::size_t f = 0; f < frames; ++f) {
      report.history.columns[0].values.push_back(10.0 * static_cast<double>(f));
      report.history.columns[1].values.push_back(1.0);
    }
  }
};

// A plate that moves and turns about a point far from it: R x + t of its first corners is where its file has
// them.
TEST(Page, WallsMoveAsInTheirFiles) {
  const test::Folder folder;
  Chain chain(3);
  chain.model.walls = {{"plate", DiscWall{{5, 0, 0}, {0, 0, 1}, 1.0}, 0, {1, 2, 3}},
                       {"table", PlaneWall{{0, 0, -1}, {0, 0, 1}}, 0, {0, 0, -1}}};
  chain.state.walls.resize(2);
  FrameWriter writer(folder.path(), false, {}, {.walls = true});
  for (int f = 0; f < 3; ++f) {
    chain.at_step(10 * f);
    chain.state.walls[0].displacement = {0.1 * f, 0, -0.2 * f};
    chain.state.walls[0].q = rotation_of({0.3 + f, 0.2 * f, 0});
    writer.write(chain.model, chain.state);
  }
  auto files = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
  add_walls(files, folder / "walls.pvd");
  Report report;
  report.sequences.push_back(read_sequence({SequenceKind::run, "Run", "", "", files}, report.body));
  report.stage_of_frame.assign(3, "push");
  const std::string html = report_page(one_line, report, {});
  const auto s = json_of(html)["sequences"][0];
  const auto x = array_of(html, s["walls"]["corners"]), motion = array_of(html, s["walls"]["motion"]),
             wall = array_of(html, s["walls"]["wall"]);
  EXPECT_EQ(s["walls"]["triangles"]["count"], 3 * (64 + 2));
  ASSERT_EQ(motion.size(), 3u * 2u * numbers_of_motion);
  for (std::size_t f = 0; f < 3; ++f) {
    const auto exact = VtpInput(files[f].walls).vectors(VtpInput::Per::point, "Points");
    ASSERT_EQ(3 * exact.size(), x.size());
    for (std::size_t k = 0; k < exact.size(); ++k) {
      const double* m = &motion[numbers_of_motion * (2 * f + static_cast<std::size_t>(wall[k]))];
      const double there[] = {exact[k].x, exact[k].y, exact[k].z};
      for (std::size_t c = 0; c < 3; ++c) {
        const double here =
            m[3 * c] * x[3 * k] + m[3 * c + 1] * x[3 * k + 1] + m[3 * c + 2] * x[3 * k + 2] + m[9 + c];
        EXPECT_NEAR(here + s["origin"][c].get<double>(), there[c], 1e-5);  // numbers below 20 in 32 bits
      }
    }
  }
}

// Triangles of which all corners are in one point are not seen.
TEST(Page, DrawsNoWallThatAStageHasTakenAway) {
  const test::Folder folder;
  Chain chain(3);
  chain.model.walls = {{"table", PlaneWall{{0, 0, -1}, {0, 0, 1}}, 0, {0, 0, -1}},
                       {"lid", DiscWall{{0, 0, 2}, {0, 0, 1}, 1.0}, 0, {0, 0, 2}}};
  chain.state.walls.resize(2);
  FrameWriter writer(folder.path(), false, {}, {.walls = true});
  for (int f = 0; f < 3; ++f) {
    chain.at_step(10 * f);
    chain.state.walls[1].off = f == 1 ? 1 : 0;
    writer.write(chain.model, chain.state);
  }
  auto files = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
  add_walls(files, folder / "walls.pvd");
  Report report;
  const std::vector<std::vector<float>> motion =
      read_sequence({SequenceKind::run, "Run", "", "", files}, report.body).walls.motion;
  ASSERT_EQ(motion.size(), 3u);
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t w = 0; w < 2; ++w)
      EXPECT_EQ(motion[f][numbers_of_motion * w], f == 1 && w == 1 ? 0.0F : 1.0F) << f << ", " << w;
}

TEST(Page, FramesComeBackWithinHalfAStep) {
  const Film film;
  const std::string html = report_page(one_line, film.report, {});
  const auto j = json_of(html);
  const auto& s = j["sequences"][0];
  EXPECT_EQ(array_of(html, j["bonds"]), (std::vector<double>{0, 1, 1, 2}));
  EXPECT_EQ(s["frames"][0]["bonds"], 1);
  EXPECT_EQ(s["frames"][4]["bonds"], 2);
  EXPECT_EQ(s["frames"][4]["step"], 40);
  EXPECT_EQ(s["frames"][4]["stage"], "push");
  std::vector<double> start = array_of(html, s["reference"]);
  for (std::size_t k = 0; k < start.size(); ++k) start[k] += s["origin"][k % 3].get<double>();
  const std::vector<double> moved = array_of(html, s["displacement"]);
  const auto steps = s["displacement"]["step"].get<std::vector<double>>();
  ASSERT_EQ(moved.size(), 5U * 3 * 3);
  for (std::size_t f = 0; f < 5; ++f)
    for (std::size_t p = 0; p < 3; ++p) {
      const Vec3d& r = film.states[f].r[ParticleId{p}];
      const double at[] = {r.x, r.y, r.z};
      for (std::size_t c = 0; c < 3; ++c)
        // 2e-7: the start is stored in single precision, numbers up to 2
        EXPECT_NEAR(start[3 * p + c] + moved[9 * f + 3 * c + p], at[c], 0.51 * steps[c] + 2e-7);
    }
}

TEST(Page, BondFieldsAreThoseOfTheFrames) {
  const Film film;
  const std::string html = report_page(one_line, film.report, {});
  const auto sequence = json_of(html)["sequences"][0];
  const VtpInput last(listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd")[4].bonds);
  const auto expect_field = [&](std::size_t k, const char* key, const std::vector<double>& values) {
    const auto& field = sequence["bond_fields"][k];
    EXPECT_EQ(field["key"], key);
    const std::vector<double> back = array_of(html, field["array"]);
    for (std::size_t b = 0; b < values.size(); ++b)
      EXPECT_NEAR(back[4 * 2 + b], values[b], 0.51 * field["array"]["step"].get<double>()) << key;
  };
  std::vector<double> strain = last.scalars(VtpInput::Per::cell, "elongation"),
                      bend = last.scalars(VtpInput::Per::cell, "bend");
  for (std::size_t b = 0; b < strain.size(); ++b) {
    strain[b] /= last.scalars(VtpInput::Per::cell, "length_at_rest")[b];
    bend[b] *= 3.14159265358979 / 180.0;
  }
  expect_field(0, "elongation", strain);
  expect_field(1, "bend", bend);
  expect_field(4, "U_B", last.scalars(VtpInput::Per::cell, "U_B"));
  EXPECT_EQ(array_of(html, sequence["bond_range"])[8], last.bytes(VtpInput::Per::cell, "range")[0]);
  EXPECT_EQ(last.bytes(VtpInput::Per::cell, "range")[0], 1);  // tilted by 1.2 rad: strained
  EXPECT_EQ(film.report.body.first_strained.bond, 0);
  EXPECT_DOUBLE_EQ(film.report.body.first_strained.time, 3.0);  // 0.9 rad is past 45 degrees
}

TEST(Page, BondsThatTouchAsCapsulesHaveTheirRadius) {
  const Film film(5, 3, {.capsules = true});  // of two bonds the second one, which is made later
  const std::string html = report_page(one_line, film.report, {});
  EXPECT_EQ(array_of(html, json_of(html)["bond_radius"]), (std::vector<double>{0.0, 0.25}));
  EXPECT_FALSE(json_of(report_page(one_line, Film().report, {})).contains("bond_radius"));
}

TEST(Page, TextCannotEndItsElement) {
  Report r;
  r.title = "</script><script>alert(1)</script> & <!-- --> \xff";
  r.case_text = "title = \"</SCRIPT >\"";
  const std::string html = report_page(one_line, r, {});
  const std::string json = test::element(html, "run");
  EXPECT_EQ(json.find_first_of("<>&"), std::string::npos) << json;
  EXPECT_EQ(json_of(html)["title"], "</script><script>alert(1)</script> & <!-- --> \xef\xbf\xbd");
  EXPECT_EQ(json_of(html)["rerun"]["case"], r.case_text);
  EXPECT_EQ(html.find("alert"), html.rfind("alert"));
}

TEST(Page, StaysBelowItsLimitAndSaysSo) {
  const Film film(40, 60);
  const std::size_t whole = report_page(one_line, film.report, {}).size();
  PageLimits limits;
  std::size_t last_frames = 40;
  for (const double part : {0.8, 0.6, 0.4}) {
    limits.bytes = static_cast<std::size_t>(part * static_cast<double>(whole));
    const std::string html = report_page(one_line, film.report, limits);
    EXPECT_LE(html.size(), limits.bytes);
    const auto j = json_of(html);
    const auto& frames = j["sequences"][0]["frames"];
    EXPECT_LT(frames.size(), last_frames);
    EXPECT_EQ(frames.front()["step"], 0);
    EXPECT_EQ(frames.back()["step"], 390);
    EXPECT_NE(j["left_out"][0].get<std::string>().find("One frame in "), std::string::npos);
    EXPECT_EQ(array_of(html, j["sequences"][0]["displacement"]).size(), frames.size() * 180);
    last_frames = frames.size() + 1;
  }
  limits.bytes = 3000;
  const auto j = json_of(report_page(one_line, film.report, limits));
  EXPECT_TRUE(j["sequences"].empty());
  EXPECT_NE(j["no_frames"].get<std::string>().find("even two of them do not fit"), std::string::npos);
  EXPECT_EQ(j["history"]["values"][1].size(), 40U);
}

TEST(Page, ModesStayWholeWhileFramesOfTheRunAreLeftOut) {
  Film film(40, 60);
  const Film swing(8, 60);
  for (const char* name : {"Mode 1", "Mode 2"}) {
    film.report.sequences.push_back(swing.report.sequences[0]);
    film.report.sequences.back().kind = SequenceKind::mode;
    film.report.sequences.back().name = name;
  }
  film.report.first_shown = 2;
  const std::size_t whole = report_page(one_line, film.report, {}).size();
  PageLimits limits;
  limits.bytes = whole * 6 / 10;
  auto j = json_of(report_page(one_line, film.report, limits));
  ASSERT_EQ(j["sequences"].size(), 3U);
  EXPECT_LT(j["sequences"][0]["frames"].size(), 40U);
  for (const int mode : {1, 2}) EXPECT_EQ(j["sequences"][mode]["frames"].size(), 8U);
  EXPECT_EQ(j["first_shown"], 2);
  EXPECT_FALSE(j.contains("no_frames"));

  Report modes = film.report;
  modes.sequences.erase(modes.sequences.begin());
  modes.first_shown = 1;
  limits.bytes = report_page(one_line, modes, {}).size() - 1000;
  j = json_of(report_page(one_line, modes, limits));
  ASSERT_EQ(j["sequences"].size(), 1U);
  EXPECT_EQ(j["sequences"][0]["name"], "Mode 1");
  EXPECT_EQ(j["first_shown"], 0);
  EXPECT_NE(j["left_out"][0].get<std::string>().find("The first 1 of the 2 modes"), std::string::npos);
}

TEST(Page, NumbersOfAllSizesAreWritten) {
  Report r;
  r.history = {{{"step", {0, 1, 2, 3}}, {"total", {4.9e-324, 1.7976931348623157e308, INFINITY, 1.0 / 3.0}}}};
  const auto j = json_of(report_page(one_line, r, {}));
  const auto& total = j["history"]["values"][1];
  EXPECT_EQ(total[0], 4.9e-324);
  EXPECT_EQ(total[1], 1.79769313e308);
  EXPECT_TRUE(total[2].is_null());
  EXPECT_EQ(total[3], 0.333333333);
}

TEST(Page, WideHistoryLeavesRoomForFrames) {
  Film film(40, 60);
  const std::size_t whole = report_page(one_line, film.report, {}).size();
  film.report.history = {{{"step", {}}}};
  for (int c = 0; c < 50; ++c) film.report.history.columns.push_back({"U" + std::to_string(c), {}});
  for (int k = 0; k < 1000; ++k)
    for (auto& column : film.report.history.columns)
      column.values.push_back(column.name == "step" ? k
                                                    : std::sin(k + static_cast<double>(column.name.size())));
  PageLimits limits;
  limits.bytes = 4 * whole;
  const std::string html = report_page(one_line, film.report, limits);
  EXPECT_LE(html.size(), limits.bytes);
  const auto j = json_of(html);
  ASSERT_EQ(j["sequences"].size(), 1U);
  EXPECT_EQ(j["sequences"][0]["frames"].size(), 40U);
  EXPECT_LT(j["history"]["values"][0].size(), 1000U);
  EXPECT_NE(j["left_out"][0].get<std::string>().find("of history.csv, so that the page stays below"),
            std::string::npos);
}

TEST(Page, TellsWhyThereAreNoFrames) {
  Report r;
  r.no_frames = "The case asks for none.";
  EXPECT_EQ(json_of(report_page(one_line, r, {}))["no_frames"], "The case asks for none.");
}

TEST(Page, ElongationWithoutALengthIsZeroAndCounted) {
  const Folder folder;
  Chain chain(3);
  chain.state.bonds[BondId{0}].a = 0.0;
  FrameWriter writer(folder.path(), false, {});
  writer.write(chain.model, chain.state);
  Body body;
  const Sequence s = read_sequence(
      {SequenceKind::run, "Run", "", "", listed_frames(folder / "particles.pvd", folder / "bonds.pvd")},
      body);
  EXPECT_EQ(body.bonds_without_length, 1U);
  EXPECT_NEAR(s.fields[0].low + s.fields[0].step * s.frames[0].fields[0][0], 0.0, 1e-12);
}

TEST(Page, HistoryIsThinnedAndSaysSo) {
  Report r;
  r.history = {{{"step", {}}, {"total", {}}}};
  for (int k = 0; k < 1000; ++k) {
    r.history.columns[0].values.push_back(k);
    r.history.columns[1].values.push_back(k % 7);
  }
  r.history.columns[1].values[5] = std::nan("");
  PageLimits limits;
  limits.history_rows = 100;
  const auto j = json_of(report_page(one_line, r, limits));
  const auto& steps = j["history"]["values"][0];
  EXPECT_LE(steps.size(), 100U);
  EXPECT_EQ(steps.front(), 0);
  EXPECT_EQ(steps.back(), 999);
  EXPECT_EQ(j["history"]["rows_in_file"], 1000);
  EXPECT_NE(j["left_out"][0].get<std::string>().find("of the 1000 rows"), std::string::npos);
  limits.history_rows = 4000;
  EXPECT_TRUE(json_of(report_page(one_line, r, limits))["history"]["values"][1][5].is_null());
}

TEST(Page, UnitsFollowTheCase) {
  Film film;
  EXPECT_EQ(json_of(report_page(one_line, film.report, {}))["sequences"][0]["particle_fields"][0]["unit"],
            "");
  film.report.units = UnitSystem::si;
  const auto j = json_of(report_page(one_line, film.report, {}));
  EXPECT_EQ(j["units"], "SI");
  EXPECT_EQ(j["sequences"][0]["bond_fields"][3]["unit"], "J");
  EXPECT_EQ(j["history"]["columns"][1]["unit"], "J");
}

TEST(Page, TemplateNeedsItsLineOnce) {
  for (const char* bad : {"", "<html></html>", "<!-- run -->\n<!-- run -->\n", "x <!-- run -->\n"})
    EXPECT_THROW(report_page(bad, {}, {}), IoError) << bad;
  EXPECT_EQ(report_page("a\n<!-- run -->\nb", {}, {}).substr(0, 9), "a\n<script");
}

TEST(Page, ModesSwingAboutTheirFirstFrame) {
  Film film;
  SequenceFiles mode{SequenceKind::mode, "Mode 1", "", "swing",
                     listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd")};
  mode.frames.erase(mode.frames.begin());
  Body body;
  const Sequence s = read_sequence(mode, body);
  EXPECT_NEAR(s.origin[1] + s.reference[1], -0.02, 1e-7);  // y of the second frame
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(s.displacement[c].low + s.displacement[c].step * s.frames[0].displacement[3 * c], 0.0, 1e-6);
  EXPECT_EQ(body.first_strained.bond, -1);
}

TEST(Page, FramesOfAnotherBodyAreRefused) {
  const Film film;
  const Chain other(4);
  const auto frames = listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd");
  write_bonds_vtp(frames[2].bonds, other.state, UnitSystem::reduced);
  Body body;
  EXPECT_THROW(read_sequence({SequenceKind::run, "Run", "", "", frames}, body), IoError);
}

/// What reading the frames of this film says of its last frame after a change to its files.
std::string refusal(const Film& film) {
  Body body;
  try {
    read_sequence({SequenceKind::run, "Run", "", "",
                   listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd")},
                  body);
  } catch (const IoError& e) {
    return e.what();
  }
  return "accepted";
}

/// The fields of bonds, of which `per_point` has a value for each point instead of each bond.
VtpFile forged_bonds(std::size_t points, const std::string& per_point,
                     const std::vector<std::int64_t>& ends = {0, 1, 1, 2}) {
  VtpFile f = VtpFile::of_lines(std::vector<Vec3d>(points), ends);
  for (const std::string name : {"elongation", "length_at_rest", "bend", "twist", "U_L", "U_B", "U_T"})
    if (name == per_point)
      f.add_point_data(name, std::vector<double>(points, 1.0));
    else
      f.add_cell_data(name, std::vector<double>{1.0, 1.0});
  f.add_cell_data("range", std::vector<std::uint8_t>{0, 0});
  return f;
}

TEST(Page, ArraysOfAnotherLengthAreRefused) {
  const Film film(2, 1000);
  const auto frames = listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd");
  const auto forge = [&](const VtpFile& file) { file.write(frames[1].bonds, 10.0, 10); };
  forge(forged_bonds(1000, "U_T"));  // 1000 values where there are two bonds
  EXPECT_NE(refusal(film).find("has no array \"U_T\" of type Float64 or Float32 for each cell"),
            std::string::npos)
      << refusal(film);
  forge(forged_bonds(1000, "length_at_rest"));
  EXPECT_NE(refusal(film).find("length_at_rest"), std::string::npos);
}

TEST(Page, FramesThatContradictThemselvesAreRefused) {
  const Film film(2);
  const auto frames = listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd");
  const std::string good = test::content_of(frames[1].bonds);
  const auto edited = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    test::put_content(frames[1].bonds, text);
    return refusal(film);
  };
  EXPECT_EQ(refusal(film), "accepted");
  EXPECT_NE(edited("NumberOfPoints=\"3\"", "NumberOfPoints=\"6148914691236517208\"").find("its size is not"),
            std::string::npos);  // 24 bytes for each of them are 64 in 64 bits
  forged_bonds(3, "", {0, 1, (std::int64_t{1} << 32) + 1, 2}).write(frames[1].bonds, 10.0, 10);
  EXPECT_NE(refusal(film).find("impossible ends"), std::string::npos) << refusal(film);  // 2^32 + 1 is not 1
  test::put_content(frames[1].bonds, good);
  test::put_content(film.folder / "particles.pvd",
                    pvd_list(pvd_entry(0.0, "frames/particles_000000000010.vtp") +
                             pvd_entry(1.0, "frames/particles_000000000000.vtp")));
  test::put_content(film.folder / "bonds.pvd", pvd_list(pvd_entry(0.0, "frames/bonds_000000000010.vtp") +
                                                        pvd_entry(1.0, "frames/bonds_000000000000.vtp")));
  EXPECT_NE(refusal(film).find("earlier step"), std::string::npos);
}

TEST(Page, TellsWhatStagesHoldAndLoad) {
  Film film;
  EXPECT_FALSE(json_of(report_page(one_line, film.report, {})).contains("stages"));
  film.report.stages = {{"push", {0, 2}, {63, 5}, {1}, {1, -2, 0.5, 0, 0, 4}}};
  const std::string html = report_page(one_line, film.report, {});
  const auto stages = json_of(html)["stages"];
  ASSERT_EQ(stages.size(), 1);
  EXPECT_EQ(stages[0]["name"], "push");
  EXPECT_EQ(array_of(html, stages[0]["held"]), (std::vector<double>{0, 2}));
  EXPECT_EQ(array_of(html, stages[0]["how"]), (std::vector<double>{63, 5}));
  EXPECT_EQ(array_of(html, stages[0]["loaded"]), (std::vector<double>{1}));
  EXPECT_EQ(array_of(html, stages[0]["loads"]), (std::vector<double>{1, -2, 0.5, 0, 0, 4}));
}

TEST(Page, ABodyFarFromZeroKeepsItsShape) {
  const Folder folder;
  Chain chain(3);
  const Vec3d far{1e8, -1e8, 3e12};
  for (const ParticleId p : chain.state.r.ids()) {
    chain.model.r_0[p] = chain.model.r_0[p] + far;
    chain.state.r[p] = chain.state.r[p] + far;
  }
  FrameWriter writer(folder.path(), false, {});
  writer.write(chain.model, chain.state);
  Report report;
  report.sequences.push_back(read_sequence(
      {SequenceKind::run, "Run", "", "", listed_frames(folder / "particles.pvd", folder / "bonds.pvd")},
      report.body));
  report.stage_of_frame = {"push"};
  const std::string html = report_page(one_line, report, {});
  const auto s = json_of(html)["sequences"][0];
  EXPECT_EQ(s["origin"], (std::vector<double>{1e8 + 1, -1e8, 3e12}));
  EXPECT_EQ(array_of(html, s["reference"]), (std::vector<double>{-1, 0, 0, 0, 0, 0, 1, 0, 0}));
}

}  // namespace
}  // namespace vbond::page::page_test
