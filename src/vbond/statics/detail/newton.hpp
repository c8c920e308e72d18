#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/by_multigrid.hpp"
#include "vbond/statics/detail/deflated.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/factor.hpp"
#include "vbond/statics/detail/kept_factor.hpp"
#include "vbond/statics/detail/unsymmetric_factor.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// Whether a factor is kept while the body moves, always or where that is cheaper: KeptFactor.
enum class FactorUse { new_each_time, kept_if_cheaper, kept };

/// Solves with the tangent of a body as it stands. Factors are made anew at each call of a factor function;
/// the order of elimination only when the pattern has changed.
class TangentSolver {
 public:
  /// crew: of solutions by a kept factor.
  explicit TangentSolver(LinearSolver wanted, FactorUse factors = FactorUse::new_each_time,
                         std::shared_ptr<Crew> crew = std::make_shared<Crew>(1));
  ~TangentSolver();

  enum class Choice { direct, multigrid, none };
  /// Finds the order of elimination, and what is wanted, or what memory and time speak for; none: the factor
  /// does not fit and there is no multigrid.
  Choice choose(const StaticBody& body);
  /// After choose(): a build with multigrid would have taken that because it is quicker.
  bool would_be_quicker_by_multigrid(const StaticBody& body) const;
  /// Makes ready for what choose() says, unless it has done so for this pattern, or a kept factor serves for
  /// it. Throws NoEquilibrium if there is none, or where multigrid is wanted and this build, or this kind of
  /// stage, has none.
  void prepare(const StaticBody& body);
  /// Factors tangent() + shift I; false if that is not positive definite. With multigrid that is
  /// noticed only in solve().
  bool factor_definite(const StaticBody& body, double shift = 0.0);
  /// Factors tangent() whatever its signs, or by multigrid finds its lowest eigenpairs; returns the number of
  /// negative eigenvalues, nothing if singular. Throws NoConvergence.
  std::optional<int> factor(const StaticBody& body);
  /// After factor(): its null vectors taken out.
  Deflated deflated(const StaticBody& body);
  /// The eigenpairs of tangent() that are nearest to zero, nearest first.
  EigenPairs near_zero(const StaticBody& body, int count);
  /// Makes ready to solve with tangent() and no more: by the kept factor if there is one, else
  /// factor_definite(). That the tangent is not definite may then show only in solve(), if at all.
  bool take_definite(const StaticBody& body);
  /// The same whatever its signs; false if it is known to be singular.
  bool take(const StaticBody& body);
  /// Whether tangent() is positive definite: by a kept factor if that shows it, else by a new one. And what
  /// the former has found together with that: x with tangent() x = b, to this part of b.
  struct Judged {
    bool definite = false;
    std::optional<Vector> solution;
  };
  Judged judge(const StaticBody& body, const Vector& b, double accuracy);
  /// M^-1 b, M the matrix of a kept factor, which is near tangent() as a rule; empty without one, or where a
  /// new one is the cheaper way on. Takes no tangent: contacts that are new since the last one are not in M.
  Vector solve_roughly(const StaticBody& body, const Vector& b);
  /// From now on the tangent has this in addition, among these unknowns: a kept factor follows.
  void note_change(const std::vector<int>& unknowns, const DenseMatrix& change);
  bool has_kept() const { return kept_.at_hand(); }
  /// No kept factor until another is made.
  void drop_kept();
  /// The kept factor, as it can be made again.
  KeptFactorUnderWay kept_under_way() const;
  /// Makes it again, if there was one, with this body, which then stands where it stood as the factor was
  /// made. broken: bonds that had broken by then, since the body was made.
  void go_on_with_kept(StaticBody& body, const KeptFactorUnderWay& then, const std::vector<BondId>& broken);

  /// Whether full_tangent() has factors of its own: where outside moments act, but not by multigrid.
  bool factors_full(const StaticBody& body) const { return !multigrid_ && body.has_moment_part(); }
  /// Makes ready to solve with full_tangent() and no more; false if it is known to be singular.
  bool take_full(const StaticBody& body);
  /// After take_full() where it factors_full(): of the determinant of full_tangent(); 0 if that is singular.
  int sign_of_full() const { return full_.sign(); }

  /// After any of these: (tangent() + shift I)^-1 b, with a kept factor to this part of b. Empty if the
  /// tangent turns out not to be what was asked for. The body stands where it stood.
  Vector solve(const Vector& b, double accuracy = full_accuracy);
  /// The same for each column, by factors that are not kept, without refinement.
  DenseMatrix solve_columns(const DenseMatrix& B) const { return factor_.solve_columns(B); }
  /// X with tangent() X = B, by a factor that is kept, from this X on, to this part of each column. Nothing
  /// if there is no such factor, or a new one is the cheaper way.
  std::optional<DenseMatrix> solve_columns_kept(const StaticBody& body, const DenseMatrix& B,
                                                const DenseMatrix& X, double accuracy);
  /// After any, without a shift: the same with full_tangent(), which differs where moments act. Empty if that
  /// is singular.
  Vector solve_full(const StaticBody& body, const Vector& b, double accuracy = full_accuracy);
  /// The equations of a step along a path, at once, by factors of their own, where it factors_full():
  ///   full_tangent() u - g f = R,  n . u + w f = c.
  /// They are regular at limit points. Empty if they are singular.
  struct Bordered {
    const Vector &g, &n;
    double w;
  };
  bool take_bordered(const StaticBody& body, const Bordered& border);
  Vector solve_bordered(const Vector& R, double c) const;
  /// By the factors of the last take_full(), although the body may have moved since.
  Vector solve_as_taken(const Vector& b) const { return full_.solve(b); }
  /// Of the determinant of the last bordered matrix.
  int sign_of_bordered() const { return bordered_.sign(); }
  bool by_multigrid() const { return multigrid_ != nullptr; }
  const char* name() const { return by_multigrid() ? "multigrid" : "direct"; }
  /// By multigrid only: ready for tangent().
  ByMultigrid& multigrid_at(const StaticBody& body);
  /// Of multigrid, so far.
  int iterations() const { return multigrid_ ? multigrid_->iterations() : 0; }
  const Factor& last_factor() const { return factor_; }
  /// Factors of all kinds that were made, or tried.
  int factors_made() const { return factor_.made() + full_.made() + bordered_.made(); }

