#include "vbond/observe/files.hpp"

#include <gtest/gtest.h>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/frames.hpp"

namespace vbond {
namespace {

using test::content_of;
using test::Folder;
using test::put_content;

/// A file that somebody else wants kept, and links to it under each of these names.
struct Trap {
  Folder folder;
  std::filesystem::path victim = folder / "victim";

  explicit Trap(const std::vector<std::string>& names) {
    put_content(victim, "precious");
    for (const std::string& name : names) std::filesystem::create_symlink(victim, folder / name);
  }
  ~Trap() { EXPECT_EQ(content_of(victim), "precious"); }
  bool is_file(const std::string& name) const {
    return std::filesystem::is_regular_file(std::filesystem::symlink_status(folder / name));
  }
};

TEST(Files, TemporaryFilesAreNeverLinks) {
  const Trap trap({"report.html.part", "p.vtp.part", "checkpoint.h5.part", "history.csv"});
  const test::Chain chain;
  replace_file(trap.folder / "report.html", "new", Sync::none);
  write_particles_vtp(trap.folder / "p.vtp", chain.model, chain.state);
  write_checkpoint(trap.folder / "checkpoint.h5", chain.model, {chain.state, {}}, "1.2.3");
  open_file(trap.folder / "history.csv", "wb");
  for (const char* name : {"report.html", "p.vtp", "checkpoint.h5", "history.csv"})
    EXPECT_TRUE(trap.is_file(name)) << name;
  EXPECT_EQ(content_of(trap.folder / "report.html"), "new");
}

TEST(Files, WhatIsContinuedIsNoLink) {
  const Trap trap({"history.csv"});
  EXPECT_THROW(open_file(trap.folder / "history.csv", "ab"), IoError);
  EXPECT_THROW(open_file(trap.folder / "history.csv", "r+b"), IoError);
  EXPECT_THROW(cut_file(trap.folder / "history.csv", 2), IoError);
  EXPECT_EQ(read_all(trap.folder / "history.csv"), "precious");  // to read is no harm
}

TEST(Files, ModesAreThoseOfFopen) {
  const Folder folder;
  const auto write = [&](const char* mode, const char* text) {
    const File f = open_file(folder / "a", mode);
    write_all(f.get(), text, folder / "a");
  };
  EXPECT_THROW(open_file(folder / "a", "rb"), IoError);
  EXPECT_THROW(open_file(folder / "a", "r+b"), IoError);
  write("ab", "one");
  write("ab", "two");
  write("r+b", "O");
  EXPECT_EQ(read_all(folder / "a"), "Onetwo");
  cut_file(folder / "a", 3);
  EXPECT_EQ(read_all(folder / "a"), "One");
  write("wb", "z");
  EXPECT_EQ(read_all(folder / "a"), "z");
}

}  // namespace
}  // namespace vbond
