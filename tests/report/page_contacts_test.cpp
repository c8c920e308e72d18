// The contacts of frames as a page has them, against the files of the frames.
#include "vbond/report/contact_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "page_reader.hpp"
#include "specimen.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/report/fit_frames.hpp"
#include "vbond/report/page.hpp"
#include "vbond/report/vtp_read.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::page::page_contacts_test {
namespace {

using test::array_of;
using test::Folder;
using test::json_of;
using test::one_line;
using Per = VtpInput::Per;

/// Three balls in a row, of which two are bonded, above them a ball, and below them a floor.
constexpr const char* balls =
    "[[specimen]]\nname = \"row\"\nkind = \"list\"\nradius = 0.5\nmass = 1\n"
    "positions = [[0, 0, 0.45], [0.9, 0, 0.4], [1.85, 0, 0.48], [1, 0.1, 1.25]]\n"
    "[[bonds]]\npairs = [[0, 1]]\nstiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}\n"
    "[[wall]]\nshape = \"plane\"\nnormal = [0, 0, 1]\n"
    "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\npairs = \"all\"\n[[stage]]\nduration = 1\n";

/// A fibre that lies across another one.
constexpr const char* fibres =
    "[[specimen]]\nname = \"lower\"\nkind = \"list\"\nradius = 0.2\nmass = 1\n"
    "positions = [[0, 0, 0], [1, 0, 0]]\n"
    "[[specimen]]\nname = \"upper\"\nkind = \"list\"\nradius = 0.2\nmass = 1\n"
    "positions = [[0.3, -0.6, 0.36], [0.3, 0.7, 0.37]]\n"
    "[[bonds]]\npairs = [[0, 1], [2, 3]]\ncapsule_radius = \"particles\"\n"
    "stiffness = {c_A = 50, c_D = 20, c_B = 2, c_T = 2}\n"
    "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\n[[stage]]\nduration = 1\n";

/// Frames of a body that goes up, so that less and less of it touches.
struct Film {
  Folder folder;
  std::vector<FrameFiles> files;

  /// without: particles that sinks have taken out.
  explicit Film(const std::string& text, FrameFormat format = {.contacts = true},
                const std::vector<ParticleId>& without = {}) {
    Built b = build(parse_case(text, "case.toml"));
    FrameWriter writer(folder.path(), false, {}, format);
    for (int f = 0; f < 4; ++f) {
      State s = b.state;
      s.clock.dt = 0.1;
      s.clock.step = s.clock.stage_step = 10 * f;
      for (const ParticleId p : s.r.ids())
        s.r[p] = s.r[p] + (0.02 * f) * Vec3d{0.3, 0.2, 1.0 + 0.7 * p.value};
      if (f > 0) s.dropped = s.taken = without;
      writer.write(b.model, s);
    }
    files = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
    if (format.contacts) add_contacts(files, folder / "contacts.pvd");
  }

