#include "vbond/observe/bond_list.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>

#include "vbond/core/error.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {
namespace {

constexpr std::string_view first_line = "vbond bonds 1";

void add_number(std::string& line, double x) {
  fmt::format_to(std::back_inserter(line), " {:.17g}", x);
}
void add_frame(std::string& line, const Quatd& q) {
  for (const double x : {q.w, q.x, q.y, q.z}) add_number(line, x);
}

/// The numbers and names of one line.
class Words {
 public:
  Words(const std::string& line, const std::filesystem::path& path, std::size_t number)
      : words_(line), place_(fmt::format("{}:{}", path.string(), number)) {}

  std::string name() {
    std::string name;
    if (!(words_ >> name)) fail("a name is missing");
    return name;
  }
  double number() {
    double x = 0;
    if (!(words_ >> x)) fail("a number is missing, or is none");
    return x;
  }
  /// Counted from 1, at most `most`.
  std::uint32_t place(std::size_t most, const char* of) {
    std::uint32_t k = 0;
    if (!(words_ >> k) || k < 1 || k > most) fail(fmt::format("this is no number of a {}", of));
    return k - 1;
  }
  Quatd frame() {
    const double w = number(), x = number(), y = number(), z = number();
    return {w, x, y, z};
  }
  void end() {
    if (std::string rest; words_ >> rest) fail("\"" + rest + "\" is one too many");
  }
  [[noreturn]] void fail(const std::string& what) const { throw IoError(place_ + ": " + what); }

 private:
  std::istringstream words_;
  std::string place_;
};

BondKind read_kind(Words& words) {
  const std::string name = words.name();
  BondKind kind;
  kind.law = find_law(name);
  if (!kind.law) words.fail("\"" + name + "\" is no law of bonds");
  RuleNumbers numbers{};
  for (double& x : numbers) x = words.number();
  const auto rules = rules_of(numbers);
  if (!rules) words.fail("these numbers are no rules of bonds");
  kind.rules = &kept(*rules);
  return kind;
}

Bond read_bond(Words& words, const BondKind& kind, ParticleId i, ParticleId j) {
  Bond b;
  b.i = i, b.j = j;
  b.law = kind.law, b.rules = kind.rules;
  b.a = words.number(), b.R_i = words.number(), b.R_j = words.number();
  const Quatd in_i = words.frame(), in_j = words.frame();
  set_frames(b, in_i, in_j);
  Coefficients coefficients{};
  for (std::size_t k = 0; k < b.law->fields.size(); ++k) coefficients[k] = words.number();
  b.coefficients = coefficients;
  if (!(b.a > 0.0)) words.fail("the length of a bond must be > 0");
  return b;
}

}  // namespace

BondList bond_list(const State& state) {
  BondList list;
  for (Bond b : state.bonds) {
    if (b.broken) continue;
    const BondKind kind{b.law, b.rules};
    const auto at = std::find(list.kinds.begin(), list.kinds.end(), kind);
    list.kind.push_back(static_cast<std::uint32_t>(at - list.kinds.begin()));
    if (at == list.kinds.end()) list.kinds.push_back(kind);
    set_frames(b, state.q[b.i] * b.frame_i, state.q[b.j] * frame_j(b));
    list.bonds.push_back(b);
  }
  return list;
}

std::string to_text(const BondList& list) {
  std::string text = fmt::format("{}\n", first_line);
  for (std::size_t k = 0; k < list.kinds.size(); ++k) {
    fmt::format_to(std::back_inserter(text), "kind {} {}", k + 1, list.kinds[k].law->name);
    for (const double x : numbers_of(*list.kinds[k].rules)) add_number(text, x);
    text += '\n';
  }
  for (std::size_t n = 0; n < list.bonds.size(); ++n) {
    const Bond& b = list.bonds[n];
    fmt::format_to(std::back_inserter(text), "{} {} {}", b.i.value + 1, b.j.value + 1, list.kind[n] + 1);
    for (const double x : {b.a, b.R_i, b.R_j}) add_number(text, x);
    add_frame(text, b.frame_i), add_frame(text, frame_j(b));
    for (std::size_t k = 0; k < b.law->fields.size(); ++k) add_number(text, b.coefficients[k]);
    text += '\n';
  }
  return text;
}

BondList read_bond_list(const std::filesystem::path& path) {
  constexpr std::size_t most_particles = 0xffffffff;
  std::istringstream text(read_all(path));
  std::string line;
  if (!std::getline(text, line) || line != first_line)
    throw IoError(fmt::format("{}: the first line must be \"{}\"", path.string(), first_line));
  BondList list;
  for (std::size_t number = 2; std::getline(text, line); ++number) {
    Words words(line, path, number);
    if (line.starts_with("kind ")) {
      words.name();
      if (words.place(list.kinds.size() + 1, "kind") != list.kinds.size())
        words.fail("kinds must be counted one after the other");
      list.kinds.push_back(read_kind(words));
    } else {
      const ParticleId i{words.place(most_particles, "particle")}, j{words.place(most_particles, "particle")};
      list.kind.push_back(words.place(list.kinds.size(), "kind"));
      list.bonds.push_back(read_bond(words, list.kinds[list.kind.back()], i, j));
    }
    words.end();
  }
  return list;
}

}  // namespace vbond
