// Keys changed from outside the file: what any text may do to the tree.
#include "vbond/case/change.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"

namespace vbond {
namespace {

constexpr const char* pulled_rod = R"(
[[specimen]]
kind = "rod"
particles = 3
mass = 1.0
inertia = 0.1

[[bonds]]
name = "thin"
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.2, c_B = 0.1, c_T = 0.1}

[groups]
ends_of_it = {indices = [0, 2]}

[time]
step = "0.01 T0"

[[stage]]
name = "pull"
duration = "1 T0"
supports = [{group = "first", fix = ["x"]}, {group = "last", fix = ["x", "y"], velocity = [1e-3, 0, 0]}]
)";

std::string changed(const std::vector<std::string>& changes) {
  Case c = parse_case(pulled_rod, "rod.toml", changes);
  c.changes.clear();
  return to_toml(c);
}
std::string edited(const std::string& from, const std::string& to) {
  std::string text = pulled_rod;
  text.replace(text.find(from), from.size(), to);
  return to_toml(parse_case(text, "rod.toml"));
}

TEST(Change, MeansWhatTheEditOfTheFileMeans) {
  EXPECT_EQ(changed({"stage[0].duration=\"2 T0\""}), edited("\"1 T0\"", "\"2 T0\""));
  EXPECT_EQ(changed({"stage[pull].duration=2 T0"}), edited("\"1 T0\"", "\"2 T0\""));
  EXPECT_EQ(changed({"bonds[thin].stiffness.c_D=3e-1"}), edited("c_D = 0.2", "c_D = 0.3"));
  EXPECT_EQ(changed({"stage[0].supports[1].velocity=[0, 2e-3, 0]"}), edited("[1e-3, 0, 0]", "[0, 2e-3, 0]"));
  EXPECT_EQ(changed({"stage[0].supports[1].velocity[0]=5e-3"}), edited("[1e-3, 0, 0]", "[5e-3, 0, 0]"));
  EXPECT_EQ(changed({"groups.ends_of_it.indices=[1]"}), edited("indices = [0, 2]", "indices = [1]"));
  EXPECT_EQ(changed({"output.history.every=3 T0"}),
            edited("[time]", "[output]\nhistory = {every = \"3 T0\"}\n\n[time]"));
  EXPECT_EQ(changed({"title=a b", "title=c"}), edited("[[specimen]]", "title = \"c\"\n[[specimen]]"));
}

TEST(Change, MistakesPointAtTheChangeAndOthersAtTheFile) {
  try {
    parse_case(pulled_rod, "rod.toml",
               {"bonds[0].distance=-1", "stage[0].durations=2", "stage[0].supports[1].fix=[x]"});
    FAIL() << "accepted";
  } catch (const CaseError& e) {
    EXPECT_EQ(std::string(e.what()).rfind("--set stage[0].supports[1].fix=[x]", 0), 0u) << e.what();
  }
  try {
    parse_case(pulled_rod, "rod.toml", {"bonds[0].distance=-1", "stage[0].durations=2", "time.step=true"});
    FAIL() << "accepted";
  } catch (const CaseError& e) {
    const std::string text = e.what();
    for (const char* place :
         {"--set bonds[0].distance=-1: ", "--set stage[0].durations=2: ", "--set time.step=true: "})
      EXPECT_NE(text.find(place), std::string::npos) << text;
  }
}

RC_GTEST_PROP(Change, AnyTextIsTakenOrRefused, ()) {
  const std::string letters = "stage[0].durionbdpl\"'= 1-{}#\\";
  std::string text =
      *rc::gen::element<std::string>("", "stage[0].duration=", "bonds[thin].", "groups", "time.step=");
  for (const int k :
       *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, static_cast<int>(letters.size()))))
    text += letters[static_cast<std::size_t>(k)];
  try {
    parse_case(pulled_rod, "rod.toml", {text});
  } catch (const CaseError& e) {
    RC_ASSERT(std::string(e.what()).find('\n') != std::string::npos);  // a rule, or a way out
  }
}

}  // namespace
}  // namespace vbond
