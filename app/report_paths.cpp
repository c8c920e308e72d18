#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <string>
#include <variant>
#include <vector>

#include "report.hpp"
#include "vbond/case/read.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// Where the case names its files.
std::vector<fs::path*> files_of(Case& c) {
  std::vector<fs::path*> files;
  for (SpecimenSpec& s : c.specimens) {
    if (auto* csv = std::get_if<CsvSpecimen>(&s.shape)) files.push_back(&csv->file.value);
    if (auto* lammps = std::get_if<LammpsSpecimen>(&s.shape)) files.push_back(&lammps->file.value);
  }
  for (BondSpec& b : c.bonds)
    if (auto* pairs = std::get_if<PairsFile>(&b.select.value)) files.push_back(&pairs->file);
  return files;
}

/// The name of a file without its folder; one that is taken by another file gets a number.
fs::path free_name(const fs::path& file, const std::set<std::string>& taken) {
  std::string name = file.filename().string();
  for (int k = 2; taken.count(name) > 0; ++k)
    name = fmt::format("{}_{}{}", file.stem().string(), k, file.extension().string());
  return name;
}

}  // namespace

CaseOfPage case_of_page(Case c, const fs::path& resolved) {
  const std::vector<fs::path*> files = files_of(c);
  if (files.empty()) return {read_all(resolved), {}};
  std::set<std::string> names;
  std::vector<std::pair<fs::path, fs::path>> named;  // the same file may stand in several places
  for (fs::path* file : files) {
    auto known = named.begin();
    while (known != named.end() && known->first != *file) ++known;
    if (known == named.end()) known = named.insert(known, {*file, free_name(*file, names)});
    *file = known->second;
    names.insert(file->string());
  }
  return {to_toml(c), fmt::format("The case reads {}, of which the page gives neither the content nor the "
                                  "folder: to run it again, put it beside resolved.toml.",
                                  fmt::join(names, ", "))};
}

std::string without_folder(std::string text, const fs::path& folder) {
  const std::string before = (folder / "").string();
  for (std::size_t at; (at = text.find(before)) != std::string::npos;) text.erase(at, before.size());
  return text;
}

}  // namespace vbond::app
