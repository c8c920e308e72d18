// The lists of frames and the dump, as they begin, grow and go on.
#include <gtest/gtest.h>

#include <sstream>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vtp_reader.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;
using test::put_content;
using test::VtpReader;

/// (time, file) of every entry of a .pvd.
std::vector<std::pair<double, std::string>> entries(const std::string& pvd) {
  std::vector<std::pair<double, std::string>> out;
  const auto after = [&pvd](const std::string& key, std::size_t at) {
    const std::size_t from = pvd.find(key, at) + key.size();
    return pvd.substr(from, pvd.find('"', from) - from);
  };
  for (std::size_t at = pvd.find("<DataSet"); at != std::string::npos; at = pvd.find("<DataSet", at + 1))
    out.emplace_back(std::stod(after("timestep=\"", at)), after("file=\"", at));
  return out;
}

void write_frames(FrameWriter& writer, Chain& chain, const std::vector<std::int64_t>& steps) {
  for (const std::int64_t step : steps) {
    chain.at_step(step);
    chain.state.r[ParticleId{0}].y = 1e-3 * static_cast<double>(step);
    writer.write(chain.model, chain.state);
  }
}

TEST(Frames, ListNamesEveryFrameWithItsTime) {
  const Folder folder;
  Chain chain;
  FrameWriter writer(folder.path(), false, {});
  EXPECT_EQ(entries(content_of(folder / "bonds.pvd")).size(), 0u);
  write_frames(writer, chain, {0, 3, 1000});
  for (const std::string kind : {"particles", "bonds"}) {
    const auto list = entries(content_of(folder / (kind + ".pvd")));
    ASSERT_EQ(list.size(), 3u);
    EXPECT_EQ(list[1].first, 3 * 0.1);  // bit for bit, although 3 * 0.1 is not 0.3
    EXPECT_EQ(list[2].second, "frames/" + kind + "_000000001000.vtp");
    for (const auto& [time, name] : list)
      EXPECT_EQ(std::stod(VtpReader(content_of(folder / name)).in_text.at("TimeValue")), time);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "dump.lammpstrj"));
}

TEST(Frames, ContinuedFilesEqualTheUninterruptedOnes) {
  const Folder folder;
  Chain chain;
  std::filesystem::create_directories(folder / "whole");
  std::filesystem::create_directories(folder / "killed");
  {
    FrameWriter writer(folder / "whole", true, {});
    write_frames(writer, chain, {0, 10, 20, 30});
  }
  {
    FrameWriter writer(folder / "killed", true, {});
    write_frames(writer, chain, {0, 10, 20, 27});  // 27: the end of a stage that will come out otherwise
  }
  const auto dump = folder / "killed/dump.lammpstrj";
  put_content(dump, content_of(dump) + "ITEM: TIMES");  // killed in the middle of the next frame
  FrameWriter writer(folder / "killed", true, 25);
  EXPECT_EQ(writer.last_step(), 20);
  write_frames(writer, chain, {30});
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "whole")) {
    if (!entry.is_regular_file()) continue;
    const auto name = std::filesystem::relative(entry.path(), folder / "whole").string();
    EXPECT_EQ(content_of(folder / ("killed/" + name)), content_of(entry.path())) << name;
    ++files;
  }
  EXPECT_EQ(files, 2u * 4 + 3);  // frames, two lists and the dump
  EXPECT_FALSE(std::filesystem::exists(folder / "killed/frames/bonds_000000000027.vtp"));
}

TEST(Frames, DumpCutInsideALineIsMended) {
  const Folder folder;
  Chain chain;
  {
    FrameWriter writer(folder.path(), true, {});
    write_frames(writer, chain, {0, 10});
  }
  const std::string whole = content_of(folder / "dump.lammpstrj");
  for (const std::string tail :
       {"I", "ITEM: TIMESTEP\n", "ITEM: TIMESTEP\n2", "ITEM: TIMESTEP\n20\nITEM: NUM"}) {
    put_content(folder / "dump.lammpstrj", whole + tail);
    FrameWriter writer(folder.path(), true, 10);
    EXPECT_EQ(content_of(folder / "dump.lammpstrj"), whole) << tail;
  }
}

// Larger than what is read of it at once, with frame heads at every place of such a part.
TEST(Frames, LongDumpIsCutAtTheRightFrame) {
  const Folder folder;
  { FrameWriter writer(folder.path(), true, {}); }
  const auto dump = folder / "dump.lammpstrj";
  constexpr std::int64_t frames = 4000;
  std::string text;
  std::vector<std::size_t> begins;
  for (std::int64_t step = 0; step < frames; ++step) {
    begins.push_back(text.size());
    text += "ITEM: TIMESTEP\n" + std::to_string(step) + '\n' + std::string(700, 'x') + '\n';
  }
  ASSERT_GT(text.size(), 2u << 20);
  for (std::int64_t last : {0, 1, 17, 999, 1460, 1461, 1462, 2000, 2525, 2526, 3998, 3999}) {
    put_content(dump, text + "ITEM: TIM");
    FrameWriter(folder.path(), true, last);
    const std::size_t end = last + 1 < frames ? begins[static_cast<std::size_t>(last) + 1] : text.size();
    EXPECT_EQ(content_of(dump), text.substr(0, end)) << last;
  }
  for (std::size_t shift = 0; shift < 40; ++shift) {  // the border of two parts anywhere in a head
    const std::size_t size = (1u << 20) + shift;      // of what follows the beginning of the last head
    put_content(dump, text + "ITEM: TIMESTEP\n5000\n" + std::string(size - 20 - 1, 'y') + '\n');
    FrameWriter(folder.path(), true, 4999);
    EXPECT_EQ(content_of(dump), text) << shift;
  }
}

