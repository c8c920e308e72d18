#include "vbond/core/short_pointer.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

namespace vbond {
namespace {

struct Shared {
  int value = 0;
};

TEST(ShortPointer, IsAPointerInTwoBytes) {
  static const std::vector<Shared> objects{{1}, {2}, {3}};
  const ShortPointer<Shared> none, first = &objects[0], again = &objects[0], second = &objects[1];
  static_assert(sizeof(first) == 2);
  EXPECT_TRUE(none == nullptr);
  EXPECT_TRUE(first == &objects[0] && first == again && first != second);
  EXPECT_EQ(second->value, 2);
  EXPECT_EQ((*first).value, 1);
  ShortPointer<Shared> moved = first;
  moved = &objects[2];
  EXPECT_EQ(moved->value, 3);
  moved = nullptr;
  EXPECT_TRUE(moved == nullptr);
}

TEST(ShortPointer, ThreadsMayMakeThemAtOnce) {
  struct Other {
    int value = 0;
  };
  static const std::vector<Other> objects(1000);
  std::vector<std::vector<ShortPointer<Other>>> of_threads(4);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < of_threads.size(); ++t)
    threads.emplace_back([&mine = of_threads[t], t] {
      for (std::size_t k = 0; k < objects.size(); ++k) mine.emplace_back(&objects[(k + 250 * t) % 1000]);
    });
  for (std::thread& t : threads) t.join();
  for (std::size_t t = 0; t < of_threads.size(); ++t)
    for (std::size_t k = 0; k < objects.size(); ++k)
      EXPECT_TRUE(of_threads[t][k] == &objects[(k + 250 * t) % 1000]);
}

TEST(ShortPointer, TooManyObjectsAreRefused) {
  struct Many {
    char value = 0;
  };
  static const std::vector<Many> objects((1 << 16) + 1);
  std::size_t made = 0;
  try {
    for (const Many& m : objects) static_cast<void>(ShortPointer<Many>(&m)), ++made;
    FAIL() << made;
  } catch (const std::length_error&) {
    EXPECT_EQ(made, std::size_t{(1 << 16) - 1});  // number 0 is nullptr
  }
}

}  // namespace
}  // namespace vbond
