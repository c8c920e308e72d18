#include "judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "child.hpp"
#include "records.hpp"
#include "vbond/core/error.hpp"
#include "vbond/statics/statics.hpp"

namespace vbond::campaign {
namespace {

constexpr int longest_run = 60;  // seconds of the processor
constexpr int longest_reference = 300;
constexpr double close_by = 1e-4;            // branches that pass each other, in loads
constexpr double least_imperfection = 1e-4;  // below: the perfect body's answer is right, too

const char* name_of(PointKind kind) {
  return kind == PointKind::limit_point ? "limit point" : "bifurcation";
}

bool is_bad(const Judgement& j) {
  return j.verdict == Verdict::missed || j.verdict == Verdict::wrong;
}

std::string text_of(const ReferencePoint& p) {
  return fmt::format("{} at {:.9g}", name_of(p.kind), p.load_factor);
}

double tolerance_of(const ReferencePoint& p, const Tolerance& t) {
  return std::min(std::max(t.least, 4 * p.error), 0.1);
}

/// Both kinds stand so close together that they may be told in either order.
bool kinds_agree(const ReferencePoint& told, const Reference& reference, std::size_t k, const Tolerance& t) {
  const auto& points = reference.points;
  for (const ReferencePoint& p : points)
    if (p.kind == told.kind &&
        std::abs(p.load_factor / points[k].load_factor - 1) <= std::max(1e-5, tolerance_of(p, t)))
      return true;
  return false;
}

/// Where branches pass each other close by, a walker may go over to the other: see Tolerance.
bool went_over(const ReferencePoint& told, const Reference& reference) {
  for (const double f : reference.passings)
    if (std::abs(told.load_factor / f - 1) < close_by) return true;
  return false;
}

/// One load that was told against its number of the reference. Right means that both agree so far.
Judgement compare_with_number(const ReferencePoint& told, const Reference& reference, std::size_t k,
                              const Tolerance& t) {
  if (k >= reference.points.size()) {
    const bool known =
        told.load_factor < (1 - t.least) * reference.searched_to || reference.ended == "limit point";
    if (!known) return {Verdict::no_reference, "reference ended: " + reference.ended};
    return {Verdict::wrong, text_of(told) + ", where the reference has none"};
  }
  const ReferencePoint& true_one = reference.points[k];
  const double off = told.load_factor / true_one.load_factor - 1, tolerance = tolerance_of(true_one, t);
  if (std::abs(off) <= tolerance) {
    if (kinds_agree(told, reference, k, t)) return {};
    return {Verdict::wrong, fmt::format("{}, which is a {}", text_of(told), name_of(true_one.kind))};
  }
  const std::string both =
      fmt::format("{}, true is {} (off by {:.2g})", text_of(told), text_of(true_one), off);
  return {off > 1e-3 ? Verdict::missed : Verdict::wrong, both};
}

/// Told with a gap: there two paths of a body that is not quite symmetric pass each other.
bool within_its_gap(const ReferencePoint& told, const Reference& reference) {
  const auto near = [&told](double f) { return std::abs(told.load_factor / f - 1) <= 3 * told.error; };
  return std::any_of(reference.passings.begin(), reference.passings.end(), near) ||
         std::any_of(reference.points.begin(), reference.points.end(),
                     [&near](const ReferencePoint& p) { return near(p.load_factor); });
}

/// The same where branches may have been changed.
Judgement compare(const ReferencePoint& told, const Reference& reference, std::size_t k, const Tolerance& t) {
  Judgement j = compare_with_number(told, reference, k, t);
  if (is_bad(j) && told.error > 0.0 && within_its_gap(told, reference))
    j = {Verdict::right, "told with a gap in which it lies"};
  if (is_bad(j) && went_over(told, reference))
    j = {Verdict::right, "went over to a branch that passes close by"};
  return j;
}

Judgement judge_failure(const Answer& a) {
  if (a.failure == "gave up") return {Verdict::gave_up, a.message};
  return {Verdict::aborted, a.message};
}

/// Nothing more was told, and the reference has another.
Judgement judge_silence(const Answer& a, const ReferencePoint& next, const Tolerance& t) {
  const std::string why =
      fmt::format("not told: {}; ended \"{}\", searched to {:.6g}", text_of(next), a.ended, a.searched_to);
  if (a.ended == "bond range" && next.beyond_range) return {};
  const bool claims = a.ended == "converged" || a.ended == "limit point" ||
                      a.searched_to > (1 + tolerance_of(next, t)) * next.load_factor;
  return {claims ? Verdict::missed : Verdict::short_of, why};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void take(Answer& a, const StaticStage& stage, const StaticResult& result) {
  a.ended = result.ended, a.factors = result.factors;
  a.searched_to = stage.kind == StageKind::path ? result.load_factor : result.searched_to;
  for (const CriticalLoad& c : result.critical_loads)
    a.loads.push_back({c.kind, c.load_factor, c.gap / std::abs(c.load_factor), false, false});
  for (const SpecialPoint& p : result.special_points)
    a.loads.push_back({p.kind, p.load_factor, p.gap / std::abs(p.load_factor),
                       p.unstable_after < p.unstable_before, false});
}

Answer ask_in_child(const BodyPlan& plan, const StaticStage& stage) {
  return answer_in_child(
      [&] {
        const testing::Specimen s = specimen_of(plan);
        return answer_of_stage(s.model, s.state, stage, Until::first_special_point);
      },
      longest_run);
}

Reference reference_in_child(const BodyPlan& plan, int count, bool near_by = false) {
  const auto work = [&] {
    const testing::Specimen s = specimen_of(plan);
    return nlohmann::json(find_reference(s.model, stage_of(plan, StageKind::buckling), s.state,
                                         {count, 0, near_by, 6000}))
        .dump();
  };
  const ChildResult child = in_child(work, longest_reference);
  if (child.fate.empty()) return nlohmann::json::parse(child.text).get<Reference>();
  Reference r;
  r.ended = child.fate, r.undecided = true;
  return r;
}

/// Right if the first load that was told is the perfect body's.
void accept_perfect(Judgement& j, const Answer& a, const Reference& of_perfect, double tolerance) {
  if (!is_bad(j) || a.loads.empty() || of_perfect.points.empty()) return;
  if (std::abs(a.loads[0].load_factor / of_perfect.points[0].load_factor - 1) < tolerance)
    j = {Verdict::right, "as the perfect body"};
}

/// The path turns by this much, or more, within three times the gap that was told.
bool turns_within_gap(const ReferencePoint& told, const Reference& reference) {
  constexpr double least_turn = 0.3;  // [rad]
  const double half = 3 * told.error * std::abs(told.load_factor);
  double before = 0.0, after = 0.0;
  for (const Reference::Turning& t : reference.turning) {
    after = t.turned;
    if (t.load_factor < told.load_factor - half) before = t.turned;
    if (t.load_factor > told.load_factor + half) break;
  }
  return after - before >= least_turn;
}

/// The answer without its remarks on a gap: what it says of branches that pass each other where the perfect
/// body has a critical load, or where the path itself turns.
Answer without_remarks(const Answer& a, const Reference& reference, const Reference& of_perfect) {
  Answer rest = a;
  std::erase_if(rest.loads, [&](const ReferencePoint& told) {
    const auto near = [&told](const ReferencePoint& p) {
      return std::abs(told.load_factor / p.load_factor - 1) <= 3 * told.error;
    };
    return told.error > 0.0 && (std::any_of(of_perfect.points.begin(), of_perfect.points.end(), near) ||
                                turns_within_gap(told, reference));
  });
  return rest;
}

/// Remarks taken out: of buckling the rest is judged, of a path nothing else was asked.
void judge_without_remarks(const RandomCase& c, CaseRecord& r) {
  const Reference of_perfect = reference_in_child(perfect(c.plan), c.count);
  const Answer buckling = without_remarks(r.buckling, r.reference, of_perfect),
               path = without_remarks(r.path, r.reference, of_perfect);
  const int fewer = static_cast<int>(r.buckling.loads.size() - buckling.loads.size());
  if (is_bad(r.of_buckling) && fewer > 0) {
    r.of_buckling = judge_buckling(buckling, r.reference, c.count - fewer, {});
    if (r.of_buckling.verdict == Verdict::right) r.of_buckling.why = "right, with a remark on a gap";
  }
  if (is_bad(r.of_path) && path.loads.size() < r.path.loads.size())
    r.of_path = {Verdict::right, "a remark on a gap"};
}

/// The perfect body decides as well, and a path that sees branches pass by from near: see Tolerance.
void judge_as_nearly_perfect(const RandomCase& c, CaseRecord& r) {
  const Reference near = reference_in_child(c.plan, c.count, true);
  if (is_bad(r.of_buckling) && judge_buckling(r.buckling, near, c.count, {}).verdict == Verdict::right)
    r.of_buckling = {Verdict::right, "as the path seen from near"};
  if (is_bad(r.of_path) && judge_path(r.path, near, {}).verdict == Verdict::right)
    r.of_path = {Verdict::right, "as the path seen from near"};
  const Reference of_perfect = reference_in_child(perfect(c.plan), 1);
  const double tolerance = 1e-6 + 0.1 * std::sqrt(c.plan.imperfection);
  accept_perfect(r.of_buckling, r.buckling, of_perfect, tolerance);
  accept_perfect(r.of_path, r.path, of_perfect, tolerance);
}

bool ends_at(Until until, PointKind kind) {
  switch (until) {
    case Until::end: return false;
    case Until::first_special_point: return kind == PointKind::limit_point || kind == PointKind::bifurcation;
    case Until::first_limit_point: return kind == PointKind::limit_point;
  }
  return false;
}

}  // namespace

const char* name_of(Verdict v) {
  switch (v) {
    case Verdict::right: return "right";
    case Verdict::missed: return "missed";
    case Verdict::wrong: return "wrong";
    case Verdict::short_of: return "short";
    case Verdict::gave_up: return "gave up";
    case Verdict::aborted: return "aborted";
    case Verdict::no_reference: break;
  }
  return "no reference";
}

Answer answer_of_stage(const Model& model, const State& state, const StaticStage& stage, Until until) {
  Answer a;
  bool seen = false;
  StaticHooks hooks;
  hooks.point = [&](const StaticPoint& p) {
    seen = seen || (stage.kind == StageKind::path && ends_at(until, p.kind));
  };
  hooks.interrupted = [&seen] { return seen; };
  const auto start = std::chrono::steady_clock::now();
  try {
    take(a, stage, run_static_stage(model, stage, state, hooks).result);
  } catch (const StaticStageFailed& e) {
    take(a, stage, e.found);
    a.failure = "gave up", a.message = e.what();
  } catch (const NoEquilibrium& e) {
    a.failure = "gave up", a.message = e.what();
  }
  a.seconds = seconds_since(start);
  return a;
}

Answer answer_in_child(const std::function<Answer()>& ask, int seconds) {
  const auto start = std::chrono::steady_clock::now();
  const ChildResult child = in_child([&] { return nlohmann::json(ask()).dump(); }, seconds);
  if (child.fate.empty()) return nlohmann::json::parse(child.text).get<Answer>();
  Answer a;
  a.failure = "aborted", a.message = child.fate, a.seconds = seconds_since(start);
  return a;
}

Judgement judge_buckling(const Answer& a, const Reference& path, int count, const Tolerance& t) {
  if (!a.failure.empty() && a.loads.empty()) return judge_failure(a);
  Reference reference = path;
  std::erase_if(reference.points, [](const ReferencePoint& p) { return p.regained; });
  std::vector<ReferencePoint> told = a.loads;
  std::sort(told.begin(), told.end(),
            [](const ReferencePoint& x, const ReferencePoint& y) { return x.load_factor < y.load_factor; });
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    if (k < told.size()) {
      const Judgement j = compare(told[k], reference, k, t);
      if (j.verdict == Verdict::no_reference && k > 0) return {};  // right as far as is known
      if (j.verdict != Verdict::right || !j.why.empty()) return j;
    } else if (!a.failure.empty()) {
      return judge_failure(a);
    } else if (k < reference.points.size()) {
      return judge_silence(a, reference.points[k], t);
    } else {
      if (k == 0 && reference.undecided && a.searched_to > reference.searched_to)
        return {Verdict::no_reference, "reference ended: " + reference.ended};
      return {};
    }
  }
  return {};
}

Judgement judge_path(const Answer& a, const Reference& reference, const Tolerance& t) {
  if (!a.loads.empty()) return compare(a.loads[0], reference, 0, t);
  if (!a.failure.empty()) return judge_failure(a);
  if (!reference.points.empty()) return judge_silence(a, reference.points[0], t);
  if (reference.undecided && a.searched_to > reference.searched_to)
    return {Verdict::no_reference, "reference ended: " + reference.ended};
  return {};
}

StaticStage buckling_stage_of(const RandomCase& c) {
  StaticStage stage = stage_of(c.plan, StageKind::buckling);
  stage.count = c.count;
  stage.frames_per_mode = 0;
  return stage;
}

StaticStage path_stage_of(const RandomCase& c, const Reference& reference) {
  StaticStage stage = stage_of(c.plan, StageKind::path);
  const bool none = reference.points.empty();
  const double f = none ? std::max(0.1 * reference.searched_to, 1e-300) : reference.points[0].load_factor;
  stage.path.first_step = c.first_step * f;
  stage.path.largest_step = c.largest_step;
  stage.path.most_points = 3000;
  stage.path.above = none ? f : 1.2 * f;
  return stage;
}

CaseRecord run_case(const RandomCase& c) {
  CaseRecord r;
  r.number = c.number, r.kind = c.plan.kind, r.what = c.plan.what;
  r.buckling = ask_in_child(c.plan, buckling_stage_of(c));
  const auto start = std::chrono::steady_clock::now();
  r.reference = reference_in_child(c.plan, c.count);
  if (c.plan.closed_form && !r.reference.points.empty()) {
    ReferencePoint& first = r.reference.points[0];
    if (std::abs(first.load_factor / *c.plan.closed_form - 1) > tolerance_of(first, {}))
      r.reference.ended = fmt::format("not the closed form's {:.12g}", *c.plan.closed_form),
      r.reference.undecided = true, r.reference.points.clear(), r.reference.searched_to = 0;
  }
  r.reference_seconds = seconds_since(start);
  r.path = ask_in_child(c.plan, path_stage_of(c, r.reference));
  r.of_buckling = judge_buckling(r.buckling, r.reference, c.count, {});
  r.of_path = judge_path(r.path, r.reference, {});
  const bool nearly_perfect = c.plan.imperfection > 0.0 && c.plan.imperfection <= least_imperfection;
  if (nearly_perfect && (is_bad(r.of_buckling) || is_bad(r.of_path))) judge_as_nearly_perfect(c, r);
  if (c.plan.imperfection > 0.0 && (is_bad(r.of_buckling) || is_bad(r.of_path))) judge_without_remarks(c, r);
  return r;
}

}  // namespace vbond::campaign
