#include "vbond/observe/mode_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vtp_reader.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::VtpReader;

Shape bent() {
  Shape shape{PerParticle<Vec3d>(3), PerParticle<Vec3d>(3)};
  shape.translation[ParticleId{1}] = {0, 1, 0};
  shape.translation[ParticleId{2}] = {0.25, -0.5, 0};
  shape.rotation[ParticleId{0}] = {0, 0, 0.5};
  return shape;
}

std::vector<double> displacements(const std::filesystem::path& frame) {
  return VtpReader(content_of(frame)).arrays.at("displacement").as<double>();
}

TEST(ModeFrames, SwingBeginsInBalanceAndTurnsAtTheAmplitude) {
  const Folder folder;
  const Chain chain;
  const auto frame = [&](int k) { return folder / ("modes/shake_mode_2_000" + std::to_string(k) + ".vtp"); };
  write_mode_frames(folder.path(), "shake", 2, 8, 0.2, chain.model, chain.state, bent());
  for (const double x : displacements(frame(0))) EXPECT_EQ(x, 0.0);
  const std::vector<double> high = displacements(frame(2)), low = displacements(frame(6));
  ASSERT_EQ(high.size(), 9u);
  EXPECT_NEAR(high[4], 0.2, 1e-15);  // a few roundings of numbers of order one
  EXPECT_NEAR(high[6], 0.05, 1e-15);
  EXPECT_NEAR(high[7], -0.1, 1e-15);
  for (std::size_t k = 0; k < high.size(); ++k) EXPECT_NEAR(low[k], -high[k], 1e-15);
  const VtpReader quarter(content_of(frame(2)));
  EXPECT_NEAR(quarter.arrays.at("rotation").as<double>()[2], 0.1, 1e-15);
  EXPECT_EQ(std::stod(quarter.in_text.at("TimeValue")), 0.25);
}

// Of a wave the particles go round: a quarter of a swing before its height they are where the other part
// says, backwards.
TEST(ModeFrames, OfAWaveShowBothParts) {
  const Folder folder;
  const Chain chain;
  Shape other{PerParticle<Vec3d>(3), PerParticle<Vec3d>(3)};
  other.translation[ParticleId{1}] = {0.5, 0, 0};
  write_mode_frames(folder.path(), "wave", 1, 4, 0.2, chain.model, chain.state, {bent(), other});
  const auto frame = [&](int k) {
    return displacements(folder / ("modes/wave_mode_1_000" + std::to_string(k) + ".vtp"));
  };
  EXPECT_NEAR(frame(0)[3], -0.1, 1e-15);
  EXPECT_NEAR(frame(0)[4], 0.0, 1e-15);
  EXPECT_NEAR(frame(1)[3], 0.0, 1e-15);
  EXPECT_NEAR(frame(1)[4], 0.2, 1e-15);
  EXPECT_NEAR(frame(2)[3], 0.1, 1e-15);
}

// One or two frames show the ends of the swing, not twice the balance.
TEST(ModeFrames, FewShowTheShape) {
  for (const int frames : {1, 2, 3}) {
    const Folder folder;
    const Chain chain;
    write_mode_frames(folder.path(), "shake", 1, frames, 0.2, chain.model, chain.state, bent());
    double largest = 0.0;
    for (int k = 0; k < frames; ++k)
      largest = std::max(
          largest,
          std::abs(displacements(folder / ("modes/shake_mode_1_000" + std::to_string(k) + ".vtp"))[4]));
    EXPECT_NEAR(largest, frames < 3 ? 0.2 : 0.2 * std::sin(2.0 * M_PI / 3.0), 1e-15) << frames;
  }
}

TEST(ModeFrames, ListsNameEveryFrameOnce) {
  const Folder folder;
  const Chain chain;
  write_mode_frames(folder.path(), "shake", 1, 4, 0.1, chain.model, chain.state, bent());
  for (const std::string kind : {"", "_bonds"}) {
    const std::string list = content_of(folder / ("modes/shake_mode_1" + kind + ".pvd"));
    std::size_t entries = 0;
    for (std::size_t at = 0; (at = list.find("file=\"", at)) != std::string::npos; ++entries) {
      at += 6;
      const std::string file = list.substr(at, list.find('"', at) - at);
      const VtpReader reader(content_of(folder / "modes" / file));
      EXPECT_EQ(kind.empty() ? reader.verts : reader.lines, kind.empty() ? 3u : 2u) << file;
    }
    EXPECT_EQ(entries, 4u);
  }
}

TEST(ModeFrames, SwingIsATenthOfTheBodyButNoTurnBeyondHalfARadian) {
  const Chain chain;
  Shape shape = bent();
  const double longest = norm(chain.state.r[ParticleId{2}] - chain.state.r[ParticleId{0}]);
  EXPECT_GE(swing_factor(chain.model, chain.state, shape, 0.0), 0.1 * longest);
  EXPECT_EQ(swing_factor(chain.model, chain.state, shape, 0.3), 0.3);
  EXPECT_EQ(swing_factor(chain.model, chain.state, shape, 3.0), 1.0);  // of turns of 0.5
  for (Vec3d& t : shape.translation) t = {};
  EXPECT_EQ(swing_factor(chain.model, chain.state, shape, 0.3), 1.0);
  EXPECT_EQ(swing_factor(chain.model, chain.state, Shape{}, 0.3), 0.0);
}

TEST(ModeFrames, AreRemovedStageByStageAndNothingElse) {
  const Folder folder;
  const Chain chain;
  for (const char* stage : {"a", "a_mode_1", "b"})
    write_mode_frames(folder.path(), stage, 1, 2, 0.1, chain.model, chain.state, bent());
  test::put_content(folder / "modes/a_mode_1_picture.png", "mine");
  remove_mode_frames(folder.path(), "a");
  EXPECT_FALSE(std::filesystem::exists(folder / "modes/a_mode_1.pvd"));
  EXPECT_FALSE(std::filesystem::exists(folder / "modes/a_mode_1_bonds_0001.vtp"));
  EXPECT_TRUE(std::filesystem::exists(folder / "modes/a_mode_1_mode_1_0000.vtp"));
  EXPECT_TRUE(std::filesystem::exists(folder / "modes/b_mode_1_bonds.pvd"));
  EXPECT_TRUE(std::filesystem::exists(folder / "modes/a_mode_1_picture.png"));
  remove_mode_frames(folder / "nowhere", "a");
  EXPECT_TRUE(is_mode_file("any_mode_12_bonds_0003.vtp.part"));
  EXPECT_TRUE(is_mode_file("any_mode_12.pvd"));
  for (const char* name : {"any_mode_x.pvd", "_mode_1.pvd", "particles.pvd", "any_mode_1_0003.txt", ""})
    EXPECT_FALSE(is_mode_file(name)) << name;
}

// Here no frame can be removed: the lists are gone all the same, whatever order the folder has.
TEST(ModeFrames, ListsAreRemovedBeforeTheirFrames) {
  const Folder folder;
  std::filesystem::create_directories(folder / "modes");
  for (int mode = 1; mode <= 20; ++mode) {
    const std::string name = "a_mode_" + std::to_string(mode);
    std::filesystem::create_directories(folder / ("modes/" + name + "_0000.vtp/in the way"));
    test::put_content(folder / ("modes/" + name + ".pvd"), "");
  }
  EXPECT_THROW(remove_mode_frames(folder.path(), "a"), IoError);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "modes"))
    EXPECT_NE(entry.path().extension(), ".pvd") << entry.path();
}

}  // namespace
}  // namespace vbond
