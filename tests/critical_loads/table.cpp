#include "table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace vbond::campaign {
namespace {

using Counts = std::array<int, verdicts>;

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string loads_of(const std::vector<ReferencePoint>& points) {
  std::string text;
  for (const ReferencePoint& p : points)
    text += fmt::format(" {}{:.9g}", p.kind == PointKind::limit_point ? "L" : "B", p.load_factor);
  return text.empty() ? " none" : text;
}

void print_row(const std::string& kind, const Counts& counts) {
  int all = 0;
  for (const int n : counts) all += n;
  fmt::print("{:24}{:7}", kind, all);
  for (const int n : counts) fmt::print("{:>13}", n == 0 ? "." : std::to_string(n));
  fmt::print("\n");
}

/// Returns the sums over all kinds.
template <class F>
Counts print_counts(const char* title, const std::vector<CaseRecord>& records, F&& verdict_of) {
  std::map<std::string, Counts> by_kind;
  Counts sums{};
  for (const CaseRecord& r : records) {
    const auto v = static_cast<std::size_t>(verdict_of(r));
    ++by_kind.try_emplace(r.kind, Counts{}).first->second[v];
    ++sums[v];
  }
  fmt::print("\n{:24}{:>7}", title, "cases");
  for (int v = 0; v < verdicts; ++v) fmt::print("{:>13}", name_of(static_cast<Verdict>(v)));
  fmt::print("\n");
  for (const auto& [kind, counts] : by_kind) print_row(kind, counts);
  print_row("all", sums);
  return sums;
}

int went_over(const std::vector<CaseRecord>& records) {
  return static_cast<int>(std::count_if(records.begin(), records.end(), [](const CaseRecord& r) {
    const auto over = [](const Judgement& j) { return j.verdict == Verdict::right && !j.why.empty(); };
    return over(r.of_buckling) || over(r.of_path);
  }));
}

bool too_many(const Counts& c, std::size_t all) {
  const auto of = [&c](Verdict v) { return c[static_cast<std::size_t>(v)]; };
  return of(Verdict::missed) + of(Verdict::wrong) + of(Verdict::aborted) > 0 ||
         of(Verdict::gave_up) + of(Verdict::short_of) > 0.005 * static_cast<double>(all) ||
         of(Verdict::no_reference) > 0.02 * static_cast<double>(all);
}

template <class F>
void print_most(const char* title, std::vector<CaseRecord> records, F&& value) {
  std::sort(records.begin(), records.end(),
            [&](const CaseRecord& a, const CaseRecord& b) { return value(a) > value(b); });
  fmt::print("\n{}\n", title);
  for (std::size_t k = 0; k < std::min<std::size_t>(10, records.size()); ++k) {
    const CaseRecord& r = records[k];
    fmt::print("  {:9.3g}  case {}: buckling {:.3g} s, {} factors; path {:.3g} s, {} factors; {}, {}\n",
               value(r), r.number, r.buckling.seconds, r.buckling.factors, r.path.seconds, r.path.factors,
               r.kind, r.what);
  }
}

double factor_ratio(const CaseRecord& r) {
  return r.path.factors == 0 ? 0.0 : static_cast<double>(r.buckling.factors) / r.path.factors;
}

}  // namespace

void print_case(const CaseRecord& r) {
  fmt::print("case {} {}: {}\n  reference{}, {}, searched to {:.6g}, {} balances, {:.2g} s\n", r.number,
             r.kind, r.what, loads_of(r.reference.points), r.reference.ended, r.reference.searched_to,
             r.reference.nodes, r.reference_seconds);
  const auto line = [](const char* name, const Answer& a, const Judgement& j) {
    fmt::print("  {} {}:{}, {}, searched to {:.6g}, {} factors, {:.2g} s{}{}\n", name, name_of(j.verdict),
               loads_of(a.loads), a.failure.empty() ? "ended \"" + a.ended + "\"" : a.failure, a.searched_to,
               a.factors, a.seconds, j.why.empty() ? "" : "\n    ", first_line(j.why));
  };
  line("buckling", r.buckling, r.of_buckling);
  line("path", r.path, r.of_path);
}

int print_table(std::vector<CaseRecord> records) {
  std::sort(records.begin(), records.end(),
            [](const CaseRecord& a, const CaseRecord& b) { return a.number < b.number; });
  fmt::print("\nNot right:\n");
  for (const CaseRecord& r : records)
    if (r.of_buckling.verdict != Verdict::right || r.of_path.verdict != Verdict::right) print_case(r);
  const Counts buckling =
      print_counts("buckling", records, [](const CaseRecord& r) { return r.of_buckling.verdict; });
  const Counts path = print_counts("path", records, [](const CaseRecord& r) { return r.of_path.verdict; });
  fmt::print("\n{} of them are right as judge.hpp lets pass where branches pass each other close by\n",
             went_over(records));
  print_most("Slowest  [s]", records,
             [](const CaseRecord& r) { return std::max(r.buckling.seconds, r.path.seconds); });
  print_most("Most factors of buckling for each of the path", records, factor_ratio);
  double b = 0, p = 0, t = 0;
  for (const CaseRecord& r : records) b += r.buckling.seconds, p += r.path.seconds, t += r.reference_seconds;
  const auto n = static_cast<double>(std::max<std::size_t>(records.size(), 1));
  fmt::print("\nper case: buckling {:.3g} s, path {:.3g} s, reference {:.3g} s\n", b / n, p / n, t / n);
  return too_many(buckling, records.size()) || too_many(path, records.size()) ? 1 : 0;
}

}  // namespace vbond::campaign
