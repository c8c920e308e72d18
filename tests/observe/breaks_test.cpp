#include "vbond/observe/breaks.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/fragments.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/observe/table_text.hpp"
#include "vtp_reader.hpp"

namespace vbond::breaks_test {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::lines_of;
using test::put_content;

OutputPlan plan_in(const Folder& folder) {
  OutputPlan plan;
  plan.folder = folder.path();
  plan.history_every = 1.0;
  plan.breaks = true;
  plan.reactions = {{"left", {ParticleId{0}}}};
  return plan;
}

/// The cell of a row of a file under a name; rows count from 1.
std::string cell(const std::string& text, std::size_t row, const std::string& name) {
  const auto lines = lines_of(text);
  const auto at = index_of(csv_cells(lines.at(0)), name);
  return at ? csv_cells(lines.at(row)).at(*at) : "no column " + name;
}
double number(const std::string& text, std::size_t row, const std::string& name) {
  return std::strtod(cell(text, row, name).c_str(), nullptr);
}

/// Particles at rest on a line, bonded from centre to centre with c_A = 1; each bond of its own strength.
Chain brittle_chain(const std::vector<double>& strengths) {
  Chain chain(strengths.size() + 1);
  chain.state = at_rest(chain.model);
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    BondRecipe recipe;
    recipe.parameters = BondStiffness<double>{1.0, 0.1, 0.1, 0.1};
    recipe.rules.strength = linear_strength(strengths[k], 1.0, 1.0, 1.0);
    recipe.set = static_cast<std::uint16_t>(10 + k);
    chain.state.bonds.push_back(make_bond(recipe, bond_site(chain.model, chain.state, ParticleId{k}),
                                          bond_site(chain.model, chain.state, ParticleId{k + 1}))
                                    .value());
  }
  return chain;
}

/// One end held, the other drawn away slowly.
Stage pull(const Chain& chain, double dt, double duration) {
  Stage stage;
  stage.name = "pull";
  stage.dt = dt;
  stage.stops.duration = duration;
  const HeldDofs all{true, true, true, true, true, true};
  stage.supports = {{"left", {ParticleId{0}}, all, {}, {}, {}},
                    {"right", {ParticleId{chain.model.particles() - 1}}, all, {1e-3, 0, 0}, {}, {}}};
  return stage;
}

void run_all(const Chain& chain, const Stage& stage, const OutputPlan& plan, int threads = 1) {
  Simulation run(chain.model, stage, chain.state, threads);
  for (const auto& o : open_output(plan, {}, "1.0").all()) run.add_observer(o);
  run.run();
}

TEST(Breaks, RowHasWhatTheBondHadAsItBroke) {
  const Folder folder;
  const Chain chain = brittle_chain({1.0, 0.01, 1.0});
  run_all(chain, pull(chain, 0.05, 60.0), plan_in(folder));
  const std::string text = content_of(folder / "breaks.csv");
  ASSERT_EQ(lines_of(text).size(), 2u);
  EXPECT_EQ(cell(text, 1, "bond"), "1");
  EXPECT_EQ(cell(text, 1, "i"), "1");
  EXPECT_EQ(cell(text, 1, "j"), "2");
  EXPECT_EQ(cell(text, 1, "set"), "11");
  EXPECT_EQ(cell(text, 1, "stage"), "0");
  EXPECT_EQ(cell(text, 1, "mode"), "tension");
  EXPECT_EQ(cell(text, 1, "criterion"), "linear");
  EXPECT_EQ(cell(text, 1, "limit"), "");
  EXPECT_EQ(number(text, 1, "time"), number(text, 1, "step") * 0.05);
  EXPECT_EQ(number(text, 1, "dx"), 1.0);
  EXPECT_EQ(number(text, 1, "dy"), 0.0);
  EXPECT_NEAR(number(text, 1, "x"), 1.5, 0.05);
  const double N = number(text, 1, "N");
  EXPECT_NEAR(N, 0.01, 2 * 1e-3 * 0.05);  // by the end of the step; waves move no faster than twice the end
  EXPECT_GE(N, 0.01);
  EXPECT_EQ(number(text, 1, "tension"), N * 100.0);
  EXPECT_EQ(number(text, 1, "utilisation"), number(text, 1, "tension"));
  EXPECT_NEAR(number(text, 1, "energy"), 0.5 * N * N, 1e-15);
  EXPECT_EQ(number(text, 1, "V"), 0.0);
  EXPECT_NEAR(number(text, 1, "load"), 0.01, 2e-3);  // of the slow pull, but for its waves
  const auto columns = nlohmann::ordered_json::parse(content_of(folder / "breaks.columns.json"));
  EXPECT_EQ(columns["limit"]["unit"], "c_A/a");
  EXPECT_EQ(columns.size(), break_quantities().size());
}