  std::string page(PageLimits limits = {}) const {
    Report report;
    report.sequences.push_back(read_sequence({SequenceKind::run, "Run", "", "", files}, report.body));
    report.stage_of_frame.assign(files.size(), "");
    return report_page(one_line, report, limits);
  }
};

/// A contact of a file: particles, force, ends.
struct Line {
  double i, j, force;
  Vec3d from, to;
};
std::vector<Line> lines_in(const FrameFiles& files) {
  const VtpInput in(files.contacts);
  const auto i = in.integers(Per::cell, "i"), j = in.integers(Per::cell, "j");
  const auto force = in.scalars(Per::cell, "normal_force");
  const auto ends = in.vectors(Per::point, "Points");
  std::vector<Line> lines;
  for (std::size_t k = 0; k < i.size(); ++k)
    lines.push_back({static_cast<double>(i[k]), static_cast<double>(j[k] < 0 ? i[k] : j[k]), force[k],
                     ends[2 * k], ends[2 * k + 1]});
  return lines;
}

/// Centres of the particles that are there, by their numbers.
std::map<double, Vec3d> centres_in(const FrameFiles& files) {
  const VtpInput in(files.particles);
  const auto ids = in.integers(Per::point, "id");
  const auto r = in.vectors(Per::point, "Points");
  std::map<double, Vec3d> centres;
  for (std::size_t k = 0; k < r.size(); ++k) centres[static_cast<double>(ids[k])] = r[k];
  return centres;
}

/// Every contact of the files is in the page with its ends. They stand in the same order: here no contact
/// between centres comes after another one. Returns how many there are, and how many not between centres.
std::pair<std::size_t, std::size_t> compare(const Film& film) {
  const std::string html = film.page();
  const auto s = json_of(html)["sequences"][0];
  const auto i = array_of(html, s["contacts"]["i"]), j = array_of(html, s["contacts"]["j"]),
             q = array_of(html, s["contacts"]["force"]), shift = array_of(html, s["contacts"]["shift"]);
  const double step = s["contacts"]["shift"]["step"].get<double>();
  std::size_t at = 0, placed_at = 0;
  for (std::size_t f = 0; f < film.files.size(); ++f) {
    const auto lines = lines_in(film.files[f]);
    const auto r = centres_in(film.files[f]);
    const auto& of_frame = s["frames"][f]["contacts"];
    const double low = of_frame["low"].get<double>(), of_force = of_frame["step"].get<double>();
    const auto centres = lines.size() - of_frame["placed"].get<std::size_t>();
    EXPECT_EQ(of_frame["count"], lines.size());
    for (std::size_t k = 0; k < lines.size(); ++k, ++at) {
      EXPECT_EQ(i[at], lines[k].i);
      EXPECT_EQ(j[at], lines[k].j);
      EXPECT_NEAR(low + of_force * q[at], lines[k].force, 0.51 * of_force);
      Vec3d from = r.at(i[at]), to = r.at(j[at]);
      if (k >= centres) {
        from = from + Vec3d{shift[placed_at], shift[placed_at + 1], shift[placed_at + 2]};
        to = to + Vec3d{shift[placed_at + 3], shift[placed_at + 4], shift[placed_at + 5]};
        placed_at += numbers_of_shift;
      }
      // half a step in each of three directions
      EXPECT_LE(norm(from - lines[k].from), 0.51 * std::sqrt(3.0) * step);
      EXPECT_LE(norm(to - lines[k].to), 0.51 * std::sqrt(3.0) * step);
    }
  }
  EXPECT_EQ(at, i.size());
  EXPECT_EQ(placed_at, shift.size());
  return {at, placed_at / numbers_of_shift};
}

TEST(PageContacts, OfBallsAndWallsAreThoseOfTheFrames) {
  const auto [all, placed] = compare(Film(balls));
  EXPECT_GT(all, placed);
  EXPECT_GT(placed, 0u);
}

TEST(PageContacts, OfFibresAreThoseOfTheFrames) {
  const auto [all, placed] = compare(Film(fibres));
  EXPECT_EQ(all, placed);
  EXPECT_GT(placed, 0u);
}

// Particles that are not there leave gaps in the numbers of a frame.
TEST(PageContacts, AreOfTheirParticlesWhereASinkHasTakenOthers) {
  const Film film(balls, {.contacts = true}, {ParticleId{0}});
  ASSERT_EQ(VtpInput(film.files[1].particles).points(), 3u);
  const auto lines = lines_in(film.files[1]);
  ASSERT_TRUE(std::any_of(lines.begin(), lines.end(), [](const Line& l) { return l.j == 3; }));
  compare(film);
}

TEST(PageContacts, InSinglePrecisionEndAtCentresAsWell) {
  const auto [all, placed] = compare(Film(balls, {.single_precision = true, .contacts = true}));
  EXPECT_GT(all, placed);
}

// Where nothing touches, and where no contacts were asked for, the page is as if there were no contacts.
TEST(PageContacts, AreNotInAPageWithoutThem) {
  const std::string apart =
      "[[specimen]]\nkind = \"list\"\nradius = 0.4\nmass = 1\npositions = [[0, 0, 0], [1, 0, 0]]\n"
      "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\n[[stage]]\nduration = 1\n";
  const Film none(balls, {}), nothing(apart);
  for (const Film* film : {&none, &nothing}) {
    const auto s = json_of(film->page())["sequences"][0];
    EXPECT_FALSE(s.contains("contacts"));
    EXPECT_FALSE(s["frames"][0].contains("contacts"));
  }
}

// A run may ask for contacts when it is resumed: its first frames were written without them.
TEST(PageContacts, MayBeginWithALaterFrame) {
  Film film(balls);
  film.files[0].contacts.clear();
  const auto s = json_of(film.page())["sequences"][0];
  EXPECT_FALSE(s["frames"][0].contains("contacts"));
  EXPECT_EQ(s["frames"][1]["contacts"]["count"], lines_in(film.files[1]).size());

  const std::string list = test::content_of(film.folder / "contacts.pvd");
  const std::size_t first = list.find("    <DataSet"), next = list.find("    <DataSet", first + 1);
  test::put_content(film.folder / "contacts.pvd", list.substr(0, first) + list.substr(next));
  auto listed = listed_frames(film.folder / "particles.pvd", film.folder / "bonds.pvd");
  add_contacts(listed, film.folder / "contacts.pvd");
  EXPECT_TRUE(listed[0].contacts.empty());
  for (std::size_t f = 1; f < 4; ++f) EXPECT_EQ(listed[f].contacts, film.files[f].contacts);
}

// Two bytes for either end, one for the force, six where the ends are not both at centres.
TEST(PageContacts, CountAsBytesOfTheirFrame) {
  Film film(balls);
  const auto lines = lines_in(film.files[0]);
  const auto on_floor = static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [](const Line& l) { return l.i == l.j; }));
  const std::size_t with = bytes_of_frame(film.files[0]);
  film.files[0].contacts.clear();
  EXPECT_EQ(with - bytes_of_frame(film.files[0]), 5 * lines.size() + 6 * on_floor);
  EXPECT_EQ(bytes_of_end(65536), 2u);
  EXPECT_EQ(bytes_of_end(65537), 4u);
}

