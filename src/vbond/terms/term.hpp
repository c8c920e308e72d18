#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace vbond {

// Of these a term is declared with the names alone: what they are is known where it is defined.
struct Model;
struct State;
struct Stage;
struct StaticStage;
enum class StageKind : std::uint8_t;
class Mistakes;
namespace keys {
class Table;
}
struct StageSpec;
struct StageResolver;
struct BodyInMotion;
class MotionTerm;
class StaticBody;
class RestTerm;
struct GroupQuantity;

/// What a term adds to a stage of motion or at rest, to one of a case file, and to State: members, declared
/// in its folder.
template <class Term>
struct StagePart {};
template <class Term>
struct SpecPart {};
template <class Term>
struct StatePart {
  friend bool operator==(const StatePart&, const StatePart&) = default;
};

/// What a term adds to the square of the highest angular frequency.
struct AddedFrequency {
  double lambda = 0;    ///< [1/time^2]
  const char* of = "";  ///< in words
};

/// What services ask each term of the list (terms.hpp). A term is a struct that inherits this one and
/// declares again what it has; the rest does nothing. It is defined in files of its folder, whose first words
/// say to which layers they belong. Besides these functions a term has
///
///   static constexpr const char* key = "walls";                                of its tables in a stage
///   static void describe(keys::Table&, SpecPart<T>&, std::optional<StageKind>);     keys_*.cpp
///   static void resolve(const StageResolver&, StagePart<T>&);                       setup_*.cpp
///
/// SpecPart<T> and StagePart<T> say by any() whether there is something in them, and SpecPart<T> by grows()
/// whether it grows with the load factor of a stage at rest.
struct Term {
  // ---- the model ----
  /// A table (field_table.hpp) for each member of StatePart<T>.
  static constexpr std::tuple<> state_tables{};
  /// What a program may do wrong with it in a stage.
  static void look_at_motion(const Model&, const Stage&, Mistakes&) {}
  static void look_at_rest(const Model&, const StaticStage&, Mistakes&) {}
  /// Bodies that the stage makes of this one, whose bonds set steps of their own.
  static void for_extremes(const State&, const Stage&, const std::function<void(const State&)>&) {}
  /// Of a term that is stiff; without it the step could be so long, infinite if nothing is elastic.
  static AddedFrequency added_frequency(const Model&, const State&, const Stage&, double /*dt_without*/) {
    return {};
  }

  // ---- setup: setup_*.cpp ----
  /// What follows from where the particles stand as the stage begins; records every mistake.
  template <class Part>
  static void complete(const StageResolver&, const State&, Part&) {}

  // ---- dynamics: motion_*.cpp ----
  /// What it does in motion; null: nothing.
  static std::unique_ptr<MotionTerm> in_motion(const BodyInMotion& on);

  // ---- statics: rest_*.cpp ----
  /// As a stage at rest begins, before there is a body of it; fields that begin anew are empty.
  static void begin_at_rest(const StaticStage&, State&) {}
  /// What it does at rest; null: nothing. Keeps references; the state is that of the body.
  static std::unique_ptr<RestTerm> at_rest(const StaticBody& body, State& state);

  // ---- what is written: output_*.cpp; the groups: keys_*.cpp ----
  /// Columns of history.csv, behind those that are there.
  static void add_columns(std::vector<GroupQuantity>&) {}
  /// Groups for which a stage asks for columns of term_quantity().
  static std::vector<std::string> groups_in_history(const StageSpec&) { return {}; }
};

}  // namespace vbond
