// What a stage with sources and sinks ends with: who is left out, what is told, when it comes to rest.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::passage_ends_test {
namespace {

const std::string grain =
    "[[specimen]]\nname = \"grain\"\nkind = \"list\"\npositions = [[0, 0, 0]]\nradius = 0.5\nmass = 1.0\n"
    "[time]\nstep = 0.01\n";

struct Made {
  Case c;
  Built built;
  explicit Made(const std::string& text) : c(parse_case(text, "case.toml")), built(build(c)) {}
  vbond::Run run() const { return vbond::Run(built.model, built.state, stages_of(c), 1); }
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// One of four has passed a wall and was dropped, another goes by a sink: the first stays where frames, means
// and fragments count it, as docs/contacts.md says.
TEST(PassageEnds, WhoWasDroppedIsShownWhenASinkHasTakenAnother) {
  const Made made(
      "[[specimen]]\nname = \"row\"\nkind = \"list\"\npositions = [[0, 0, 0], [2, 0, 0], [4, 0, 0], [6, 0, "
      "0]]\n"
      "radius = 0.5\nmass = 1.0\n[time]\nstep = 0.01\n[[stage]]\nduration = 1\n"
      "[[sink]]\nevery = 0.1\nbox = { min = [5, -1, -1], max = [7, 1, 1] }\n");
  vbond::Run run = made.run();
  run.step(10);
  const Stage& stage = run.simulation()->stage();
  State s = run.state();
  drop({ParticleId{1}}, s);
  const auto shown = [&] { return lammps_frame(made.built.model, s, {}); };
  EXPECT_TRUE(has(shown(), "NUMBER OF ATOMS\n4\n"));
  const Passage passed = visit(made.built.model, stage, s);
  ASSERT_TRUE(passed.any_gone);
  EXPECT_EQ(s.taken, std::vector<ParticleId>{ParticleId{3}});
  EXPECT_EQ(s.dropped, (std::vector<ParticleId>{ParticleId{1}, ParticleId{3}}));
  EXPECT_EQ(left_out(s), std::vector<ParticleId>{ParticleId{3}});
  EXPECT_TRUE(has(shown(), "NUMBER OF ATOMS\n3\n"));
  EXPECT_FALSE(mistake_in_waiting(made.built.model, s));
  s.taken = {ParticleId{0}};
  EXPECT_TRUE(mistake_in_waiting(made.built.model, s));
}

TEST(PassageEnds, ASourceWhoseTimeIsOverDoesNotHoldUpTheStop) {
  const std::string text =
      grain +
      "[[stage]]\nduration = 5\nstop = { rest = { kinetic_energy_below = 1, during = 0.3 } }\n"
      "[[source]]\nspecimen = \"grain\"\ncount = 10\nevery = 0.1\nrate = 10\n"
      "box = { min = [-20, -20, -20], max = [20, 20, 20] }\n";
  const Made over(text + "until = 0.5\n"), open(text);
  vbond::Run first = over.run(), second = open.run();
  const StageResult a = first.run_stage(), b = second.run_stage();
  EXPECT_EQ(a.stop, StopReason::rest);
  EXPECT_EQ(first.current().mass.particles_in, 5);
  EXPECT_EQ(a.steps, 50 + 30) << "quiet steps count from the last visit, at step 50";
  EXPECT_EQ(b.stop, StopReason::rest);
  EXPECT_EQ(second.current().mass.particles_in, 10);
  EXPECT_EQ(b.steps, 100 + 30);
}

// Free flight: what a frame shows as displacement is velocity times the time since it came in.
TEST(PassageEnds, DisplacementsCountFromWhereABodyCameIn) {
  const Made made(grain +
                  "[[stage]]\nduration = 3\n[[source]]\nspecimen = \"grain\"\ncount = 3\nevery = 0.5\n"
                  "rate = 2\nvelocity = [1, 2, -3]\nbox = { min = [-20, -20, -20], max = [20, 20, 20] }\n");
  vbond::Run run = made.run();
  run.step(290);
  const State& s = run.current();
  ASSERT_TRUE(s.waiting.empty());
  for (const ParticleId p : s.r.ids()) {
    const double since = 2.9 - 0.5 * static_cast<double>(p.value + 1);
    const Vec3d moved = s.r[p] - first_place(made.built.model, s, p);
    EXPECT_LT(norm(moved - since * Vec3d{1, 2, -3}), 1e-12) << p.value;
  }
}

// A region repeats with the cell: two grains cross a face, and are where the region is by an image. Wherever
// they are, they are in a region as wide as the cell.
TEST(PassageEnds, ASinkTakesWhatItsRegionHoldsAnImageOf) {
  const auto particles_after = [](const std::string& sink) {
    const Made made(
        "[cell]\na = [4, 0, 0]\nb = [0, 4, 0]\nc = [0, 0, 40]\nopen = [\"c\"]\n[time]\nstep = 0.01\n"
        "[[specimen]]\nkind = \"list\"\npositions = [[1, 1, 3], [3, 3, 3]]\nmass = 1.0\nradius = 0.3\n"
        "[[velocities]]\nvelocity = [2, 0, -1]\n[[stage]]\nduration = 8\n[[sink]]\nevery = 0.1\n" +
        sink);
    vbond::Run run = made.run();
    run.run();
    return run.current().r.size() - run.current().taken.size();
  };
  EXPECT_EQ(particles_after("box = { min = [0, 0, -10], max = [4, 4, 0] }\n"), 0u);
  EXPECT_EQ(particles_after("box = { min = [8, 0, -10], max = [12, 4, 0] }\n"), 0u) << "an image of it";
  EXPECT_EQ(particles_after("box = { min = [0, 0, -10], max = [4, 2, 0] }\n"), 1u)
      << "y = 3 passes beside it";
  EXPECT_EQ(particles_after("takes = \"outside\"\nbox = { min = [0, 0, -10], max = [4, 4, 10] }\n"), 2u);
}

/// What is told of the source as its stage ends.
std::string told_at_end(const std::string& more) {
  const Made made(grain + "[[source]]\nspecimen = \"grain\"\ncount = 20\n" + more);
  vbond::Run run = made.run();
  std::string told;
  RunHooks hooks;
  hooks.tell = [&told](const std::string& line) { told += line + "\n"; };
  run.set_hooks(std::move(hooks));
  run.run();
  return told;
}

TEST(PassageEnds, WhoWasNotTriedIsToldApartFromWhoFoundNoRoom) {
  const std::string wide = "box = { min = [-20, -20, -20], max = [20, 20, 20] }\n",
                    narrow = "box = { min = [-0.6, -0.6, -0.6], max = [0.6, 0.6, 0.6] }\n";
  // visits at 0.3, 0.6, 0.9 of 1.15: 9 come in, 2 more become due after the last one
  const std::string late = told_at_end("rate = 10\nevery = 0.3\n" + wide + "[[stage]]\nduration = 1.15\n");
  EXPECT_TRUE(has(late, "9 of 20 bodies have come in; 2 became due after its last visit, and were not tried"))
      << late;
  EXPECT_FALSE(has(late, "no room")) << late;
  // one fills the place; at 0.9 8 find no room
  const std::string full = told_at_end("rate = 10\nevery = 0.3\n" + narrow + "[[stage]]\nduration = 1.15\n");
  EXPECT_TRUE(has(full, "1 of 20 bodies have come in; 8 more found no room")) << full;
  EXPECT_TRUE(has(full, "2 became due after its last visit")) << full;
  const std::string never = told_at_end("every = 2\n" + wide + "[[stage]]\nduration = 1\n");
  EXPECT_TRUE(has(never, "0 of 20 bodies have come in; it was not visited: its visits are 200 steps apart"))
      << never;
  const std::string all = told_at_end("every = 0.3\n" + wide + "[[stage]]\nduration = 1\n");
  EXPECT_TRUE(has(all, "20 of 20 bodies have come in\n")) << all;
}

}  // namespace
}  // namespace vbond::passage_ends_test
