#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond {

/// What works on a body as the load factor grows.
struct Acting {
  Placement at;
  double power = 0;       ///< of the supports that move and of heating, per load factor  [energy]
  Vector power_of_walls;  ///< of each wall, per load factor  [energy]
  std::array<double, 6> forces_on_cell{};  ///< of a cell that moves: StaticBody::forces_on_cell()  [energy]
};

/// What the books need of a balance.
struct Stand : Acting {
  double stored = 0;      ///< in bonds and contacts  [energy]
  double dissipated = 0;  ///< by bonds that yield or soften, since they were made  [energy]
  Vector rate;            ///< how the body goes on, per load factor; empty: not known  [length]
  double spent() const { return stored + dissipated; }
};
/// rate: how the body goes on from here, if it has a potential and that is known.
Stand stand_of(const StaticBody& body, Vector rate = {});

/// Work of loads, supports and walls between balances that are close. A sum that has begun is not
/// interrupted: half of it would stand in the books for good.
class WorkOnTheWay {
 public:
  /// Keeps references.
  WorkOnTheWay(StaticBody& body, TangentSolver& solver, StaticResult& result)
      : body_(body), solver_(solver), result_(result) {}

  /// From one balance to the other along the way between: first that of all, then of each wall. Sums over
  /// balances between them, more of them until the work is known as well as the books are to close, or they
  /// do not close. scale: the largest energy in the books. splits: how often a way of an elastic body may be
  /// halved for that. Leaves the body at the second.  [energy]
  Vector between(const Stand& a, const Stand& b, double scale, int splits = 4);
  /// The same after a jump at one load factor, by the means of what acts at both: loads, the stress of the
  /// cell and what is left of the relief.  [energy]
  double of_jump(const Stand& a, const Stand& b) const { return trapezium(a, b)[0]; }
  /// What the work on the way has not become, as a part of what is turned over, if it is more than this part:
  /// after a jump, or flow in a step that is too long. A coarser sum, of bodies that flow.
  double missing(const Stand& a, const Stand& b, double part);
  /// To a balance at a load factor between those of two that are close. False: anywhere.
  bool balance_between(const Placement& a, const Placement& b, double load_factor);
  /// Newton's method from where the body stands.
  bool correct_here();

 private:
  template <class Node, class Known>
  double by_halving(const Stand& a, const Stand& b, Node&& node, Known&& known) const;
  Acting near_balance(const Stand& a, const Stand& b, const Vector& from_a_to_b, double load_factor);
  bool balance_between(const std::vector<Acting>& nodes, std::size_t k);
  bool balance_from(const Placement& a, const Vector& x, double load_factor);
  Vector trapezium(const Acting& a, const Acting& b) const;
  Vector between_kinks(const Stand& a, const Stand& b, double within);

  StaticBody& body_;
  TangentSolver& solver_;
  StaticResult& result_;
};

}  // namespace vbond
