#include "inertia.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "vbond/statics/detail/body.hpp"

namespace vbond::campaign {
namespace {

// Loads that were told are looked at so far to either side, in parts of them, or three times the gap that was
// told: nearer by, what is out of balance moves the body along its soft modes.
constexpr double beside = 1e-4;
// A body that is not quite symmetric has moved along its soft modes even there. If that is too much for a
// step over the load, the step begins and ends so many times as far away.
constexpr double farther = 10.0;
constexpr double grid[] = {0.15, 0.3, 0.45, 0.6, 0.7, 0.8, 0.87, 0.92, 0.96, 0.985};
constexpr int most_halvings = 10;
constexpr double longest_step = 0.1;    // of a bond, as predicted
constexpr double farthest_aside = 0.5;  // of what corrections move, over the step
constexpr double largest_change = 0.3;  // of a bond in a correction
// As long as corrections by a factor made elsewhere bring what is out of balance down to this part of it,
// none is made. Where signs are counted, or corrections were many, a balance has one of its own.
constexpr double factor_serves = 0.2;
constexpr int many_corrections = 4, most_corrections = 40;

struct Balance {
  Placement at;
  Vector rate;       // of the unknowns, per load factor; roughly that, on the way
  int negative = 0;  // if counted
  double f() const { return at.load_factor; }
};

class LoadSteps {
 public:
  LoadSteps(const Model& model, const StaticStage& stage, const State& state) : body_(model, stage, state) {}

  std::optional<Balance> unloaded() {
    return find(body_.placement(), Vector::Zero(body_.unknowns().size()), 0.0, true);
  }
  /// Where a step fails its half is tried first.
  std::optional<Balance> next(const Balance& from, double f) { return next(from, f, true, 0); }
  /// By one step. Half of it would end next to the load.
  std::optional<Balance> over_load(const Balance& from, double f) {
    return find(from.at, (f - from.f()) * from.rate, f, true, 0.0);
  }
  int balances() const { return balances_; }

 private:
  std::optional<Balance> next(const Balance& from, double f, bool counted, int halvings) {
    if (const auto there = find(from.at, (f - from.f()) * from.rate, f, counted)) return there;
    if (halvings == most_halvings) return {};
    const auto middle = next(from, 0.5 * (from.f() + f), false, halvings + 1);
    return middle ? next(*middle, f, counted, halvings + 1) : std::nullopt;
  }
  /// The balance at f near `from` moved by x: not far from there beside that movement.
  std::optional<Balance> find(const Placement& from, const Vector& x, double f, bool counted,
                              double serves = factor_serves) {
    body_.restore(from);
    if (body_.largest_bond_change(x) > longest_step) return {};
    ++balances_;
    body_.move(x, f);
    Vector aside = Vector::Zero(x.size());
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_corrections; ++round) {
      const double residual = body_.residual();
      if (!std::isfinite(residual)) return {};
      const bool found = round > 0 && residual <= std::max(1e-10, 100 * body_.residual_of_rounding());
      const bool slow = round > 0 ? residual > serves * last : serves == 0.0;
      const bool own = found && (counted || round > many_corrections);
      if ((own || slow || !analysed_) && !factor()) return {};
      if (found) {
        const Vector rate = ldlt_.solve(body_.load_direction());
        if (!rate.allFinite()) return {};
        return Balance{body_.placement(), rate, static_cast<int>((ldlt_.vectorD().array() < 0.0).count())};
      }
      last = residual;
      const Vector step = ldlt_.solve(body_.unbalanced());
      if (!step.allFinite() || body_.largest_bond_change(step) > largest_change) return {};
      aside += step;
      if (x.squaredNorm() > 0.0 && aside.norm() > farthest_aside * x.norm()) return {};
      body_.move(step, f);
    }
    return {};
  }
  bool factor() {
    const SparseMatrix& K = body_.tangent();
    if (!analysed_) ldlt_.analyzePattern(K);
    analysed_ = true;
    ldlt_.factorize(K);
    return ldlt_.info() == Eigen::Success && ldlt_.vectorD().allFinite();
  }

