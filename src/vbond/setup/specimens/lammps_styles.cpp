#include "vbond/setup/specimens/lammps_styles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string_view>

#include "vbond/core/nearest.hpp"
#include "vbond/setup/text_file.hpp"

// Format: LAMMPS manual, command read_data.
namespace vbond {
namespace {

constexpr AtomColumns atom_styles[] = {
    {"atomic", 1, 2, 5},    {"charge", 1, 3, 6}, {"bond", 2, 3, 6},      {"angle", 2, 3, 6},
    {"molecular", 2, 3, 6}, {"full", 2, 4, 7},   {"sphere", 1, 4, 7, 2}, {"bpm/sphere", 2, 5, 8, 3},
};

/// Styles of LAMMPS that are not read. Other words after "Atoms #" are no styles.
constexpr std::string_view other_styles[] = {
    "amoeba",    "apip",   "body", "dielectric", "dipole",   "dpd",  "edpd",      "electron",
    "ellipsoid", "hybrid", "line", "mdpd",       "oxdna",    "peri", "rheo",      "rheo/thermal",
    "smd",       "sph",    "spin", "tdpd",       "template", "tri",  "wavepacket"};

const AtomColumns* find_style(std::string_view style) {
  const auto found = std::find_if(std::begin(atom_styles), std::end(atom_styles),
                                  [style](const AtomColumns& c) { return style == c.style; });
  return found == std::end(atom_styles) ? nullptr : found;
}

bool have_one_layout(const AtomColumns& a, const AtomColumns& b) {
  return a.type == b.type && a.x == b.x && a.count == b.count && a.diameter == b.diameter;
}

std::vector<std::string> all_styles() {
  std::vector<std::string> names;
  for (const AtomColumns& c : atom_styles) names.emplace_back(c.style);
  return names;
}

/// The header of the Atoms section and the lines below it.
struct AtomsSection {
  std::uint32_t line = 0;                            ///< from 1; 0: there is none
  std::string_view word;                             ///< the first after the #
  std::vector<std::vector<std::string_view>> atoms;  ///< the words of the first of its lines
};

AtomsSection find_atoms(const std::vector<std::string>& lines) {
  constexpr std::size_t enough = 1000;
  AtomsSection section;
  for (std::size_t k = 1; k < lines.size() && section.atoms.size() < enough; ++k) {  // the first is a title
    const std::string_view line = lines[k];
    const std::size_t hash = std::min(line.find('#'), line.size());
    auto words = words_of(line.substr(0, hash));
    if (words.empty()) continue;
    if (section.line > 0) {
      if (std::isalpha(static_cast<unsigned char>(words[0][0])) != 0) break;  // the next section
      section.atoms.push_back(std::move(words));
    } else if (words.size() == 1 && words[0] == "Atoms") {
      section.line = static_cast<std::uint32_t>(k + 1);
      const auto comment = words_of(line.substr(std::min(hash + 1, line.size())));
      if (!comment.empty()) section.word = comment[0];
    }
  }
  return section;
}

bool fits(const AtomColumns& columns, const std::vector<std::string_view>& words) {
  if (words.size() != columns.count && words.size() != columns.count + 3) return false;
  for (std::size_t k = columns.x; k < words.size(); ++k)
    if (k < columns.count ? !to_number(words[k]) : !to_integer(words[k])) return false;
  return to_integer(words[0]) && (columns.diameter == 0 || to_number(words[columns.diameter]));
}

void refuse_unnamed(const AtomsSection& section, const SourcePlace& place, Problems& problems) {
  std::vector<std::string> fitting;
  for (const AtomColumns& c : atom_styles)
    if (std::all_of(section.atoms.begin(), section.atoms.end(),
                    [&c](const auto& words) { return fits(c, words); }))
      fitting.emplace_back(c.style);
  const std::size_t fields = section.atoms.front().size();
  if (fitting.empty())
    problems.add(
        place, fmt::format("the style of the atoms is not known, and no style fits their {} fields", fields),
        fmt::format("supported: {}", fmt::join(all_styles(), ", ")), "write the file in one of these styles");
  else
    problems.add(
        place, "the style of the atoms is named neither by the file nor by the case",
        fmt::format("atoms of {} fields may have the style {}", fields, fmt::join(fitting, ", ")),
        fmt::format("name it in the case, as in atom_style = \"{0}\", or here: Atoms # {0}", fitting.back()));
}

void refuse_style(std::string_view style, const SourcePlace& place, Problems& problems) {
  const bool hybrid = style == "hybrid";
  problems.add(
      place, fmt::format("the file says atom style \"{}\", which is not supported", style),
      hybrid ? "the columns of a hybrid style depend on its parts, which the file does not name"
             : fmt::format("supported: {}", fmt::join(all_styles(), ", ")),
      hybrid ? "bring the columns into the order of one style, such as \"id molecule type diameter density "
               "x y z\", and name it here: Atoms # bpm/sphere"
             : "write the file in one of these styles");
}

}  // namespace

std::optional<std::string> use_of_passed_section(const std::string& name) {
  const auto usual = [](unsigned char c) { return std::isalnum(c) != 0 || c == ' '; };
  if (!std::all_of(name.begin(), name.end(), usual)) return std::nullopt;
  const auto ends_with = [&name](std::string_view end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (ends_with(" Coeffs")) return "the case gives the laws of bonds and contacts";
  if (ends_with(" Type Labels")) return "only types of atoms and bonds are of use here";
  if (name == "Angles" || name == "Dihedrals" || name == "Impropers")
    return "bonds join two particles here, and resist bending and torsion themselves";
  if (name == "Masses") return "diameters and densities of the atoms give their masses";
  if (name == "Velocities") return "the case says velocities = false";
  return std::nullopt;
}

const AtomColumns& columns_of(const std::string& style, const SourcePlace& place) {
  if (const AtomColumns* columns = find_style(style)) return *columns;
  const auto near = nearest_name(style, all_styles());
  throw CaseError({place, fmt::format("atom_style = \"{}\" is not supported", style),
                   fmt::format("supported: {}", fmt::join(all_styles(), ", ")),
                   near ? fmt::format("did you mean \"{}\"?", *near) : "convert the file to one of them"});
}

const AtomColumns* choose_columns(const std::vector<std::string>& lines, const std::string& file,
                                  const std::string& asked, Problems& problems) {
  const AtomsSection section = find_atoms(lines);
  if (section.line == 0) return nullptr;
  const SourcePlace place{file, section.line, 1};
  const bool other =
      std::find(std::begin(other_styles), std::end(other_styles), section.word) != std::end(other_styles);
  const AtomColumns *of_file = find_style(section.word),
                    *of_case = asked.empty() ? nullptr : find_style(asked);
  if (other)
    refuse_style(section.word, place, problems);
  else if (of_file && of_case && !have_one_layout(*of_file, *of_case))
    problems.add(place, fmt::format("the file says atom style \"{}\"", section.word),
                 fmt::format("the case says atom_style = \"{}\"", asked),
                 "leave atom_style out of the case, or correct the file");
  else if (of_case || of_file)
    return of_case ? of_case : of_file;
  else if (!section.atoms.empty())
    refuse_unnamed(section, place, problems);
  return nullptr;
}

}  // namespace vbond
