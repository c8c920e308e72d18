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
  EXPECT_EQ(changed({"title=a b"}), edited("[[specimen]]", "title = \"a b\"\n[[specimen]]"));
  EXPECT_EQ(changed({"title=\"a # b\""}), edited("[[specimen]]", "title = \"a # b\"\n[[specimen]]"));
}

TEST(Change, AKeyIsSetOnceByWhateverName) {
  const std::vector<std::pair<std::string, std::string>> same{
      {"title=a", "title=b"},
      {"stage[pull].duration=2 T0", "stage[0].duration=3 T0"},
      {"stage[0].duration=2 T0", "stage[pull].duration=2 T0"},
      {"bonds[0].stiffness.c_D=0.3", "bonds[thin].stiffness={c_A = 1, c_D = 0.2, c_B = 0.1, c_T = 0.1}"},
      {"bonds[thin].stiffness={c_A = 1, c_D = 0.2, c_B = 0.1, c_T = 0.1}", "bonds[0].stiffness.c_D=0.3"},
      {"stage[0].supports[1].velocity[0]=1", "stage[0].supports[1].velocity=[0, 1, 0]"},
      {"output.history.every=2 T0", "output={history = {every = \"3 T0\"}}"},
      {"output.history={every = \"3 T0\"}", "output.history.every=2 T0"}};
  for (const auto& [first, second] : same) {
    try {
      parse_case(pulled_rod, "rod.toml", {"time.step=0.02 T0", first, second});
      ADD_FAILURE() << "accepted: " << first << ", " << second;
    } catch (const CaseError& e) {
      EXPECT_NE(std::string(e.what()).find("--set number 2 sets this key"), std::string::npos) << e.what();
    }
    const Case last = parse_case(pulled_rod, "rod.toml", {first, second}, SetTwice::last_wins);
    EXPECT_EQ(last.changes.size(), 2u);
  }
  EXPECT_EQ(to_toml(parse_case(pulled_rod, "rod.toml", {"title=a", "title=c"}, SetTwice::last_wins))
                .find("title = \"a\""),
            std::string::npos);
  // neighbours are other keys, also in a table that neither finds in the file
  parse_case(pulled_rod, "rod.toml",
             {"output.history.every=2 T0", "output.frames.every=3 T0", "bonds[0].stiffness.c_D=0.3",
              "bonds[thin].stiffness.c_B=0.3", "stage[0].supports[0].fix=[\"y\"]",
              "stage[0].supports[1].fix=[\"x\"]"});
}

TEST(Change, ValuesAreOneValueOnOneLine) {
  for (const char* wrong : {"title=1 # x", "title=1] # ", "title=1], [2", "title=a\nb", "title=\"a\nb\"",
                            "title= ", "title='a' 'b'"}) {
    try {
      parse_case(pulled_rod, "rod.toml", {wrong});
      ADD_FAILURE() << "accepted: " << wrong;
    } catch (const CaseError& e) {
      EXPECT_EQ(std::string(e.what()).rfind("--set title=", 0), 0u) << e.what();
      EXPECT_NE(std::string(e.what()).find(": the value "), std::string::npos) << e.what();
    }
  }
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
