#include "vbond/observe/due.hpp"

#include <gtest/gtest.h>

namespace vbond {
namespace {

TEST(Due, StepsToTheNextAreThoseThatAskingEveryStepWouldFind) {
  Due due(10.4);  // one object for all steps, as in a run: it must notice that the step has changed
  for (const double dt : {1.0, 0.7, 3.0, 10.4, 20.0, 100.0}) {
    SCOPED_TRACE(dt);
    const std::int64_t last = 200;
    std::int64_t found = 0;
    Clock c{.step = 1000, .stage_step = 0, .stage = 0, .stage_start = 0, .dt = dt};
    EXPECT_TRUE(due.now(c));
    for (std::int64_t next = c.stage_step + due.steps_to_next(c); c.stage_step < last;) {
      ++c.step, ++c.stage_step;
      ASSERT_EQ(due.now(c), c.stage_step == next) << "step " << c.stage_step << " of the stage";
      if (c.stage_step == next) next += due.steps_to_next(c), ++found;
      ASSERT_EQ(c.stage_step + due.steps_to_next(c), next) << "asked on the way";
    }
    EXPECT_EQ(found, last / steps_in(10.4, dt));
  }
}

TEST(Due, IntervalLongerThanAnyRunIsNoOverflow) {
  const Due due(1e300);
  const Clock c{.step = 5, .stage_step = 5, .stage = 0, .stage_start = 0, .dt = 1e-9};
  EXPECT_FALSE(due.now(c));
  EXPECT_EQ(due.steps_to_next(c), (std::int64_t{1} << 62) - 5);
}

}  // namespace
}  // namespace vbond
