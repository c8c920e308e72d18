#include "vbond/statics/detail/wave_buckling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vbond/core/crossing.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/detail/bloch.hpp"
#include "vbond/statics/detail/eigen.hpp"
#include "vbond/statics/detail/path_walk.hpp"
#include "vbond/statics/detail/pulse.hpp"

namespace vbond {
namespace {

/// The first step changes no bond by more than this; later ones are chosen by the walk.
constexpr double first_change_of_bonds = 0.02;

/// The lowest eigenvalues of K(q), and vectors.
struct LowestOfWave {
  Vector values;
  Eigen::MatrixXcd vectors;
  double zero = 0;  ///< what rounding may make of none
};

/// The `count` lowest, or all; without motions that meet no stiffness because a part floats.
LowestOfWave lowest_of_wave(const StaticBody& body, const Wave& wave, int count) {
  const BlochTangent K = bloch_tangent(body, wave);
  const Eigen::MatrixXcd rigid =
      motions_in_phase(body, free_rigid_motions(body.model(), body.state(), body.unknowns()).basis, wave);
  const bool real = K.is_real();
  const SparseMatrix A = real ? K.real : doubled(K.real, K.imaginary);
  const SparseMatrix without =
      real ? SparseMatrix(DenseMatrix(rigid.real()).sparseView()) : doubled_columns(rigid);
  const double size = max_norm(A.cwiseAbs().transpose() * Vector::Ones(A.rows()));
  const int times = real ? 1 : 2;
  const EigenPairs pairs = smallest_eigenpairs(A, times * count, -1.1 * size, without);
  LowestOfWave found;
  found.zero = 1e-12 * size;
  found.vectors = real ? Eigen::MatrixXcd(pairs.vectors.cast<std::complex<double>>())
                       : independent_waves(pairs.vectors, count);
  found.values.resize(found.vectors.cols());
  for (Eigen::Index k = 0; k < found.values.size(); ++k) found.values[k] = pairs.values[times * k];
  return found;
}

/// Where an eigenvalue of a wave passes zero within a step.
struct CriticalWave {
  double s = 0;
  std::size_t wave = 0;
  int number = 0;  // of the eigenvalue, from 0
};

class CriticalWaves {
 public:
  CriticalWaves(const Model& model, const StaticStage& stage, State state, const StaticHooks& hooks,
                StaticResult& result)
      : model_(model),
        stage_(stage),
        as_waves_(without_floating_held(stage)),
        hooks_(hooks),
        result_(result),
        body_(model, stage, std::move(state)),
        solver_(LinearSolver::direct),
        walk_(body_, solver_, stage.newton, stage.path.largest_step),
        negative_(stage.waves.q.size(), 0),
        found_(stage.waves.q.size(), 0) {
    as_waves_.cell = {};  // a wave leaves the cell as it is
  }

  State run() && {
    const Placement at_zero = body_.placement();
    start();
    walk_until_ended(walk_, hooks_, result_, [this] { take_step(); });
    std::stable_sort(
        result_.critical_loads.begin(), result_.critical_loads.end(),
        [](const CriticalLoad& a, const CriticalLoad& b) { return a.load_factor < b.load_factor; });
    result_.solver = solver_.name();
    result_.iterations += walk_.iterations();
    result_.factors = walk_.factors();
    result_.unstable = 0;
    body_.restore(at_zero);
    return std::move(body_).take_state();
  }

 private:
  void end(const std::string& why, double searched_to) {
    result_.ended = why;
    result_.searched_to = searched_to;
  }

  /// As the body stands. A wave has as many particles all the way, and so the phases that it begins with.
  LowestOfWave lowest(std::size_t k, int count) const {
    Pulse::may_end();
    const StaticBody free(model_, as_waves_, body_.state(), body_.load_factor());
    if (free.has_moment_part())
      throw NoEquilibrium(
          stage_.name,
          fmt::format("at load factor {:.6g} a moment from outside acts on particles that are "
                      "free to turn",
                      body_.load_factor()),
          "such a moment has no potential: apply a couple of forces");
    return lowest_of_wave(free, result_.waves[k], count);
  }

  /// How many eigenvalues are negative.
  int count_negative(std::size_t k) const {
    for (int count = negative_[k] + 2;; count *= 2) {
      const LowestOfWave found = lowest(k, count);
      const auto negative = static_cast<int>((found.values.array() < -found.zero).count());
      if (negative < count) return negative;
    }
  }

  void start() {
    const PathPoint& here = start_walk(body_, solver_, walk_, 1.0);
    for (std::size_t k = 0; k < negative_.size(); ++k) {
      result_.waves.push_back(wave_of(stage_.waves, k, body_.state().cell, model_.cell.periodic));
      if (count_negative(k) > 0)
        throw NoEquilibrium(stage_.name,
                            fmt::format("at load factor 0, without the proportional loads, the body is not "
                                        "stable: wave {} grows",
                                        k + 1),
                            "find a stable balance by an equilibrium stage before this one");
    }
    const Vector rate = here.tangent.u / here.tangent.f;
    double first = first_change_of_bonds / body_.largest_bond_change(rate, 1.0);
    if (stage_.search_to > 0.0) first = std::min(first, stage_.search_to);
    walk_.start(first);
    report_point(body_, PointKind::regular, 0, hooks_, result_);
  }

