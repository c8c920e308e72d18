#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/case/change.hpp"
#include "vbond/case/dimension.hpp"
#include "vbond/case/names.hpp"
#include "vbond/case/node.hpp"
#include "vbond/core/problems.hpp"

/// Codecs: how one kind of value is read from a file, checked, written and described.
/// A codec has read, write, type (for the key reference), schema (a JSON Schema, for editors; it may accept
/// more) and example (for the way out of a mistake).
namespace vbond::keys {

/// What is the same for all values of one file, and the mistakes found so far.
struct ReadContext {
  std::string file;
  std::filesystem::path folder;      ///< relative file names start here
  std::vector<std::string> changes;  ///< made in the tree of the file, by change.hpp
  UnitSystem units = UnitSystem::reduced;
  bool any_units = false;  ///< the system could not be read: do not report every unit as well
  Problems problems;

  SourcePlace place(std::uint32_t line, std::uint32_t column) const {
    if (line < first_changed_line) return {file, line, column};
    return {"--set " + changes[line - first_changed_line], 0, 0};
  }
  SourcePlace place(const Node& n) const { return place(n.line, n.column); }
  void report(SourcePlace at, std::string what, std::string rule, std::string way_out) {
    problems.add(std::move(at), std::move(what), std::move(rule), std::move(way_out));
  }
  /// Reports a value that breaks a rule; always false, so that a codec can return it.
  bool refuse(const Node& n, const std::string& path, std::string rule, std::string way_out) {
    report(place(n), path + " = " + short_text(n), std::move(rule), std::move(way_out));
    return false;
  }
  bool refuse_kind(const Node& n, const std::string& path, const std::string& type,
                   const std::string& example);
};

/// The key's own name: what stands behind the last dot.
std::string last_name(const std::string& path);
/// `write for example key = example`, or, for an element of a list, what to put there.
std::string such_as(const std::string& path, const std::string& example);

/// A schema of what is one of these.
std::string any_of(const std::vector<std::string>& schemas);
/// A list of so many elements of this kind.
std::string list_schema(const std::string& element, std::size_t min, std::size_t max = SIZE_MAX);
/// One of a few words.
std::string enum_schema(const std::vector<std::string>& words);

constexpr double largest_number = 1e60;  // so that the fourth power of a length is still a double
constexpr std::int64_t most_particles = 100'000'000;

/// Bounds of a number. The default bounds keep every product of a few numbers finite.
struct Range {
  double min = -largest_number, max = largest_number;
  bool min_open = false, max_open = false;

  bool contains(double x) const { return (min_open ? x > min : x >= min) && (max_open ? x < max : x <= max); }
  std::string rule(const std::string& name) const;
  /// The rule in the short form of the key reference, such as `> 0`; empty if there is none.
  std::string text() const;
  /// A JSON Schema of numbers in it, or of text with a number and a unit, of which the number is not checked.
  std::string schema() const;
};

inline constexpr Range any_number{};
inline constexpr Range above_zero{0, largest_number, true, false};
inline constexpr Range from_zero{0, largest_number, false, false};

struct NumberCodec {
  Dimension dimension;
  Range range;
  const char* sample = "";  ///< example that suits every rule of the key; empty: one within the range
  bool read(const Node& n, ReadContext& in, const std::string& path, double& out) const;
  std::string write(double x) const { return number_text(x); }
  std::string type() const;
  std::string schema() const { return range.schema(); }
  std::string example(UnitSystem u) const;
};
constexpr NumberCodec number(const Dimension& d, const Range& r = any_number) {
  return {d, r};
}
constexpr NumberCodec positive(const Dimension& d) {
  return {d, above_zero};
}
constexpr NumberCodec not_negative(const Dimension& d) {
  return {d, from_zero};
}

/// The sample suits every theory of bonds.
constexpr NumberCodec poisson_ratio(const Range& r) {
  return {pure, r, "0.25"};
}

/// A unit alone, as of a column of a file.
struct UnitCodec {
  Dimension dimension;
  bool read(const Node& n, ReadContext& in, const std::string& path, ColumnUnit& out) const;
  std::string write(const ColumnUnit& unit) const { return toml_string(unit.text); }
  std::string type() const { return std::string("unit of ") + dimension.name; }
  std::string schema() const { return R"({"type": "string", "minLength": 1})"; }
  std::string example(UnitSystem u) const;
};

struct CountCodec {
  std::int64_t min = 0, max = most_particles;
  bool read(const Node& n, ReadContext& in, const std::string& path, std::int64_t& out) const;
  /// max must fit into T.
  template <std::integral T>
  bool read(const Node& n, ReadContext& in, const std::string& path, T& out) const {
    std::int64_t x = 0;
    if (!read(n, in, path, x)) return false;
    out = static_cast<T>(x);
    return true;
  }
  template <std::integral T>
  std::string write(T x) const {
    return std::to_string(x);
  }
  std::string type() const;
  std::string schema() const;
  std::string example(UnitSystem) const { return std::to_string(min > 0 ? min : 1); }
};
inline constexpr CountCodec particle_number{0, most_particles - 1};
inline constexpr CountCodec seed_number{0, INT64_MAX};

struct FlagCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, bool& out) const;
  std::string write(bool x) const { return x ? "true" : "false"; }
  std::string type() const { return "true or false"; }
  std::string schema() const { return R"({"type": "boolean"})"; }
  std::string example(UnitSystem) const { return "true"; }
};

struct TextCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const;
  std::string write(const std::string& x) const { return toml_string(x); }
  std::string type() const { return "text"; }
  std::string schema() const { return R"({"type": "string"})"; }
  std::string example(UnitSystem) const { return "\"...\""; }
};

