// Periodic bodies on the page: the cell of each frame, and which images bonds join, from frames of either
// kind.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "page_reader.hpp"
#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/report/page.hpp"

namespace vbond::page::page_cell_test {
namespace {

using test::array_of;
using test::Chain;
using test::Folder;
using test::json_of;
using test::one_line;

/// A chain of three bonded to its next image, whose particles leave a cell that is sheared.
struct Film {
  Folder folder;
  std::vector<State> states;
  std::vector<FrameFiles> files;
  Chain chain;

  explicit Film(FrameFormat format) {
    Model& model = chain.model;
    model.cell = {{Vec3d{3, 0, 0}, {0.5, 4, 0}, {0, 0, 5}}, {true, true, false}, {-0.25, -2, 0}, true};
    chain.state.cell = cell_at_start(model);
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.1};
    chain.state.bonds.push_back(make_bond(recipe, bond_site(model, chain.state, ParticleId{2}),
                                          bond_site(model, chain.state, ParticleId{0}, {1, 0, 0}))
                                    .value());
    format.cell = true;
    FrameWriter writer(folder.path(), false, {}, format);
    for (int f = 0; f < 3; ++f) {
      chain.at_step(10 * f);
      State s = chain.state;
      s.cell[1].along.x += 0.5 * f;
      for (const ParticleId p : s.r.ids()) s.r[p] += Vec3d{4.0 * f + 2.0 * f * p.value, 3.0 * f, 0.1 * f};
      writer.write(model, s);
      states.push_back(s);
    }
    files = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
  }

  Report report() const {
    Report r;
    r.sequences.push_back(read_sequence({SequenceKind::run, "Run", "", "", files}, r.body));
    r.stage_of_frame.assign(files.size(), "shear");
    return r;
  }
};

void expect_film(const Film& film) {
  const Report report = film.report();
  EXPECT_EQ(report.body.bonds, (std::vector<std::uint32_t>{0, 1, 1, 2, 2, 0}));
  EXPECT_EQ(report.body.images, (std::vector<float>{0, 0, 0, 0, 0, 0, 1, 0, 0}));
  const std::string html = report_page(one_line, report, {});
  const auto j = json_of(html), s = j["sequences"][0];
  EXPECT_EQ(array_of(html, j["bond_image"]), (std::vector<double>{0, 0, 0, 0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(s["cell"]["periodic"], (std::vector<bool>{true, true, false}));
  const std::vector<double> cells = array_of(html, s["cell"]["edges"]),
                            reference = array_of(html, s["reference"]);
  ASSERT_EQ(cells.size(), 3u * 12u);
  for (std::size_t f = 0; f < 3; ++f) {
    const FrameCell cell = *frame_cell(film.chain.model, film.states[f]);
    const std::array<Vec3d, 4> expected{cell.edges[0], cell.edges[1], cell.edges[2], cell.corner};
    for (std::size_t k = 0; k < 12; ++k) {
      const double from_origin = k < 9 ? 0.0 : s["origin"][k - 9].get<double>();
      EXPECT_NEAR(cells[12 * f + k] + from_origin, component(expected[k / 3], static_cast<int>(k % 3)), 1e-6);
    }
  }
  // where particles go, faces or not: the page brings them into the cell by itself
  for (const ParticleId p : film.chain.model.r_0.ids())
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(reference[3 * p.value + c] + s["origin"][c].get<double>(),
                  component(film.chain.model.r_0[p], static_cast<int>(c)), 1e-6);
  const Sequence& run = report.sequences[0];
  for (std::size_t c = 0; c < 3; ++c) {
    const Range& range = run.displacement[c];
    const double last = range.low + range.step * run.frames[2].displacement[3 * c + 2];
    EXPECT_NEAR(
        last,
        component(film.states[2].r[ParticleId{2}] - film.chain.model.r_0[ParticleId{2}], static_cast<int>(c)),
        range.step);
  }
}

TEST(PageCell, IsThatOfEachFrameAndBondsJoinImages) {
  expect_film(Film({}));
}

TEST(PageCell, FramesWithWrappedParticlesGiveTheSamePage) {
  expect_film(Film({.wrap = true}));
  expect_film(Film({.single_precision = true, .wrap = true}));
}

// Particles 0 and 2 of the chain touch through a face of the cell.
TEST(PageCell, ContactsThroughFacesEndBesideTheirFirstParticle) {
  for (const bool wrap : {false, true}) {
    const Folder folder;
    Chain chain;
    chain.model.cell = {{Vec3d{2.5, 0, 0}, {0, 4, 0}, {0, 0, 5}}, {true, true, true}, {0.5, -2, -2}, true};
    chain.state.cell = cell_at_start(chain.model);
    chain.model.contact.law = ContactLaw::linear;
    chain.model.contact.k = 1.0;
    for (double& R : chain.model.radius) R = 0.3;
    FrameWriter writer(folder.path(), false, {}, {.contacts = true, .cell = true, .wrap = wrap});
    writer.write(chain.model, chain.state);
    auto files = listed_frames(folder / "particles.pvd", folder / "bonds.pvd");
    add_contacts(files, folder / "contacts.pvd");
    Body body;
    const Sequence s = read_sequence({SequenceKind::run, "Run", "", "", files}, body);
    const FrameContacts& c = s.contacts.frames[0];
    ASSERT_EQ(c.i.size(), 1u) << wrap;
    EXPECT_EQ(c.j, c.i);
    ASSERT_EQ(c.shift.size(), 6u);
    std::array<double, 6> shift{};
    for (std::size_t k = 0; k < 6; ++k) shift[k] = s.contacts.shift.low + s.contacts.shift.step * c.shift[k];
    EXPECT_NEAR(shift[0], 0.0, 1e-12);
    EXPECT_NEAR(std::abs(shift[3]), 0.5, 0.01);  // to the image, not across the cell
  }
}

TEST(PageCell, IsMissingForBodiesThatAreNotPeriodic) {
  const Folder folder;
  Chain chain;
  FrameWriter(folder.path(), false, {}).write(chain.model, chain.state);
  Report r;
  r.sequences.push_back(read_sequence(
      {SequenceKind::run, "Run", "", "", listed_frames(folder / "particles.pvd", folder / "bonds.pvd")},
      r.body));
  r.stage_of_frame.assign(1, "rest");
  const auto j = json_of(report_page(one_line, r, {}));
  EXPECT_FALSE(j.contains("bond_image"));
  EXPECT_FALSE(j["sequences"][0].contains("cell"));
}

TEST(PageCell, RefusesCellsThatAreNone) {
  const Film film({});
  const auto damaged = [&](const std::string& what, const std::string& by) {
    const std::string good = test::content_of(film.files[1].particles);
    std::string bad = good;
    bad.replace(bad.find(what), what.size(), by);
    test::put_content(film.files[1].particles, bad);
    std::string told;
    try {
      film.report();
    } catch (const IoError& e) {
      told = e.what();
    }
    test::put_content(film.files[1].particles, good);
    return told;
  };
  EXPECT_NE(damaged("\"cell\" NumberOfComponents", "\"cell\" NumberOfComponent").find("is damaged"),
            std::string::npos);
  EXPECT_NE(damaged("ascii\">3 0 0 1 4", "ascii\">3 0 0 x 4").find("is damaged"), std::string::npos);
  EXPECT_NE(damaged("ascii\">1 1 0", "ascii\">1 2 0").find("is damaged"), std::string::npos);
  EXPECT_EQ(damaged("ascii\">1 1 0", "ascii\">1 1 1"), "");
}

}  // namespace
}  // namespace vbond::page::page_cell_test
