#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "vbond/case/value.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/specimens/lammps_box.hpp"
#include "vbond/setup/specimens/lammps_styles.hpp"
#include "vbond/setup/specimens/specimen.hpp"
#include "vbond/setup/text_file.hpp"

// Format: LAMMPS manual, command read_data.
namespace vbond {
namespace {

struct Atom {
  std::int64_t id, type;
  Vec3d r;
  double diameter = 0, density = 0;
  std::array<std::int64_t, 3> image{};  ///< periods of the box that lie between x and the unwrapped place
  SourcePlace place;
};

struct VelocityLine {
  std::int64_t id;
  Vec3d v, omega;
  SourcePlace place;
};

struct BondLine {
  std::int64_t type, first, second;
  SourcePlace place;
};

/// Names of types in place of their numbers.
using TypeLabels = std::map<std::string, std::int64_t, std::less<>>;

class LammpsReader {
 public:
  LammpsReader(const std::filesystem::path& file, bool velocities)
      : takes_velocities_(velocities), at_{file.string(), 0, 1} {}

  SpecimenPoints read(const std::vector<std::string>& lines, const std::string& asked_style) {
    columns_ = choose_columns(lines, at_.file, asked_style, problems_);
    knows_columns_ = columns_ != nullptr;
    if (!knows_columns_) columns_ = &columns_of("bond", {});  // told already; the other sections are read
    for (const std::string& line : lines) {
      ++at_.line;
      if (at_.line == 1) continue;  // a title, whatever it says
      const std::size_t hash = line.find('#');
      const auto words = words_of(std::string_view(line).substr(0, hash));
      if (words.empty()) continue;
      const bool is_data =
          words.size() > 1 && labels_.count(words[0]) > 0;  // masses of labels begin with them
      if (std::isalpha(static_cast<unsigned char>(words[0][0])) != 0 && !is_data)
        begin_section(fmt::format("{}", fmt::join(words, " ")));
      else
        data_line(words);
    }
    check_whole();
    throw_if_any();
    unwrap();
    return points();
  }

 private:
  enum class Section {
    header,
    masses,
    atoms,
    velocities,
    bonds,
    atom_labels,
    bond_labels,
    other_labels,
    passed_over
  };

  /// One mistake of a kind in the lines of sections, all of the others.
  void throw_if_any() {
    problems_.add(in_lines_.shown());
    problems_.throw_if_any();
  }

  void check_whole() {
    if (!problems_.none() || !in_lines_.none()) return;  // of which a wrong count may be a consequence
    if (const std::string mistake = box_.mistake(); !mistake.empty())
      problems_.add(
          box_place_, mistake,
          "a box has either low and high along x, y and z and perhaps xy xz yz, or the right-handed "
          "system avec, bvec, cvec and its abc origin",
          "correct the lines of the box");
    const SourcePlace whole{at_.file, 0, 0};
    if (atoms_.empty())
      problems_.add(whole, "there is no Atoms section", "it holds the particles", "add the section");
    check_count("atoms", declared_atoms_, atoms_.size());
    check_count("bonds", declared_bonds_, bonds_.size());
    if (!velocities_.empty() && velocities_.size() != atoms_.size())
      problems_.add(whole, fmt::format("velocities of {} of {} atoms", velocities_.size(), atoms_.size()),
                    "a Velocities section has a line for each atom", "complete the section, or remove it");
  }

  void begin_section(const std::string& name) {
    const bool of_atoms = name == "Atoms" || name == "Masses" || name == "Velocities";
    if (of_atoms && !knows_columns_) {
      section_ = Section::passed_over;
    } else if (name == "Masses" && columns_->diameter == 0) {
      section_ = Section::masses;
    } else if (name == "Bonds") {
      section_ = Section::bonds;
    } else if (name == "Velocities" && takes_velocities_) {
      section_ = Section::velocities;
      notes_.push_back(fmt::format("{}:{}: section Velocities is where the run begins", at_.file, at_.line));
    } else if (name == "Atoms") {
      section_ = Section::atoms;
    } else if (name == "Atom Type Labels") {
      section_ = Section::atom_labels;
    } else if (name == "Bond Type Labels") {
      section_ = Section::bond_labels;
    } else {
      pass_over(name);
    }
  }

