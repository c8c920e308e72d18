#include "vbond/observe/vtp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/spool.hpp"

namespace vbond {
namespace {

using test::content_of;
using test::Folder;

bool is_empty(const Folder& folder) {
  return std::filesystem::is_empty(folder / ".");
}

TEST(Spool, GivesBackWhatItWasGivenFromMemoryAndFromTheDisk) {
  const Folder folder;
  std::mt19937_64 random(3);
  Spool spool(folder / "frame.vtp");
  std::vector<std::string> given;
  std::vector<Spool::Piece> pieces;
  for (std::size_t all = 0; all < 3 * Spool::in_memory; all += given.back().size()) {
    given.emplace_back(random() % 1'000'000, static_cast<char>(random()));
    pieces.push_back(spool.keep(given.back()));
  }
  EXPECT_FALSE(pieces.front().in_file);
  EXPECT_TRUE(pieces.back().in_file);
  EXPECT_TRUE(is_empty(folder)) << "the file has a name";
  Replacement out(folder / "out");
  std::string expected;
  for (const std::size_t k : {pieces.size() - 1, std::size_t{0}, pieces.size() / 2}) {
    spool.copy(pieces[k], out);
    expected += given[k];
  }
  out.publish(Sync::none);
  EXPECT_TRUE(content_of(folder / "out") == expected);
}

/// The same numbers, given some at a time.
VtpFile in_pieces(const std::vector<Vec3d>& points, const std::vector<double>& values, FrameFormat format,
                  const std::filesystem::path& beside) {
  VtpFile f(VtpFile::Topology::verts, format, beside);
  VtpArray& squares = f.begin_cell_data<double>("values", "J");
  for (std::size_t first = 0; first < points.size(); first += 777) {
    const std::size_t n = std::min<std::size_t>(777, points.size() - first);
    std::vector<std::int64_t> each;
    for (std::size_t k = first; k < first + n; ++k) each.push_back(static_cast<std::int64_t>(k));
    squares.append(std::span(values).subspan(first, n));
    f.add_points(std::span(points).subspan(first, n));
    f.add_cells(each);
  }
  return f;
}

TEST(VtpFile, IsTheSameSomeAtATimeAsAtOnceAndByWayOfTheDisk) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3d> points;
  std::vector<double> values;
  for (std::size_t k = 0; k < 500'000; ++k) {
    points.push_back({normal(random), normal(random), normal(random)});
    values.push_back(static_cast<double>(k / 100));
  }
  for (const bool compressed : {false, true})
    for (const bool single : {false, true}) {
      const Folder folder;
      const FrameFormat format{.single_precision = single, .compressed = compressed};
      VtpFile at_once = VtpFile::of_points(points, format);
      at_once.add_cell_data("values", values, "J");
      at_once.write(folder / "at_once", 0.5, 3);
      in_pieces(points, values, format, {}).write(folder / "in_memory", 0.5, 3);
      in_pieces(points, values, format, folder / "on_disk").write(folder / "on_disk", 0.5, 3);
      const std::string expected = content_of(folder / "at_once");
      EXPECT_TRUE(content_of(folder / "in_memory") == expected) << compressed << single;
      EXPECT_TRUE(content_of(folder / "on_disk") == expected) << compressed << single;
    }
}

TEST(VtpArray, RefusesValuesOfAnotherTypeAndThoseThatDoNotFit) {
  VtpFile f(VtpFile::Topology::verts, {.single_precision = true});
  VtpArray& real = f.begin_point_data<double>("real");
  VtpArray& number = f.begin_point_data<std::int64_t>("number");
  const std::vector<double> large{1.0, 1e39};
  const std::vector<std::int64_t> long_ones{5, std::int64_t{1} << 31};
  EXPECT_THROW(real.append(large), IoError);
  EXPECT_THROW(real.append(long_ones), std::logic_error);
  EXPECT_THROW(number.append(long_ones), std::logic_error);
  EXPECT_THROW(number.append(large), std::logic_error);
}

}  // namespace
}  // namespace vbond