// The last frame, in which less touches than before, is not taken for all of them.
TEST(PageContacts, OfSomeFramesAreLookedAtBeforeFramesAreChosen) {
  const Film film(balls);
  const std::size_t first = bytes_of_frame(film.files[0]);
  ASSERT_GT(first, bytes_of_frame(film.files[3]));
  std::vector<SequenceFiles> all{{SequenceKind::run, "Run", "", "", film.files}};
  PageLimits limits;
  limits.packed_bytes = 4 * first - 1;
  std::vector<std::string> said;
  fit_frames(all, limits, said);
  EXPECT_EQ(all[0].frames.size(), 3u);
}

// Wherever contacts with other ends than centres stand in the file, they are the last ones in the page.
TEST(PageContacts, OfPlacesStandAfterThoseOfCentres) {
  const Film film(balls);
  VtpFile file = VtpFile::of_lines({{0, 0, 0.45}, {0, 0, 0}, {0, 0, 0.45}, {0.9, 0, 0.4}}, {0, 1, 2, 3});
  file.add_cell_data("i", std::vector<std::int64_t>{0, 0});
  file.add_cell_data("j", std::vector<std::int64_t>{-1, 1});
  file.add_cell_data("normal_force", std::vector<double>{3.0, 1.0});
  file.write(film.files[0].contacts, 0.0, 0);
  const FrameContacts c = read_contacts({film.files[0]}).frames[0];
  EXPECT_EQ(c.j, (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(c.force, (std::vector<std::uint8_t>{0, 255}));
  EXPECT_EQ(c.shift, (std::vector<std::uint8_t>{127, 127, 127, 127, 127, 0}));  // 127 is zero: signed
}

TEST(PageContacts, FilesOfOtherFramesAndDamagedOnesAreRefused) {
  const auto expect_refused = [](const Film& film, const char* why) {
    try {
      film.page();
      ADD_FAILURE() << why;
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  Film other(balls);
  std::swap(other.files[0].contacts, other.files[1].contacts);
  expect_refused(other, "has not the contacts of");

  const auto expect_forged = [&](const std::vector<std::int64_t>& ends, std::int64_t i, double force,
                                 const char* why) {
    const Film film(balls);
    VtpFile file = VtpFile::of_lines({{0, 0, 0.47}, {0.9, 0, 0.42}}, ends);
    file.add_cell_data("i", std::vector<std::int64_t>{i});
    file.add_cell_data("j", std::vector<std::int64_t>{1});
    file.add_cell_data("normal_force", std::vector<double>{force});
    file.write(film.files[0].contacts, 0.0, 0);
    expect_refused(film, why);
  };
  expect_forged({0, 1}, 4, 1.0, "of a particle that is not there");
  expect_forged({0, 1}, -1, 1.0, "of a particle that is not there");
  expect_forged({0, 2}, 0, 1.0, "an end of a contact is not there");
  expect_forged({0, 1}, 0, NAN, "not finite");

  Film cut(balls);
  std::filesystem::resize_file(cut.files[3].contacts, 100);
  std::vector<SequenceFiles> all{{SequenceKind::run, "Run", "", "", cut.files}};
  EXPECT_EQ(drop_unreadable_ends(all).size(), 1u);
  EXPECT_EQ(all[0].frames.size(), 3u);
}

}  // namespace
}  // namespace vbond::page::page_contacts_test