  void pass_over(const std::string& name) {
    section_ = name.ends_with(" Type Labels") ? Section::other_labels : Section::passed_over;
    if (const auto use = use_of_passed_section(name))
      notes_.push_back(fmt::format("{}:{}: section {} is passed over: {}", at_.file, at_.line, name, *use));
    else
      problems_.add(
          at_, fmt::format("section \"{}\" is not supported", name),
          "read are the sections Masses, Atoms, Velocities, Bonds, Atom Type Labels and Bond Type Labels; "
          "coefficients, other labels, angles, dihedrals and impropers are passed over",
          "remove the section and describe in the case what it is for");
  }

  void data_line(const std::vector<std::string_view>& words) {
    switch (section_) {
      case Section::header: return header_line(words);
      case Section::masses: return mass_line(words);
      case Section::atoms: return atom_line(words);
      case Section::velocities: return velocity_line(words);
      case Section::bonds: return bond_line(words);
      case Section::atom_labels: return label_line(words, &atom_labels_);
      case Section::bond_labels: return label_line(words, &bond_labels_);
      case Section::other_labels: return label_line(words, nullptr);
      case Section::passed_over: return;
    }
  }

  void label_line(const std::vector<std::string_view>& words, TypeLabels* types) {
    const auto type = words.size() == 2 ? to_integer(words[0]) : std::nullopt;
    if (!type) return malformed("type label");
    labels_.insert(std::string(words[1]));
    if (types && !types->emplace(words[1], *type).second)
      in_lines_.add(at_, fmt::format("a second type of the label {}", shown_field(std::string(words[1]))),
                    "a label stands for one type", "rename one of them");
  }

  /// The number of a type that stands as number or label; nothing if it is neither.
  static std::optional<std::int64_t> type_of(std::string_view word, const TypeLabels& labels) {
    const auto label = labels.find(word);
    return label == labels.end() ? to_integer(word) : label->second;
  }

  /// A type that the header does not count is a slip of the pen.
  void check_type(std::int64_t type, const char* of, std::optional<std::int64_t> declared) {
    if (type < 1 || (declared && type > *declared))
      in_lines_.add(at_, fmt::format("{} type {}", of, type),
                    declared ? fmt::format("the header declares {} {} types", *declared, of)
                             : fmt::format("{} types are counted from 1", of),
                    "correct the line or the header");
  }

  /// A number that can be computed with.
  static std::optional<double> number_in(std::string_view word) {
    const auto value = to_number(word);
    return value && std::abs(*value) <= keys::largest_number ? value : std::nullopt;
  }

  void header_line(const std::vector<std::string_view>& words) {
    const std::string what = fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " "));
    const auto count = to_integer(words[0]);
    if (what == "atoms" && count) {
      declared_atoms_ = *count;
    } else if (what == "bonds" && count) {
      declared_bonds_ = *count;
    } else if (what == "atom types" && count) {
      declared_atom_types_ = *count;
    } else if (what == "bond types" && count) {
      declared_bond_types_ = *count;
    } else if (const char* form = box_.form_of(words)) {
      box_place_ = at_;
      if (!box_.read(words)) malformed(form);
    } else if (!is_passive_header(words.back(), what)) {
      problems_.add(at_, fmt::format("\"{}\" is not understood", fmt::join(words, " ")),
                    "before the first section stand counts and the box", "correct or remove the line");
    }
  }

  /// Counts of types and of what is passed over, and room for more, are of no use here.
  static bool is_passive_header(std::string_view last, const std::string& what) {
    return last == "types" || what.find("extra") == 0 || what == "angles" || what == "dihedrals" ||
           what == "impropers";
  }

  void mass_line(const std::vector<std::string_view>& words) {
    const auto type = words.size() == 2 ? type_of(words[0], atom_labels_) : std::nullopt;
    const auto mass = words.size() == 2 ? number_in(words[1]) : std::nullopt;
    if (!type || !mass) return malformed("type mass", has_numbers);
    check_type(*type, "atom", declared_atom_types_);
    if (!masses_.emplace(*type, *mass).second)
      in_lines_.add(at_, fmt::format("a second mass of type {}", *type), "each type has one mass",
                    "remove one");
  }

