// Frames of periodic bodies: the cell, particles brought into it, and the boxes of dumps.
#include <gtest/gtest.h>

#include <iterator>
#include <map>
#include <sstream>

#include "specimen.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/observe/quantities.hpp"
#include "vtp_reader.hpp"

namespace vbond::cell_frames_test {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;
using test::VtpReader;

/// A chain of three whose last particle is bonded to the first one's next image; the cell is tilted and
/// deforms.
struct Ring : Chain {
  explicit Ring(bool triangular = true) {
    model.cell = {
        {Vec3d{3, 0, 0}, {0.5, 4, 0}, {0.25, -0.5, 5}}, {true, true, false}, {-0.5, -2, 1}, triangular};
    state.cell = cell_at_start(model);
    state.cell[0].rate = {0.1, 0, 0}, state.cell[1].rate = {0.2, 0.3, 0};
    const BondSite last = bond_site(model, state, ParticleId{2}),
                   next = bond_site(model, state, ParticleId{0}, {1, 0, 0});
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
    state.bonds.push_back(make_bond(recipe, last, next).value());
  }
};

std::vector<double> three(const std::vector<double>& all, std::size_t k) {
  return {all.begin() + static_cast<std::ptrdiff_t>(3 * k),
          all.begin() + static_cast<std::ptrdiff_t>(3 * k + 3)};
}
Vec3d point(const VtpReader& f, std::size_t k) {
  const auto x = three(f.arrays.at("Points").as<double>(), k);
  return {x[0], x[1], x[2]};
}

TEST(CellFrame, HasTwelveEdges) {
  const Folder folder;
  Ring ring;
  ring.state.cell[1].along = {0.5, 4.5, 0};
  write_cell_vtp(folder / "c.vtp", ring.model, ring.state, 0.5);
  const VtpReader f(content_of(folder / "c.vtp"));
  EXPECT_EQ(f.points, 8u);
  EXPECT_EQ(f.lines, 12u);
  const Vec3d corner{-0.5, -2 * 4.5 / 4 + 0.0125, 1};  // it moves with the cell: F_yy = 4.5/4, F_yz = 0.0125
  EXPECT_LT(norm(point(f, 0) - corner), 1e-14);
  EXPECT_LT(norm(point(f, 7) - (corner + Vec3d{3.75, 4, 5})), 1e-14);
  const auto ends = f.arrays.at("connectivity").integers(), edge = f.arrays.at("edge").integers();
  std::map<std::int64_t, int> count;
  for (std::size_t k = 0; k < 12; ++k) {
    const Vec3d along =
        point(f, static_cast<std::size_t>(ends[2 * k + 1])) - point(f, static_cast<std::size_t>(ends[2 * k]));
    EXPECT_LT(norm(along - ring.state.cell[static_cast<std::size_t>(edge[k])].along), 1e-14) << k;
    ++count[edge[k]];
  }
  EXPECT_EQ(count, (std::map<std::int64_t, int>{{0, 4}, {1, 4}, {2, 4}}));
  EXPECT_EQ(f.in_text.at("cell"), "3 0 0 0.5 4.5 0 0.25 -0.5 5");
  EXPECT_EQ(f.in_text.at("cell_periodic"), "1 1 0");
  EXPECT_EQ(f.in_text.at("load_factor"), "0.5");
}

TEST(CellFrame, ParticlesTellTheCellAndBondsGoToImages) {
  const Folder folder;
  const Ring ring;
  write_particles_vtp(folder / "p.vtp", ring.model, ring.state, {}, {.cell = true});
  write_bonds_vtp(folder / "b.vtp", ring.state, UnitSystem::reduced, {}, {.cell = true});
  const VtpReader p(content_of(folder / "p.vtp")), b(content_of(folder / "b.vtp"));
  EXPECT_EQ(p.in_text.at("cell"), "3 0 0 0.5 4 0 0.25 -0.5 5");
  EXPECT_EQ(p.in_text.at("cell_corner"), "-0.5 -2 1");
  EXPECT_EQ(p.arrays.count("image"), 0u);
  EXPECT_EQ(b.arrays.at("connectivity").integers(), (std::vector<std::int64_t>{0, 1, 1, 2, 2, 3}));
  EXPECT_EQ(point(b, 3), (Vec3d{3, 0, 0}));  // an image of particle 0, behind the particles
}

// The chain has moved by more than the cell; brought back, particles and bonds are as if it had not.
TEST(CellFrame, WrappedParticlesStandInTheCellAndBondsWithThem) {
  const Folder folder;
  Ring ring;
  const Image away[] = {{2, -1, 0}, {-1, 0, 0}, {0, 3, 0}};
  const State before = ring.state;
  for (const ParticleId p : ring.state.r.ids()) {
    ring.state.r[p] += to_image(ring.state.cell, away[p.value]);
    ring.state.v[p] += image_velocity(ring.state.cell, away[p.value]);
  }
  for (Bond& bond : ring.state.bonds)
    set_image_of_j(bond, image_of_j(bond) + away[bond.i.value] - away[bond.j.value]);
  const FrameFormat format{.cell = true, .wrap = true};
  FrameWriter writer(folder.path(), true, {}, format);
  writer.write(ring.model, ring.state);
  const VtpReader p(content_of(folder / "frames/particles_000000001200.vtp")),
      b(content_of(folder / "frames/bonds_000000001200.vtp"));
  const auto image = p.arrays.at("image").as<std::int32_t>();
  const auto velocity = p.arrays.at("velocity").as<double>(),
             moved = p.arrays.at("displacement").as<double>();
  for (const ParticleId k : before.r.ids()) {
    const std::size_t n = 3 * k.value;
    const Image to_cell = images_in_cell(ring.model, before)[k];
    EXPECT_EQ((Image{image[n], image[n + 1], image[n + 2]}), away[k.value] - to_cell);
    const Vec3d shown = before.r[k] + to_image(before.cell, to_cell);
    EXPECT_LT(norm(point(p, k.value) - shown), 1e-14);
    EXPECT_LT(norm(point(b, k.value) - shown), 1e-14);
    const Vec3d v = before.v[k] + image_velocity(before.cell, to_cell);
    EXPECT_LT(norm(Vec3d{velocity[n], velocity[n + 1], velocity[n + 2]} - v), 1e-14);
    const Vec3d u = ring.state.r[k] - ring.model.r_0[k];  // of the particle, not of the image
    EXPECT_LT(norm(Vec3d{moved[n], moved[n + 1], moved[n + 2]} - u), 1e-14);
  }
  const auto ends = b.arrays.at("connectivity").integers();
  for (std::size_t k = 0; k < 3;
       ++k) {  // each bond is as long as it is, from where its first particle is shown
    EXPECT_EQ(ends[2 * k], static_cast<std::int64_t>(ring.state.bonds[BondId{k}].i.value));
    const Vec3d along =
        point(b, static_cast<std::size_t>(ends[2 * k + 1])) - point(b, static_cast<std::size_t>(ends[2 * k]));
    EXPECT_LT(norm(along - between(ring.state, ring.state.bonds[BondId{k}])), 1e-14) << k;
  }
  EXPECT_NE(content_of(folder / "cell.pvd").find("frames/cell_000000001200.vtp"), std::string::npos);
  const auto dump = lines_of(content_of(folder / "dump.lammpstrj"));
  EXPECT_EQ(dump[8], "ITEM: ATOMS id type x y z vx vy vz radius quatw quati quatj quatk ix iy iz");
  std::istringstream row(dump[9]);
  std::vector<double> numbers{std::istream_iterator<double>(row), {}};
  ASSERT_EQ(numbers.size(), 16u);
  EXPECT_EQ(numbers[2], point(p, 0).x);
  EXPECT_EQ(numbers[13], image[0]);
  EXPECT_EQ(numbers[14], image[1]);
}

TEST(CellFrame, AViewByImagesIsTheSameBody) {
  Ring ring;
  ring.state.r[ParticleId{1}] += Vec3d{0.1, 0.2, -0.1};
  ring.state.bonds[BondId{2}].a += 0.05;
  PerParticle<Image> images(3);
  images[ParticleId{0}] = {5, -2, 0}, images[ParticleId{2}] = {1, 1, 0};
  const State shown = shown_by_images(ring.state, images);
  const double U = bond_energies(ring.state).potential();
  EXPECT_GT(U, 1e-4);
  EXPECT_NEAR(bond_energies(shown).potential(), U, 1e-13 * U);
}

std::string box_line(const CellShape& shape, bool shears, const std::array<Vec3d, 3>& now) {
  Ring ring;
  ring.model.cell = shape;
  ring.state.cell = cell_at_start(ring.model);
  for (std::size_t k = 0; k < 3; ++k) ring.state.cell[k].along = now[k];
  return lines_of(lammps_frame(ring.model, ring.state, {.cell = true, .cell_shears = shears}))[4];
}

// Readers of dumps take the style of the first frame for that of all.
TEST(LammpsDump, KeepsTheStyleOfItsBox) {
  const std::array<Vec3d, 3> cube{Vec3d{3, 0, 0}, {0, 3, 0}, {0, 0, 3}},
      tilted{Vec3d{3, 0, 0}, {0.4, 3, 0}, {0, 0, 3}}, turned{Vec3d{3, 0.1, 0}, {0.1, 3, 0}, {0, 0, 3}};
  const CellShape symmetric{cube, {true, true, true}, {}, false},
      triangular{cube, {true, true, true}, {}, true};
  EXPECT_EQ(box_line(symmetric, false, cube), "ITEM: BOX BOUNDS pp pp pp");
  for (const auto& now : {cube, turned})
    EXPECT_EQ(box_line(symmetric, true, now), "ITEM: BOX BOUNDS abc origin pp pp pp");
  for (const auto& now : {cube, tilted})
    EXPECT_EQ(box_line(triangular, true, now), "ITEM: BOX BOUNDS xy xz yz pp pp pp");
  EXPECT_EQ(box_line({tilted, {true, true, false}, {}, false}, false, tilted),
            "ITEM: BOX BOUNDS xy xz yz pp pp ss");
  EXPECT_EQ(box_line({turned, {true, true, true}, {}, true}, false, turned),
            "ITEM: BOX BOUNDS abc origin pp pp pp");
  // of a cell that has not kept to it no frame is wrong
  EXPECT_EQ(box_line(symmetric, false, turned), "ITEM: BOX BOUNDS abc origin pp pp pp");
}

// A prism of LAMMPS (29 Sep 2021): region 0 4 0 3 0 5 1.2 -0.7 0.9, and the box of its dump.
TEST(LammpsDump, HasTheBoxOfATiltedCellAsLammps) {
  Ring ring;
  ring.model.cell = {{Vec3d{4, 0, 0}, {1.2, 3, 0}, {-0.7, 0.9, 5}}, {true, true, true}, {}, true};
  ring.state.cell = cell_at_start(ring.model);
  const auto lines = lines_of(lammps_frame(ring.model, ring.state, {.cell = true}));
  EXPECT_EQ(lines[5], "-0.7 5.2 1.2");
  EXPECT_EQ(lines[6], "0 3.9 -0.7");
  EXPECT_EQ(lines[7], "0 5 0.9");
  EXPECT_EQ(lines[8], "ITEM: ATOMS id type xu yu zu vx vy vz radius quatw quati quatj quatk");
}

TEST(CellFrame, ListsOfAResumedRunGoOn) {
  const Folder folder;
  Ring ring;
  const FrameFormat format{.cell = true};
  {
    FrameWriter writer(folder.path(), false, {}, format);
    for (const std::int64_t step : {0, 10, 20}) {
      ring.state.clock.step = step;
      writer.write(ring.model, ring.state);
    }
  }
  FrameWriter writer(folder.path(), false, 10, format);
  const std::string list = content_of(folder / "cell.pvd");
  EXPECT_NE(list.find("cell_000000000010.vtp"), std::string::npos);
  EXPECT_EQ(list.find("cell_000000000020.vtp"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/cell_000000000020.vtp"));
}

}  // namespace vbond::cell_frames_test
