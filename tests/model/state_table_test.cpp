#include "vbond/model/state_table.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace vbond {
namespace state_table_tests {

struct OfThree {
  int a;
  Vec3d b;
  std::vector<double> c;
};
// a table of State that forgets one of these, or a member of State, does not compile
static_assert(member_count<OfThree>() == 3);
static_assert(member_count<PeakRecord>() == 6);

struct Whole {
  State state;
  OfThree other;
};
static_assert(member_count<Whole>() == 2);

TEST(StateTable, NamesEachDataSetOnce) {
  std::set<std::string> paths;
  for_each_table(state_table, [&](const auto& table) {
    for_each_field(table, [&](const auto& f) {
      EXPECT_TRUE(paths.insert(std::string(table.path) + f.name).second) << table.path << f.name;
      EXPECT_NE(std::string(f.meaning), "") << table.path << f.name;
    });
  });
}

State busy() {
  State s;
  for (auto* column : {&s.r, &s.v, &s.omega, &s.spin}) column->assign(2, {1, 2, 3});
  s.q.assign(2, rotation_of({0, 0, 1}));
  s.temperature.assign(2, 4.0);
  s.grips.resize(1), s.gripped.resize(2), s.walls.resize(1);
  s.contact_history.resize(1), s.pressed.resize(1);
  s.books.dissipated = 5.0;
  s.peak = {.sum = 1, .samples = 2, .last = 3, .peak = 4, .peak_time = 5, .blocks = 6};
  s.rest.quiet_steps = 7;
  s.breaks = 8;
  return s;
}

TEST(StateTable, AStageClearsTheRecordsOfItsStopConditionsAndNothingElse) {
  State s = busy();
  begin_anew(s, Anew::stage);
  State expected = busy();
  expected.peak = {}, expected.rest = {}, expected.breaks = 0, expected.pressed = {};
  EXPECT_TRUE(s == expected);
}

TEST(StateTable, AStageOfEitherKindClearsWhatBelongedToTheLast) {
  State s = busy();
  begin_anew(s, Anew::any_stage);
  State expected = busy();
  expected.pressed = {};
  EXPECT_TRUE(s == expected);
}

TEST(StateTable, ABodyAtRestHasNoVelocitiesAndNoGripsOfMotion) {
  State s = busy();
  begin_anew(s, Anew::at_rest);
  State expected = busy();
  expected.v.assign(2, {}), expected.omega.assign(2, {}), expected.spin = {};
  expected.grips = {}, expected.gripped = {};
  EXPECT_TRUE(s == expected);
}

}  // namespace state_table_tests
}  // namespace vbond
