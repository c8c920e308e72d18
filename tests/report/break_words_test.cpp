#include "vbond/report/break_words.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/breaks.hpp"

namespace vbond::break_words_test {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::put_content;

TEST(BreaksInWords, SayWhatGovernedAndHowMuchOfIt) {
  BreakTold b;
  b.bond = 1234, b.i = 17, b.j = 21, b.time = 0.00125, b.criterion = "stress", b.mode = "tension";
  b.failure = {0.75, 0.1, 0.2585, 0.05, 0, 1.0085};
  b.limit = 12e6;
  b.energy = 2.5e-4;
  EXPECT_EQ(
      in_words(b, UnitSystem::si),
      "bond 1234 (particles 17, 21) broke at t = 0.00125 s in tension: N/A + M_b r/J = 9 + 3.102 = 12.1 of "
      "12 MPa; it held 0.00025 J");
  b.limit = 12.0;
  EXPECT_EQ(
      in_words(b, UnitSystem::reduced),
      "bond 1234 (particles 17, 21) broke at t = 0.00125 in tension: N/A + M_b r/J = 9 + 3.102 = 12.1 of "
      "12; it held 0.00025");
  const auto said = [&](const char* text) {
    return in_words(b, UnitSystem::reduced).find(text) != std::string::npos;
  };
  b.mode = "torsion";
  EXPECT_TRUE(said("in torsion: V/A + |M_t| r/J_p = 1.2 + 0.6 = 1.8 of 12;"));
  b.criterion = "mohr-coulomb";
  EXPECT_TRUE(said("= 1.8 of c - (N/A) tan phi = 12;"));
  b.limit = -1.0;
  EXPECT_TRUE(said("tension leaves it no shear strength: c - (N/A) tan phi = -1;"));
  b.limit = 12.0;
  b.mode = "tension";
  EXPECT_TRUE(said("N/A + M_b r/J = 9 + 3.102 = 12.1 of 12;"));  // with moment_share
  const double bending = std::exchange(b.failure.bending, 0.0);
  EXPECT_TRUE(said("N/A = 9 of 12;"));
  b.failure.bending = bending;
  b.criterion = "fibre";
  EXPECT_TRUE(said("N/A + M_e r/J = 9 + 3.102 = 12.1 of 12;"));
  b.mode = "compression";
  b.failure.compression = 1.5;
  EXPECT_TRUE(said("in compression: -N/A + M_e r/J = 18 of 12;"));
  b.limit.reset();
  b.mode = "bending";
  for (const char* sum : {"linear", "quadratic", "energy"}) {
    b.criterion = sum;
    EXPECT_TRUE(said("= 0.75 + 0.1 + 0.2585 + 0.05 = 1.159 of 1;")) << sum;
  }
  b.criterion = "elongation";
  EXPECT_TRUE(said("elongation D/a - 1 was 1.008 of what it bears"));
  b.criterion = "none", b.mode = "other";
  EXPECT_TRUE(said("by its own law: its law gave a utilisation of 1.008 of 1"));
}

TEST(BreaksInWords, AreReadFromTheFile) {
  const Folder folder;
  Chain chain;
  BondRecipe recipe;
  recipe.parameters = BondStiffness<double>{1.0, 0.1, 0.1, 0.1};
  recipe.rules.strength = linear_strength(1.0, 1.0, 1.0, 1.0);
  for (const BondId b : chain.state.bonds.ids()) {
    const Bond& old = chain.state.bonds[b];
    chain.state.bonds[b] = make_bond(recipe, bond_site(chain.model, chain.state, old.i),
                                     bond_site(chain.model, chain.state, old.j))
                               .value();
  }
  {
    OutputPlan plan;
    plan.folder = folder.path();
    plan.breaks = true;
    BreaksWriter writer(plan, {});
    const auto broken = [&chain](BondId k) {
      return event_of(BondEvent::Kind::broken, chain.state.bonds[k], k, 1200);
    };
    BondEvent event = broken(BondId{1});
    event.cause = {BreakMode::shear, 2.0};
    event.failure = {0.1, 0.2, 0.3, 0.4, 0.5, 1.0};
    event.energy = 3.0;
    writer.write(chain.state.clock, event, {});
    event = broken(BondId{0});
    event.cause = {BreakMode::tension, 0.0};
    for (int k = 0; k < 3; ++k) writer.write(chain.state.clock, event, {});
  }
  const BreaksTold told = read_breaks(folder / "breaks.csv", 2);
  EXPECT_EQ(told.count, 4);
  EXPECT_EQ(in_words(told), "4 bonds broke: 1 in shear, 3 in tension");
  ASSERT_EQ(told.first.size(), 2u);
  const BreakTold& b = told.first[0];
  EXPECT_EQ(b.bond, 1);
  EXPECT_EQ(b.i, 1);
  EXPECT_EQ(b.j, 2);
  EXPECT_EQ(b.mode, "shear");
  EXPECT_EQ(b.criterion, "linear");
  EXPECT_EQ(b.limit, 2.0);
  EXPECT_EQ(b.energy, 3.0);
  EXPECT_EQ(b.failure.torsion, 0.4);
  EXPECT_FALSE(told.first[1].limit);
  EXPECT_EQ(in_words(BreaksTold{}), "no bond has broken");
  put_content(folder / "breaks.csv", content_of(folder / "breaks.csv") + "1,2\n");
  EXPECT_THROW(read_breaks(folder / "breaks.csv", 2), IoError);
  EXPECT_THROW(read_breaks(folder / "none.csv", 2), IoError);
}

}  // namespace
}  // namespace vbond::break_words_test
