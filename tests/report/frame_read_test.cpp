#include "vbond/report/frame_read.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "dynamics/processes.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frame_names.hpp"
#include "vbond/observe/frames.hpp"

namespace vbond::frame_read_test {
namespace {

namespace fs = std::filesystem;
using Per = FrameInput::Per;
using test::Chain;
using test::content_of;
using test::Folder;
using test::put_content;

constexpr FrameFormat format{.breaks = true, .capsules = true, .flow = true};

std::vector<ParticleId> ids(const std::vector<std::size_t>& numbers) {
  std::vector<ParticleId> particles;
  for (const std::size_t k : numbers) particles.emplace_back(k);
  return particles;
}

std::vector<ImageOf> ghosts(const std::vector<std::size_t>& numbers) {
  std::vector<ImageOf> particles;
  for (const std::size_t k : numbers) particles.push_back({ParticleId{k}, {}});
  return particles;
}

/// A chain of seven, bent, with a broken bond; and its frames, whole and in three parts: particles that have
/// neighbours in others, the rest of them, and none.
struct InParts {
  Folder folder;
  Chain chain{7};
  testing::Meeting meeting{3};

  InParts() {
    State& s = chain.state;
    for (const ParticleId p : chain.model.mass.ids()) {
      const double x = p.value;
      s.r[p] = {x, 0.01 * x * x, 0};
      s.v[p] = {0, x, -x};
    }
    s.clock.stage_step = s.clock.step;
    s.bonds[BondId{2}].broken = true;
    fs::create_directory(folder / "frames");
    write_particles_vtp(folder / "p.vtp", chain.model, s, {}, format);
    write_bonds_vtp(folder / "b.vtp", s, UnitSystem::reduced, {}, format);
    std::vector<std::thread> processes;
    processes.emplace_back([this] { write({ids({3, 1, 2, 6}), ids({1, 3, 6}), ghosts({0, 4, 5})}, 0); });
    processes.emplace_back([this] { write({ids({0, 4, 5}), ids({0, 4, 5}), ghosts({1, 3, 6})}, 1); });
    processes.emplace_back([this] { write({}, 2); });
    for (std::thread& p : processes) p.join();
    write_lists_of_parts(folder.path(), 3, chain.model, s.clock.step, format);
  }
  fs::path list(const char* kind) const { return folder / name_of_parts(kind, chain.state.clock.step); }
  fs::path file(const char* kind, int part) const {
    return folder / name_of_part(kind, chain.state.clock.step, part);
  }

