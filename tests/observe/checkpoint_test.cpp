#include "vbond/observe/checkpoint.hpp"
#include "vbond/model/rules.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "specimen.hpp"
#include "under_way.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/seal.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::put_content;

/// A checkpoint in which no field has its default value, so that a forgotten one is noticed.
Checkpoint busy_checkpoint(Chain& chain) {
  chain.turn(1, {0.3, 0.4, 0.5}, 0.7);
  chain.state.r[ParticleId{0}] = {-0.0, std::numeric_limits<double>::denorm_min(), 1e308};
  chain.state.clock = {
      .step = 5000000000, .stage_step = 4999999999, .stage = 2, .stage_start = 0.1, .dt = 1e-9};
  chain.state.books = {.at_start = 1.1,
                       .dissipated = 2.2,
                       .released = 7.7,
                       .work_loads = 3.3,
                       .work_supports = 4.4,
                       .largest = 5.5};
  for (std::size_t k = 0; k < loss_count; ++k)
    chain.state.books.lost[static_cast<Loss>(k)] = 0.01 * static_cast<double>(k + 1);
  chain.state.temperature = {10.5, -3.0, 0.25};
  chain.state.warm_bonds = {{BondId{1}, 1e-3, 0.5, 0.1, 0.2}};
  chain.state.peak = {.sum = 0.1, .samples = 7, .last = 0.2, .peak = 0.3, .peak_time = 0.4, .blocks = 8};
  chain.state.rest = {.quiet_steps = 9};
  chain.state.breaks = 5;
  chain.state.bonds[BondId{1}].law = &bond_law<WithRules<Evm>::Law>;
  BondRules rules;
  rules.stretch.form = StretchForm::morse, rules.stretch.alpha = 5.0;
  rules.strength = elongation_strength(0.1);
  chain.state.bonds[BondId{1}].rules = &kept(rules);
  chain.state.bonds[BondId{1}].broken = true;
  chain.state.bonds[BondId{1}].mode = BreakMode::bending;
  chain.state.bond_history = {{0.1, 0.2}, {0.3}};
  chain.state.contact_history = {{ParticleId{0}, ParticleId{2}, {0.5, -0.25}}};
  chain.state.grips = {
      {{1, 2, 3}, 0.5, 0.25, 1, {}, {1, 0, 0, 0}, {}, {}},
      {{4, 5, 6}, 1.5, 0.75, 1, {7, 8, 9}, rotation_of({0, 0, 1}), {1, 2, 0}, {0, 3, 1}, 0.5}};
  chain.state.gripped = {{{0.1, 0.2, 0.3}, rotation_of({0.1, 0, 0})}, {{-1, 0, 1}, rotation_of({0, 0.2, 1})}};
  chain.state.carried = {{ParticleId{0}, 2}, {ParticleId{2}, 1}};
  chain.state.pressed = {{0, ParticleId{0}, ParticleId{1}, ParticleId{2}, {0.1, -1, 2}, {}},
                         {1, ParticleId{2}, ParticleId{0}, ParticleId{2}, {3, 0, 0.7}, {0.2, 0.1, 0}}};
  set_capsule(chain.state.bonds[BondId{0}], 0.3);
  chain.state.fibre_history = {{ParticleId{0},
                                ParticleId{1},
                                ParticleId{2},
                                ParticleId{2},
                                0.25,
                                0.0,
                                0.3,
                                0.2,
                                {0, 0, 1},
                                {0.5, -0.25, 0.125}}};
  chain.state.damping = {{{1, 1, 3}, {4, 1, 6}, {7, 1, 9}}, {{3, 1, 1}, {6, 1, 4}, {9, 1, 7}}};
  chain.state.local_damping = {{{0, 1, 3}, {4, 0, 6}, {7, 1, 0}}, {{3, 0, 1}, {6, 0, 4}, {0, 1, 7}}};
  chain.state.loads = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{3, 2, 1}, {6, 5, 4}, {9, 8, 7}}};
  WatchRecord watch;
  watch.bonds = {{BondRange::snapped, false}, {BondRange::strained, true}};
  watch.strained = 3, watch.snapped = 2, watch.shortened = 1;
  watch.overlapping = {{ParticleId{0}, ParticleId{2}}, {ParticleId{1}, ParticleId{2}}};
  watch.stretched = {BondId{1}};
  watch.fastest = 3.5;
  watch.farthest_turn = 0.75;
  watch.in_walls = {{ParticleId{1}, 0}, {ParticleId{1}, 1}};
  watch.deep[{ParticleId{0}, ParticleId{2}}] = {ParticleId{0}, ParticleId{2}, {0.1, -0.2, 0.3}, 0.25, 1199};
  return {chain.state, watch};
}