// All files that bonds which break have, from one run and from one that is killed after its checkpoint.
TEST(Breaks, ContinuedFilesEqualTheUninterruptedOnes) {
  const Folder folder;
  Chain chain = brittle_chain({0.03, 0.01, 0.02, 0.01});
  for (const ParticleId p : chain.state.v.ids())
    chain.state.v[p].x = 4e-3 * static_cast<double>(p.value * p.value);
  const Stage stage = pull(chain, 0.05, 20.0);
  OutputPlan plan = plan_in(folder);
  plan.checkpoint_every = 1.0;
  plan.folder = folder / "whole";
  std::filesystem::create_directory(plan.folder);
  run_all(chain, stage, plan);
  ASSERT_GE(lines_of(content_of(plan.folder / "breaks.csv")).size(), 4u);
  ASSERT_GE(lines_of(content_of(plan.folder / "fragments.csv")).size(), 4u);
  const double first = number(content_of(plan.folder / "breaks.csv"), 1, "time");

  OutputPlan other = plan;
  other.folder = folder / "killed";
  std::filesystem::create_directory(other.folder);
  {
    Simulation run(chain.model, stage, chain.state);
    for (const auto& o : open_output(other, {}, "1.0").all()) run.add_observer(o);
    run.run({}, static_cast<std::int64_t>((first + 1.0) / 0.05));  // past a checkpoint that has a broken bond
    std::filesystem::copy(other.folder / "checkpoint.h5", folder / "early.h5");
    run.run();  // all that it writes from here on is too much
  }
  put_content(other.folder / "breaks.csv", content_of(other.folder / "breaks.csv") + "12.");
  const Checkpoint early = read_checkpoint(folder / "early.h5", chain.model);
  {
    Simulation run(chain.model, stage, early.state);
    const FileObservers files = open_output(other, {}, "1.0", &early);
    for (const auto& o : files.all()) run.add_observer(o);
    run.run();
  }
  for (const char* name : {"breaks.csv", "fragments.csv", "history.csv"})
    EXPECT_EQ(content_of(other.folder / name), content_of(plan.folder / name)) << name;
}

TEST(Breaks, RecordOfAContinuedFileIsThatOfItsRows) {
  const Folder folder;
  Chain chain = brittle_chain({1.0, 1.0});
  const OutputPlan plan = plan_in(folder);
  BondEvent event{BondEvent::Kind::broken, BondId{0}, 10};
  const auto at = [&](std::int64_t step) {
    chain.at_step(step);
    event.step = step;
    return chain.state.clock;
  };
  {
    BreaksWriter writer(plan, {});
    EXPECT_EQ(writer.record(), BreakRecord{});
    writer.write(at(10), event, 0.5);
    writer.write(at(20), event, 0.75);
    writer.write(at(30), event, 7.0);
    EXPECT_EQ(writer.record(), (BreakRecord{10 * 0.1, 0.5, 7.0}));
  }
  EXPECT_EQ(BreaksWriter(plan, 20).record(), (BreakRecord{10 * 0.1, 0.5, 0.75}));
  EXPECT_EQ(BreaksWriter(plan, 9).record(), BreakRecord{});
  EXPECT_EQ(lines_of(content_of(folder / "breaks.csv")).size(), 1u);
  put_content(folder / "breaks.csv", "step,time\n");
  EXPECT_THROW(BreaksWriter(plan, 9), IoError);
}

// ---- fragments ------------------------------------------------------------------------------------------

