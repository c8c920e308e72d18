#include "vbond/report/case_of_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <string>
#include <vector>

#include "vbond/case/read.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::page {
namespace {

namespace fs = std::filesystem;

/// A file as it is named from the folder; one that lies elsewhere by its name alone, with a number if another
/// file has taken that.
fs::path name_in(const fs::path& folder, const fs::path& file, const std::set<std::string>& taken) {
  const fs::path relative = file.lexically_relative(folder);
  if (!relative.empty() && *relative.begin() != "..") return relative;
  std::string name = file.filename().string();
  for (int k = 2; taken.count(name) > 0; ++k)
    name = fmt::format("{}_{}{}", file.stem().string(), k, file.extension().string());
  return name;
}

}  // namespace

CaseOfPage case_of_page(Case c, const fs::path& resolved) {
  const std::vector<fs::path*> files = files_of(c);
  if (files.empty()) return {read_all(resolved), {}};
  const fs::path folder = fs::absolute(resolved).lexically_normal().parent_path();
  std::set<std::string> names;
  std::vector<std::pair<fs::path, fs::path>> named;  // the same file may stand in several places
  for (fs::path* file : files) {
    auto known = named.begin();
    while (known != named.end() && known->first != *file) ++known;
    if (known == named.end()) known = named.insert(known, {*file, name_in(folder, *file, names)});
    *file = known->second;
    names.insert(file->string());
  }
  return {to_toml(c), fmt::format("The case reads {}, whose content is not in the page: to run it again, put "
                                  "it beside resolved.toml under that name.",
                                  fmt::join(names, ", "))};
}

std::string without_folder(std::string text, const fs::path& folder) {
  const std::string before = (folder / "").string();
  for (std::size_t at; (at = text.find(before)) != std::string::npos;) text.erase(at, before.size());
  return text;
}

}  // namespace vbond::page