std::string error_of(const std::filesystem::path& path, const Model& model) {
  try {
    read_checkpoint(path, model);
  } catch (const IoError& e) {
    return e.what();
  }
  return "no error";
}

void expect_error(const std::filesystem::path& path, const Model& model, const std::string& part) {
  EXPECT_NE(error_of(path, model).find(part), std::string::npos) << error_of(path, model);
  EXPECT_NE(error_of(path, model).find(path.string()), std::string::npos) << error_of(path, model);
}

TEST(Checkpoint, ReadsBackBitForBit) {
  const Folder folder;
  Chain chain;
  const Checkpoint written = busy_checkpoint(chain);
  write_checkpoint(folder / "checkpoint.h5", chain.model, written, "1.2.3");
  const Checkpoint read = read_checkpoint(folder / "checkpoint.h5", chain.model);
  EXPECT_TRUE(read == written);
  // == does not tell -0 from 0
  EXPECT_EQ(std::memcmp(read.state.r.data(), written.state.r.data(), 3 * sizeof(Vec3d)), 0);
}

TEST(Checkpoint, BodyWithoutBondsReadsBack) {
  const Folder folder;
  Chain chain(1);
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  EXPECT_TRUE(read_checkpoint(folder / "c.h5", chain.model).state == chain.state);
}

TEST(Checkpoint, SameStateGivesTheSameBytesLater) {
  const Folder folder;
  Chain chain;
  const Checkpoint c = busy_checkpoint(chain);
  write_checkpoint(folder / "a.h5", chain.model, c, "1.2.3");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 would store times in seconds
  write_checkpoint(folder / "b.h5", chain.model, c, "1.2.3");
  EXPECT_EQ(content_of(folder / "a.h5"), content_of(folder / "b.h5"));
}

TEST(Checkpoint, ReplacesTheOldOneAndLeavesNothingElse) {
  const Folder folder;
  Chain chain;
  for (const std::int64_t step : {10, 20}) {
    chain.at_step(step);
    write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  }
  EXPECT_EQ(read_checkpoint(folder / "c.h5", chain.model).state.clock.step, 20);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.exists();
  EXPECT_EQ(files, 1u);
}

TEST(Checkpoint, EveryTruncatedFileIsRefused) {
  const Folder folder;
  Chain chain;
  write_checkpoint(folder / "c.h5", chain.model, busy_checkpoint(chain), "1.2.3");
  const std::string whole = content_of(folder / "c.h5");
  for (const double part : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999}) {
    put_content(folder / "cut.h5",
                whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    expect_error(folder / "cut.h5", chain.model, "cut short");
  }
}