TEST(Fragments, AreSortedByMassAndThenByTheirLowestParticle) {
  Chain chain = brittle_chain({1, 1, 1, 1, 1, 1});
  for (double& m : chain.model.mass) m = 1.0;
  chain.model.mass[ParticleId{6}] = 2.0;
  for (const std::size_t k : {0u, 2u, 5u}) chain.state.bonds[BondId{k}].broken = true;
  // 0 | 1 2 | 3 4 5 | 6, of masses 1, 2, 3, 2
  const Fragments f = find_fragments(chain.model, chain.state);
  ASSERT_EQ(f.all.size(), 4u);
  EXPECT_EQ(f.number.values(), (std::vector<std::int64_t>{3, 1, 1, 0, 0, 0, 2}));
  EXPECT_EQ(f.all[1].lowest, ParticleId{1});
  EXPECT_EQ(f.all[1].particles, 2);
  EXPECT_EQ(f.all[1].mass, 2.0);
  EXPECT_EQ(f.all[0].mass, 3.0);
  EXPECT_EQ(count_fragments(chain.model, chain.state), (FragmentCount{4, 3.0 / 8.0}));
  chain.state.v[ParticleId{1}] = {1, 2, 3};
  chain.model.mass[ParticleId{1}] = 0.5;
  const Fragments g = find_fragments(chain.model, chain.state);
  const FragmentMotion m = motion_of(g, chain.model, chain.state);
  const auto k = static_cast<std::size_t>(g.number[ParticleId{1}]);
  EXPECT_NEAR(m.centre[k]->x, (0.5 * 1 + 1.0 * 2) / 1.5, 1e-15);
  EXPECT_NEAR(m.velocity[k].y, 2.0 / 3.0, 1e-15);
}

/// A particle of mass 1 at each x in a cell of 6, each bonded to the image of the next that is `image` edges
/// away.
Chain chain_in_cell(const std::vector<double>& x, const std::vector<std::int32_t>& image) {
  Chain chain = brittle_chain(std::vector<double>(image.size(), 1.0));
  chain.model.cell.edges = {Vec3d{6, 0, 0}, {0, 6, 0}, {0, 0, 6}};
  chain.model.cell.periodic = {true, true, true};
  for (std::size_t k = 0; k < x.size(); ++k) chain.model.r_0[ParticleId{k}] = {x[k], 3, 3};
  for (double& m : chain.model.mass) m = 1.0;
  chain.state.r = chain.model.r_0;
  chain.state.cell = cell_at_start(chain.model);
  for (std::size_t k = 0; k < image.size(); ++k)
    set_image_of_j(chain.state.bonds[BondId{k}], {image[k], 0, 0});
  return chain;
}
FragmentMotion motion_of(const Chain& chain) {
  return vbond::motion_of(find_fragments(chain.model, chain.state), chain.model, chain.state);
}

// In a periodic cell a fragment is what its bonds join, wherever its particles stand, and moves with its
// images.
TEST(Fragments, CentreIsThatOfTheBodyThatAFaceCuts) {
  Chain rod = chain_in_cell({5, 0, 1, 3}, {1, 0, 0});
  rod.state.bonds[BondId{2}].broken = true;
  rod.state.v[ParticleId{0}] = {0.3, 0, 0};
  FragmentMotion m = motion_of(rod);
  ASSERT_EQ(m.centre.size(), 2u);
  EXPECT_NEAR(m.centre[0]->x, 6.0, 1e-14);  // 5, 6 and 7
  EXPECT_NEAR(m.centre[0]->y, 3.0, 1e-14);
  EXPECT_NEAR(m.velocity[0].x, 0.1, 1e-15);
  EXPECT_NEAR(m.centre[1]->x, 3.0, 1e-14);
  rod.state.cell[0].rate = {0.6, 0, 0};  // of the two images
  EXPECT_NEAR(motion_of(rod).velocity[0].x, 0.1 + 0.4, 1e-15);
}

// What goes all through the cell has no centre.
TEST(Fragments, WithoutEndHaveNoCentre) {
  const Folder folder;
  Chain ring = chain_in_cell({0, 2, 4, 1}, {0, 0, 0});
  ring.state.bonds[BondId{2}].j = ParticleId{0};
  set_image_of_j(ring.state.bonds[BondId{2}], {1, 0, 0});
  ring.state.v[ParticleId{0}] = {0.3, 0, 0};
  ring.state.cell[0].rate = {0.6, 0, 0};
  const FragmentMotion m = motion_of(ring);
  ASSERT_EQ(m.centre.size(), 2u);
  EXPECT_FALSE(m.centre[0]);
  EXPECT_NEAR(m.velocity[0].x, 0.1, 1e-15);
  EXPECT_EQ(m.centre[1], (Vec3d{1, 3, 3}));
  FragmentsWriter(plan_in(folder), {}).write({}, 0, find_fragments(ring.model, ring.state), m);
  const std::string text = content_of(folder / "fragments.csv");
  EXPECT_EQ(cell(text, 1, "x"), "");
  EXPECT_EQ(number(text, 1, "particles"), 3.0);
  EXPECT_EQ(number(text, 2, "x"), 1.0);
}

