#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/history_values.hpp"
#include "vbond/observe/plan.hpp"
#include "vbond/physics/range.hpp"

/// The one table of what is written: every quantity with its name, unit, meaning and getter. The columns of
/// history.csv and their units, the arrays of frames, the attributes of checkpoints, the units of the page
/// and the tables of docs/output.md come from it. A new column or array is an entry here, and nothing else.
namespace vbond {

/// In SI, and in reduced units, where a = m = c_A = 1. Empty: a pure number, a count or a number of
/// something.
struct Unit {
  const char* si;
  const char* reduced;
  const char* in(UnitSystem system) const { return system == UnitSystem::si ? si : reduced; }
};

namespace unit {
inline constexpr Unit none{"", ""};
inline constexpr Unit length{"m", "a"}, time{"s", "sqrt(m/c_A)"}, mass{"kg", "m"}, inertia{"kg m^2", "m a^2"};
inline constexpr Unit velocity{"m/s", "a sqrt(c_A/m)"}, angular_velocity{"rad/s", "rad sqrt(c_A/m)"};
inline constexpr Unit force{"N", "a c_A"}, moment{"N m", "a^2 c_A"}, energy{"J", "a^2 c_A"};
inline constexpr Unit stiffness{"N/m", "c_A"}, angle{"rad", "rad"}, degrees{"deg", "deg"};
}  // namespace unit

// ---- history.csv ---------------------------------------------------------------------------------------

/// What stands in one place of history.csv: nothing, a whole number, or a number.
using Cell = std::variant<std::monostate, std::int64_t, double>;

/// A column of history.csv.
struct HistoryQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  Cell (*value)(const HistoryValues&);
  bool statics_only = false;  ///< the column is there only in cases with static stages
};
std::span<const HistoryQuantity> history_quantities();

/// Columns for each group that the case asks for: NAME.GROUP.COMPONENT, or NAME.GROUP if there is one
/// component without a name.
struct GroupQuantity {
  struct Component {
    const char* name;
    Unit unit;
  };
  const char* name;
  std::vector<Component> components;
  const char* meaning;
  std::vector<Group> OutputPlan::*groups;
  /// Adds the values of the components for the k-th of these groups.
  void (*add)(const HistoryValues&, std::size_t k, std::vector<Cell>& to);
};
std::span<const GroupQuantity> group_quantities();

/// A column as others show it: with the unit and meaning of its quantity.
struct ColumnFacts {
  Unit unit;
  const char* meaning;
};
/// Nothing if no quantity has a column of this name.
std::optional<ColumnFacts> facts_of_column(std::string_view name);

// ---- frames --------------------------------------------------------------------------------------------

/// A particle at the time of a frame.
struct ParticleView {
  const Model& model;
  const State& state;
  ParticleId id;
};

/// An array of the particles' frames, one value per particle.
struct ParticleQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<double (*)(const ParticleView&), Vec3d (*)(const ParticleView&),
               std::int64_t (*)(const ParticleView&)>
      value;
};
std::span<const ParticleQuantity> particle_quantities();

/// A bond at the time of a frame, with what several of its quantities need.
struct BondView {
  const Bond& bond;
  BondId id;
  BondShape shape;
  BondEnergy<double> U;
  double axial_force, shear_force;  ///< [force]
  double moment_i, moment_j;        ///< sizes  [moment]
};

/// An array of the bonds' frames, one value per bond.
struct BondQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<double (*)(const BondView&), std::int64_t (*)(const BondView&),
               std::uint8_t (*)(const BondView&)>
      value;
};
std::span<const BondQuantity> bond_quantities();

// ---- checkpoints ---------------------------------------------------------------------------------------

/// A data set of checkpoint.h5; its unit and meaning are attributes.
struct CheckpointQuantity {
  const char* path;
  Unit unit;
  const char* meaning;
};
std::span<const CheckpointQuantity> checkpoint_quantities();

// ---- the reference -------------------------------------------------------------------------------------

/// The tables of docs/output.md: where = "history", "particles", "bonds" or "checkpoint". Markdown.
std::string quantity_table(std::string_view where);

}  // namespace vbond