TEST(Checkpoint, RandomBytesAreRefused) {
  const Folder folder;
  Chain chain;
  std::mt19937 random(1);
  std::string bytes(20000, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  put_content(folder / "random.h5", bytes);
  expect_error(folder / "random.h5", chain.model, "is not a checkpoint of vbond");
}

TEST(Checkpoint, EveryDamagedByteIsNoticed) {
  const Folder folder;
  Chain chain;
  write_checkpoint(folder / "c.h5", chain.model, busy_checkpoint(chain), "1.2.3");
  const std::string whole = content_of(folder / "c.h5");
  for (std::size_t at = seal_size; at < whole.size(); at += 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    put_content(folder / "d.h5", damaged);
    expect_error(folder / "d.h5", chain.model, "checksum");
  }
}

TEST(Checkpoint, MissingFileIsToldInTheSystemsWords) {
  const Folder folder;
  expect_error(folder / "none.h5", Chain().model, "No such file");
}

TEST(Checkpoint, ForeignHdf5FileIsRefused) {
  const Folder folder;
  H5Fclose(H5Fcreate((folder / "foreign.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  expect_error(folder / "foreign.h5", Chain().model, "is not a checkpoint of vbond");
}

TEST(Checkpoint, OtherFormatNamesTheVersionToUse) {
  const Folder folder;
  Chain chain;
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "9.8.7");
  std::string newer = content_of(folder / "c.h5");
  newer.replace(newer.find("format 4\n"), 9, "format 7\n");
  put_content(folder / "c.h5", newer);
  expect_error(folder / "c.h5", chain.model, "vbond 9.8.7, in format 7");
}

TEST(Checkpoint, OtherModelIsRefused) {
  const Folder folder;
  Chain chain;
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  expect_error(folder / "c.h5", Chain(4).model, "it has 3 particles, the case has 4");
  Model heavier = chain.model;
  heavier.mass[ParticleId{1}] *= 1.0 + 1e-15;
  expect_error(folder / "c.h5", heavier, "masses differ");
  Model top = chain.model;
  make_top(top, ParticleId{1}, {{0.1, 0.2, 0.25}, {}});
  top.inertia = chain.model.inertia;
  expect_error(folder / "c.h5", top, "moments of inertia differ");
  write_checkpoint(folder / "top.h5", top, {chain.state, {}}, "1.2.3");
  EXPECT_TRUE(read_checkpoint(folder / "top.h5", top).state == chain.state);
  expect_error(folder / "top.h5", chain.model, "moments of inertia differ");
  Model turned = top;
  turned.principal[ParticleId{1}].axes = {0, 1, 0, 0};
  expect_error(folder / "top.h5", turned, "moments of inertia differ");
  Model moved = chain.model;
  moved.r_0[ParticleId{1}].z += 1e-300;
  expect_error(folder / "c.h5", moved, "first positions differ");
}

// Grains without bonds fit any cell: only its first edges tell.
TEST(Checkpoint, OtherCellIsRefused) {
  const Folder folder;
  Chain chain;
  chain.model.cell.edges = {Vec3d{9, 0, 0}, {1, 9, 0}, {0, 0, 9}};
  chain.model.cell.periodic = {true, true, false};
  chain.state.cell = cell_at_start(chain.model);
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  EXPECT_TRUE(read_checkpoint(folder / "c.h5", chain.model).state == chain.state);
  Model wider = chain.model, closed = chain.model, triangular = chain.model;
  wider.cell.edges[1].x = 1.1;
  closed.cell.periodic[2] = true;
  triangular.cell.triangular = true;
  for (const Model& other : {wider, closed, triangular})
    expect_error(folder / "c.h5", other, "its cells at the start differ");
}

TEST(Checkpoint, ImpossibleBondIsRefused) {
  const Folder folder;
  Chain chain;
  chain.state.bonds[BondId{0}].j = ParticleId{77};
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  expect_error(folder / "c.h5", chain.model, "is damaged: bonds[0].j is particle 77, and there are 3");
}

TEST(Checkpoint, UnwritableFolderIsAnError) {
  const Folder folder;
  Chain chain;
  EXPECT_THROW(write_checkpoint(folder / "nowhere/c.h5", chain.model, {chain.state, {}}, "1"), IoError);
}

TEST(Checkpoint, ErrorsOfHdf5AreNotPrinted) {
  const Folder folder;
  put_content(folder / "c.h5", std::string(seal_size, ' ') + "not HDF5");
  write_seal(folder / "c.h5", 1, "1.2.3");  // sound in itself, so that HDF5 has to find out
  testing::internal::CaptureStderr();
  EXPECT_NE(error_of(folder / "c.h5", Chain().model), "no error");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Checkpoint, StatesThatNoRunIsInAreRefused) {
  const Folder folder;
  const auto refused = [&](const std::string& words, auto forge) {
    Chain chain;
    Checkpoint c = busy_checkpoint(chain);
    forge(c);
    write_checkpoint(folder / "c.h5", chain.model, c, "1.2.3");
    expect_error(folder / "c.h5", chain.model, words);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("is damaged: the position of particle 1",
          [nan](Checkpoint& c) { c.state.r[ParticleId{1}].y = nan; });
  refused("is damaged: the velocity of particle 2",
          [](Checkpoint& c) { c.state.v[ParticleId{2}].z = INFINITY; });
  refused("is damaged: the orientation of particle 0", [](Checkpoint& c) {
    c.state.q[ParticleId{0}] = {2, 0, 0, 0};
  });
  refused("is damaged: contacts[0].j is particle 3, and there are 3",
          [](Checkpoint& c) { c.state.contact_history[0].j = ParticleId{3}; });
  refused("is damaged: warm_bonds[0].bond is bond 2, and there are 2",
          [](Checkpoint& c) { c.state.warm_bonds[0].bond = BondId{2}; });
  refused("is damaged: fibres[0].b_j is particle 9",
          [](Checkpoint& c) { c.state.fibre_history[0].b_j = ParticleId{9}; });
  refused("a deep pair has impossible ends",
          [](Checkpoint& c) { c.watch.deep.begin()->second.j = ParticleId{3}; });
  refused("watches missing bonds", [](Checkpoint& c) { c.watch.bonds.resize(3); });
}

// Bonds had nine coefficients once, and twelve; shorter rows are read as nine and zeros.
// What is read of a stage of fracture under way gives the same file again; other checkpoints keep their
// format.
TEST(Checkpoint, WithinAStageOfFractureItHoldsAllThatTheStageKnows) {
  const Folder folder;
  Chain chain;
  const FractureUnderWay under_way = test::under_way_of(chain.state);
  write_checkpoint(folder / "a.h5", chain.model, chain.state, {}, "test", &under_way);
  const Checkpoint read = read_checkpoint(folder / "a.h5", chain.model);
  ASSERT_TRUE(read.under_way);
  EXPECT_TRUE(read.under_way->found == under_way.found);
  EXPECT_TRUE(read.under_way->factor.random == under_way.factor.random);
  EXPECT_TRUE(read.under_way->held == under_way.held);
  write_checkpoint(folder / "b.h5", chain.model, read, "test");
  EXPECT_EQ(content_of(folder / "a.h5"), content_of(folder / "b.h5"));
  EXPECT_EQ(content_of(folder / "a.h5").substr(0, 26), "vbond checkpoint\nformat 5\n");
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "test");
  EXPECT_EQ(content_of(folder / "c.h5").substr(0, 26), "vbond checkpoint\nformat 4\n");
  EXPECT_FALSE(read_checkpoint(folder / "c.h5", chain.model).under_way);
}

TEST(Checkpoint, WithinAStageOfFractureWhatCannotBelongIsRefused) {
  const Folder folder;
  Chain chain;
  const FractureUnderWay good = test::under_way_of(chain.state);
  const auto refuses = [&](auto change, const std::string& why) {
    FractureUnderWay bad = good;
    change(bad);
    write_checkpoint(folder / "bad.h5", chain.model, chain.state, {}, "test", &bad);
    try {
      read_checkpoint(folder / "bad.h5", chain.model);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refuses([](FractureUnderWay& u) { u.found.points = 4; }, "at another point");
  refuses([](FractureUnderWay& u) { u.numbers.breaks = 2; }, "more breaks than are listed");
  refuses([](FractureUnderWay& u) { u.rate.pop_back(); }, "moves other unknowns");
  refuses([](FractureUnderWay& u) { u.factor.changes[0].unknowns[1] = 12; }, "of other unknowns");
  refuses([](FractureUnderWay& u) { u.factor.changes[0].numbers.pop_back(); }, "cut short");
  refuses([](FractureUnderWay& u) { u.found.fracture.breaks[0].use.bond = BondId{9}; }, "none of its bonds");
  refuses([](FractureUnderWay& u) { u.held[0].particle = ParticleId{9}; }, "a part that is held is missing");
  refuses([](FractureUnderWay& u) { u.held[0].dof = 6; }, "an impossible direction");
  refuses(
      [](FractureUnderWay& u) {
        u.pattern = std::make_shared<const std::vector<std::pair<ParticleId, ParticleId>>>(
            1, std::pair(ParticleId{0}, ParticleId{0}));
      },
      "lacks a bond");
  refuses([](FractureUnderWay& u) { u.numbers.flows = true; }, "have no past");
  refuses(
      [](FractureUnderWay& u) {
        State other = *u.begun;
        other.bonds = {};
        u.begun = std::make_shared<const State>(other);
      },
      "began with other bonds");
}

TEST(Checkpoint, ShorterRowsOfEarlierVersionsAreFilledUp) {
  const Folder folder;
  const Chain chain(3);
  write_checkpoint(folder / "c.h5", chain.model, {chain.state, {}}, "1.2.3");
  const hid_t file = H5Fopen((folder / "c.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "/bonds/coefficients", H5P_DEFAULT), 0);
  const hsize_t size[] = {2, 9};
  const hid_t space = H5Screate_simple(2, size, nullptr);
  const hid_t set =
      H5Dcreate2(file, "/bonds/coefficients", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  double numbers[18]{};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t n = 0; n < 9; ++n) numbers[9 * k + n] = chain.state.bonds[BondId{k}].coefficients[n];
  ASSERT_GE(H5Dwrite(set, H5T_IEEE_F64LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers), 0);
  H5Dclose(set), H5Sclose(space), H5Fclose(file);
  write_seal(folder / "c.h5", 4, "1.2.3");
  EXPECT_EQ(read_checkpoint(folder / "c.h5", chain.model).state.bonds, chain.state.bonds);
}

TEST(Checkpoint, NumbersOfAnotherFileAreRefused) {
  const Folder folder;
  Chain chain;
  const Checkpoint c = busy_checkpoint(chain);
  for (const char* name : {"c.h5", "other.h5"}) write_checkpoint(folder / name, chain.model, c, "1.2.3");
  const hid_t file = H5Fopen((folder / "c.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "/books/at_start", H5P_DEFAULT), 0);
  ASSERT_GE(
      H5Lcreate_external("other.h5", "/books/at_start", file, "/books/at_start", H5P_DEFAULT, H5P_DEFAULT),
      0);
  H5Fclose(file);
  write_seal(folder / "c.h5", 4, "1.2.3");
  expect_error(folder / "c.h5", chain.model, "/books/at_start is missing or not as expected");
}

}  // namespace
}  // namespace vbond