TEST(Fragments, RowsOfTheStageThatIsGoneOnWithAreDropped) {
  const Folder folder;
  Chain chain = brittle_chain({1, 1});
  chain.state.bonds[BondId{1}].broken = true;
  const OutputPlan plan = plan_in(folder);
  std::string two;
  {
    FragmentsWriter writer(plan, {});
    const Fragments fragments = find_fragments(chain.model, chain.state);
    writer.write(chain.state.clock, 0, fragments, motion_of(chain));
    writer.write(chain.state.clock, 1, fragments, motion_of(chain));
    two = content_of(folder / "fragments.csv");
    writer.write(chain.state.clock, 2, fragments, motion_of(chain));
  }
  ASSERT_EQ(lines_of(two).size(), 1u + 2 * 2);
  EXPECT_EQ(cell(two, 1, "particles"), "2");
  EXPECT_EQ(cell(two, 2, "lowest"), "2");
  EXPECT_EQ(number(two, 2, "mass"), 1.2);
  EXPECT_EQ(number(two, 2, "x"), 2.0);
  FragmentsWriter again(plan, 2);
  EXPECT_EQ(content_of(folder / "fragments.csv"), two);
}

// ---- history, frames, table -----------------------------------------------------------------------------

TEST(Breaks, OtherFilesTellOfThemOnlyWhereBondsMayBreak) {
  const Folder folder;
  Chain chain = brittle_chain({1.0, 0.01, 1.0});
  OutputPlan plan = plan_in(folder);
  Stage stage = pull(chain, 0.05, 60.0);
  run_all(chain, stage, plan);
  const std::string history = content_of(folder / "history.csv");
  const std::size_t last = lines_of(history).size() - 1;
  EXPECT_EQ(cell(history, 1, "broken"), "0");
  EXPECT_EQ(cell(history, 1, "fragments"), "1");
  EXPECT_EQ(number(history, 1, "largest_fragment"), 1.0);
  EXPECT_EQ(cell(history, last, "broken"), "1");
  EXPECT_EQ(cell(history, last, "fragments"), "2");
  EXPECT_NEAR(number(history, last, "largest_fragment"), 2.5 / 4.6, 1e-15);  // masses 1, 1.1, 1.2, 1.3
  EXPECT_EQ(number(history, last, "released"), number(content_of(folder / "breaks.csv"), 1, "energy"));

  plan.breaks = false;
  std::filesystem::create_directory(plan.folder / "elastic");
  plan.folder = plan.folder / "elastic";
  run_all(chain, stage, plan);
  EXPECT_FALSE(std::filesystem::exists(plan.folder / "breaks.csv"));
  EXPECT_FALSE(std::filesystem::exists(plan.folder / "fragments.csv"));
  EXPECT_EQ(cell(content_of(plan.folder / "history.csv"), 1, "broken"), "no column broken");
  EXPECT_EQ(table_header(true).size(), table_row(chain.state.clock, {}, {}, 0.0, {}, 99999999).size());
  EXPECT_EQ(table_header().size() + 9, table_header(true).size());
}

TEST(Breaks, FramesShowHowNearBondsAreAndByWhatTheyBroke) {
  const Folder folder;
  Chain chain = brittle_chain({0.5, 0.25, 1.0});
  chain.state.r[ParticleId{0}].x -= 0.1;
  chain.state.bonds[BondId{2}].broken = true;
  chain.state.bonds[BondId{2}].mode = BreakMode::torsion;
  for (const bool breaks : {false, true}) {
    write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced, {}, {.breaks = breaks});
    write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {}, {.breaks = breaks});
    const test::VtpReader b(content_of(folder / "b.vtp")), p(content_of(folder / "p.vtp"));
    EXPECT_EQ(b.arrays.count("utilisation"), breaks ? 1u : 0u);
    EXPECT_EQ(b.arrays.count("broken"), breaks ? 1u : 0u);
    EXPECT_EQ(p.arrays.count("fragment"), breaks ? 1u : 0u);
    if (!breaks) continue;
    const auto utilisation = b.arrays.at("utilisation").as<double>();
    EXPECT_NEAR(utilisation[0], 0.2, 1e-15);
    EXPECT_EQ(utilisation[1], 0.0);
    EXPECT_EQ(utilisation[2], 0.0);
    EXPECT_EQ(b.arrays.at("broken").as<std::uint8_t>(), (std::vector<std::uint8_t>{0, 0, 4}));
    EXPECT_EQ(p.arrays.at("fragment").integers(), (std::vector<std::int64_t>{0, 0, 0, 1}));
  }
}

}  // namespace
}  // namespace vbond::breaks_test