 private:
  void write(const Holding& holding, int part) {
    Stage stage;
    stage.name = "pull";
    stage.dt = chain.state.clock.dt;
    State state = chain.state;
    testing::Process process(meeting, static_cast<std::size_t>(part));
    const Simulation run(chain.model, stage, &state, {part_of(spatial_order(chain.model.r_0), holding)},
                         process);
    write_part(folder.path(), part, run, format);
  }
};

/// What reading a frame says of it.
std::string trouble_with(const fs::path& file) {
  try {
    const FrameInput in(file);
    in.integers(Per::end, "connectivity");
    return "none";
  } catch (const IoError& e) {
    return e.what();
  }
}

void expect_found(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

/// All arrays of a table, which must be there, in both.
template <class Quantity>
void expect_same_arrays(const FrameInput& a, const FrameInput& b, Per per, std::span<const Quantity> table) {
  for (const Quantity& q : table) {
    if (q.cases == Only::stress || q.cases == Only::cell || q.cases == Only::wrap || q.cases == Only::passage)
      continue;
    const auto same = [&](auto get) { EXPECT_EQ((a.*get)(per, q.name), (b.*get)(per, q.name)) << q.name; };
    std::visit(
        [&]<class T, class View>(T (*)(const View&)) {
          if constexpr (std::is_same_v<T, double>) same(&FrameInput::scalars);
          if constexpr (std::is_same_v<T, Vec3d>) same(&FrameInput::vectors);
          if constexpr (std::is_same_v<T, std::int64_t>) same(&FrameInput::integers);
          if constexpr (std::is_same_v<T, std::uint8_t>) same(&FrameInput::bytes);
        },
        q.value);
  }
}

TEST(FrameInput, PutsPartsTogetherAsTheWhole) {
  const InParts body;
  const FrameInput p(body.folder / "p.vtp"), of_parts(body.list("particles"));
  EXPECT_EQ(of_parts.points(), 7U);
  EXPECT_EQ(of_parts.step(), p.step());
  EXPECT_EQ(of_parts.time(), p.time());
  EXPECT_EQ(of_parts.unit("velocity"), p.unit("velocity"));
  EXPECT_FALSE(of_parts.has(Per::point, "stress_normal"));
  EXPECT_EQ(of_parts.vectors(Per::point, "Points"), p.vectors(Per::point, "Points"));
  expect_same_arrays(of_parts, p, Per::point, particle_quantities());

  const FrameInput b(body.folder / "b.vtp"), bonds(body.list("bonds"));
  EXPECT_EQ(bonds.points(), 7U);
  EXPECT_EQ(bonds.cells(), 6U);
  EXPECT_TRUE(bonds.lines());
  EXPECT_EQ(bonds.vectors(Per::point, "Points"), b.vectors(Per::point, "Points"));
  EXPECT_EQ(bonds.integers(Per::end, "connectivity"), b.integers(Per::end, "connectivity"));
  expect_same_arrays(bonds, b, Per::cell, bond_quantities());
}

TEST(FrameInput, RefusesPartsThatAreNotOfOneFrame) {
  const InParts body;
  const auto particles = [&body](int part) { return body.file("particles", part); };
  const std::string good = content_of(particles(1));
  const auto with = [&](const std::string& content) {
    put_content(particles(1), content);
    return trouble_with(body.list("particles"));
  };
  EXPECT_EQ(with(good), "none");
  expect_found(with(content_of(particles(0))), "two of its parts have the number 1");
  expect_found(with(content_of(body.folder / "b.vtp")), "its parts are not of one frame");
  std::string fewer = good;
  const std::string cells = "NumberOfVerts=\"3\"";
  expect_found(with(fewer.replace(fewer.find(cells), cells.size(), "NumberOfVerts=\"2\"")),
               "a part has particles that are not points");
  std::string later = good;
  const std::string step = ">" + std::to_string(body.chain.state.clock.step) + "<";
  expect_found(with(later.replace(later.find(step), step.size(), ">" + std::to_string(1201) + "<")),
               "its parts are not of one frame");
  // of particles some may not be there, so that numbers have gaps: how many there are is told
  expect_found(with(content_of(particles(2))), "particles are missing");
  put_content(particles(1), good);
  // of bonds none is left out
  put_content(body.file("bonds", 1), content_of(body.file("bonds", 2)));
  expect_found(trouble_with(body.list("bonds")), "number");
  fs::remove(particles(1));
  expect_found(trouble_with(body.list("particles")), particles(1).filename().string());
}

TEST(FrameInput, RefusesListsThatItDidNotWrite) {
  const InParts body;
  const std::string good = content_of(body.list("bonds"));
  const auto edited = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    put_content(body.list("bonds"), text.replace(text.find(from), from.size(), to));
    return trouble_with(body.list("bonds"));
  };
  const std::string name = body.file("bonds", 1).filename().string();
  EXPECT_EQ(edited(name, name), "none");
  expect_found(edited(name, "../" + name), "is damaged, at");
  expect_found(edited("PPolyData", "PImageData"), "is damaged, at");
  expect_found(edited("</VTKFile>\n", "</VTKFile>\nmore"), "is damaged, at");
  expect_found(edited(name, body.file("bonds", 0).filename().string()), "twice");
  put_content(body.list("bonds"), "");
  expect_found(trouble_with(body.list("bonds")), "is damaged, at");
}

TEST(FrameNames, AreThoseOfFramesAndOfWhatIsLeftOfThem) {
  EXPECT_EQ(step_of_frame(fs::path(frame_name("walls", 70)).filename().string()), 70);
  EXPECT_EQ(step_of_frame(fs::path(name_of_part("bonds", 1200, 31)).filename().string()), 1200);
  EXPECT_EQ(step_of_frame(fs::path(name_of_parts("particles", 0)).filename().string()), 0);
  EXPECT_EQ(step_of_frame("bonds_000000000007_2.vtp.part"), 7);
  for (const char* other :
       {"bonds_7_.vtp", "bonds_7_2.pvtp", "bonds_7_2_3.vtp", "bonds_-7.vtp", "bonds_.vtp", "notes_7.vtp",
        "bonds_7.vtk", "bonds_7", "bonds_7a.vtp", "7.vtp", "", "bonds_99999999999999999999.vtp"})
    EXPECT_FALSE(step_of_frame(other)) << other;
}

TEST(FrameWriter, GoesOnWithFramesInPartsWithoutTheLateOnes) {
  const InParts body;
  const std::int64_t step = body.chain.state.clock.step;
  const auto entry = [](const char* kind, std::int64_t at) {
    return pvd_entry(0.1, name_of_parts(kind, at));
  };
  for (const char* kind : {"particles", "bonds"}) {
    put_content(body.folder / (kind + std::string(".pvd")),
                pvd_list(entry(kind, step) + entry(kind, step + 10)));
    for (const std::string& late : {name_of_parts(kind, step + 10), name_of_part(kind, step + 10, 1)})
      put_content(body.folder / late, "late");
  }
  const FrameWriter writer(body.folder.path(), false, step + 5, format);
  EXPECT_EQ(writer.last_step(), step);
  EXPECT_EQ(read_pvd(body.folder / "bonds.pvd").size(), 1U);
  EXPECT_EQ(trouble_with(read_pvd(body.folder / "bonds.pvd")[0].file), "none");
  std::size_t files = 0;
  for (const auto& file : fs::directory_iterator(body.folder / "frames")) {
    EXPECT_EQ(step_of_frame(file.path().filename().string()), step) << file.path();
    ++files;
  }
  EXPECT_EQ(files, 8U);  // of two kinds three parts and their list
}

}  // namespace
}  // namespace vbond::frame_read_test
