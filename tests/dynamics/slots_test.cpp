#include "vbond/dynamics/slots.hpp"

#include <gtest/gtest.h>

#include <map>

#include "vbond/core/random.hpp"

namespace vbond {
namespace {

TEST(Slots, AreNeverGivenTwiceAtATime) {
  Slots slots;
  Random dice(7);
  std::map<std::size_t, std::size_t> taken;  // first: count
  std::size_t in_use = 0, most_in_use = 0;
  for (int k = 0; k < 20000; ++k) {
    if (!taken.empty() && (taken.size() > 50 || dice.uniform() < 0.45)) {
      const auto one =
          std::next(taken.begin(), static_cast<std::ptrdiff_t>(dice.uniform() * double(taken.size())));
      slots.give_back(one->first, one->second);
      in_use -= one->second;
      taken.erase(one);
      continue;
    }
    const auto count = static_cast<std::size_t>(dice.uniform() * 400);
    const std::size_t first = slots.take(count);
    if (count == 0) continue;
    ASSERT_LE(first + count, slots.size());
    const auto next = taken.lower_bound(first);
    const std::size_t end_of_room = next == taken.end() ? slots.size() : next->first;
    const std::size_t start_of_room =
        next == taken.begin() ? 0 : std::prev(next)->first + std::prev(next)->second;
    ASSERT_LE(first + count, end_of_room);
    ASSERT_LE(start_of_room, first);
    taken.emplace(first, count);
    most_in_use = std::max(most_in_use, in_use += count);
  }
  // the first room that is large enough never needs more than this (Robson's bound for first fit is M log2 n)
  EXPECT_LE(slots.size(), most_in_use * 9);
  for (const auto& [first, count] : taken) slots.give_back(first, count);
  EXPECT_EQ(slots.take(slots.size()), 0u);  // what was given back is one stretch again
}

}  // namespace
}  // namespace vbond