  StaticBody body_;
  Eigen::SimplicialLDLT<SparseMatrix> ldlt_;
  bool analysed_ = false;
  int balances_ = 0;
};

/// Loads that are too close together to look between them.
struct Together {
  double from, to;  // load factors beside them
  int number = 0;
  bool limit = false, gap = false;
};

std::vector<Together> groups_of(std::vector<ReferencePoint> told) {
  std::sort(told.begin(), told.end(),
            [](const ReferencePoint& a, const ReferencePoint& b) { return a.load_factor < b.load_factor; });
  std::vector<Together> groups;
  for (const ReferencePoint& p : told) {
    const double off = std::max(beside, 3 * p.error), from = (1 - off) * p.load_factor,
                 to = (1 + off) * p.load_factor;
    if (groups.empty() || from > groups.back().to) groups.push_back({from, to});
    groups.back().to = std::max(groups.back().to, to);
    ++groups.back().number;
    groups.back().gap = groups.back().gap || p.error > 0.0;
    groups.back().limit = groups.back().limit || p.kind == PointKind::limit_point;
  }
  return groups;
}

class Witness {
 public:
  Witness(const Model& model, const StaticStage& stage, const State& state) : steps_(model, stage, state) {}

  Witnessed run(const Answer& answer, int count) {
    const std::vector<Together> groups = groups_of(answer.loads);
    const double first = groups.empty() ? answer.searched_to : groups.front().from;
    auto start = steps_.unloaded();
    if (!start) return end(Verdict::no_reference, "no balance at load factor 0");
    here_ = std::move(*start);
    int before = 0;
    for (const double part : grid)
      if (!stands(part * first, before)) return result();
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const Together& g = groups[k];
      const Balance calm = here_;
      if (!stands(g.from, before)) return result();
      if (g.limit) {
        if (steps_.next(here_, g.to))
          return end(Verdict::wrong,
                     fmt::format("there is a balance beyond the limit point, at {:.9g}", g.to));
        return result();
      }
      before += g.number;
      const bool may_be_more = before >= count;  // the search ended within a crowd
      const double up_to =
          k + 1 < groups.size() ? groups[k + 1].from : std::numeric_limits<double>::infinity();
      auto there = over(g, calm, up_to);
      if (there && g.gap && there->negative != before && there->negative > before - g.number)
        return end(Verdict::right,
                   fmt::format("told with a gap, behind which {} eigenvalues are negative", there->negative));
      if (!stands_there(std::move(there), g.to, before, may_be_more)) return result();
    }
    if (before < count && answer.searched_to > here_.f()) stands((1 - beside) * answer.searched_to, before);
    return result();
  }

 private:
  /// Beyond the loads of a group, from where it stands beside them; else from `calm` on, and not beyond
  /// up_to.
  std::optional<Balance> over(const Together& g, const Balance& calm, double up_to) {
    if (auto there = steps_.over_load(here_, g.to)) return there;
    const double middle = 0.5 * (g.from + g.to), off = farther * (g.to - middle);
    if (middle - off <= calm.f() || middle + off >= up_to) return {};
    const auto from = steps_.next(calm, middle - off);
    return from ? steps_.over_load(*from, middle + off) : std::nullopt;
  }
  /// Goes to f, where so many eigenvalues must be negative, or fewer: nobody tells where stability is
  /// regained.
  bool stands(double f, int& negative) {
    auto there = steps_.next(here_, f);
    if (there) negative = std::min(negative, there->negative);
    return stands_there(std::move(there), f, negative);
  }
  bool stands_there(std::optional<Balance> there, double f, int negative, bool may_be_more = false) {
    if (!there) {
      end(Verdict::no_reference, fmt::format("the witness has no balance at {:.9g}", f));
      return false;
    }
    if (there->negative == negative || (may_be_more && there->negative > negative)) {
      here_ = std::move(*there);
      result_.searched_to = here_.f();
      return true;
    }
    const bool more = there->negative > negative;
    end(more ? Verdict::missed : Verdict::wrong,
        fmt::format("{} negative eigenvalues at {:.9g}, not {}; from {:.9g} on", there->negative, there->f(),
                    negative, narrowed(*there)));
    return false;
  }
  /// Where the number changes on the way there.
  double narrowed(const Balance& there) {
    double lo = here_.f(), hi = there.f();
    for (int k = 0; k < 12; ++k) {
      const double middle = 0.5 * (lo + hi);
      const auto b = steps_.next(here_, middle);
      (b && b->negative == here_.negative ? lo : hi) = middle;
    }
    return hi;
  }
  Witnessed end(Verdict v, const std::string& why) {
    result_.judgement = {v, why};
    return result();
  }
  Witnessed result() {
    result_.balances = steps_.balances();
    return result_;
  }

  LoadSteps steps_;
  Balance here_;
  Witnessed result_;
};

}  // namespace

Witnessed witness_of(const Model& model, const StaticStage& stage, const State& state, const Answer& answer,
                     int count) {
  return Witness(model, stage, state).run(answer, count);
}

}  // namespace vbond::campaign
