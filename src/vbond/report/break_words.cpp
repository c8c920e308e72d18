#include "vbond/report/break_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

#include "vbond/observe/csv.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

/// The mode of bonds that were broken as a particle was dropped, or taken out by a sink: the file has them as
/// `other`, though nothing was used up. No bond that its law breaks is below this utilisation.
constexpr const char* with_dropped = "dropped";
constexpr double least_of_a_break = 0.999;

/// "0.7 + 0.3 = 1".
std::string sum(const std::vector<double>& terms, double scale) {
  std::string text;
  double all = 0.0;
  for (const double term : terms) {
    text += fmt::format("{}{:.4g}", text.empty() ? "" : " + ", term * scale + 0.0);  // no -0
    all += term * scale;
  }
  return text + fmt::format(" = {:.4g}", all);
}

/// Stresses: shares of a limit are told as what they are shares of.
std::string stress_in_words(const BreakTold& b, UnitSystem units) {
  const Failure<double>& f = b.failure;
  const double limit = b.limit.value();
  const bool mega = units == UnitSystem::si && std::abs(limit) >= 1e4;
  const double scale = mega ? 1e-6 : 1.0;
  const char* unit = units != UnitSystem::si ? "" : mega ? " MPa" : " Pa";
  const bool mohr_coulomb = b.criterion == "mohr-coulomb", fibre = b.criterion == "fibre";
  const auto told = [&](const char* formula, const std::vector<double>& shares, const char* bound) {
    return fmt::format("{} = {} of {}{:.4g}{}", formula, sum(shares, limit * scale), bound, limit * scale,
                       unit);
  };
  if (b.mode == "compression")
    return fmt::format("-N/A + {} r/J = {:.4g} of {:.4g}{}", fibre ? "M_e" : "M_b",
                       f.compression * limit * scale, limit * scale, unit);
  if (b.mode == "shear" || b.mode == "torsion") {
    if (!(limit > 0.0))
      return fmt::format("tension leaves it no shear strength: c - (N/A) tan phi = {:.4g}{}", limit * scale,
                         unit);
    return told(fibre ? "4V/3A + |M_t| r/J_p" : "V/A + |M_t| r/J_p", {f.shear, f.torsion},
                mohr_coulomb ? "c - (N/A) tan phi = " : "");
  }
  if (mohr_coulomb && f.bending == 0.0)
    return fmt::format("N/A = {:.4g} of {:.4g}{}", f.tension * limit * scale, limit * scale, unit);
  return told(fibre ? "N/A + M_e r/J" : "N/A + M_b r/J", {f.tension, f.bending}, "");
}

/// "by its own law" where the law does not say by what.
std::string mode_in_words(const std::string& mode) {
  if (mode == with_dropped) return "with a particle that was dropped or that a sink took out";
  return mode == "other" ? "by its own law" : "in " + mode;
}

/// The row that was read.
BreakTold told_row(const CsvReader& in) {
  const auto cell = [&](const char* name) -> const std::string& { return in.cells()[in.place(name)]; };
  const auto number = [&](const char* name) {
    const auto value = csv_number<double>(cell(name));
    if (!value) in.refuse();
    return *value;
  };
  const auto whole = [&](const char* name) {
    const auto value = csv_number<std::int64_t>(cell(name));
    if (!value) in.refuse();
    return *value;
  };
  return {.bond = whole("bond"),
          .i = whole("i"),
          .j = whole("j"),
          .stage = whole("stage"),
          .step = whole("step"),
          .time = number("time"),
          .criterion = csv_plain(cell("criterion")),
          .mode = csv_plain(cell("mode")),
          .failure = {number("tension"), number("shear"), number("bending"), number("torsion"),
                      number("compression"), number("utilisation")},
          .limit = csv_number<double>(cell("limit")),
          .energy = number("energy")};
}

}  // namespace