  void atom_line(const std::vector<std::string_view>& words) {
    const std::size_t n = words.size();
    const std::string form = fmt::format("{} fields of atom style {}, and three image flags at most",
                                         columns_->count, columns_->style);
    if (n != columns_->count && n != columns_->count + 3) return malformed(form);
    const auto id = to_integer(words[0]), type = type_of(words[columns_->type], atom_labels_);
    std::array<std::optional<double>, 5> values;  // x y z, diameter, density
    for (std::size_t k = 0; k < 3; ++k) values[k] = number_in(words[columns_->x + k]);
    const bool sphere = columns_->diameter > 0;
    for (std::size_t k = 0; k < 2; ++k)
      values[3 + k] = sphere ? number_in(words[columns_->diameter + k]) : 0.0;
    const auto known = [](const std::optional<double>& value) { return value.has_value(); };
    if (!id || !type || !std::all_of(values.begin(), values.end(), known))
      return malformed(form, has_numbers);
    check_type(*type, "atom", declared_atom_types_);
    Atom atom{*id, *type, {*values[0], *values[1], *values[2]}, *values[3], *values[4], {}, at_};
    for (std::size_t k = 0; n > columns_->count && k < 3; ++k) {
      const auto flag = to_integer(words[columns_->count + k]);
      if (!flag) return malformed(form);
      atom.image[k] = *flag;
    }
    atoms_.push_back(atom);
  }

