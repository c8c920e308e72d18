#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "vbond/build/problems.hpp"
#include "vbond/build/specimens/specimen.hpp"
#include "vbond/build/text_file.hpp"
#include "vbond/core/nearest.hpp"

// Format: LAMMPS manual, command read_data.
namespace vbond {
namespace {

/// Where an atom style keeps what we need, as positions in a line of the Atoms section.
struct AtomColumns {
  const char* style;
  std::size_t type, x, count;  ///< count without the three optional image flags
  std::size_t diameter = 0;    ///< 0: none; the density follows it
};

constexpr AtomColumns atom_styles[] = {
    {"atomic", 1, 2, 5},    {"charge", 1, 3, 6}, {"bond", 2, 3, 6},      {"angle", 2, 3, 6},
    {"molecular", 2, 3, 6}, {"full", 2, 4, 7},   {"sphere", 1, 4, 7, 2}, {"bpm/sphere", 2, 5, 8, 3},
};

const AtomColumns& columns_of(const std::string& style, const SourcePlace& place) {
  std::vector<std::string> known;
  for (const AtomColumns& c : atom_styles) {
    if (style == c.style) return c;
    known.emplace_back(c.style);
  }
  const auto near = nearest_name(style, known);
  throw CaseError({place, fmt::format("atom_style = \"{}\" is not supported", style),
                   fmt::format("supported: {}", fmt::join(known, ", ")),
                   near ? fmt::format("did you mean \"{}\"?", *near) : "convert the file to one of them"});
}

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

/// What a section is for; nothing for one that cannot be passed over. `write_data` writes coefficients unless
/// told not to, and lists of angles and the like for most molecules.
std::optional<std::string> use_of_passed_section(const std::string& name) {
  const auto usual = [](unsigned char c) { return std::isalnum(c) != 0 || c == ' '; };
  if (!std::all_of(name.begin(), name.end(), usual)) return std::nullopt;
  const auto ends_with = [&name](std::string_view end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  if (ends_with(" Coeffs")) return "the case gives the laws of bonds and contacts";
  if (ends_with(" Type Labels")) return "types are told apart by their numbers";
  if (name == "Angles" || name == "Dihedrals" || name == "Impropers")
    return "bonds join two particles here, and resist bending and torsion themselves";
  if (name == "Masses") return "diameters and densities of the atoms give their masses";
  if (name == "Velocities") return "the case says velocities = false";
  return std::nullopt;
}

class LammpsReader {
 public:
  LammpsReader(const std::filesystem::path& file, const AtomColumns& columns, bool velocities)
      : columns_(columns), takes_velocities_(velocities), at_{file.string(), 0, 1} {}

  SpecimenPoints read(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      ++at_.line;
      if (at_.line == 1) continue;  // a title, whatever it says
      const std::size_t hash = line.find('#');
      const auto words = words_of(std::string_view(line).substr(0, hash));
      if (words.empty()) continue;
      const std::string_view comment =
          hash == std::string::npos ? std::string_view() : std::string_view(line).substr(hash + 1);
      if (std::isalpha(static_cast<unsigned char>(words[0][0])))
        begin_section(fmt::format("{}", fmt::join(words, " ")), comment);
      else
        data_line(words);
    }
    SourcePlace whole{at_.file, 0, 0};
    if (atoms_.empty())
      problems_.add(whole, "there is no Atoms section", "it holds the particles", "add the section");
    check_count("atoms", declared_atoms_, atoms_.size());
    check_count("bonds", declared_bonds_, bonds_.size());
    if (!velocities_.empty() && velocities_.size() != atoms_.size() && problems_.none())
      problems_.add(whole, fmt::format("velocities of {} of {} atoms", velocities_.size(), atoms_.size()),
                    "a Velocities section has a line for each atom", "complete the section, or remove it");
    problems_.throw_if_any();
    unwrap();
    return points();
  }

 private:
  enum class Section { header, masses, atoms, velocities, bonds, passed_over };

  void begin_section(const std::string& name, std::string_view comment) {
    if (name == "Masses" && columns_.diameter == 0) {
      section_ = Section::masses;
    } else if (name == "Bonds") {
      section_ = Section::bonds;
    } else if (name == "Velocities" && takes_velocities_) {
      section_ = Section::velocities;
      notes_.push_back(fmt::format("{}:{}: section Velocities is where the run begins", at_.file, at_.line));
    } else if (name == "Atoms") {
      section_ = Section::atoms;
      const auto words = words_of(comment);
      if (!words.empty() && words[0] != columns_.style)
        problems_.add(at_, fmt::format("the file says atom style \"{}\"", words[0]),
                      fmt::format("the case says atom_style = \"{}\"", columns_.style), "make them agree");
    } else {
      section_ = Section::passed_over;
      if (const auto use = use_of_passed_section(name))
        notes_.push_back(fmt::format("{}:{}: section {} is passed over: {}", at_.file, at_.line, name, *use));
      else
        problems_.add(at_, fmt::format("section \"{}\" is not supported", name),
                      "read are the sections Masses, Atoms, Velocities and Bonds; coefficients, type labels, "
                      "angles, dihedrals and impropers are passed over",
                      "remove the section and describe in the case what it is for");
    }
  }

  void data_line(const std::vector<std::string_view>& words) {
    switch (section_) {
      case Section::header: return header_line(words);
      case Section::masses: return mass_line(words);
      case Section::atoms: return atom_line(words);
      case Section::velocities: return velocity_line(words);
      case Section::bonds: return bond_line(words);
      case Section::passed_over: return;
    }
  }

  void header_line(const std::vector<std::string_view>& words) {
    const std::string what = fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " "));
    const auto count = to_integer(words[0]);
    if (what == "atoms" && count) {
      declared_atoms_ = *count;
    } else if (what == "bonds" && count) {
      declared_bonds_ = *count;
    } else if (what.find("xy xz yz") != std::string::npos) {
      tilted_ = std::any_of(words.begin(), words.end() - 3,
                            [](std::string_view word) { return to_number(word) != 0.0; });
    } else if (const auto axis = axis_of_box(words)) {
      box_line(words, *axis);
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

  static std::optional<std::size_t> axis_of_box(const std::vector<std::string_view>& words) {
    for (std::size_t k = 0; k < 3; ++k)
      if (words.back() == axes[k].high) return k;
    return std::nullopt;
  }

  void box_line(const std::vector<std::string_view>& words, std::size_t axis) {
    const bool complete = words.size() == 4 && words[2] == axes[axis].low;
    const auto low = complete ? to_number(words[0]) : std::nullopt;
    const auto high = complete ? to_number(words[1]) : std::nullopt;
    if (!low || !high || *low > *high)
      return malformed(fmt::format("low high {} {}", axes[axis].low, axes[axis].high));
    period_[axis] = *high - *low;
  }

  void mass_line(const std::vector<std::string_view>& words) {
    const auto type = words.size() == 2 ? to_integer(words[0]) : std::nullopt;
    const auto mass = words.size() == 2 ? to_number(words[1]) : std::nullopt;
    if (!type || !mass) return malformed("type mass");
    if (!masses_.emplace(*type, *mass).second)
      problems_.add(at_, fmt::format("a second mass of type {}", *type), "each type has one mass",
                    "remove one");
  }

  void atom_line(const std::vector<std::string_view>& words) {
    const std::size_t n = words.size();
    const std::string form = fmt::format("{} fields of atom style {}, and three image flags at most",
                                         columns_.count, columns_.style);
    if (n != columns_.count && n != columns_.count + 3) return malformed(form);
    const auto id = to_integer(words[0]), type = to_integer(words[columns_.type]);
    std::array<std::optional<double>, 5> values;  // x y z, diameter, density
    for (std::size_t k = 0; k < 3; ++k) values[k] = to_number(words[columns_.x + k]);
    const bool sphere = columns_.diameter > 0;
    for (std::size_t k = 0; k < 2; ++k)
      values[3 + k] = sphere ? to_number(words[columns_.diameter + k]) : 0.0;
    const auto known = [](const std::optional<double>& value) { return value.has_value(); };
    if (!id || !type || !std::all_of(values.begin(), values.end(), known)) return malformed(form);
    Atom atom{*id, *type, {*values[0], *values[1], *values[2]}, *values[3], *values[4], {}, at_};
    for (std::size_t k = 0; n > columns_.count && k < 3; ++k) {
      const auto flag = to_integer(words[columns_.count + k]);
      if (!flag) return malformed(form);
      atom.image[k] = *flag;
    }
    atoms_.push_back(atom);
  }

  void velocity_line(const std::vector<std::string_view>& words) {
    const std::size_t count = columns_.diameter > 0 ? 6 : 3;  // spheres turn, points do not
    const auto id = to_integer(words[0]);
    std::array<double, 6> values{};
    bool good = id && words.size() == 1 + count;
    for (std::size_t k = 0; good && k < count; ++k) {
      const auto value = to_number(words[1 + k]);
      good = value.has_value();
      values[k] = value.value_or(0.0);
    }
    if (!good) return malformed(count == 6 ? "atom vx vy vz wx wy wz" : "atom vx vy vz");
    velocities_.push_back({*id, {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, at_});
  }

  /// Takes atoms to where they are without periods: in a file of LAMMPS's own they are put back into the box.
  void unwrap() {
    for (Atom& atom : atoms_) {
      double shift[3] = {};
      for (std::size_t k = 0; k < 3; ++k) {
        if (atom.image[k] == 0) continue;
        if (tilted_) return refuse_tilted(atom);
        if (!period_[k])
          problems_.add(atom.place, fmt::format("an image flag along {}, and no box", "xyz"[k]),
                        "image flags count periods of the box",
                        fmt::format("add the line \"low high {} {}\" above", axes[k].low, axes[k].high));
        shift[k] = static_cast<double>(atom.image[k]) * period_[k].value_or(0.0);
      }
      atom.r += Vec3d{shift[0], shift[1], shift[2]};
    }
  }

  void refuse_tilted(const Atom& atom) {
    problems_.add(atom.place, "an image flag in a tilted box", "only boxes with right angles are unwrapped",
                  "write the file with unwrapped coordinates and without image flags");
  }

  void bond_line(const std::vector<std::string_view>& words) {
    const auto number = [&words](std::size_t k) {
      return words.size() == 4 ? to_integer(words[k]) : std::nullopt;
    };
    const auto type = number(1), first = number(2), second = number(3);
    if (!type || !first || !second) return malformed("bond-number type atom atom");
    bonds_.push_back({*type, *first, *second, at_});
  }

  void malformed(const std::string& form) {
    problems_.add(at_, "the line is not understood", "expected: " + form, "correct the line");
  }

  void check_count(const char* what, std::optional<std::int64_t> declared, std::size_t found) {
    if (declared && *declared != static_cast<std::int64_t>(found) && problems_.none())
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
        problems_.add(atom.place, fmt::format("a second atom of number {}", atom.id),
                      "atom numbers are all different", "renumber it");
      points.r.push_back(atom.r);
      add_properties(atom, points);
    }
    add_velocities(index, points);
    for (const BondLine& bond : bonds_) {
      const auto i = index.find(bond.first), j = index.find(bond.second);
      if (i == index.end() || j == index.end())
        problems_.add(bond.place,
                      fmt::format("a bond to atom {}", i == index.end() ? bond.first : bond.second),
                      "there is no such atom in the file", "correct the line");
      else
        points.bonds.push_back({{i->second, j->second}, bond.type});
    }
    for (auto& [type, atoms] : of_type)
      points.parts.emplace_back(fmt::format("type-{}", type), std::move(atoms));
    problems_.throw_if_any();
    return points;
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
        problems_.add(line.place, fmt::format("a {}velocity of atom {}", unknown ? "" : "second ", line.id),
                      unknown ? "there is no such atom in the file" : "each atom has one velocity",
                      "correct the line");
        continue;
      }
      const auto i = static_cast<std::size_t>(found->second);
      has[i] = 1, points.v[i] = line.v, points.omega[i] = line.omega;
    }
  }

