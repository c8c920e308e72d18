#include "inputs.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>

#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// A file that the case reads, and the name of its copy.
struct Copy {
  fs::path source;
  std::string name;
};

fs::path inputs_of(const fs::path& folder) {
  return (fs::absolute(folder) / inputs_folder).lexically_normal();
}

/// Under whatever names and links.
bool is_same_file(const fs::path& one, const fs::path& other) {
  std::error_code e;
  return one == other || (fs::equivalent(one, other, e) && !e);
}

bool is_one_of(const fs::path& file, const std::vector<fs::path>& files) {
  return std::any_of(files.begin(), files.end(), [&](const fs::path& f) { return is_same_file(file, f); });
}

/// The block that is read next; empty at the end of the file.
std::string next_block(std::FILE* f, const fs::path& path) {
  std::string block(1 << 20, '\0');
  block.resize(std::fread(block.data(), 1, block.size(), f));
  require_read(f, path);
  return block;
}

bool have_same_content(const fs::path& one, const fs::path& other) {
  const File f = open_file(one, "rb"), g = open_file(other, "rb");
  for (;;) {
    const std::string block = next_block(f.get(), one);
    if (block != next_block(g.get(), other)) return false;
    if (block.empty()) return true;
  }
}

void make_copy(const fs::path& source, const fs::path& target) {
  const File f = open_file(source, "rb");
  Replacement copy(target);
  for (std::string block; !(block = next_block(f.get(), source)).empty();) copy.write(block);
  copy.publish(Sync::to_disk);
}

std::string in_lower_case(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

/// The k-th name for the copy of a file: its own, then with a number. ".part" is the end of unfinished files.
std::string name_of_copy(const fs::path& source, int k) {
  const std::string number = k == 1 ? "" : "_" + std::to_string(k);
  const std::string name = source.stem().string() + number + source.extension().string();
  return source.extension() == ".part" ? name + ".data" : name;
}

class InputKeeper {
 public:
  InputKeeper(fs::path inputs, std::vector<fs::path> sources, const std::vector<fs::path>& old)
      : inputs_(std::move(inputs)), sources_(std::move(sources)), old_(old) {}

  /// The name of the copy of this file, which is made unless it is there.
  std::string keep(const fs::path& source) {
    for (const Copy& c : copies_)
      if (is_same_file(c.source, source)) return c.name;
    make_folder(inputs_);
    for (int k = 1;; ++k) {
      const std::string name = name_of_copy(source, k);
      if (is_taken(name)) continue;
      const fs::path target = inputs_ / name;
      std::error_code e;
      const fs::file_status there = fs::symlink_status(target, e);
      const bool free = !fs::exists(there) || is_ours_to_replace(target);
      const bool is_copy = fs::is_regular_file(there) && have_same_content(source, target);
      if (!free && !is_copy) continue;
      if (!is_copy) make_copy(source, target);
      copies_.push_back({source, name});
      return name;
    }
  }

  void remove_what_is_left_of_old() const {
    for (const fs::path& file : old_)
      if (!is_taken(file.filename().string())) remove_file(file);
    std::error_code e;
    if (fs::is_directory(inputs_, e) && fs::is_empty(inputs_, e) && !e) fs::remove(inputs_, e);
  }

 private:
  /// Also where a folder does not tell "A.csv" from "a.csv", as on the machine it may be moved to.
  bool is_taken(const std::string& name) const {
    return std::any_of(copies_.begin(), copies_.end(),
                       [&](const Copy& c) { return in_lower_case(c.name) == in_lower_case(name); });
  }
  bool is_ours_to_replace(const fs::path& file) const {
    return is_one_of(file, old_) && !is_one_of(file, sources_);
  }

  fs::path inputs_;
  std::vector<fs::path> sources_;
  const std::vector<fs::path>& old_;
  std::vector<Copy> copies_;
};

}  // namespace

std::vector<fs::path> copies_in(const fs::path& folder) {
  std::vector<fs::path> copies;
  try {
    Case c = read_case(folder / "resolved.toml");
    for (const fs::path* file : files_of(c))
      if (file->parent_path() == inputs_of(folder)) copies.push_back(*file);
  } catch (const IoError&) {
  } catch (const CaseError&) {
  }
  return copies;
}

Case keep_inputs(Case& c, const fs::path& folder, const std::vector<fs::path>& old) {
  const std::vector<fs::path*> files = files_of(c);
  std::vector<fs::path> sources;
  for (const fs::path* file : files) sources.push_back(*file);
  InputKeeper keeper(inputs_of(folder), std::move(sources), old);
  for (fs::path* file : files) *file = fs::path(inputs_folder) / keeper.keep(*file);
  keeper.remove_what_is_left_of_old();
  Case written = c;
  for (fs::path* file : files) *file = inputs_of(folder) / file->filename();
  return written;
}

bool reads_the_same(Case& c, Case other) {
  const std::vector<fs::path*> files = files_of(c), copies = files_of(other);
  if (files.size() != copies.size()) return false;
  for (std::size_t k = 0; k < files.size(); ++k)
    if (!have_same_content(*files[k], *copies[k])) return false;
  for (std::size_t k = 0; k < files.size(); ++k) *files[k] = fs::path(inputs_folder) / copies[k]->filename();
  return true;
}

}  // namespace vbond::app