  void velocity_line(const std::vector<std::string_view>& words) {
    const std::size_t count = columns_->diameter > 0 ? 6 : 3;  // spheres turn, points do not
    const auto id = to_integer(words[0]);
    std::array<double, 6> values{};
    bool good = id && words.size() == 1 + count;
    for (std::size_t k = 0; good && k < count; ++k) {
      const auto value = number_in(words[1 + k]);
      good = value.has_value();
      values[k] = value.value_or(0.0);
    }
    if (!good) return malformed(count == 6 ? "atom vx vy vz wx wy wz" : "atom vx vy vz", has_numbers);
    velocities_.push_back({*id, {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, at_});
  }

  /// Takes atoms to where they are without periods: in a file of LAMMPS's own they are put back into the box.
  void unwrap() {
    for (Atom& atom : atoms_)
      for (std::size_t k = 0; k < 3; ++k) {
        if (atom.image[k] == 0) continue;
        if (const std::optional<Vec3d> edge = box_.edge(k))
          atom.r += static_cast<double>(atom.image[k]) * *edge;
        else
          in_lines_.add(atom.place, fmt::format("an image flag along {}, and no box", "xyz"[k]),
                        "image flags count periods of the box",
                        fmt::format("add the line \"{}\" above", box_.line_of_edge(k)));
      }
  }

  void bond_line(const std::vector<std::string_view>& words) {
    constexpr const char* form = "bond-number type atom atom";
    if (words.size() != 4) return malformed(form);
    const auto type = type_of(words[1], bond_labels_);
    const auto first = to_integer(words[2]), second = to_integer(words[3]);
    if (!type || !first || !second) return malformed(form);
    check_type(*type, "bond", declared_bond_types_);
    bonds_.push_back({*type, *first, *second, at_});
  }

  static constexpr const char* has_numbers = "; numbers are finite and at most 1e60 in size";

  void malformed(const std::string& form, const char* rule = "") {
    in_lines_.add(at_, "the line is not understood", "expected: " + form + rule, "correct the line");
  }

  void check_count(const char* what, std::optional<std::int64_t> declared, std::size_t found) {
    if (declared && *declared != static_cast<std::int64_t>(found))
      problems_.add({at_.file, 0, 0}, fmt::format("{} {} are declared, {} found", *declared, what, found),
                    "the header says how many there are", "correct the header or complete the file");
  }

  /// Particles in the order of their atom numbers, which may come in any order.
  SpecimenPoints points() {
    std::sort(atoms_.begin(), atoms_.end(), [](const Atom& a, const Atom& b) { return a.id < b.id; });
    SpecimenPoints points;
    points.notes = std::move(notes_);
    std::map<std::int64_t, std::int64_t> index;
    std::map<std::int64_t, std::vector<std::int64_t>> of_type;
    for (const Atom& atom : atoms_) {
      of_type[atom.type].push_back(static_cast<std::int64_t>(points.r.size()));
      if (!index.emplace(atom.id, static_cast<std::int64_t>(index.size())).second)
        in_lines_.add(atom.place, fmt::format("a second atom of number {}", atom.id),
                      "atom numbers are all different", "renumber it");
      points.r.push_back(atom.r);
      add_properties(atom, points);
    }
    add_velocities(index, points);
    for (const BondLine& bond : bonds_) {
      const auto i = index.find(bond.first), j = index.find(bond.second);
      if (i == index.end() || j == index.end())
        in_lines_.add(bond.place,
                      fmt::format("a bond to atom {}", i == index.end() ? bond.first : bond.second),
                      "there is no such atom in the file", "correct the line");
      else
        points.bonds.push_back({{i->second, j->second}, bond.type});
    }
    find_bonds_across(box_, at_.file, points);
    points.box = box_.whole();
    for (auto& [type, atoms] : of_type)
      points.parts.emplace_back(fmt::format("type-{}", type), std::move(atoms));
    note_labels("atom", atom_labels_, points);
    note_labels("bond", bond_labels_, points);
    throw_if_any();
    return points;
  }

  void note_labels(const char* of, const TypeLabels& labels, SpecimenPoints& points) const {
    if (labels.empty()) return;
    std::vector<std::string> texts;
    for (const auto& [label, type] : labels)
      if (texts.size() < 10) texts.push_back(fmt::format("{} is {}", label, type));
    points.notes.push_back(fmt::format("{}: labels of {} types stand for their numbers: {}{}", at_.file, of,
                                       fmt::join(texts, ", "), labels.size() > texts.size() ? ", ..." : ""));
  }

  void add_velocities(const std::map<std::int64_t, std::int64_t>& index, SpecimenPoints& points) {
    if (velocities_.empty()) return;
    points.v.resize(points.r.size());
    points.omega.resize(points.r.size());
    std::vector<char> has(points.r.size(), 0);
    for (const VelocityLine& line : velocities_) {
      const auto found = index.find(line.id);
      if (found == index.end() || has[static_cast<std::size_t>(found->second)]) {
        const bool unknown = found == index.end();
        in_lines_.add(line.place, fmt::format("a {}velocity of atom {}", unknown ? "" : "second ", line.id),
                      unknown ? "there is no such atom in the file" : "each atom has one velocity",
                      "correct the line");
        continue;
      }
      const auto i = static_cast<std::size_t>(found->second);
      has[i] = 1, points.v[i] = line.v, points.omega[i] = line.omega;
    }
  }

  void add_properties(const Atom& atom, SpecimenPoints& points) {
    if (columns_->diameter > 0) {
      const double R = 0.5 * atom.diameter;
      points.radius.push_back(R);
      // a sphere of diameter 0 is a point, and its density is its mass (read_data, style sphere)
      points.mass.push_back(R > 0.0 ? 4.0 / 3.0 * std::numbers::pi * R * R * R * atom.density : atom.density);
    } else if (!masses_.empty()) {
      const auto mass = masses_.find(atom.type);
      if (mass == masses_.end())
        in_lines_.add(atom.place, fmt::format("type {} has no mass", atom.type),
                      "the Masses section gives one for every type", "add it there");
      else
        points.mass.push_back(mass->second);
    }
  }

  const AtomColumns* columns_ = nullptr;
  bool knows_columns_ = false;
  bool takes_velocities_;
  SourcePlace at_;
  Section section_ = Section::header;
  Problems problems_, in_lines_{1};
  std::optional<std::int64_t> declared_atoms_, declared_bonds_, declared_atom_types_, declared_bond_types_;
  LammpsBox box_;
  SourcePlace box_place_;                      ///< of its last line
  std::set<std::string, std::less<>> labels_;  ///< of all kinds
  TypeLabels atom_labels_, bond_labels_;
  std::map<std::int64_t, double> masses_;
  std::vector<Atom> atoms_;
  std::vector<VelocityLine> velocities_;
  std::vector<BondLine> bonds_;
  std::vector<std::string> notes_;
};

}  // namespace

SpecimenPoints read_lammps_specimen(const std::filesystem::path& file, const std::string& atom_style,
                                    const SourcePlace& place, bool velocities) {
  if (!atom_style.empty()) columns_of(atom_style, place);
  return LammpsReader(file, velocities).read(read_lines(file, place), atom_style);
}

}  // namespace vbond