// Nothing is removed before the lists are written: here the first late frame cannot be removed.
TEST(Frames, ListsNeverNameAFrameThatIsGone) {
  const Folder folder;
  Chain chain;
  {
    FrameWriter writer(folder.path(), false, {});
    write_frames(writer, chain, {0, 10, 20, 30});
  }
  for (const char* kind : {"particles", "bonds"})
    for (const char* step : {"20", "30"}) {
      const auto frame = folder / (std::string("frames/") + kind + "_0000000000" + step + ".vtp");
      ASSERT_TRUE(std::filesystem::remove(frame));
      std::filesystem::create_directories(frame / "in the way");
    }
  EXPECT_THROW(FrameWriter(folder.path(), false, 15), IoError);
  for (const char* list : {"particles.pvd", "bonds.pvd"})
    EXPECT_EQ(entries(content_of(folder / list)).size(), 2u) << list;
}

TEST(Frames, WallsAreListedAndGoOnWithTheOthers) {
  const Folder folder;
  Chain body;
  body.model.walls = {{"floor", PlaneWall{{}, {0, 0, 1}}, 0, {}}};
  const auto list = [&] { return entries(content_of(folder / "walls.pvd")); };
  { FrameWriter(folder.path(), false, {}); }
  EXPECT_FALSE(std::filesystem::exists(folder / "walls.pvd"));
  {
    FrameWriter writer(folder.path(), false, {}, {.walls = true});
    write_frames(writer, body, {0, 10, 20});
  }
  EXPECT_EQ(list().size(), 3u);
  FrameWriter writer(folder.path(), false, 10, {.walls = true});
  EXPECT_EQ(list().size(), 2u);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/walls_000000000020.vtp"));
  write_frames(writer, body, {20});
  EXPECT_EQ(list().size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/walls_000000000020.vtp"));
}

TEST(Frames, MayBeAskedForLaterOn) {
  const Folder folder;
  Chain chain;
  FrameWriter writer(folder.path(), true, 25);
  write_frames(writer, chain, {30});
  EXPECT_EQ(entries(content_of(folder / "particles.pvd")).size(), 1u);
  EXPECT_EQ(content_of(folder / "dump.lammpstrj"), lammps_frame(chain.model, chain.state));
}

TEST(Frames, ForeignListIsNotContinued) {
  const Folder folder;
  { FrameWriter writer(folder.path(), false, {}); }
  put_content(folder / "particles.pvd", "<xml/>");
  EXPECT_THROW(FrameWriter(folder.path(), false, 0), IoError);
}

TEST(LammpsDump, ParsesByItsOwnHeaders) {
  Chain chain;
  chain.turn(1, {0, 1, 0}, 0.5);
  const auto lines = lines_of(lammps_frame(chain.model, chain.state));
  ASSERT_EQ(lines.size(), 9u + 3);
  EXPECT_EQ(lines[1], "1200");
  EXPECT_EQ(lines[3], "3");
  const std::string columns = "ITEM: ATOMS id type x y z vx vy vz radius quatw quati quatj quatk";
  EXPECT_EQ(lines[8], columns);
  double low = 0, high = 0;
  std::istringstream(lines[5]) >> low >> high;
  EXPECT_EQ(low, -chain.model.radius[ParticleId{0}]);
  EXPECT_EQ(high, 2.0 + chain.model.radius[ParticleId{2}]);
  for (const ParticleId p : chain.model.mass.ids()) {
    std::istringstream row(lines[9 + p.value]);
    std::size_t id = 0;
    int type = 0;
    Vec3d r, v;
    double radius = 0;
    Quatd q;
    row >> id >> type >> r.x >> r.y >> r.z >> v.x >> v.y >> v.z >> radius >> q.w >> q.x >> q.y >> q.z;
    EXPECT_FALSE(row.fail());
    EXPECT_EQ(id, p.value + 1u);  // LAMMPS counts from 1
    EXPECT_EQ(type, 1);
    EXPECT_EQ(r, chain.state.r[p]);
    EXPECT_EQ(v, chain.state.v[p]);
    EXPECT_EQ(radius, chain.model.radius[p]);
    EXPECT_EQ(q, chain.state.q[p]);
  }
}

}  // namespace
}  // namespace vbond
