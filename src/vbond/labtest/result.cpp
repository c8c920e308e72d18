#include "vbond/labtest/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/labtest/broken_bonds.hpp"
#include "vbond/labtest/moduli.hpp"
#include "vbond/labtest/rows.hpp"
#include "vbond/observe/files.hpp"

namespace vbond::labtest {
namespace {

/// The last row before so many bonds have broken: at rest just where the break began.
const CurvePoint* point_of_break(const std::vector<Row>& rows, std::int64_t count) {
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k].broken >= count) return &rows[k > 0 ? k - 1 : 0].at;
  return nullptr;
}

/// `listed`: bonds that broke in the run. At rest the last of them are in no row if no balance follows them.
void find_breaks(const std::vector<Row>& rows, std::size_t peak, std::int64_t listed, TestResult& result) {
  result.breaks = std::max(rows.back().broken - rows.front().broken, listed);
  result.breaks_before_peak = rows[peak].broken - rows.front().broken;
  if (result.breaks == 0) return;
  const std::int64_t before = rows.front().broken;
  const CurvePoint* first = point_of_break(rows, before + 1);
  result.first_break = first ? *first : rows.back().at;
  const auto hundredth =
      static_cast<std::int64_t>(std::ceil(0.01 * static_cast<double>(result.breaks_before_peak)));
  if (hundredth < 1) return;
  if (const CurvePoint* at = point_of_break(rows, before + hundredth)) result.one_percent = *at;
}

std::size_t row_of_largest(const std::vector<Row>& rows, std::size_t begin) {
  std::size_t most = begin;
  for (std::size_t k = begin; k < rows.size(); ++k)
    if (rows[k].at.stress > rows[most].at.stress) most = k;
  return most;
}

/// The row of the load at which a disc splits: the first after which breaks take a tenth of it. Its halves
/// may bear more later.
std::optional<std::size_t> row_of_splitting(const std::vector<Row>& rows, std::size_t begin) {
  constexpr double lost = 0.1;
  std::size_t most = begin;
  for (std::size_t k = begin; k < rows.size(); ++k) {
    if (rows[k].at.stress > rows[most].at.stress)
      most = k;
    else if (rows[k].broken > rows[most].broken && rows[k].at.stress <= (1.0 - lost) * rows[most].at.stress)
      return most;
  }
  return std::nullopt;
}

void tell_no_peak(TestResult& result, std::string why) {
  result.notes.push_back(why);
  result.no_peak = std::move(why);
}

/// Tells that a test in motion is over before it was well under way.
bool ended_too_soon(const MadeTest& test, const std::vector<Row>& rows, std::size_t begin, std::size_t peak,
                    TestResult& result) {
  const double strain = rows[peak].at.strain;
  if (test.request.at_rest || (peak - begin >= 20 && strain >= 0.1 * test.end_strain)) return false;
  tell_no_peak(
      result,
      fmt::format("the peak comes after {} rows, at a strain of {:.3g} of {:.3g}, while the platens set in: "
                  "neither a "
                  "strength nor moduli follow; give --strain {:.2g}, about twice the strain at the peak",
                  peak - begin, strain, test.end_strain, 2.0 * strain));
  return true;
}

void find_peak(const MadeTest& test, const std::vector<Row>& rows, std::size_t peak, TestResult& result) {
  if (!test.breaks) {
    tell_no_peak(result, "no bond has a strength: there is no peak to look for");
    return;
  }
  const CurvePoint& most = rows[peak].at;
  if (test.request.kind == Kind::brazilian && row_of_splitting(rows, begin_of(test, rows)) == peak) {
    result.peak = most;
    if (result.largest.stress > most.stress)
      result.notes.push_back(fmt::format(
          "the disc splits at this stress; its parts are pressed on and bear {:.7g} later, at a strain "
          "of {:.6g}: that is no strength of the disc",
          result.largest.stress, result.largest.strain));
    return;
  }
  double least_after = rows[peak].at.stress;
  for (std::size_t k = peak; k < rows.size(); ++k) least_after = std::min(least_after, rows[k].at.stress);
  const bool collapsed = result.ended == "parted" || result.ended == "lost stability" ||
                         result.ended == "peak" ||
                         result.ended == "load drop";  // by the force on the upper end
  if (most.stress > 0.0 && (collapsed || least_after <= (1.0 - test.request.drop) * most.stress)) {
    const bool unstable = result.ended == "lost stability";
    if (result.ended == "parted" && least_after > (1.0 - test.request.drop) * most.stress)
      result.notes.push_back(fmt::format(
          "the test ended where loads drive off a part that nothing holds, with {:.2g} of the largest "
          "stress left: the strength may be larger; the message of the run names the part",
          least_after / most.stress));
    if (!unstable || result.breaks > 0 || test.gives_way) result.peak = most;
    if (unstable && result.breaks == 0 && test.gives_way)
      result.notes.push_back(
          "the body lost stability before a bond broke: bonds that soften, or stretch by a curve, bear no "
          "more "
          "than this, or it has buckled; what it would bear then is not known");
    else if (unstable && result.breaks == 0)
      tell_no_peak(result,
                   "the body lost stability before a bond broke: it has buckled, and has no strength");
    else if (unstable)
      result.notes.push_back(
          "the body lost stability: there is no balance beyond, and what it would bear then is not known");
    return;
  }
  tell_no_peak(result,
               fmt::format("no peak within the strain of {:.6g}: the stress has not fallen by {:.3g} of its "
                           "largest value; give a "
                           "larger --strain{}",
                           test.end_strain, test.request.drop, result.breaks == 0 ? "; no bond broke" : ""));
}

