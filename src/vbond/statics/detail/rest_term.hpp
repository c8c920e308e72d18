#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/tensor.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/statics/detail/assembly.hpp"
#include "vbond/statics/detail/matrix.hpp"

namespace vbond {

/// Loads on all particles, held degrees of freedom among them.
struct LoadSum {
  Loads loads;
  double largest = 0;  ///< force in the body
  /// What rounding of places may do to what terms add.  [force], [energy]
  double rounding_of_force = 0, rounding_of_potential = 0;
  Tensor of_cell;  ///< derivatives of the energy with those of the cell's deformation gradient  [energy]
};

/// What changes with the unknowns and with the load factor.
struct StiffnessSum {
  Assembly assembly;      ///< symmetric part of the tangent
  Assembly full;          ///< without symmetry, of bodies that flow
  Vector load_direction;  ///< derivative of what is unbalanced with the load factor  [force]
};

struct Placement;
struct TermHold;

/// An entry of a matrix over the unknowns.
using SkewEntry = std::function<void(int row, int column, double K)>;

/// Something besides bonds and contacts that acts on a body at rest: walls, temperatures. StaticBody calls
/// what is there, in the order of terms/terms.hpp. Functions that stay as they are do nothing.
class RestTerm {
 public:
  virtual ~RestTerm() = default;
  /// Whether the stage has it; if not, nothing else is called.
  virtual bool is_there() const = 0;
  /// The stage takes hold of the body, which stands where it was found.
  virtual void take_hold() {}
  /// The body stands elsewhere, or the load factor is another: takes what it has to the load factor.
  virtual void follow() {}
  virtual void add_loads(LoadSum&) const {}
  /// By how much loads change per load factor while nothing moves.
  virtual void add_load_rates(LoadSum&) const {}
  /// The largest strain that it imposes on bonds per load factor, where that moves no particle by itself.
  virtual double imposed_strain() const { return 0.0; }
  /// Pairs of particles that add_stiffness() couples, besides those that are bonded.
  virtual void add_pairs(std::vector<Assembly::Pair>&) const {}
  virtual void add_stiffness(StiffnessSum&) const {}
  /// Of a term that is a load: its forces where the body stands, at this load factor.
  virtual void add_applied(double /*load_factor*/, Loads&) const {}
  /// And its work on the straight way from one placement to another, at this load factor.  [energy]
  virtual double work(const Placement& /*from*/, const Placement& /*to*/, double /*load_factor*/) const {
    return 0.0;
  }
  /// The antisymmetric part of what it adds to the tangent, which add_stiffness() leaves out where bonds do
  /// not flow: it has no potential. The largest sum of a row, and its entries.  [force/length]
  virtual double largest_skew() const { return 0.0; }
  virtual void for_skew(const SkewEntry&) const {}
  /// The first particle at which it is a load without an energy, in words; nothing if it has one.
  virtual std::optional<std::string> without_energy() const { return std::nullopt; }
  /// Where it holds particles along a direction; to come: or may in this stage.
  virtual void add_holds(bool /*to_come*/, std::vector<TermHold>&) const {}
  /// What it stores, of contacts.  [energy]
  virtual double energy() const { return 0.0; }
  /// The body as it stands is the balance from which it goes on.
  virtual void accept() {}
  /// What the stage cannot go on with here, e.g. "particle 3: its centre has come through wall \"floor\"".
  virtual std::optional<std::string> fault() const { return std::nullopt; }
  /// How far these unknowns, and what is held with the load factor, would go at most, as a part of what a
  /// linear step can tell.
  virtual double largest_change(const Vector& /*x*/, double /*load_factor_change*/) const { return 0.0; }
};

}  // namespace vbond
