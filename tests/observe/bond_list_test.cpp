// Bonds as text for other programs.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/bond_list.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {
namespace {

/// Bonds of two laws, one with rules, between particles that are turned.
State some_bonds() {
  State state;
  for (int k = 0; k < 3; ++k) {
    state.r.push_back({1.0 * k, 0.1 * k, 0});
    state.q.push_back(rotation_of({0.1 * k, 0.7, -0.3 * k}));
  }
  BondRecipe ruled;
  ruled.parameters = BondStiffness<double>{1.0, 0.3, 0.1, 0.2};
  ruled.rules.strength = linear_strength(0.1, 0.2, 0.3, 0.4);
  BondRecipe plain;
  plain.law = find_law("evm");
  plain.parameters = BondStiffness<double>{2.0, 0.5, 0.2, 0.1};
  const auto site = [&](std::size_t k) {
    return BondSite{ParticleId{k}, state.r[ParticleId{k}], state.q[ParticleId{k}], 0.4};
  };
  for (const auto& [recipe, i, j] :
       {std::tuple(&ruled, 0u, 1u), std::tuple(&plain, 2u, 1u), std::tuple(&ruled, 0u, 2u)})
    state.bonds.push_back(*make_bond(*recipe, site(i), site(j)));
  state.bonds[BondId{2}].broken = true;
  return state;
}

class BondListFile : public ::testing::Test {
 protected:
  BondList read(const std::string& text) {
    replace_file(path_, text);
    return read_bond_list(path_);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const IoError& e) {
      return std::string(e.what()).substr(path_.string().size());
    }
    return "accepted";
  }
  const test::Folder folder_;
  const std::filesystem::path path_ = folder_ / "bonds";
};

TEST_F(BondListFile, IsReadAsItWasWritten) {
  const State state = some_bonds();
  const BondList list = bond_list(state), other = read(to_text(list));
  ASSERT_EQ(other.bonds.size(), 2u);
  EXPECT_EQ(other.kinds, list.kinds);
  EXPECT_EQ(other.kind, list.kind);
  for (std::size_t n = 0; n < 2; ++n) {
    Bond expected = list.bonds[n];
    expected.set = 0;
    EXPECT_EQ(other.bonds[n], expected);
    const Bond& b = state.bonds[BondId{n}];  // the same axes in space, of particles that are not turned
    EXPECT_EQ(other.bonds[n].frame_i, state.q[b.i] * b.frame_i);
    EXPECT_EQ(frame_j(other.bonds[n]), state.q[b.j] * frame_j(b));
  }
}

TEST_F(BondListFile, MistakesAreToldWithTheirLine) {
  const std::string text = to_text(bond_list(some_bonds()));
  const std::size_t bonds = text.find("\n1 2 ") + 1;
  EXPECT_EQ(refusal("bonds\n"), ": the first line must be \"vbond bonds 1\"");
  EXPECT_EQ(refusal("vbond bonds 1\nkind 1 steel\n"), ":2: \"steel\" is no law of bonds");
  EXPECT_EQ(refusal("vbond bonds 1\nkind 2 evm\n"), ":2: this is no number of a kind");
  EXPECT_EQ(refusal("vbond bonds 1\nkind 1 evm 0 0\n"), ":2: a number is missing, or is none");
  EXPECT_EQ(refusal("vbond bonds 1\n1 2 1\n"), ":2: this is no number of a kind");
  EXPECT_EQ(refusal(text.substr(0, bonds) + "0 1 1\n"), ":4: this is no number of a particle");
  EXPECT_EQ(refusal(text.substr(0, bonds) + "1 2 1 -1 0 0 1 0 0 0 1 0 0 0 1 1 1 1 0 0 0 0 0\n"),
            ":4: the length of a bond must be > 0");
  EXPECT_EQ(refusal(text.substr(0, text.size() - 1) + " 7\n"), ":5: \"7\" is one too many");
}

}  // namespace
}  // namespace vbond