/// Of a notched beam, once its peak is known.
void find_toughness(const MadeTest& test, const std::vector<Row>& rows, std::size_t begin,
                    TestResult& result) {
  Toughness& t = *result.toughness;
  if (!result.peak) return;
  t.K_Ic = result.peak->force * test.notch->toughness_per_force;
  if (test.request.modulus) t.G_Ic = sq(*t.K_Ic) / *test.request.modulus;
  if (!test.request.at_rest) return;  // what waves and damping take is no work of fracture
  const double left = rows.back().at.force / result.peak->force;
  if (left > force_gone) return result.notes.push_back(no_work_of_fracture(left));
  double work = 0;  // at rest history.csv has none of supports; between two rows the body is elastic
  for (std::size_t k = begin; k + 1 < rows.size(); ++k)
    work += 0.5 * (rows[k].at.force + rows[k + 1].at.force) * (rows[k + 1].at.strain - rows[k].at.strain) /
            test.strain_per_way;
  t.work_of_fracture = work / test.notch->ligament();
}

/// Until the peak. If bonds break from the row before it on, that is the last: what they set free is no fault
/// of the rate.
Inertia inertia_of(const std::vector<Row>& rows, std::size_t peak) {
  if (peak > 0 && rows[peak].broken > rows[peak - 1].broken) --peak;
  Inertia found;
  const auto share = [](const Row& r) { return r.work > 0.0 ? r.kinetic / r.work : 0.0; };
  found.at_peak = share(rows[peak]);
  const CurvePoint& most = rows[peak].at;
  for (std::size_t k = 0; k <= peak; ++k) {
    if (rows[k].at.stress >= 0.1 * most.stress) found.largest = std::max(found.largest, share(rows[k]));
    if (rows[k].at.stress >= 0.5 * most.stress && most.force > 0.0)
      found.ends_differ = std::max(found.ends_differ, std::abs(rows[k].off_balance) / most.force);
  }
  return found;
}

constexpr const char* not_quasi_static = "not quasi-static";

void tell_inertia(const MadeTest& test, TestResult& result) {
  if (result.inertia->quasi_static()) return;
  result.notes.push_back(fmt::format(
      "{}: kinetic energy is {:.2g} of the work at the peak and up to {:.2g} before it, forces "
      "on "
      "the ends differ by {:.2g} of the peak; moduli are off then, and strengths mostly too large: give a "
      "smaller --rate, as {:.2g}",
      not_quasi_static, result.inertia->at_peak, result.inertia->largest, result.inertia->ends_differ,
      0.1 * test.rate));
}

/// A disc that splits by tension does so at once. One that bears on while bonds break has a peak of its ends
/// and wedges.
void tell_peak_of_disc(const std::vector<Row>& rows, std::size_t begin, std::size_t peak,
                       TestResult& result) {
  constexpr double well_below = 0.8;  // of the peak
  const bool splits = row_of_splitting(rows, begin).has_value();
  const auto reaches = [&](const Row& r) { return r.at.stress >= well_below * rows[peak].at.stress; };
  const auto first = rows.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto there = std::find_if(first, rows.end(), reaches);  // the peak at the latest
  const double part = share_broken(rows, there == first ? *there : *std::prev(there), peak);
  result.peak_in_doubt = !splits || part > many_early;
  if (!result.peak_in_doubt) return;
  std::string why = "the peak is no tensile strength: a disc that splits by tension does so at once";
  if (part > many_early)
    why += fmt::format("; {:.2g} of the {} breaks before it come below {} of it, the first at {:.7g}", part,
                       result.breaks_before_peak, well_below, result.first_break->stress);
  if (!splits) why += "; here no break takes a tenth of its load";
  if (result.largest_fragment)
    why += fmt::format("; at the end its largest fragment has {:.3g} of the mass", *result.largest_fragment);
  result.notes.push_back(why + "; the first break is nearer to it, and vbond test tension tells it");
}

