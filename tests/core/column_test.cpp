// Columns of all particles, and of some alone, which keep their numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "campaigns/dice.hpp"
#include "vbond/core/column.hpp"

namespace vbond::column_test {
namespace {

using Some = IdSet<ParticleId>;

/// Each of so many with this chance, some of them named twice, in no order.
std::vector<ParticleId> some_of(std::size_t whole, double chance, testing::Dice& dice) {
  std::vector<ParticleId> some;
  for (std::size_t p = 0; p < whole; ++p)
    if (dice.chance(chance))
      some.insert(some.begin() + static_cast<std::ptrdiff_t>(dice.below(some.size() + 1)), ParticleId{p});
  if (!some.empty()) some.push_back(some.front());
  return some;
}

TEST(IdSet, KnowsWhoIsInItAndHowManyAreLower) {
  testing::Dice dice(1);
  for (const std::size_t whole : {1u, 63u, 64u, 65u, 128u, 1000u})
    for (const double chance : {0.0, 0.1, 0.7, 1.0}) {
      const std::vector<ParticleId> some = some_of(whole, chance, dice);
      const Some set(whole, some);
      std::vector<ParticleId> found;
      set.for_each([&found](ParticleId p) { found.push_back(p); });
      EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
      EXPECT_EQ(found.size(), set.size());
      for (std::size_t p = 0; p < whole; ++p) {
        const ParticleId id{p};
        const bool in = std::find(some.begin(), some.end(), id) != some.end();
        ASSERT_EQ(set.has(id), in) << p;
        if (in) {
          EXPECT_EQ(found.at(set.place(id)), id);
        } else {
          EXPECT_THROW(set.place(id), std::logic_error);
        }
      }
      EXPECT_FALSE(set.has(ParticleId{whole}));
    }
}

TEST(Column, OfSomeHasTheirValuesUnderTheirNumbersAndNoRoomForOthers) {
  testing::Dice dice(2);
  constexpr std::size_t whole = 500;
  PerParticle<double> all(whole);
  for (const ParticleId p : all.ids()) all[p] = 1.0 + static_cast<double>(p.value);
  const auto first = std::make_shared<const Some>(whole, some_of(whole, 0.3, dice));
  const auto second = std::make_shared<const Some>(whole, some_of(whole, 0.3, dice));
  PerParticle<double> some = all;
  some.hold(first);
  EXPECT_EQ(some.size(), whole);
  EXPECT_EQ(some.values().size(), first->size());
  EXPECT_EQ(some.values().capacity(), first->size());
  for (const ParticleId p : all.ids()) {
    ASSERT_EQ(some.holds(p), first->has(p));
    if (first->has(p)) {
      EXPECT_EQ(some[p], all[p]);
    } else {
      EXPECT_THROW(some[p], std::logic_error);
    }
  }
  EXPECT_FALSE(some == all);
  PerParticle<double> same = all;
  same.hold(std::make_shared<const Some>(*first));
  EXPECT_TRUE(some == same);

  some.hold(second);  // what it has not had is as new
  second->for_each([&](ParticleId p) { EXPECT_EQ(some[p], first->has(p) ? all[p] : 0.0); });
  some.hold({});
  EXPECT_TRUE(some.holds_all());
  for (const ParticleId p : all.ids()) EXPECT_EQ(some[p], first->has(p) && second->has(p) ? all[p] : 0.0);
  same.assign(whole, 2.0);
  EXPECT_EQ(same.values(), std::vector<double>(first->size(), 2.0));
  same.assign(0, 0.0);
  EXPECT_TRUE(same.holds_all() && same.empty());
}

}  // namespace
}  // namespace vbond::column_test
