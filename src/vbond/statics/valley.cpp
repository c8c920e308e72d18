#include "vbond/statics/detail/valley.hpp"

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

class Valley {
 public:
  Valley(StaticBody& body, TangentSolver& solver, const DenseMatrix& modes,
         const std::function<bool()>& interrupted)
      : body_(body), solver_(solver), modes_(modes), interrupted_(interrupted) {}

  ValleyWalk walk(double eigenvalue, double first) {
    const double depth = -eigenvalue;
    ValleyPoint in{body_.placement(), 0.0, depth};
    const std::optional<ValleyPoint> out = pass_the_lowest(in, first);
    result_.found = out && narrow(in, *out, 1e-4 * depth);
    return result_;
  }

 private:
  /// On until the body is driven back: that place, and in `in` the one before. Nothing if there is none.
  std::optional<ValleyPoint> pass_the_lowest(ValleyPoint& in, double step) {
    constexpr int most_steps = 60;
    const double shortest = 1e-3 * std::abs(step);
    for (int k = 0; k < most_steps && std::abs(step) > shortest; ++k) {
      const std::optional<ValleyPoint> next = stand_at(in, in.amplitude + step);
      if (result_.interrupted) break;
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
    if (!result_.interrupted) body_.restore(out.at);
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
      ++result_.iterations;
      const double left = body_.residual_beside(modes_), rounding = body_.residual_of_rounding();
      const bool stalled = left > 0.3 * before && left <= 100.0 * rounding;
      if (k >= fewest && (left <= std::max(1e-10, rounding) || stalled))
        return ValleyPoint{body_.placement(), amplitude, modes_.col(0).dot(body_.unbalanced()) / amplitude};
      before = left;
      result_.interrupted = interrupted_ && interrupted_();
      if (k == most_corrections || result_.interrupted) break;
      x = correction();
    }
    return {};
  }

  /// The movement by so much along the lowest mode, and not along the others, that leaves all else in
  /// balance.
  std::optional<Vector> along_mode(double change) {
    if (!solver_.factor(body_)) return {};
    const DenseMatrix B = responses();
    return Vector(B * solve_dense(modes_.transpose() * B, change * Vector::Unit(modes_.cols(), 0)));
  }

  /// Newton's step that does not move the body along the modes.
  std::optional<Vector> correction() {
    if (!solver_.factor(body_)) return {};
    const Vector a = solver_.solve_full(body_, body_.unbalanced());
    const DenseMatrix B = responses();
    return Vector(a - B * solve_dense(modes_.transpose() * B, modes_.transpose() * a));
  }

  /// To a force along each mode.
  DenseMatrix responses() const {
    DenseMatrix B(modes_.rows(), modes_.cols());
    for (Eigen::Index k = 0; k < B.cols(); ++k) B.col(k) = solver_.solve_full(body_, modes_.col(k));
    return B;
  }

  StaticBody& body_;
  TangentSolver& solver_;
  const DenseMatrix& modes_;
  const std::function<bool()>& interrupted_;
  ValleyWalk result_;
};

}  // namespace

ValleyWalk walk_down_valley(StaticBody& body, TangentSolver& solver, const DenseMatrix& modes,
                            double eigenvalue, double first, const std::function<bool()>& interrupted) {
  return Valley(body, solver, modes, interrupted).walk(eigenvalue, first);
}

}  // namespace vbond
