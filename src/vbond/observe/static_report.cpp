#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "vbond/observe/table_text.hpp"

namespace vbond {
namespace {

const char* in_words(PointKind kind) {
  switch (kind) {
    case PointKind::regular: return "";
    case PointKind::limit_point: return "limit point";
    case PointKind::bifurcation: return "bifurcation";
    case PointKind::critical: return "critical";
    case PointKind::broken: return "broken";
    case PointKind::end: return "end";
  }
  return "";
}

std::string count_or_dash(const std::optional<int>& n) {
  return n ? fmt::format("{}", *n) : "-";
}

/// A balance beyond the strength of a bond must not look like any other.
std::string strength(const StaticResult& r) {
  if (!r.most_used) return "";
  const BondUse& u = *r.most_used;
  return fmt::format("{}bond {} (particles {}, {}) used {:.6g} of its strength at load factor {:.6g}{}\n",
                     u.utilisation >= 1.0 ? "BEYOND STRENGTH: " : "", u.bond.value, u.i.value, u.j.value,
                     u.utilisation, u.load_factor,
                     u.utilisation >= 1.0 ? ": bonds do not break in this kind of stage, but in "
                                            "kind = \"fracture\""
                                          : ", the most of all");
}

std::string or_dash(const std::optional<double>& x) {
  return x ? fmt::format("{:.8g}", *x) : "-";
}

std::string breaks(const FractureResult& f) {
  if (f.breaks.empty()) return fmt::format("no bond broke; largest load {:.8g}\n", f.peak_load);
  constexpr std::size_t shown = 25;
  std::string text =
      fmt::format("{:>6} {:>9} {:>8} {:>15} {:>14} {:>14} {:>14} {:>12}\n", "break", "avalanche", "bond",
                  "particles", "load factor", "load", "load after", "released");
  for (std::size_t k = 0; k < std::min(shown, f.breaks.size()); ++k) {
    const BrokenBond& b = f.breaks[k];
    text += fmt::format("{:>6} {:>9} {:>8} {:>15} {:>14.8g} {:>14.8g} {:>14} {:>12.5e}\n", k + 1, b.avalanche,
                        b.use.bond.value, fmt::format("{}-{}", b.use.i.value, b.use.j.value),
                        b.use.load_factor, b.load, or_dash(b.load_after), b.released);
  }
  if (f.breaks.size() > shown)
    text += fmt::format("{:>6} {} more in fracture.csv\n", "and", f.breaks.size() - shown);
  text += fmt::format(
      "{} bond{} broke in {} avalanche{}, {} in the largest; peak load {:.8g} at load factor "
      "{:.8g}\n",
      f.breaks.size(), f.breaks.size() == 1 ? "" : "s", f.avalanches, f.avalanches == 1 ? "" : "s",
      f.largest_avalanche, f.peak_load, f.peak_load_factor);
  if (f.released_parts > 0)
    text += fmt::format("{} time{} a part came off that nothing held any more\n", f.released_parts,
                        f.released_parts == 1 ? "" : "s");
  const std::string dissipated =
      f.books.dissipated != 0.0 ? fmt::format(" + dissipated {:.6g}", f.books.dissipated) : "";
  return text + fmt::format(
                    "energy: initial {:.6g} + work {:.6g} = stored {:.6g}{} + released {:.6g}, to "
                    "{:.1e}\n",
                    f.books.initial, f.books.work, f.books.stored, dissipated, f.books.released,
                    std::abs(f.books.error()));
}

std::string stability(const StaticResult& r) {
  std::string text = balance_in_words(r);
  if (r.smallest_eigenvalue) text += fmt::format(", smallest eigenvalue {:.6g}", *r.smallest_eigenvalue);
  if (r.free_turns > 0) text += fmt::format("; {} turns meet no stiffness", r.free_turns);
  if (r.jumped) text += "; the body jumped on the way";
  if (r.left_saddle) text += "; an unstable balance was left on the way";
  return text + '\n' + strength(r);
}

std::string special_points(const StaticResult& r) {
  if (r.special_points.empty())
    return r.unstable ? "stability does not change on the way\n" : "no limit point on the way\n";
  std::string text = fmt::format("{:>12} {:>16} {:>8} {:>18}\n", "", "load factor", "point", "unstable");
  for (const SpecialPoint& s : r.special_points)
    text += fmt::format(
        "{:>12} {:>16.8g} {:>8} {:>18}\n", in_words(s.kind), s.load_factor, s.point,
        fmt::format("{} -> {}", count_or_dash(s.unstable_before), count_or_dash(s.unstable_after)));
  return text;
}

std::string in_words(const Wave& w) {
  return fmt::format("({:.8g}, {:.8g}, {:.8g}), phases {:.8g}, {:.8g}, {:.8g}", w.q.x, w.q.y, w.q.z,
                     w.edges.x, w.edges.y, w.edges.z);
}

std::string critical_loads(const StaticResult& r) {
  if (r.critical_loads.empty()) return fmt::format("none up to load factor {:.8g}\n", r.searched_to);
  const bool any_moves = r.critical_loads[0].reaction.has_value();
  std::string text =
      fmt::format("{:>6} {:>12} {:>16} {:>16} {:>16}{}\n", "mode", "", "load factor", "linear estimate",
                  "force", any_moves ? fmt::format(" {:>16} {:>16}", "displacement", "reaction") : "");
  for (std::size_t k = 0; k < r.critical_loads.size(); ++k) {
    const CriticalLoad& c = r.critical_loads[k];
    text += fmt::format(
        "{:>6} {:>12} {:>16.8g} {:>16} {:>16}{}{}{}\n", k + 1, in_words(c.kind), c.load_factor,
        or_dash(c.estimate), c.force != 0.0 ? fmt::format("{:.8g}", c.force) : "-",
        any_moves ? fmt::format(" {:>16} {:>16}", or_dash(c.displacement), or_dash(c.reaction)) : "",
        c.gap > 0.0 ? fmt::format("  load factor +- {:.1g}", c.gap) : "",
        c.wave > 0
            ? fmt::format("  wave {}: {}", c.wave, in_words(r.waves[static_cast<std::size_t>(c.wave - 1)]))
            : "");
  }
  return text + fmt::format("no others up to load factor {:.8g}\n", r.searched_to);
}

std::string frequencies(const StaticResult& r, const std::string& time_unit) {
  if (r.modes.empty()) return "no mode was found\n";
  int wave = 0;
  const bool si = !time_unit.empty();
  std::string text = fmt::format("{:>6} {:>16} {:>16} {:>16}\n", "mode", si ? "omega [rad/s]" : "omega",
                                 si ? "frequency [Hz]" : "frequency",
                                 si ? "period [" + time_unit.substr(1) + "]" : "period");
  for (std::size_t k = 0; k < r.modes.size(); ++k) {
    const NaturalMode& m = r.modes[k];
    if (m.wave != wave) {
      wave = m.wave;
      text += fmt::format("wave {}: {}\n", wave, in_words(r.waves[static_cast<std::size_t>(wave - 1)]));
    }
    text += m.rigid ? fmt::format("{:>6} {:>16}\n", k + 1, "rigid")
            : m.omega2 <= 0.0
                ? fmt::format("{:>6} {:>16}  omega^2 = {:.8g}\n", k + 1, "UNSTABLE", m.omega2)
                : fmt::format("{:>6} {:>16.8g} {:>16.8g} {:>16.8g}\n", k + 1, m.omega,
                              m.omega / (2.0 * std::numbers::pi), 2.0 * std::numbers::pi / m.omega);
  }
  return text;
}

}  // namespace

std::string static_table_header() {
  return fmt::format("{:>12} {:>16} {:>13} {:>10} {:>12} {:>8} {:>8}\n", "step", "load factor", "point",
                     "unstable", "potential", "strained", "snapped");
}

std::string static_table_row(std::int64_t step, const BalancePoint& b, const Energies& energies,
                             const RangeCounts& ranges) {
  return fmt::format("{:12} {:16.8g} {:>13} {:>10} {:12.4e} {:8} {:8}\n", step, b.load_factor,
                     in_words(b.kind), count_or_dash(b.unstable), energies.potential(), ranges.strained,
                     ranges.snapped);
}

std::string balance_in_words(const StaticResult& r) {
  if (r.unstable.value_or(0) > 0)
    return fmt::format("UNSTABLE in {} direction{}", *r.unstable, *r.unstable == 1 ? "" : "s");
  if (r.neutral) return "neutral: some motion meets no stiffness";
  return r.unstable ? "stable" : "stability not known: unstable directions were not counted";
}

std::string static_report(StageKind kind, const StaticResult& r, const std::string& time_unit) {
  const bool goes_to_a_load =
      kind == StageKind::equilibrium || kind == StageKind::path || kind == StageKind::fracture;
  std::string text =
      fmt::format("ended: {}{}; {} point{} of balance, {} Newton iterations, {} solver\n", r.ended,
                  goes_to_a_load ? fmt::format(", at load factor {:.8g}", r.load_factor) : "", r.points,
                  r.points == 1 ? "" : "s", r.iterations, r.solver);
  switch (kind) {
    case StageKind::dynamics: break;
    case StageKind::equilibrium: return text + stability(r);
    case StageKind::path: return text + special_points(r) + stability(r);
    case StageKind::buckling: return text + critical_loads(r) + strength(r);
    case StageKind::modes: return text + frequencies(r, time_unit) + strength(r);
    case StageKind::fracture:
      return text + (r.fracture.reason.empty() ? "" : r.fracture.reason + '\n') + breaks(r.fracture);
  }
  return text;
}

}  // namespace vbond
