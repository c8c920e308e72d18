#include "vbond/core/large_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace vbond {
namespace {

constexpr std::size_t large_page = std::size_t{1} << 21;

struct alignas(64) Row {
  double value[8];
};

template <class T>
std::uintptr_t address(const LargeArray<T>& array) {
  return reinterpret_cast<std::uintptr_t>(array.data());
}

/// Whether the system was asked for large pages where this address is, by smaps of proc(5).
bool was_asked_for(std::uintptr_t address) {
  std::ifstream maps("/proc/self/smaps");
  bool here = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t from = 0, to = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &from, &to) == 2) here = from <= address && address < to;
    if (here && line.starts_with("VmFlags:")) return line.find(" hg") != std::string::npos;
  }
  return false;
}

TEST(LargeArray, KeepsItsValuesAsItGrows) {
  LargeArray<std::uint32_t> array;
  for (std::uint32_t k = 0; k < 3'000'000; ++k) array.push_back(k);
  for (std::uint32_t k = 0; k < array.size(); ++k) ASSERT_EQ(array[k], k);
  const LargeArray<std::uint32_t> copy = array;
  const auto before = address(array);
  const LargeArray<std::uint32_t> moved = std::move(array);
  EXPECT_EQ(address(moved), before);
  EXPECT_EQ(moved, copy);
}

TEST(LargeArray, OfAFewIsAlignedAsItsType) {
  for (std::size_t n = 1; n < 40; ++n) EXPECT_EQ(address(LargeArray<Row>(n)) % alignof(Row), 0u);
}

TEST(LargeArray, OfManyBeginsAtALargePageAndAsksForSuch) {
  const LargeArray<Row> array(2 * large_page / sizeof(Row));
  EXPECT_EQ(address(array) % large_page, 0u);
  const LargeArray<double> other(large_page);
  EXPECT_EQ(address(other) % large_page, 0u);
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage/enabled"))
    GTEST_SKIP() << "this system has no large pages for those who ask";
  EXPECT_TRUE(was_asked_for(address(array)));
  EXPECT_TRUE(was_asked_for(address(other) + sizeof(double) * large_page - 1));
}

}  // namespace
}  // namespace vbond
