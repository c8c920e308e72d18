#include "vbond/core/memory.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace vbond {
namespace {

namespace fs = std::filesystem;

/// The files in which the kernel tells a process its limits.
class Kernel {
 public:
  Kernel() : root_(fs::temp_directory_path() / ("vbond_memory_" + name_of_test())) { fs::remove_all(root_); }
  ~Kernel() { fs::remove_all(root_); }
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  Kernel& with(const std::string& file, const std::string& content) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << content;
    return *this;
  }
  double limit() const { return memory_limit(root_); }

 private:
  static std::string name_of_test() {
    return ::testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  fs::path root_;
};

TEST(MemoryLimit, IsThatOfTheMachineWithoutGroups) {
  EXPECT_GT(Kernel().limit(), 0x1p20);
  EXPECT_GE(Kernel().limit(), memory_limit());
  EXPECT_EQ(Kernel().with("proc/self/cgroup", "nonsense\n0::/a\n").limit(), Kernel().limit());
}

TEST(MemoryLimit, OfVersion2IsTheLeastOnTheWayUp) {
  Kernel k;
  k.with("proc/self/cgroup", "0::/job/step\n")
      .with("sys/fs/cgroup/job/memory.max", "1048576\n")
      .with("sys/fs/cgroup/job/step/memory.max", "max\n");
  EXPECT_EQ(k.limit(), 1048576);
  EXPECT_EQ(k.with("sys/fs/cgroup/job/step/memory.max", "4096\n").limit(), 4096);
  EXPECT_EQ(k.with("sys/fs/cgroup/other/memory.max", "1\n").limit(), 4096);
}

TEST(MemoryLimit, OfAContainerThatSeesOnlyItself) {
  Kernel k;
  k.with("proc/self/cgroup", "0::/\n").with("sys/fs/cgroup/memory.max", "8192\n");
  EXPECT_EQ(k.limit(), 8192);
  // version 1: the path is that of the host, and what the container sees is mounted on top
  Kernel one;
  one.with("proc/self/cgroup", "9:cpu:/x\n4:memory,hugetlb:/docker/abc\n0::/\n")
      .with("sys/fs/cgroup/memory/memory.limit_in_bytes", "16384\n");
  EXPECT_EQ(one.limit(), 16384);
}

TEST(MemoryLimit, OfVersion1IsTheLeastOnTheWayUp) {
  Kernel k;
  k.with("proc/self/cgroup", "4:memory:/job/step\n")
      .with("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n")
      .with("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "32768\n")
      .with("sys/fs/cgroup/memory/job/step/memory.limit_in_bytes", "65536\n");
  EXPECT_EQ(k.limit(), 32768);
}

}  // namespace
}  // namespace vbond
