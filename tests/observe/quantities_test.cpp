#include "vbond/observe/quantities.hpp"
#include "vbond/model/rules.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "specimen.hpp"
#include "under_way.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;

// docs/output.md holds the tables between marks; the message says how to write them anew.
TEST(OutputReference, TablesOfThePageAreThoseOfTheCode) {
  const std::string path = std::string(VBOND_DOCS) + "/output.md";
  std::string page = content_of(path);
  const std::string as_it_was = page;
  for (const std::string where :
       {"history", "breaks", "fragments", "particles", "bonds", "walls", "contacts", "checkpoint"}) {
    const std::string begin = "<!-- quantities: " + where + " -->\n", end = "<!-- end of quantities -->";
    const std::size_t from = page.find(begin), to = page.find(end, from);
    ASSERT_NE(from, std::string::npos) << where;
    ASSERT_NE(to, std::string::npos) << where;
    page.replace(from + begin.size(), to - from - begin.size(), quantity_table(where));
  }
  if (std::getenv("VBOND_UPDATE_REFERENCE") != nullptr)
    std::ofstream(path, std::ios::binary) << page;
  else
    EXPECT_TRUE(page == as_it_was) << path << " is stale; to write it anew:\n"
                                   << "  VBOND_UPDATE_REFERENCE=1 build/dev/test_observe "
                                      "--gtest_filter='OutputReference.*'";
}

TEST(Quantities, NamesStandForOneThingEach) {
  const auto expect_different = [](const auto& quantities) {
    std::set<std::string> names;
    for (const auto& q : quantities) EXPECT_TRUE(names.insert(q.name).second) << q.name;
  };
  expect_different(history_quantities());
  expect_different(group_quantities());
  expect_different(wall_quantities());
  expect_different(break_quantities());
  expect_different(fragment_quantities());
  expect_different(particle_quantities());
  expect_different(bond_quantities());
}

TEST(Quantities, EveryColumnHasItsFacts) {
  OutputPlan plan;
  plan.statics = plan.breaks = true;
  plan.reactions = {{"a.b", {}}};
  plan.axial_force = {{"rod", {}}};
  plan.displacements = {{"7", {}}};
  plan.walls = {"lid"};
  plan.grips = {"upper"};
  std::istringstream header(history_header(plan));
  std::string name;
  for (; std::getline(header, name, ',');) {
    if (name.back() == '\n') name.pop_back();
    EXPECT_TRUE(facts_of_column(name)) << name;
  }
  EXPECT_STREQ(facts_of_column("reaction.a.b.fx")->unit.si, "N");
  EXPECT_STREQ(facts_of_column("reaction.a.b.mx")->unit.si, "N m");
  EXPECT_STREQ(facts_of_column("axial_force.rod")->unit.reduced, "a c_A");
  EXPECT_STREQ(facts_of_column("displacement.7.z")->unit.si, "m");
  EXPECT_STREQ(facts_of_column("wall.lid.Mz")->unit.si, "N m");
  EXPECT_EQ(facts_of_column("wall.lid.Mz")->meaning, facts_of_column("wall.lid.Mx")->meaning);
  EXPECT_NE(facts_of_column("wall.lid.Mx")->meaning, facts_of_column("wall.lid.Fx")->meaning);
  for (const char* other : {"reaction.fx", "reaction.a.b.fw", "axial_force.", "displacement.7", "U_X", ""})
    EXPECT_FALSE(facts_of_column(other)) << other;
}

TEST(Quantities, UnitsOfColumnsStandBesideTheHistory) {
  const Folder folder;
  OutputPlan plan;
  plan.folder = folder.path();
  plan.units = UnitSystem::si;
  plan.axial_force = {{"a,\"b\"", {ParticleId{0}}}};
  const auto columns = [&] {
    return nlohmann::ordered_json::parse(content_of(folder / "history.columns.json"));
  };
  {
    HistoryWriter writer(plan, {});
    EXPECT_EQ(columns()["time"]["unit"], "s");
    EXPECT_EQ(columns()["step"]["unit"], "");
    EXPECT_EQ(columns()["axial_force.a,\"b\""]["unit"], "N");
    EXPECT_EQ(columns()["U_T"]["meaning"], "energy of the bonds: torsion");
    EXPECT_EQ(columns().begin().key(), "step");
  }
  plan.displacements = {{"0", {ParticleId{0}}}};  // asked for as the run goes on: behind the others
  plan.axial_force.clear();
  const HistoryWriter writer(plan, 0);
  const auto all = history_quantities();
  const auto always = std::count_if(all.begin(), all.end(),
                                    [](const HistoryQuantity& q) { return q.cases == Only::everywhere; });
  EXPECT_EQ(static_cast<std::ptrdiff_t>(columns().size()), always + 1 + 3);
  EXPECT_EQ(columns()["axial_force.a,\"b\""]["unit"], "N");
  EXPECT_EQ(columns()["displacement.0.y"]["unit"], "m");
  EXPECT_EQ((--columns().end()).key(), "displacement.0.z");
}