/// True for digits and nothing else, and for an empty text: never a name, but the number of a particle.
bool only_digits(std::string_view s);

/// The name of something that this table defines: letters, digits, `_` and `-`, since it becomes a column
/// title of history.csv and part of a key.
struct NameCodec : TextCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const;
  std::string write(const std::string& x) const { return x.empty() ? std::string{} : toml_string(x); }
  std::string type() const { return "name"; }
  std::string schema() const { return R"({"type": "string", "pattern": "^[A-Za-z0-9_-]{1,64}$"})"; }
};

/// A name that is defined elsewhere.
struct ReferenceCodec : TextCodec {
  const char* to = "group";
  constexpr explicit ReferenceCodec(const char* to_what) : to(to_what) {}
  bool read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const;
  std::string type() const { return std::string("name of a ") + to; }
  std::string schema() const { return R"({"type": "string", "minLength": 1})"; }
};
inline constexpr ReferenceCodec group_name{"group"}, stage_name{"stage"}, material_name{"material"},
    specimen_name{"specimen"};

/// The name of a group, or the number of one particle, which is kept as its digits.
struct ParticlesCodec : ReferenceCodec {
  constexpr ParticlesCodec() : ReferenceCodec("group") {}
  bool read(const Node& n, ReadContext& in, const std::string& path, std::string& out) const;
  std::string write(const std::string& x) const;
  std::string type() const { return "name of a group or number of a particle"; }
  std::string schema() const { return any_of({ReferenceCodec::schema(), particle_number.schema()}); }
};

struct FileCodec {
  bool read(const Node& n, ReadContext& in, const std::string& path, std::filesystem::path& out) const;
  std::string write(const std::filesystem::path& p) const { return toml_string(p.string()); }
  std::string type() const { return "file name, relative to the case file"; }
  std::string schema() const { return R"({"type": "string", "minLength": 1})"; }
  std::string example(UnitSystem) const { return "\"points.csv\""; }
};

/// Reports a word that is none of `names`, with the nearest; otherwise gives its index.
bool read_word(const Node& n, ReadContext& in, const std::string& path, const std::vector<std::string>& names,
               std::size_t& index);

/// One of a few words, each standing for a value of E.
template <class E>
struct ChoiceCodec {
  std::vector<std::string> names;
  std::vector<E> values;

  bool read(const Node& n, ReadContext& in, const std::string& path, E& out) const {
    std::size_t index = 0;
    if (!read_word(n, in, path, names, index)) return false;
    out = values[index];
    return true;
  }
  std::string write(const E& x) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (values[i] == x) return toml_string(names[i]);
    return {};
  }
  std::string type() const { return "one of " + join(names, "\""); }
  std::string schema() const { return enum_schema(names); }
  std::string example(UnitSystem) const { return toml_string(names.front()); }
};

struct VectorCodec {
  Dimension dimension;
  bool may_be_zero = true;
  bool read(const Node& n, ReadContext& in, const std::string& path, Vec3d& out) const;
  std::string write(const Vec3d& v) const;
  std::string type() const;
  std::string schema() const { return list_schema(any_number.schema(), 3, 3); }
  std::string example(UnitSystem u) const;
};
constexpr VectorCodec vector_of(const Dimension& d) {
  return {d, true};
}
inline constexpr VectorCodec direction_vector{pure, false};

/// A time: a number of the unit system, or a multiple of T_0 such as "10 T0".
struct TimeCodec {
  Range range = above_zero;
  bool read(const Node& n, ReadContext& in, const std::string& path, CaseTime& out) const;
  std::string write(const CaseTime& t) const;
  std::string type() const;
  std::string schema() const { return range.schema(); }
  std::string example(UnitSystem) const { return "\"10 T0\""; }
};

/// Reports a list of another length.
bool refuse_length(const Node& n, ReadContext& in, const std::string& path, std::size_t is,
                   std::size_t wanted, const std::string& example);

/// Reports a value that is no list of some of `names`, with how it is written.
bool refuse_subset(const Node& n, ReadContext& in, const std::string& path,
                   const std::vector<std::string>& names);

/// Which of N named things are meant: a list of their names.
template <std::size_t N>
struct SubsetCodec {
  std::vector<std::string> names;
  bool read(const Node& n, ReadContext& in, const std::string& path, std::array<bool, N>& out) const {
    const auto* items = std::get_if<NodeList>(&n.value);
    if (!items) return refuse_subset(n, in, path, names);
    std::array<bool, N> chosen{};
    bool good = true;
    for (std::size_t k = 0; k < items->size(); ++k) {
      std::size_t index = 0;
      const auto* word = std::get_if<std::string>(&(*items)[k].value);
      if (word && *word == "all")
        good = refuse_subset((*items)[k], in, path, names);
      else if (read_word((*items)[k], in, path + "[" + std::to_string(k) + "]", names, index))
        chosen[index] = true;
      else
        good = false;
    }
    if (good) out = chosen;
    return good;
  }
  std::string write(const std::array<bool, N>& chosen) const {
    std::vector<std::string> words;
    for (std::size_t k = 0; k < N; ++k)
      if (chosen[k]) words.push_back(names[k]);
    return "[" + join(words, "\"") + "]";
  }
  std::string type() const { return "list of " + join(names, "\""); }
  std::string schema() const { return list_schema(enum_schema(names), 0); }
  std::string example(UnitSystem) const { return "[" + toml_string(names.front()) + "]"; }
};

}  // namespace vbond::keys