BreaksTold read_breaks(const std::filesystem::path& path, std::size_t most) {
  CsvReader in(path);
  BreaksTold told;
  while (in.next()) {
    BreakTold row = told_row(in);
    if (row.mode == to_text(BreakMode::other) && row.failure.utilisation < least_of_a_break)
      row.mode = with_dropped;
    ++told.count;
    ++told.modes[row.mode];
    if (told.first.size() < most) told.first.push_back(std::move(row));
  }
  return told;
}

void find_load_factors(BreaksTold& told, const Case& c, const std::filesystem::path& folder) {
  const auto stage_of = [&c](const BreakTold& b) -> const StageSpec* {
    const auto k = static_cast<std::size_t>(b.stage);
    return k < c.stages.size() && is_static(c.stages[k].kind) ? &c.stages[k] : nullptr;
  };
  for (BreakTold& b : told.first) b.at_rest = stage_of(b) != nullptr;
  const std::filesystem::path table = folder / "fracture.csv";
  std::error_code e;
  if (!std::filesystem::exists(table, e)) return;
  std::map<std::pair<std::string, std::int64_t>, double> factors;  // of a stage and a bond, which breaks once
  CsvReader in(table);
  while (in.next()) {
    const auto bond = csv_number<std::int64_t>(in.cells()[in.place("bond")]);
    const auto factor = csv_number<double>(in.cells()[in.place("load_factor")]);
    if (!bond || !factor) in.refuse();
    factors[{csv_plain(in.cells()[in.place("stage")]), *bond}] = *factor;
  }
  for (BreakTold& b : told.first)
    if (const StageSpec* stage = stage_of(b))
      if (const auto at = factors.find({stage->name, b.bond}); at != factors.end())
        b.load_factor = at->second;
}

BreakMode break_mode(const std::string& name) {
  using enum BreakMode;
  for (const BreakMode mode : {tension, shear, bending, torsion, compression})
    if (name == to_text(mode)) return mode;
  return other;
}

std::string when_in_words(const BreakTold& b, UnitSystem units) {
  if (b.load_factor) return fmt::format("load factor {:.6g}", *b.load_factor);
  if (b.at_rest) return fmt::format("point {}", b.step);
  return fmt::format("t = {:.6g}{}", b.time, units == UnitSystem::si ? " s" : "");
}

std::string cause_in_words(const BreakTold& b, UnitSystem units) {
  const Failure<double>& f = b.failure;
  if (b.mode == with_dropped) return fmt::format("its utilisation was {:.4g} of 1", f.utilisation);
  if (b.limit) return stress_in_words(b, units);
  const std::vector<double> all{f.tension, f.shear, f.bending, f.torsion};
  if (b.criterion == "linear") return "N/N_c + V/V_c + M_b/M_bc + |M_t|/M_tc = " + sum(all, 1.0) + " of 1";
  if (b.criterion == "quadratic")
    return "(N/N_c)^2 + (V/V_c)^2 + (M_b/M_bc)^2 + (M_t/M_tc)^2 = " + sum(all, 1.0) + " of 1";
  if (b.criterion == "energy")
    return "energy of tension/W_1 + of shear, bending and torsion/W_2 = " + sum(all, 1.0) + " of 1";
  if (b.criterion == "elongation")
    return fmt::format("its elongation D/a - 1 was {:.4g} of what it bears", f.utilisation);
  return fmt::format("its law gave a utilisation of {:.4g} of 1", f.utilisation);
}

std::string in_words(const BreakTold& b, UnitSystem units) {
  return fmt::format("bond {} (particles {}, {}) broke at {} {}: {}; it held {:.4g}{}", b.bond, b.i, b.j,
                     when_in_words(b, units), mode_in_words(b.mode), cause_in_words(b, units), b.energy,
                     units == UnitSystem::si ? " J" : "");
}

std::string in_words(const BreaksTold& told) {
  if (told.count == 0) return "no bond has broken";
  std::string text = fmt::format("{} bond{} broke:", told.count, told.count == 1 ? "" : "s");
  const char* separator = " ";
  for (const auto& [mode, count] : told.modes) {
    text += fmt::format("{}{} {}", separator, count, mode_in_words(mode));
    separator = ", ";
  }
  return text;
}

}  // namespace vbond
