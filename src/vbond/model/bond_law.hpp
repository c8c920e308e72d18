#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "vbond/core/column.hpp"
#include "vbond/physics/laws.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

struct Bond;
struct BondLoops;
template <std::size_t N>
struct PairTangent;

/// The coefficients of a law in the order of its fields; those it does not have are zero.
using Coefficients = std::array<double, most_coefficients>;

/// A bond law as loops over bonds and files see it, where the law is known at run time only. One object per
/// law, bond_law<Law>: a bond points to it.
struct BondLaw {
  std::string_view name;   ///< in case files and checkpoints
  std::string_view title;  ///< for people
  std::span<const LawFieldInfo> fields;
  double strained_past;                           ///< tilt or twist from which a bond is strained  [degrees]
  std::string_view rest_condition, rest_way_out;  ///< when rest is the least energy, and how to get there
  BondEnergy<double> (*energy)(const Bond&, const BondPose<double>&);
  BondLoads<double> (*loads)(const Bond&, const BondPose<double>&);
  PairTangent<9> (*tangent)(const Bond&, const BondPose<double>&);
  double (*tension)(const Bond&, double D);  ///< force of stretching at the length D  [force]
  BondStiffness<double> (*stiffness)(const Bond&);
  BondRange (*range)(const Bond&, const BondShape&);
  /// The coefficients of a bond of length a with these stiffnesses; those that are always given stay as in
  /// `given`.
  Coefficients (*from_stiffness)(const BondStiffness<double>&, double a, const Coefficients& given);
  /// The loops of the step for this law in a kernel of that name, or nullptr; not set for the library's own
  /// laws, whose loops are in the kernels.
  const BondLoops* (*loops)(std::string_view kernel) = nullptr;
};

/// The law as an object, for laws of the library and others alike; define_law.hpp says how it is made.
template <template <class> class Law>
struct LawObject {
  static const BondLaw object;
};
template <template <class> class Law>
inline constexpr const BondLaw& bond_law = LawObject<Law>::object;

/// The laws of the library, in the order of BondLaws.
std::span<const BondLaw* const> bond_laws();

/// The one of that name among the library's laws and these, or nullptr.
const BondLaw* find_law(std::string_view name, std::span<const BondLaw* const> others = {});

}  // namespace vbond
