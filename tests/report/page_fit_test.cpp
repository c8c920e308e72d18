#include "vbond/report/fit_frames.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "specimen.hpp"
#include "vbond/observe/frames.hpp"

namespace vbond::page {
namespace {

using test::Chain;
using test::Folder;

/// The frames of a run that stands still, and as often as asked for the first 16 of them as a mode.
struct Reel {
  Folder folder;
  std::vector<SequenceFiles> files;

  Reel(std::size_t frames, int modes) {
    Chain chain(3);
    FrameWriter writer(folder.path(), false, {});
    for (std::size_t f = 0; f < frames; ++f) {
      chain.state.clock.step = chain.state.clock.stage_step = static_cast<std::int64_t>(f);
      writer.write(chain.model, chain.state);
    }
    const auto all = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
    files.push_back({SequenceKind::run, "Run", "", "", all});
    for (int k = 1; k <= modes; ++k)
      files.push_back({SequenceKind::mode,
                       "Mode " + std::to_string(k),
                       "",
                       "swing",
                       {all.begin(), all.begin() + std::min<std::ptrdiff_t>(16, std::ssize(all))}});
  }
  std::size_t frame_bytes() const { return bytes_of_frame(files[0].frames[0]); }
};

TEST(PageFit, OnlyTheRunIsThinned) {
  Reel reel(200, 2);
  PageLimits limits;
  limits.frames = 40;
  std::vector<std::string> said;
  fit_frames(reel.files, limits, said);
  EXPECT_EQ(reel.files[0].frames.size(), 35U);  // one in 6: 1 + ceil(199 / 6)
  for (const int mode : {1, 2}) EXPECT_EQ(reel.files[static_cast<std::size_t>(mode)].frames.size(), 16U);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("Of the 200 frames of the run one in 6 was read"), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("no more than 40 frames"), std::string::npos) << said[0];
}

TEST(PageFit, StridesAreTheSmallestThatFit) {
  for (const std::size_t most : {2U, 3U, 7U, 14U, 19U, 20U, 39U, 40U}) {
    Reel reel(40, 0);
    PageLimits limits;
    limits.frames = most;
    std::vector<std::string> said;
    std::size_t stride = 1;
    while (thinned(40, stride).size() > most) ++stride;
    fit_frames(reel.files, limits, said);
    EXPECT_EQ(reel.files[0].frames.size(), thinned(40, stride).size()) << most;
    EXPECT_EQ(said.empty(), most == 40);
  }
}

TEST(PageFit, BytesOfModesCountAndAreNamed) {
  Reel reel(40, 1);
  PageLimits limits;
  limits.packed_bytes = 26 * reel.frame_bytes();  // 16 for the mode, 10 for the run
  std::vector<std::string> said;
  fit_frames(reel.files, limits, said);
  EXPECT_EQ(reel.files[0].frames.size(), 9U);  // one in 5
  EXPECT_EQ(reel.files[1].frames.size(), 16U);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("MB of numbers"), std::string::npos) << said[0];
}

TEST(PageFit, LastModesGoOnlyIfModesAloneAreTooMany) {
  Reel reel(40, 3);
  PageLimits limits;
  limits.packed_bytes = 40 * reel.frame_bytes();  // two modes and 8 frames
  std::vector<std::string> said;
  fit_frames(reel.files, limits, said);
  ASSERT_EQ(reel.files.size(), 3U);
  EXPECT_EQ(reel.files[2].name, "Mode 2");
  EXPECT_EQ(reel.files[0].frames.size(), 8U);  // one in 6: 1 + ceil(39 / 6)
  ASSERT_EQ(said.size(), 2U);
  EXPECT_NE(said[0].find("The last mode is left out"), std::string::npos) << said[0];
}

TEST(PageFit, UnreadableFramesGoAtTheEndAlone) {
  Reel reel(10, 1);
  std::filesystem::resize_file(reel.files[0].frames[9].bonds, 100);
  std::filesystem::remove(reel.files[0].frames[8].particles);
  std::filesystem::remove(reel.files[0].frames[4].particles);
  const std::vector<Warning> warnings = drop_unreadable_ends(reel.files);
  ASSERT_EQ(reel.files.size(), 1U);  // half a swing is no mode
  EXPECT_EQ(reel.files[0].frames.size(), 8U);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0].level, Level::warning);
  EXPECT_NE(warnings[0].text.find("The last 2 of the 10 frames of the run are left out"), std::string::npos)
      << warnings[0].text;
  EXPECT_NE(warnings[1].text.find("Mode 1 is left out"), std::string::npos) << warnings[1].text;
}

TEST(PageFit, WholeFoldersStayAsTheyAre) {
  Reel reel(5, 1);
  std::vector<std::string> said;
  EXPECT_TRUE(drop_unreadable_ends(reel.files).empty());
  fit_frames(reel.files, {}, said);
  EXPECT_EQ(reel.files[0].frames.size(), 5U);
  EXPECT_TRUE(said.empty());
}

}  // namespace
}  // namespace vbond::page