 private:
  static constexpr double full_accuracy = 1e-12;
  std::optional<int> counted_by_multigrid(const StaticBody& body);
  /// As prepare(), for factors that are made of this pattern.
  void find_order(const StaticBody& body);
  bool kept_for(const StaticBody& body);
  void keep(const StaticBody& body);
  bool may_keep() const;
  Vector solve_by_iteration(const StaticBody& body, const Vector& b);

  LinearSolver wanted_;
  FactorUse factors_;
  Factor factor_;
  UnsymmetricFactor full_, bordered_;
  std::uint64_t full_at_ = 0;  // placement_number; 0: nowhere
  bool full_is_regular_ = false;
  double per_factor_ = 1.0;  // of the bordered equations: their last unknown is f over this
  int analysed_ = 0;         // pattern_version
  std::unique_ptr<ByMultigrid> multigrid_;
  KeptFactor kept_;
  const SparseMatrix* present_ = nullptr;  // the tangent, where the kept factor is used
  const StaticBody* present_body_ = nullptr;
  std::shared_ptr<const KeptFactorUnderWay::Place> kept_of_;  // where the body of the kept factor stood
  bool any_signs_ = false;                                    // it need not be definite
  bool lost_ = false;                                         // it turned out not to be what was asked for
};

/// A predicted step along the load factor turns bonds by no more than this.  [rad]
inline constexpr double largest_prediction = 0.3;

/// How Newton's method went at one load factor.
struct NewtonOutcome {
  bool converged = false;
  bool interrupted = false;
  std::vector<double> residuals;  ///< StaticBody::residual() before each correction and at the end
  std::string why;                ///< not converged: what stood in the way, e.g. "60 iterations"
  int iterations() const { return static_cast<int>(residuals.size()) - 1; }
};

/// As well as was asked for, or to rounding.
bool in_balance(const StaticBody& body, const NewtonSettings& settings);

/// Balanced as well as was asked for, or as rounding lets it be known: residuals, the last being that of the
/// body as it stands, have stopped falling close to what rounding leaves.
bool balanced(const StaticBody& body, const NewtonSettings& settings, const std::vector<double>& residuals);

/// Balanced to a hundred times what rounding leaves: good enough where no step does better.
bool close_to_rounding(const StaticBody& body);

/// A linear step turns bonds by angles; beyond this it is no guide.  [rad]
inline constexpr double largest_change = 0.5;
/// What a step x changes: the turn of bonds, and the way to walls of which half a radius counts as much, so
/// that nothing comes through one unseen.
double change_of(const StaticBody& body, const Vector& x);

/// Why an iteration cannot go on; balanced: the body as it stands will do.
struct NewtonStop {
  std::string why;
  bool balanced = false;
};
/// Moves the body by a correction, or says why not. It gets the residuals so far.
using NewtonStep = std::function<std::optional<NewtonStop>(const std::vector<double>& residuals)>;

/// Newton's method of any kind: steps until the body is balanced, or one cannot be made.
NewtonOutcome iterate(StaticBody& body, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted, const NewtonStep& step);

/// Plain Newton at the body's load factor, from a state near balance; stable or not. For points on a known
/// path: it gives up when residuals grow, and the body is then where it gave up.
NewtonOutcome correct(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                      const std::function<bool()>& interrupted = {});

/// Newton's method for bodies without a potential: it makes the next correction smaller at each step, as the
/// tangent at hand measures it, whatever the signs of its eigenvalues (Deuflhard, Newton Methods for
/// Nonlinear Problems (2004), 3.3: the natural monotonicity test). Where solver.factors_full().
NewtonOutcome correct_with_care(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                                const std::function<bool()>& interrupted = {});

/// How far from where a body stands its balance may be looked for.
enum class Reach {
  near,  ///< where Newton's method leads
  far    ///< also far off, where outside moments act: downhill, by the work that they would do on small turns
};

/// The balance that a body comes to which is let go as it stands: downhill, or where outside moments have no
/// potential to go down straight on. Adds to iterations.
NewtonOutcome settle(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                     const std::function<bool()>& interrupted, int& iterations, Reach reach = Reach::far);

/// Newton with a line search downhill in the potential, the tangent shifted where it is not positive
/// definite, so that it goes to a minimum and not to a saddle. It may still stop at a balance that is
/// unstable, if it meets one exactly (a straight column): ask solver.factor().
NewtonOutcome minimise(StaticBody& body, TangentSolver& solver, const NewtonSettings& settings,
                       const std::function<bool()>& interrupted = {});

}  // namespace vbond
