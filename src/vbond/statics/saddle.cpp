#include "vbond/statics/detail/saddle.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "vbond/statics/detail/dense.hpp"

namespace vbond {
namespace {

/// Balanced at a given amplitude of the mode: how far that is, and what drives the body on along the mode
/// over the amplitude.
struct ValleyPoint {
  Placement at;
  double amplitude = 0;  // [length]
  double drive = 0;      // [force/length]
};

/// An orthonormal basis of what these orthonormal columns span, and x, which is nearly among them: x first.
DenseMatrix with_first(const Vector& x, const DenseMatrix& columns) {
  const DenseMatrix rest = columns - x * (x.transpose() * columns);
  DenseMatrix all(x.size(), std::max<Eigen::Index>(1, columns.cols()));
  all << x, singular_values(rest).U.leftCols(all.cols() - 1);
  return all;
}

/// The ways down from an unstable balance.
class Saddle {
 public:
  Saddle(StaticBody& body, TangentSolver& solver, Stability& stability,
         const std::function<bool()>& interrupted, int& iterations)
      : body_(body),
        solver_(solver),
        stability_(stability),
        interrupted_(interrupted),
        iterations_(iterations),
        saddle_(body.placement()) {}

  NewtonOutcome leave() {
    constexpr double nudge = 0.02;  // of the length scale: far above rounding, far below a change of shape
    constexpr int patience = 5;     // just above a critical load the valley is long and flat
    const EigenPairs lowest = stability_.lowest.value();
    const int unstable = stability_.unstable.value();
    const Vector x = lowest.vectors.col(0);
    Eigen::Index largest = 0;
    x.cwiseAbs().maxCoeff(&largest);
    const double first = nudge * body_.unknowns().length() / x[largest];
    NewtonOutcome outcome = from_beside(first * x, 1);
    if (!is_unstable(outcome)) return outcome;
    body_.restore(saddle_);
    modes_ = with_first(x, unstable_modes(lowest, unstable));
    if (walk_down_valley(-lowest.values[0], first)) outcome = correct_or_go_downhill();
    return is_unstable(outcome) ? from_beside(first * x, patience) : outcome;
  }

 private:
  NewtonOutcome judged(const NewtonOutcome& outcome) {
    iterations_ += outcome.iterations();
    if (outcome.converged) stability_ = judge_stability(body_, solver_);
    return outcome;
  }

  bool is_unstable(const NewtonOutcome& outcome) const {
    return !outcome.interrupted && (!outcome.converged || stability_.unstable.value_or(0) > 0);
  }

  NewtonOutcome go_downhill(int patience) {
    NewtonSettings settings = body_.stage().newton;
    settings.iterations *= patience;
    return judged(minimise(body_, solver_, settings, interrupted_));
  }

  NewtonOutcome from_beside(const Vector& x, int patience) {
    body_.restore(saddle_);
    body_.move(x, saddle_.load_factor);
    return go_downhill(patience);
  }

  /// From next to a balance, which may be too flat to be gone down to: straight, and downhill if that fails.
  NewtonOutcome correct_or_go_downhill() {
    const Placement here = body_.placement();
    const NewtonOutcome outcome = judged(correct(body_, solver_, body_.stage().newton, interrupted_));
    if (!is_unstable(outcome)) return outcome;
    body_.restore(here);
    return go_downhill(1);
  }

  /// Of the saddle, where the body stands.
  DenseMatrix unstable_modes(const EigenPairs& lowest, int unstable) const {
    const int count = std::min(unstable, 6);
    if (lowest.vectors.cols() >= unstable) return lowest.vectors.leftCols(count);  // by multigrid
    const double bound = lowest.values[0] - std::abs(lowest.values[0]);
    return smallest_eigenpairs(body_.tangent(), count, bound).vectors;
  }

  /// The body is moved along the lowest mode by more and more and balanced each time but for the modes, until
  /// nothing drives it on along that one. Near a critical load that valley is so flat that neither the
  /// potential nor what is out of balance shows its end: the drive over the amplitude does, which begins at
  /// minus the eigenvalue and is known as well as that. Along the other modes the body stays where it is.
  /// Whether it then stands where the valley is lowest; otherwise it is as far as the walk came.
  bool walk_down_valley(double depth, double first) {
    ValleyPoint in{saddle_, 0.0, depth};
    const std::optional<ValleyPoint> out = pass_the_lowest(in, first);
    return out && narrow(in, *out, 1e-4 * depth);
  }

