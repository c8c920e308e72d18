#include "vbond/core/id_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

#include "vbond/core/column.hpp"

namespace vbond {
namespace {

using Ids = IdList<ParticleId>;

void expect_same(const Ids& list, const std::vector<ParticleId>& ids) {
  ASSERT_EQ(list.size(), ids.size());
  EXPECT_EQ(list.empty(), ids.empty());
  EXPECT_TRUE(std::equal(list.begin(), list.end(), ids.begin(), ids.end()));
  EXPECT_EQ(static_cast<std::vector<ParticleId>>(list), ids);
  EXPECT_TRUE(list == Ids(ids));
  for (std::size_t k = 0; k < ids.size(); ++k) EXPECT_EQ(list[k], ids[k]);
  if (ids.empty()) return;
  EXPECT_EQ(list.front(), ids.front());
  EXPECT_EQ(list.back(), ids.back());
}

// Whether they follow each other to the end, to some place, or from none on.
TEST(IdList, IsAVectorOfThem) {
  std::mt19937 random(1);
  std::size_t consecutive = 0;
  for (int n = 0; n < 500; ++n) {
    Ids list;
    std::vector<ParticleId> ids;
    const std::size_t size = random() % 12, gaps = random() % 3;
    for (std::size_t k = 0, id = random() % 5; k < size;
         ++k, id += 1 + (gaps > 0 && random() % 4 < gaps ? 1 : 0)) {
      list.push_back(ParticleId{id}), ids.push_back(ParticleId{id});
      expect_same(list, ids);
    }
    const bool one_by_one = ids.empty() || ids.back().value - ids.front().value + 1 == ids.size();
    EXPECT_EQ(list.bytes() == 0, one_by_one);
    consecutive += one_by_one ? 1 : 0;
    for (std::size_t id = 0; id < 30; ++id)
      EXPECT_EQ(std::binary_search(list.begin(), list.end(), ParticleId{id}),
                std::binary_search(ids.begin(), ids.end(), ParticleId{id}));
  }
  EXPECT_GT(consecutive, 100u);
  EXPECT_LT(consecutive, 400u);
}

TEST(IdList, OfConsecutiveOnesGoesOnAsAnyOther) {
  Ids list = Ids::consecutive(ParticleId{3}, 2);
  expect_same(list, {ParticleId{3}, ParticleId{4}});
  list.push_back(ParticleId{5});
  EXPECT_EQ(list.bytes(), 0u);
  list.push_back(ParticleId{1});
  expect_same(list, {ParticleId{3}, ParticleId{4}, ParticleId{5}, ParticleId{1}});
  EXPECT_FALSE(list == Ids::consecutive(ParticleId{3}, 4));
  expect_same(Ids{ParticleId{7}, ParticleId{2}}, {ParticleId{7}, ParticleId{2}});
  expect_same(Ids::consecutive(ParticleId{9}, 0), {});
}

}  // namespace
}  // namespace vbond