  void add_properties(const Atom& atom, SpecimenPoints& points) {
    if (columns_.diameter > 0) {
      const double R = 0.5 * atom.diameter;
      points.radius.push_back(R);
      // a sphere of diameter 0 is a point, and its density is its mass (read_data, style sphere)
      points.mass.push_back(R > 0.0 ? 4.0 / 3.0 * std::numbers::pi * R * R * R * atom.density : atom.density);
    } else if (!masses_.empty()) {
      const auto mass = masses_.find(atom.type);
      if (mass == masses_.end())
        problems_.add(atom.place, fmt::format("type {} has no mass", atom.type),
                      "the Masses section gives one for every type", "add it there");
      else
        points.mass.push_back(mass->second);
    }
  }

  struct Axis {
    const char *low, *high;
  };
  static constexpr Axis axes[3] = {{"xlo", "xhi"}, {"ylo", "yhi"}, {"zlo", "zhi"}};

  const AtomColumns& columns_;
  bool takes_velocities_;
  SourcePlace at_;
  Section section_ = Section::header;
  Problems problems_;
  std::optional<std::int64_t> declared_atoms_, declared_bonds_;
  std::optional<double> period_[3];  // edges of the box
  bool tilted_ = false;
  std::map<std::int64_t, double> masses_;
  std::vector<Atom> atoms_;
  std::vector<VelocityLine> velocities_;
  std::vector<BondLine> bonds_;
  std::vector<std::string> notes_;
};

}  // namespace

SpecimenPoints read_lammps_specimen(const std::filesystem::path& file, const std::string& atom_style,
                                    const SourcePlace& place, bool velocities) {
  const AtomColumns& columns = columns_of(atom_style, place);
  return LammpsReader(file, columns, velocities).read(read_lines(file, place));
}

}  // namespace vbond