  void take_step() {
    const std::optional<PathLeg> leg = walk_.next();
    if (!leg && walk_.stopped_by_a_bond()) return end("bond range", result_.searched_to);
    if (!leg)
      throw NoEquilibrium(
          stage_.name,
          fmt::format("no balance found beyond load factor {:.9g}: {}", result_.searched_to, walk_.why_not()),
          "a smaller largest_step of the stage helps if the way is difficult, and kind = \"path\" shows how "
          "it goes on");
    const CriticalPoint* limit = nullptr;
    for (const CriticalPoint& c : leg->critical) {
      if (c.kind == PointKind::limit_point) {
        limit = &c;
        break;
      }
      tell(stage_, hooks_,
           fmt::format("{}: what repeats with the cell becomes unstable, and waves beyond it are those of an "
                       "unstable balance",
                       in_words(c)));
    }
    PathStep step = leg->step;
    const PathNode& last = limit ? limit->node : leg->end;
    for (const CriticalWave& c : critical_on(step, leg->start, last))
      if (!add(c, step)) return;
    if (limit) {
      tell(stage_, hooks_,
           fmt::format("the path has a limit point at load factor {:.8g}: critical loads beyond it are not "
                       "looked for",
                       limit->load_factor));
      return end("limit point", limit->load_factor);
    }
    walk_.arrive(*leg);
    const double here = body_.load_factor();
    report_point(body_, PointKind::regular, {}, hooks_, result_);
    if (stage_.search_to > 0.0 && here >= stage_.search_to) return end("load factor", stage_.search_to);
    if (std::all_of(found_.begin(), found_.end(), [&](int n) { return n >= stage_.count; }))
      return end("converged", here);
    if (any_bond_beyond_its_law(body_.state())) return end("bond range", here);
    if (result_.points >= stage_.path.most_points) end("points", here);
  }

  /// In the order of the path. Leaves the body anywhere.
  std::vector<CriticalWave> critical_on(PathStep& step, const PathNode& from, const PathNode& to) {
    std::vector<CriticalWave> all;
    for (std::size_t k = 0; k < negative_.size(); ++k) {
      body_.restore(to.point.at);
      const int after = count_negative(k);
      for (int number = negative_[k]; number < after; ++number)
        all.push_back({zero_of(k, number, step, from, to), k, number});
      negative_[k] = after;
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const CriticalWave& a, const CriticalWave& b) { return a.s < b.s; });
    return all;
  }

  /// Each eigenvalue by its number is a continuous function along the path.
  double zero_of(std::size_t k, int number, PathStep& step, const PathNode& from, const PathNode& to) {
    const auto value_here = [&] { return lowest(k, number + 1).values[number]; };
    body_.restore(from.point.at);
    const double first = value_here();
    if (!(first > 0.0)) return from.s;
    body_.restore(to.point.at);
    const double last = value_here();
    const double small = epsilon * max_norm(body_.tangent().diagonal());
    const Crossed c =
        crossing(Sample{from.s, first}, Sample{to.s, last}, small, [&](double s) -> std::optional<double> {
          if (!step.to(s).point) return std::nullopt;
          return value_here();
        });
    if (!c.found)
      throw NoEquilibrium(
          stage_.name,
          fmt::format("no balance found between load factors {:.9g} and {:.9g}, where wave {} "
                      "becomes unstable",
                      from.point.at.load_factor, to.point.at.load_factor, k + 1),
          "a smaller largest_step of the stage helps if the way is difficult");
    return c.s;
  }

  /// False: the search ends before it.
  bool add(const CriticalWave& c, PathStep& step) {
    if (!step.to(c.s).point) body_.restore(step.start().at);
    const double f = body_.load_factor();
    if (stage_.search_to > 0.0 && f > stage_.search_to) return end("load factor", stage_.search_to), false;
    if (any_bond_beyond_its_law(body_.state())) return end("bond range", f), false;
    CriticalLoad& found = result_.critical_loads.emplace_back();
    found.load_factor = f;
    found.wave = static_cast<int>(c.wave) + 1;
    WaveShape shape =
        wave_shape(body_of_waves().unknowns(), lowest(c.wave, c.number + 1).vectors.col(c.number));
    found.mode = std::move(shape.in_phase);
    found.out_of_phase = std::move(shape.out_of_phase);
    ++found_[c.wave];
    report_point(body_, PointKind::bifurcation, {}, hooks_, result_);
    return true;
  }
  StaticBody body_of_waves() const { return {model_, as_waves_, body_.state(), body_.load_factor()}; }

  const Model& model_;
  const StaticStage& stage_;
  StaticStage as_waves_;  // what holds floating parts is left out
  const StaticHooks& hooks_;
  StaticResult& result_;
  StaticBody body_;
  TangentSolver solver_;
  PathWalk walk_;
  std::vector<int> negative_;  // eigenvalues of each wave here
  std::vector<int> found_;     // critical loads of each wave
};

}  // namespace

State find_critical_waves(const Model& model, const StaticStage& stage, State balanced,
                          const StaticHooks& hooks, StaticResult& result) {
  return CriticalWaves(model, stage, std::move(balanced), hooks, result).run();
}

}  // namespace vbond
