#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "vbond/core/column.hpp"
#include "vbond/physics/bond_numbers.hpp"
#include "vbond/physics/bond_rules.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

// The elastic laws, by name alone: nearly all sources include this header, and few need the formulas of a law
// (physics/laws.hpp).
template <Scalar T>
struct VModel;
template <Scalar T>
struct Evm;

struct Bond;
struct BondLoops;
template <std::size_t N>
struct PairTangent;

/// The coefficients of a law in the order of its fields; those it does not have are zero.
using Coefficients = std::array<double, most_coefficients>;

/// What a bond remembers, in the order of its law's history; the rest is zero.
using BondHistory = std::array<double, most_history>;
inline constexpr BondHistory no_history{};

/// A bond law as loops over bonds and files see it, where the law is known at run time only. One object per
/// law, bond_law<Law>: a bond points to it.
struct BondLaw {
  std::string_view name;   ///< in case files and checkpoints
  std::string_view title;  ///< for people
  std::span<const LawFieldInfo> fields;
  double strained_past;                           ///< tilt or twist from which a bond is strained  [degrees]
  std::string_view rest_condition, rest_way_out;  ///< when rest is the least energy, and how to get there
  std::span<const std::string_view> history;      ///< names of what a bond remembers
  std::size_t dissipated_at;                      ///< which of it is what it has dissipated; or most_history
  bool damped, breakable;
  bool has_rules;               ///< whether it reads the rules of a bond
  const BondLaw* with_rules;    ///< this law with rules; nullptr unless it takes them
  const BondLaw* with_flow;     ///< the same with flow
  const BondLaw* with_rubbing;  ///< this law with rules whose bonds rub when they have broken
  bool has_offsets;             ///< whether its first coefficients are offsets of the bonded points
  /// The loads that damping adds.
  BondLoads<double> (*damping_loads)(const Bond&, const BondPose<double>&, const BondRates<double>&);
  BondEnergy<double> (*energy)(const Bond&, const BondPose<double>&, const BondHistory&);
  BondLoads<double> (*loads)(const Bond&, const BondPose<double>&, const BondHistory&);  ///< without damping
  /// Derivative of the loads, at rest; of bonds that flow, that of the loads after the flow of an increment
  /// from this history. Not for other laws that remember, whose loads depend on the way.
  PairTangent<9> (*tangent)(const Bond&, const BondPose<double>&, const BondHistory& before);
  /// What is remembered after a time dt at the end of which the pose and these rates hold.
  BondHistory (*advance)(const Bond&, const BondPose<double>&, const BondRates<double>&, double dt,
                         const BondHistory&);
  /// What a bond that rubs once it has broken remembers when it breaks as it stands; nullptr for laws whose
  /// bonds are gone then.
  BondHistory (*crack)(const Bond&, const BondPose<double>&, const BondHistory&);
  /// How near the bond is to breaking, at 1, and by what; zeros for laws that do not break.
  Failure<double> (*failure)(const Bond&, const BondPose<double>&, const BondHistory&);
  /// Force of stretching at the length D.  [force]
  double (*tension)(const Bond&, double D, const BondHistory&);
  BondStiffness<double> (*stiffness)(const Bond&);
  BondStiffness<double> (*stiffest)(const Bond&);  ///< that the time step allows for
  BondStiffness<double> (*damping)(const Bond&);   ///< slopes of the damping at rest: stiffness times time
  BondRange (*range)(const Bond&, const BondShape&);
  /// The pose between the bonded points by which the range is judged: for R_i = R_j = 0.
  BondPose<double> (*elastic_pose)(const Bond&, const BondPose<double>&, const BondHistory&);
  /// The coefficients of a bond of length a with these stiffnesses; those that are always given stay as in
  /// `given`.
  Coefficients (*from_stiffness)(const BondStiffness<double>&, double a, const Coefficients& given);
  /// The loops of the step for this law in a kernel of that name, or nullptr; not set for the library's own
  /// laws, whose loops are in the kernels.
  const BondLoops* (*loops)(std::string_view kernel) = nullptr;

  bool remembers() const { return !history.empty(); }
};

/// The law as an object, for laws of the library and others alike; define_law.hpp says how it is made.
template <template <class> class Law>
struct LawObject {
  static const BondLaw object;
};
template <template <class> class Law>
inline constexpr const BondLaw& bond_law = LawObject<Law>::object;

/// The laws of the library, in the order of BondLaws, and those of them that case files name: without rules.
std::span<const BondLaw* const> bond_laws();
std::span<const BondLaw* const> named_laws();

/// This law with rules, and with flow, or rubbing, if the rules say so; or nullptr, of a law of a program's
/// own that damps, breaks or remembers by itself, or has more than eight coefficients.
const BondLaw* with_rules(const BondLaw& law, const BondRules& rules);

/// The form with offsets of a law of the library with rules or flow; nullptr for other laws.
const BondLaw* with_offsets(const BondLaw& law);

/// The one of that name among the library's laws, these and these with rules, or nullptr.
const BondLaw* find_law(std::string_view name, std::span<const BondLaw* const> others = {});

}  // namespace vbond