/// What the body bears before the test, if it is much.
void tell_stress_before(const MadeTest& test, TestResult& result) {
  if (!test.request.at_rest || test.confinement) return;  // the pressure's part is known
  const auto& E = result.modulus ? result.modulus : result.modulus_by_ends;
  const double much = test.breaks ? 1e-3 * std::abs(result.largest.stress) : E ? 1e-6 * std::abs(*E) : 0.0;
  if (std::abs(result.stress_before) <= much) return;
  result.notes.push_back(
      fmt::format("the body bears a stress of {:.6g} between its ends before the test: strains count from "
                  "there, stresses "
                  "include it, and moduli are those of the body under it",
                  result.stress_before));
}

/// What run.json tells beside the tables.
struct RunEnd {
  std::string ended;       ///< how the last stage ended
  double used_before = 0;  ///< the most that a bond has used of its strength before any could break
};
RunEnd end_of_run(const std::filesystem::path& file) {
  const auto run = nlohmann::json::parse(read_all(file), nullptr, false);
  if (run.is_discarded() || !run.contains("stages") || run["stages"].empty())
    throw IoError(file.string() + ": it tells of no stage");
  RunEnd end;
  const auto& last = run["stages"].back();
  for (const char* key : {"ended", "stop"})
    if (last.contains(key) && last[key].is_string()) end.ended = last[key].get<std::string>();
  for (const auto& stage : run["stages"])
    if (stage.contains("most_used_bond") && stage["most_used_bond"].contains("utilisation"))
      end.used_before = std::max(end.used_before, stage["most_used_bond"]["utilisation"].get<double>());
  return end;
}

}  // namespace

TestResult result_of(const MadeTest& test, const std::filesystem::path& folder) {
  TestResult result;
  const std::vector<Row> rows = read_rows(test, folder / "history.csv");
  const RunEnd end = end_of_run(folder / "run.json");
  result.ended = end.ended;
  const std::size_t begin = begin_of(test, rows), largest = row_of_largest(rows, begin);
  std::size_t peak = largest;
  if (test.request.kind == Kind::brazilian) peak = row_of_splitting(rows, begin).value_or(largest);
  find_elastic(test, rows, peak, result);
  result.largest = rows[largest].at;
  if (test.breaks && end.used_before >= 1.0) {
    tell_stress_before(test, result);
    tell_no_peak(result, fmt::format("a bond is at {:.4g} of its strength before any may break, at a strain "
                                     "of {:g}: no strength follows; "
                                     "let the body come to rest unloaded, or give bonds more strength",
                                     end.used_before, elastic_strain));
    return result;
  }
  const bool any_listed = std::filesystem::exists(folder / "breaks.csv");
  const std::vector<FirstBreak> breaks = any_listed ? breaks_of(folder) : std::vector<FirstBreak>{};
  find_breaks(rows, peak, static_cast<std::int64_t>(breaks.size()), result);
  find_peak(test, rows, peak, result);
  if (result.peak && ended_too_soon(test, rows, begin, peak, result))
    result.peak.reset(), result.modulus.reset(), result.modulus_by_ends.reset(), result.nu.reset();
  if (result.toughness) find_toughness(test, rows, begin, result);
  tell_stress_before(test, result);
  result.fragments = rows.back().fragments, result.largest_fragment = rows.back().largest_fragment;
  if (!test.request.at_rest) {
    result.inertia = inertia_of(rows, peak);
    tell_inertia(test, result);
  }
  if (result.breaks == 0) return result;
  if (!breaks.empty()) result.first_break_at = breaks.front();
  if (test.request.kind == Kind::bend3 && result.first_break_at) tell_break_of_beam(test, result);
  if (test.request.kind == Kind::brazilian) {
    result.splitting = splitting_of(test, breaks);
    if (result.splitting && result.splitting->first_from_middle > 0.8) {
      result.peak.reset();
      tell_no_peak(result, "the first break is at a platen, not in the middle: it has no tensile strength");
    }
    if (result.peak) tell_peak_of_disc(rows, begin, peak, result);
  }
  return result;
}

std::string why_no_strength(const TestResult& result) {
  if (!result.peak) return result.no_peak;
  if (!result.inertia || result.inertia->quasi_static()) return "";
  for (const std::string& note : result.notes)
    if (note.starts_with(not_quasi_static)) return note;
  return not_quasi_static;
}

}  // namespace vbond::labtest