std::string text_of(hid_t set, const char* name) {
  if (H5Aexists(set, name) <= 0) return "no attribute";
  const hid_t attribute = H5Aopen(set, name, H5P_DEFAULT), type = H5Aget_type(attribute);
  std::string text(H5Tget_size(type), '\0');
  EXPECT_GE(H5Aread(attribute, type, text.data()), 0);
  H5Tclose(type), H5Aclose(attribute);
  return text.c_str();
}

/// The attributes of every data set: its path, unit and meaning.
std::vector<std::array<std::string, 3>> data_sets_of(const std::filesystem::path& file) {
  std::vector<std::array<std::string, 3>> all;
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t at, const char* name, const H5O_info_t* info, void* to) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const hid_t set = H5Dopen2(at, name, H5P_DEFAULT);
    static_cast<decltype(&all)>(to)->push_back(
        {'/' + std::string(name), text_of(set, "unit"), text_of(set, "meaning")});
    return H5Dclose(set);
  };
  EXPECT_GE(H5Ovisit2(f, H5_INDEX_NAME, H5_ITER_INC, visit, &all, H5O_INFO_BASIC), 0);
  H5Fclose(f);
  return all;
}

TEST(Quantities, EveryDataSetOfACheckpointHasItsUnitAndMeaning) {
  const Folder folder;
  Chain chain;
  chain.model.units = UnitSystem::si;
  WatchRecord watch;  // with all that few runs have
  watch.overlapping.insert({ParticleId{0}, ParticleId{2}});
  watch.stretched.insert(BondId{0});
  watch.fastest = 2.0;
  watch.farthest_turn = 1.0;
  watch.in_walls.insert({ParticleId{0}, 0});
  watch.deep[{ParticleId{0}, ParticleId{1}}] = {ParticleId{0}, ParticleId{1}, {}, 0.0, 0};
  chain.state.bond_history.resize(chain.state.bonds.size());
  chain.state.contact_history = {{ParticleId{0}, ParticleId{2}, {1.0}}};
  make_top(chain.model, ParticleId{1}, {{1, 2, 2}, {}});
  chain.state.spin.resize(chain.state.r.size());
  set_capsule(chain.state.bonds[BondId{0}], 0.3);
  chain.state.fibre_history = {
      {ParticleId{0}, ParticleId{1}, ParticleId{2}, ParticleId{2}, 0.5, 0.0, 0.3, 0.2, {}, {}}};
  chain.model.walls = {{"floor", PlaneWall{{}, {0, 0, 1}}, 0, {}}};
  chain.state.walls.resize(1);
  chain.state.walls[0].off = 1;
  chain.state.wall_history = {{ParticleId{0}, 0, {0, 0, 1}, {1.0}}};
  chain.state.grips = {
      {{1, 0, 0}, 0.0, 2.0, 1, {0, 0, 1}, rotation_of({0, 0, 1}), {1, 0, 0}, {0, 0, 2}, 1.0}};
  chain.state.gripped = {{{0, 1, 0}, {}}};
  chain.state.carried = {{ParticleId{1}, 1}};
  chain.state.pressed = {{0, ParticleId{0}, ParticleId{1}, ParticleId{2}, {0, 0, 1}, {0.5, 0, 0}}};
  chain.state.temperature.resize(chain.state.r.size());
  chain.state.warm_bonds = {{BondId{1}, 1e-3, 0.5, 0.1, 0.2}};
  chain.state.books.lost[Loss::drag] = 0.5;
  chain.state.bonds[BondId{1}].broken = true;
  chain.state.dropped = chain.state.taken = {ParticleId{2}};
  chain.state.mass = {2, 1, 2.0, 1.0, {1, 0, 0}, {0, 1, 0}};
  chain.state.books.inserted = chain.state.books.removed = 0.5;
  for (Loads* loads : {&chain.state.loads, &chain.state.damping, &chain.state.local_damping})
    *loads = {PerParticle<Vec3d>(chain.state.r.size()), PerParticle<Vec3d>(chain.state.r.size())};
  chain.state.bonds[BondId{0}].law = &bond_law<WithRules<VModel>::Law>;
  BondRules rules;
  rules.strength = elongation_strength(0.1);
  chain.state.bonds[BondId{0}].rules = &kept(rules);
  Chain periodic;  // which has no walls
  periodic.model.units = UnitSystem::si;
  periodic.model.cell = {{Vec3d{9, 0, 0}, {0, 9, 0}, {0, 0, 9}}, {true, true, true}, {}, false};
  periodic.state.cell = {
      {{9, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 3}}, {{0, 9, 0}, {}, {}, {}}, {{0, 0, 9}, {}, {}, {}}};
  set_image_of_j(periodic.state.bonds[BondId{0}], {0, 1, 0});
  set_capsule(periodic.state.bonds[BondId{0}], 0.3);
  periodic.state.fibre_history = {{ParticleId{0},
                                   ParticleId{1},
                                   ParticleId{2},
                                   ParticleId{2},
                                   0.5,
                                   0.0,
                                   0.3,
                                   0.2,
                                   {},
                                   {},
                                   {0, 1, 0},
                                   {1, 0, 0},
                                   {1, 0, 0}}};
  periodic.state.contact_history = {{ParticleId{0}, ParticleId{2}, {1.0}, 0.1, {1, -2, 0}}};
  std::set<std::string> described;
  const auto look = [&](const std::filesystem::path& file, const Chain& of, const WatchRecord& seen,
                        const FractureUnderWay* under_way = nullptr) {
    write_checkpoint(file, of.model, of.state, seen, "1.0", under_way);
    for (auto [path, unit, meaning] : data_sets_of(file)) {
      const std::string begun = "/fracture/begun";  // the state once more
      if (path.starts_with(begun)) path.erase(0, begun.size());
      const auto all = checkpoint_quantities();
      const auto q =
          std::find_if(all.begin(), all.end(), [&p = path](const auto& one) { return p == one.path; });
      ASSERT_NE(q, all.end()) << path << " is not in checkpoint_quantities()";
      EXPECT_EQ(unit, q->unit.si) << path;
      EXPECT_EQ(meaning, q->meaning) << path;
      described.insert(path);
    }
    EXPECT_TRUE(read_checkpoint(file, of.model).state == of.state) << file;
  };
  look(folder / "c.h5", chain, watch);
  look(folder / "p.h5", periodic, {});
  const FractureUnderWay under_way = test::under_way_of(periodic.state);
  look(folder / "f.h5", periodic, {}, &under_way);
  Chain waiting;  // without its bonds
  waiting.model.units = UnitSystem::si;
  waiting.state.bonds = {};
  waiting.state.waiting = {ParticleId{1}};
  Source source;
  source.name = "one";
  source.body = {ParticleId{1}};
  waiting.model.sources = {source};
  waiting.state.sources = {{1.5}};
  waiting.state.came_at = waiting.state.r;
  look(folder / "w.h5", waiting, {});
  for (const CheckpointQuantity& q : checkpoint_quantities())
    EXPECT_EQ(described.count(q.path), 1U) << q.path;
}

// Columns of a term are for the groups that the plan has under its name, in their order, and for no others.
TEST(Quantities, OfATermAreThoseOfItsGroupsInThePlan) {
  const GroupQuantity q =
      term_quantity("springs", {{"energy", unit::energy, "stored"}, {"torn", unit::none, "broken"}}, nullptr);
  OutputPlan plan;
  plan.of_terms["others"] = {{"a", {}}};
  EXPECT_TRUE(q.names(plan).empty());
  plan.of_terms["springs"] = {{"a", {}}, {"b", {}}};
  EXPECT_EQ(q.names(plan), (std::vector<std::string>{"a", "b"}));
  HistoryValues values;
  values.of_terms["springs"] = {{Cell(1.5), Cell(std::int64_t{2})}, {Cell(3.5), Cell(std::int64_t{4})}};
  std::vector<Cell> cells{Cell(0.5)};
  q.add(values, 1, cells);
  EXPECT_EQ(cells, (std::vector<Cell>{Cell(0.5), Cell(3.5), Cell(std::int64_t{4})}));
}

}  // namespace
}  // namespace vbond
