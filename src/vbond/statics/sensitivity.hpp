#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"
#include "vbond/statics/results.hpp"

/// How balances change with parameters of their bonds, from the tangent at hand: without further balances.
///
/// In balance g(u, p) = 0: what is out of balance on the unknowns u vanishes for each p. So u' = K^-1 dg/dp
/// with the tangent K = -dg/du, and a number h(u, p) of the body, such as a reaction, changes by
///
///     h' = dh/dp + dh/du u'.
///
/// This is the direct form: one solution with K for each parameter. The adjoint form solves K^T a = dh/du for
/// each number and gives the same; it pays where there are more parameters than numbers, which a curve has
/// not: each of its points is a number.
///
/// u' solves with the exact tangent. dg/dp, dh/dp and dh/du u' are central differences of sixth order of
/// explicit formulas, at fixed places or along a fixed direction, wrong by some 1e-12 of themselves.
namespace vbond {

/// f'(0) by f at -3 h, ..., 3 h without 0, to h^6/140 of the seventh derivative. f(k) is f(k h), a vector.
template <class F>
auto derivative_of_sixth_order(double h, F&& f) {
  auto sum = f(1);
  sum = (45.0 * (sum - f(-1)) - 9.0 * (f(2) - f(-2)) + (f(3) - f(-3))) / (60.0 * h);
  return sum;
}

/// The bonds of the body at p + k h, |k| <= 3, in the order of those of its state: the same pairs in the same
/// frames, with other coefficients, lengths or rules.
struct BondParameter {
  double step = 0;  ///< h > 0, in the unit of p
  std::function<PerBond<Bond>(int k)> bonds;
};

/// Numbers of a balance, as many for each.
using NumbersOfBalance = std::function<std::vector<double>(const StaticPoint&)>;

/// The changes of the balances of one run, stage by stage and point by point in their order.
class Sensitivities {
 public:
  /// Keeps a reference to the model.
  Sensitivities(const Model& model, std::vector<BondParameter> parameters);
  ~Sensitivities();

  /// The next stage begins in this state, in which its first point stands. A reason if its balances cannot be
  /// followed: a stage of another kind than equilibrium and path, bonds that remember, warmth, moving walls,
  /// supports that hold one turn of three, or turn what they hold of two.
  std::optional<std::string> begin(const StaticStage& stage, const State& state);

  /// The next balance of the stage. Of each parameter, d number / d p: at this load factor; of a path along
  /// the direction normal to it, so that the load factor changes too. NaN where a number is none. Nothing,
  /// with a reason in `why`, where that is not known: there the body does not come out in balance, or its
  /// tangent is singular. Nothing comes after that.
  std::optional<std::vector<std::vector<double>>> at(const StaticPoint& point,
                                                     const NumbersOfBalance& numbers, std::string& why);

 private:
  struct Inside;
  std::unique_ptr<Inside> in_;
};

}  // namespace vbond
