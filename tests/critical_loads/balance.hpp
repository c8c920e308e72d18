#pragma once
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <functional>
#include <optional>

#include "vbond/statics/detail/body.hpp"

/// The reference's own way to balances on a path, with nothing of the solver but the body and its tangent:
/// Newton's method at a given load factor or at a given displacement, Eigen's factors, inertia by L D L^T.
namespace vbond::campaign {

/// What is prescribed along a step: an unknown that is a translation, or the load factor.
struct Control {
  static constexpr int load_factor = -1;
  int unknown = load_factor;
};

/// A balance and how the path goes through it, per unit of the control.
struct Node {
  Placement at;
  double p = 0;       ///< value of the control
  Vector u_rate;      ///< d unknowns / dp
  double f_rate = 0;  ///< d load factor / dp
  int negative = 0;   ///< eigenvalues of the tangent
  double f() const { return at.load_factor; }
};

class Balances {
 public:
  explicit Balances(StaticBody& body) : body_(body) {}

  /// The balance where the control has the value p, sought from `from` moved by x and the load factor by df.
  std::optional<Node> find(const Placement& from, const Vector& x, double df, Control control, double p);
  double value(Control control) const;
  /// Eigenvalue j (from 1, in increasing order) of the tangent at a node, which must not be singular; nothing
  /// if it is not among those next to zero.
  std::optional<double> eigenvalue(const Node& node, int j);
  /// Largest entry on the tangent's diagonal, at the node used last.
  double largest_stiffness() const;
  int nodes() const { return nodes_; }

 private:
  bool factor(Control control);
  std::optional<int> count_negative(double det_sign);

  StaticBody& body_;
  Eigen::SparseLU<SparseMatrix> bordered_;
  Eigen::SimplicialLDLT<SparseMatrix> inertia_;
  int analysed_for_ = -2;
  bool inertia_analysed_ = false;
  int nodes_ = 0;
};

}  // namespace vbond::campaign