  /// On until the body is driven back: that place, and in `in` the one before. Nothing if there is none.
  std::optional<ValleyPoint> pass_the_lowest(ValleyPoint& in, double step) {
    constexpr int most_steps = 60;
    const double shortest = 1e-3 * std::abs(step);
    for (int k = 0; k < most_steps && std::abs(step) > shortest; ++k) {
      const std::optional<ValleyPoint> next = stand_at(in, in.amplitude + step);
      if (stopped_) break;
      if (!next) {
        step *= 0.5;
        continue;
      }
      if (next->drive <= 0.0) return next;
      in = *next;
      step *= 2.0;
    }
    body_.restore(in.at);
    return {};
  }

  /// Regula falsi (Illinois) in the square of the amplitude, of which the drive is nearly a linear function.
  bool narrow(ValleyPoint in, ValleyPoint out, double small) {
    double drive_in = in.drive, drive_out = out.drive;
    int side = 0;  // on which the last one was
    for (int k = 0; k < 40; ++k) {
      const double from = in.amplitude * in.amplitude, to = out.amplitude * out.amplitude;
      const double there = std::sqrt(from + (to - from) * drive_in / (drive_in - drive_out));
      const std::optional<ValleyPoint> next = stand_at(in, std::copysign(there, out.amplitude));
      if (!next) break;
      const double width = std::abs(out.amplitude - in.amplitude);
      if (std::abs(next->drive) <= small || width < 1e-6 * std::abs(out.amplitude)) return true;
      const int now = next->drive > 0.0 ? 1 : -1;
      (now > 0 ? in : out) = *next;
      (now > 0 ? drive_in : drive_out) = next->drive;
      if (now == side) (now > 0 ? drive_out : drive_in) *= 0.5;
      side = now;
    }
    if (!stopped_) body_.restore(out.at);
    return false;
  }

  /// The body balanced at this amplitude but for the modes, from a place near by.
  std::optional<ValleyPoint> stand_at(const ValleyPoint& from, double amplitude) {
    constexpr int most_corrections = 12, fewest = 2;
    constexpr double longest = 0.2;  // of bonds: a linear step is then off by some hundredths
    body_.restore(from.at);
    std::optional<Vector> x = along_mode(amplitude - from.amplitude);
    double before = 0.0;
    for (int k = 0; x && x->allFinite() && body_.largest_bond_change(*x) <= longest; ++k) {
      body_.move(*x, from.at.load_factor);
      ++iterations_;
      const double left = body_.residual_beside(modes_), rounding = body_.residual_of_rounding();
      const bool stalled = left > 0.3 * before && left <= 100.0 * rounding;
      if (k >= fewest && (left <= std::max(1e-10, rounding) || stalled))
        return ValleyPoint{body_.placement(), amplitude, modes_.col(0).dot(body_.unbalanced()) / amplitude};
      before = left;
      stopped_ = interrupted_ && interrupted_();
      if (k == most_corrections || stopped_) break;
      x = correction();
    }
    return {};
  }

  /// The movement by so much along the lowest mode, and not along the others, that leaves all else in
  /// balance.
  std::optional<Vector> along_mode(double change) {
    if (!solver_.factor(body_)) return {};
    const std::optional<DenseMatrix> B = responses();
    if (!B) return {};
    return Vector(*B * solve_dense(modes_.transpose() * *B, change * Vector::Unit(modes_.cols(), 0)));
  }

  /// Newton's step that does not move the body along the modes.
  std::optional<Vector> correction() {
    if (!solver_.factor(body_)) return {};
    const std::optional<DenseMatrix> B = responses();
    if (!B) return {};
    const Vector a = solver_.solve_full(body_, body_.unbalanced());
    return Vector(a - *B * solve_dense(modes_.transpose() * *B, modes_.transpose() * a));
  }

  /// To a force along each mode. Nothing where outside moments make the tangent singular.
  std::optional<DenseMatrix> responses() const {
    DenseMatrix B(modes_.rows(), modes_.cols());
    for (Eigen::Index k = 0; k < B.cols(); ++k) {
      const Vector response = solver_.solve_full(body_, modes_.col(k));
      if (response.size() == 0) return {};
      B.col(k) = response;
    }
    return B;
  }

  StaticBody& body_;
  TangentSolver& solver_;
  Stability& stability_;
  const std::function<bool()>& interrupted_;
  int& iterations_;
  const Placement saddle_;
  DenseMatrix modes_;  // orthonormal, those that are unstable, the lowest first
  bool stopped_ = false;
};

}  // namespace

NewtonOutcome leave_saddle(StaticBody& body, TangentSolver& solver, Stability& stability,
                           const std::function<bool()>& interrupted, int& iterations) {
  return Saddle(body, solver, stability, interrupted, iterations).leave();
}

}  // namespace vbond
