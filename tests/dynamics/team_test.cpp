#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "vbond/dynamics/team.hpp"

namespace vbond {
namespace {

TEST(Team, SharesOutEveryBlockOnce) {
  for (const int threads : {1, 2, 3, 7}) {
    std::vector<std::size_t> work(50, 1000);
    work[3] = 400000;  // one block as heavy as all the others: some part may be empty
    const Team team(50 * block_rows - 5, work, threads);
    EXPECT_EQ(team.parts().size(), static_cast<std::size_t>(threads));
    std::vector<int> visits(50);
    std::size_t next = 0;
    for (const Part& p : team.parts()) {
      EXPECT_EQ(p.first_block, next);
      next = p.last_block;
      EXPECT_EQ(p.rows.first, p.first_block * block_rows);
    }
    EXPECT_EQ(next, 50u);
    team.for_blocks([&](const Block& b) { ++visits[b.index]; });
    EXPECT_EQ(visits, std::vector<int>(50, 1)) << threads << " threads";
  }
}

TEST(Team, GoesOnToMoreRows) {
  for (const int threads : {1, 3}) {
    const Team fewer(20 * block_rows - 5, std::vector<std::size_t>(20, 5000), threads);
    const Team more(fewer, 23 * block_rows - 30);
    EXPECT_EQ(more.blocks(), 23u);
    ASSERT_EQ(more.parts().size(), fewer.parts().size());
    for (std::size_t p = 0; p + 1 < more.parts().size(); ++p)
      EXPECT_EQ(more.parts()[p].last_block, fewer.parts()[p].last_block);
    EXPECT_EQ(more.parts().back().rows.last, 23 * block_rows - 24) << "filled up to whole packs of rows";
    std::vector<int> visits(23);
    for (int round = 0; round < 100; ++round) {  // in turns
      fewer.for_blocks([&](const Block& b) { ++visits[b.index]; });
      more.for_blocks([&](const Block& b) { ++visits[b.index]; });
    }
    for (std::size_t b = 0; b < 23; ++b) EXPECT_EQ(visits[b], b < 20 ? 200 : 100) << "block " << b;
  }
}

// A part ends where the work done is nearest to its share: half the heaviest block away at most.
TEST(Team, SharesOutEvenly) {
  for (const int threads : {2, 3, 5, 8}) {
    std::vector<std::size_t> work, before{0};
    for (std::size_t b = 0; b < 50; ++b) {
      work.push_back(2000 + 37 * b % 400);
      before.push_back(before.back() + work.back());
    }
    const Team team(50 * block_rows, work, threads);
    ASSERT_EQ(team.parts().size(), static_cast<std::size_t>(threads));
    for (const Part& p : team.parts()) {
      const auto share = static_cast<double>(before.back() * (p.index + 1)) / threads;
      EXPECT_NEAR(static_cast<double>(before[p.last_block]), share, 0.5 * 2400)
          << p.index << " of " << threads;
    }
  }
}

TEST(Team, IsOneThreadForLittleWork) {
  EXPECT_EQ(Team(100, {2 * least_part - 1}, 8).parts().size(), 1u);
  EXPECT_EQ(Team(0, {}, 8).parts().size(), 1u);
}

// Work is handed out at once or after the others have gone to sleep, and nobody goes on before all are done.
TEST(Team, WaitsForEveryPartOfEveryRound) {
  const std::vector<std::size_t> work(8, least_part);
  const Team team(8 * block_rows, work, 4);
  ASSERT_EQ(team.parts().size(), 4u);
  std::vector<int> rounds(4);
  for (int round = 1; round <= 3000; ++round) {
    if (round % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    team.for_parts([&](const Part& p) {
      if (round % 1000 == static_cast<int>(p.index))
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ++rounds[p.index];
    });
    ASSERT_EQ(rounds, std::vector<int>(4, round));
  }
}

// Memory may run out in any thread: the caller hears of it once all are done, and the team works on.
TEST(Team, HandsOnWhatIsThrownInAnyThread) {
  const std::vector<std::size_t> work(8, least_part);
  const Team team(8 * block_rows, work, 4);
  ASSERT_EQ(team.parts().size(), 4u);
  for (std::size_t bad = 0; bad < 4; ++bad) {
    std::vector<int> done(4);
    const auto work_badly = [&] {
      team.for_parts([&](const Part& p) {
        if (p.index >= bad) throw std::runtime_error("part " + std::to_string(p.index));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        done[p.index] = 1;
      });
    };
    try {
      work_badly();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(e.what(), "part " + std::to_string(bad));  // the lowest of them
    }
    for (std::size_t p = 0; p < bad; ++p) EXPECT_EQ(done[p], 1);
    std::vector<int> visits(8);
    team.for_blocks([&](const Block& b) { ++visits[b.index]; });
    EXPECT_EQ(visits, std::vector<int>(8, 1));
  }
}

}  // namespace
}  // namespace vbond
