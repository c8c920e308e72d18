#include "vbond/observe/files.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/spool.hpp"
#include "vbond/observe/vtp.hpp"

namespace vbond {
namespace {

using test::Chain;
using test::content_of;
using test::Folder;
using test::put_content;

/// While it lives no file can grow beyond so many bytes, which takes the same path as a full disk.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

template <class Write>
std::string error_of(Write&& write) {
  try {
    write();
  } catch (const IoError& e) {
    return e.what();
  }
  return "no error";
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(FullDisk, OlderFileStaysAndNoHalfOneIsLeft) {
  const Folder folder;
  Chain chain;
  const auto write_all_kinds = [&](std::int64_t step) {
    chain.at_step(step);
    std::string errors =
        error_of([&] { replace_file(folder / "a", std::string(5000, 'x') + std::to_string(step)); });
    errors += error_of([&] { write_checkpoint(folder / "b", chain.model, {chain.state, {}}, "1.2.3"); });
    VtpFile vtp = VtpFile::of_points(std::vector<Vec3d>(100), {.compressed = false});
    errors += error_of([&] { vtp.write(folder / "c", 0.0, step); });
    return errors;
  };
  write_all_kinds(1);
  std::vector<std::string> before;
  for (const char* name : {"a", "b", "c"}) before.push_back(content_of(folder / name));
  for (const rlim_t bytes : {0, 1, 511, 512, 513, 4000}) {
    const FileLimit limit(bytes);
    const std::string errors = write_all_kinds(2);
    for (const char* name : {"a.part: File too large", "b.part: File too large", "c.part: File too large"})
      expect_in(errors, name);
  }
  std::size_t k = 0;
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_EQ(content_of(folder / name), before[k++]);
    EXPECT_FALSE(std::filesystem::exists(temporary_name(folder / name)));
  }
}

TEST(FullDisk, ArraysThatWaitTellOfIt) {
  const Folder folder;
  Spool spool(folder / "frame.vtp");
  const std::string block(1 << 20, 'x');
  const FileLimit limit(3 << 20);
  expect_in(error_of([&] {
              for (std::size_t k = 0; k < Spool::in_memory / block.size() + 4; ++k) spool.keep(block);
            }),
            "frame.vtp: File too large");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "."));
}

TEST(GrowingFile, GrowsWhileNobodyTouchesIt) {
  const Folder folder;
  const auto path = folder / "rows";
  put_content(path, "old");
  {
    GrowingFile file(path, GrowingFile::Begin::anew);
    file.append("one\n");
    file.append("two\n");
  }
  GrowingFile file(path, GrowingFile::Begin::at_end);
  file.append("three\n");
  EXPECT_EQ(content_of(path), "one\ntwo\nthree\n");
}

TEST(GrowingFile, NoticesWhatOthersDoToIt) {
  const Folder folder;
  const auto path = folder / "rows";
  const auto after = [&](auto&& touch) {
    GrowingFile file(path, GrowingFile::Begin::anew);
    file.append("one\n");
    touch();
    return error_of([&] { file.append("two\n"); });
  };
  expect_in(after([] {}), "no error");
  expect_in(after([&] { std::filesystem::remove(path); }), path.string() + ": was removed");
  expect_in(after([&] {
              put_content(folder / "copy", content_of(path));
              std::filesystem::rename(folder / "copy", path);
            }),
            "was replaced");
  expect_in(after([&] { put_content(path, ""); }), "was changed");
  expect_in(after([&] { put_content(path, content_of(path) + "more\n"); }), "was changed");
}

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

// As root it could be replaced, and every program on the machine would write into a file.
TEST(Files, DevicesAndPipesAreNotReplaced) {
  const Folder folder;
  const std::filesystem::path pipe = folder / "pipe", link = folder / "link";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", link);
  for (const std::filesystem::path& path : {pipe, link}) {
    EXPECT_THROW(open_file(path, "wb"), IoError) << path;
    EXPECT_THROW(remove_file(path), IoError) << path;
    open_file(temporary_name(path), "wb");
    EXPECT_THROW(publish(path), IoError) << path;
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
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
