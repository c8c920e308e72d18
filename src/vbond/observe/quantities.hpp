#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/bond_event.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/stress.hpp"
#include "vbond/model/units.hpp"
#include "vbond/observe/contact_list.hpp"
#include "vbond/observe/csv.hpp"
#include "vbond/observe/fragments.hpp"
#include "vbond/observe/history_values.hpp"
#include "vbond/observe/plan.hpp"
#include "vbond/physics/range.hpp"

/// The one table of what is written: every quantity with its name, unit, meaning and getter. The columns of
/// history.csv and their units, the arrays of frames, the attributes of checkpoints, the units of the page
/// and the tables of docs/output.md come from it. A new column or array is an entry here, and nothing else.
namespace vbond {

// ---- history.csv ---------------------------------------------------------------------------------------

/// Which cases have a quantity.
enum class Only : std::uint8_t { everywhere, statics, breaks, stress, capsules, flow, cell, wrap, passage };
inline bool is_in(Only cases, const OutputPlan& plan) {
  switch (cases) {
    case Only::everywhere: return true;
    case Only::statics: return plan.statics;
    case Only::breaks: return plan.breaks;
    case Only::stress: return plan.frame_format.stress;
    case Only::capsules: return plan.capsules;
    case Only::flow: return plan.flow;
    case Only::cell: return plan.cell;
    case Only::wrap: return plan.cell && plan.frame_format.wrap;
    case Only::passage: return plan.passage;
  }
  return true;
}
/// For the tables of docs/output.md.
const char* in_words(Only cases);

/// A column of history.csv.
struct HistoryQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  Cell (*value)(const HistoryValues&);
  Only cases = Only::everywhere;
};
std::span<const HistoryQuantity> history_quantities();

/// Columns for each group that the case asks for, or each wall: NAME.GROUP.COMPONENT, or NAME.GROUP if there
/// is one component without a name.
struct GroupQuantity {
  struct Component {
    const char* name;
    Unit unit;
    const char* meaning = nullptr;  ///< where it differs from that of the component before it
  };
  const char* name;
  const char* of;  ///< GROUP or WALL: what the names are of, for the tables of docs/output.md
  std::vector<Component> components;
  /// Of these groups or walls.
  std::function<std::vector<std::string>(const OutputPlan&)> names;
  /// Adds the values of the components for the k-th of them.
  std::function<void(const HistoryValues&, std::size_t k, std::vector<Cell>& to)> add;
  /// Of a term_quantity(): adds those of a group, which HistoryValues::of_terms takes up.
  void (*look)(const BodyView&, const Group&, std::vector<Cell>& to) = nullptr;
};
std::span<const GroupQuantity> group_quantities();
/// Columns that a term has for the groups of OutputPlan::of_terms with this name, which is that of its keys.
GroupQuantity term_quantity(const char* name, std::vector<GroupQuantity::Component> components,
                            void (*look)(const BodyView&, const Group&, std::vector<Cell>& to));

/// A column of history.csv as others show it. Nothing if no quantity has a column of this name.
std::optional<ColumnFacts> facts_of_column(std::string_view name);

// ---- breaks.csv and fragments.csv ----------------------------------------------------------------------

/// A bond that broke.
struct BreakView {
  const Clock& clock;
  const BondEvent& event;
  std::optional<double> load;  ///< of the first group whose reaction is asked for  [force]
};

/// A fragment at the end of a stage.
struct FragmentView {
  const Clock& clock;
  std::int64_t stage, number;
  const Fragment& fragment;
  std::optional<Vec3d> centre;  ///< [length]
  Vec3d velocity;               ///< [length/time]
};

/// A column of breaks.csv or fragments.csv.
template <class View>
struct RowQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  Cell (*value)(const View&);
};
std::span<const RowQuantity<BreakView>> break_quantities();
std::span<const RowQuantity<FragmentView>> fragment_quantities();

/// bond_damping, yield_axial ...: as in columns of history.csv and in run.json.
const char* to_text(Loss cause);
/// tension, shear, bending, torsion, compression, other.
const char* to_text(BreakMode mode);
/// The names of case files; none: of a law without criterion.
const char* to_text(Criterion criterion);

// ---- frames --------------------------------------------------------------------------------------------

/// A particle at the time of a frame.
struct ParticleView {
  const Model& model;
  const State& state;
  ParticleId id;
  const Fragments* fragments = nullptr;  ///< of the body, where bonds may break
  SymmetricParts stress{};               ///< of the particle as a sphere, if it is asked for
  Image image{};                         ///< of the particle, which stands at its point of the frame
};

/// An array of the particles' frames, one value per particle.
struct ParticleQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<double (*)(const ParticleView&), Vec3d (*)(const ParticleView&),
               std::int64_t (*)(const ParticleView&), Image (*)(const ParticleView&)>
      value;
  Only cases = Only::everywhere;
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
  double bending_moment, torque;    ///< at the middle: size; positive if it turns i about d  [moment]
  double utilisation;               ///< 0 of a broken one, and where no bond may break
  const BondHistory& flowed;  ///< what it remembers, places as in namespace memory; zeros if it does not flow
};

/// An array of the bonds' frames, one value per bond.
struct BondQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<double (*)(const BondView&), std::int64_t (*)(const BondView&),
               std::uint8_t (*)(const BondView&), Image (*)(const BondView&)>
      value;
  Only cases = Only::everywhere;
};
std::span<const BondQuantity> bond_quantities();

/// A wall at the time of a frame.
struct WallView {
  std::size_t index;  ///< in Model::walls
  const WallState& now;
};

/// An array of the walls' frames, one value per triangle: that of its wall.
struct WallQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<Vec3d (*)(const WallView&), std::int64_t (*)(const WallView&)> value;
};
std::span<const WallQuantity> wall_quantities();

/// An array of the contacts' frames, one value per contact.
struct ContactQuantity {
  const char* name;
  Unit unit;
  const char* meaning;
  std::variant<double (*)(const ListedContact&), Vec3d (*)(const ListedContact&),
               std::int64_t (*)(const ListedContact&)>
      value;
};
std::span<const ContactQuantity> contact_quantities();

// ---- checkpoints ---------------------------------------------------------------------------------------

/// A data set of checkpoint.h5; its unit and meaning are attributes.
struct CheckpointQuantity {
  std::string path;
  Unit unit;
  const char* meaning;
};
std::span<const CheckpointQuantity> checkpoint_quantities();

// ---- the reference -------------------------------------------------------------------------------------

/// The tables of docs/output.md: where = "history", "breaks", "fragments", "particles", "bonds",
/// "walls", "contacts" or "checkpoint". Markdown.
std::string quantity_table(std::string_view where);

}  // namespace vbond
