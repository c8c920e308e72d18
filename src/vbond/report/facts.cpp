#include "vbond/report/facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/model/step_bound.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/observe/table_text.hpp"
#include "vbond/statics/results.hpp"

namespace vbond::page {
namespace {

/// Kinds in the order of SpecimenSpec::shape.
const char* kind_of(const SpecimenSpec& s) {
  constexpr const char* kinds[] = {"rod",
                                   "half-sphere",
                                   "block",
                                   "sheet",
                                   "ring",
                                   "helix",
                                   "points of a CSV file",
                                   "LAMMPS data file",
                                   "listed points",
                                   "cylinder",
                                   "cone",
                                   "sphere",
                                   "packed grains",
                                   "fibres"};
  static_assert(std::size(kinds) == std::variant_size_v<decltype(s.shape)>);
  return kinds[s.shape.index()];
}

const char* name_of(BondTheory theory) {
  switch (theory) {
    case BondTheory::bernoulli_euler: return "Bernoulli-Euler";
    case BondTheory::timoshenko: return "Timoshenko";
    case BondTheory::short_cylinder: return "short cylinder";
    case BondTheory::shell: return "shell";
    case BondTheory::parallel: return "parallel";
  }
  return "";
}

struct ParametersInWords {
  const BondLaw& law;
  bool si;
  std::string thickness(const TheoryParameters& p) const {
    return fmt::format(", thickness {:.6g}{}", p.thickness, si ? " m" : "");
  }
  /// The area, or the radius where each bond has its own.
  std::string section(const TheoryParameters& p) const {
    const char *metre = si ? " m" : "", *of_area = si ? " m^2" : "";
    if (p.of_radii.any())
      return fmt::format(", section of {:.6g} times the {} radius", p.of_radii.factor,
                         p.of_radii.of_mean ? "mean" : "smaller");
    if (!(p.section.A > 0.0)) return {};
    const bool full_circle = p.section.A == circle(2.0 * p.section.r).A;
    return full_circle ? fmt::format(", section of diameter {:.6g}{}", 2.0 * p.section.r, metre)
                       : fmt::format(", section of area {:.6g}{}", p.section.A, of_area);
  }
  std::string operator()(const GivenCoefficients& given) const {
    std::string text;
    for (std::size_t k = 0; k < law.fields.size(); ++k)
      text += fmt::format("{} {} = {:.6g}", text.empty() ? "coefficients" : ",", law.fields[k].name,
                          given.values[k]);
    return text;
  }
  std::string operator()(const BondStiffness<double>& c) const {
    return fmt::format("stiffnesses c_A = {:.6g}, c_D = {:.6g}, c_B = {:.6g}, c_T = {:.6g}", c.c_A, c.c_D,
                       c.c_B, c.c_T);
  }
  std::string operator()(const TheoryParameters& p) const {
    if (p.theory == BondTheory::parallel && !p.per_area.of_modulus())
      return fmt::format("theory parallel, k_n = {:.6g}{}, k_s = {:.6g}{}", p.per_area.k_n,
                         si ? " N/m^3" : "", p.per_area.k_s, si ? " N/m^3" : "") +
             section(p);
    if (p.theory == BondTheory::parallel)
      return fmt::format("theory parallel, E = {:.6g}{}, k_n/k_s = {:.6g}", p.material.E, si ? " Pa" : "",
                         p.per_area.ratio) +
             section(p);
    return fmt::format("theory {}, E = {:.6g}{}, nu = {:.6g}{}", name_of(p.theory), p.material.E,
                       si ? " Pa" : "", p.material.nu,
                       p.theory == BondTheory::shell ? thickness(p) : section(p));
  }
};

std::string specimen_in_words(const Case& c) {
  std::string text;
  for (const SpecimenSpec& s : c.specimens)
    text += fmt::format("{}{} \"{}\"", text.empty() ? "" : ", ", kind_of(s), s.name);
  return text;
}

std::string factors_in_words(const BondStiffness<double>& f) {
  if (f.c_A == 1.0 && f.c_D == 1.0 && f.c_B == 1.0 && f.c_T == 1.0) return {};
  return fmt::format(", times {:.6g} (c_A), {:.6g} (c_D), {:.6g} (c_B), {:.6g} (c_T)", f.c_A, f.c_D, f.c_B,
                     f.c_T);
}

/// "by stress: tension 3e+06 Pa, shear 5e+06 Pa"; nothing where bonds hold for ever.
std::string strength_in_words(const BondSpec& b, bool si) {
  using enum Criterion;
  if (!b.strength || b.strength->criterion == none) return {};
  const StrengthSpec& s = *b.strength;
  std::string text;
  const auto add = [&](const char* name, double value, const char* unit) {
    text += fmt::format("{} {} {:.6g}{}{}", text.empty() ? "" : ",", name, value,
                        si && *unit != '\0' ? " " : "", si ? unit : "");
  };
  switch (s.criterion) {
    case none: break;
    case stress:
    case fibre:
      add("tension", s.tension, "Pa"), add("shear", s.shear, "Pa");
      if (s.compression > 0.0) add("compression", s.compression, "Pa");
      if (s.moment_share != 1.0) add("share of moments", s.moment_share, "");
      break;
    case mohr_coulomb:
      add("cohesion", s.cohesion, "Pa");
      add("friction angle", s.friction_angle * 180.0 / std::numbers::pi, "");
      text += " degrees";
      add("tension", s.tension, "Pa");
      if (s.moments) add("share of moments", *s.moments, "");
      break;
    case linear:
    case quadratic:
      add("axial force", s.axial_force, "N"), add("shear force", s.shear_force, "N");
      add("bending moment", s.bending_moment, "N m"), add("torque", s.torque, "N m");
      break;
    case energy: add("tension", s.tension_energy, "J"), add("others", s.other_energy, "J"); break;
    case elongation: add("of", s.elongation, "");
  }
  if (b.recipe.weibull.modulus > 0.0) add("Weibull's modulus", b.recipe.weibull.modulus, "");
  return fmt::format("by {}:{}", to_text(s.criterion), text);
}

std::string strengths_in_words(const Case& c) {
  std::string text;
  for (const BondSpec& b : c.bonds)
    if (const std::string words = strength_in_words(b, c.units == UnitSystem::si); !words.empty())
      text += fmt::format("{}\"{}\" {}", text.empty() ? "" : "; ", b.name, words);
  return text;
}

std::string bonds_in_words(const Case& c) {
  std::string text;
  for (const BondSpec& b : c.bonds)
    text += fmt::format(
        "{}\"{}\": {}, {}", text.empty() ? "" : "; ", b.name, b.recipe.law->title,
        std::visit(ParametersInWords{*b.recipe.law, c.units == UnitSystem::si}, b.recipe.parameters) +
            factors_in_words(b.recipe.factors));
  return text.empty() ? "none" : text;
}

std::string step_in_words(const StepFacts& step, const Model& model) {
  std::string text = fmt::format("{:.6g}{}", step.dt, model.units == UnitSystem::si ? " s" : "");
  if (model.T_0 > 0.0) text += fmt::format(", {:.3g} T_0", step.dt / model.T_0);
  if (step.critical > 0.0)
    text += fmt::format(", {:.3g} % of the critical step", 100.0 * step.dt / step.critical);
  return text;
}

std::string stage_in_words(const StageSpec& spec, const StageSummary* s, const char* time_unit) {
  std::string text = to_text(spec.kind);
  if (!s) return text + ", has not ended";
  if (s->statics)
    return text + fmt::format(", {} point{} of balance, ended: {}", s->statics->result.points,
                              s->statics->result.points == 1 ? "" : "s", s->statics->result.ended);
  return text +
         fmt::format(", {} steps to t = {:.6g}{}, ended: {}", s->steps, s->time, time_unit, to_text(s->stop));
}

std::string numbers(const std::vector<double>& all, const std::string& unit) {
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, all.size()); ++k)
    text += fmt::format("{}{:.6g}", k == 0 ? "" : ", ", all[k]);
  if (all.size() > most) text += fmt::format(" and {} more", all.size() - most);
  return text + unit;
}

void add_static_results(const StageSummary& s, bool si, Lines& lines) {
  const StaticResult& r = s.statics->result;
  const auto add = [&](const std::string& what, const std::vector<double>& values, const char* unit) {
    if (!values.empty())
      lines.push_back({fmt::format("{} of stage \"{}\"", what, s.name), numbers(values, unit)});
  };
  std::vector<double> factors, forces, displacements, reactions, frequencies, limits, bifurcations;
  for (const CriticalLoad& load : r.critical_loads) {
    factors.push_back(load.load_factor);
    if (load.force != 0.0) forces.push_back(load.force);
    if (!load.reaction) continue;
    displacements.push_back(*load.displacement);
    reactions.push_back(*load.reaction);
  }
  for (const NaturalMode& m : r.modes)
    if (!m.rigid) frequencies.push_back(m.omega / (2.0 * std::numbers::pi));
  for (const SpecialPoint& p : r.special_points)
    (p.kind == PointKind::limit_point ? limits : bifurcations).push_back(p.load_factor);
  add("Critical forces", forces, si ? " N" : "");
  add("Critical displacements of the first support that moves", displacements, "");
  add("Its reactions there", reactions, "");
  add("Critical load factors", factors, "");
  add("Frequencies", frequencies, si ? " Hz" : "");
  add("Limit points, load factors,", limits, "");
  add("Bifurcations, load factors,", bifurcations, "");
  if (s.statics->kind == StageKind::fracture)
    lines.push_back({fmt::format("Fracture in stage \"{}\"", s.name),
                     fmt::format("{} bonds broke in {} avalanches, peak load {:.6g} at load factor {:.6g}; "
                                 "ended: {}",
                                 r.fracture.breaks.size(), r.fracture.avalanches, r.fracture.peak_load,
                                 r.fracture.peak_load_factor, r.ended)});
  if (s.statics->kind == StageKind::equilibrium && (r.unstable || r.neutral))
    lines.push_back({fmt::format("Balance of stage \"{}\"", s.name),
                     fmt::format("{}, load factor {:.6g}", balance_in_words(r), r.load_factor)});
}

/// That of a run that blew up up to there would only reassure.
bool any_balance_of_energy(const RunSummary& summary) {
  const auto& all = summary.stages;
  return any_dynamics(summary) && std::none_of(all.begin(), all.end(), [](const StageSummary& s) {
           return s.stop == StopReason::diverged;
         });
}

}  // namespace

const char* contacts_in_words(const Model& model) {
  if (model.contact.law == ContactLaw::none) return "none";
  return model.contact.pairs == ContactPairs::all ? "between all pairs, bonded ones too"
                                                  : "between pairs that are not bonded";
}

StepFacts step_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary) {
  StepFacts step;
  if (!c.any_dynamics()) return step;
  if (summary)
    for (const StageSummary& s : summary->stages)
      if (!s.statics && step.dt == 0.0) step.dt = s.dt;
  const bool first_is_dynamics = !is_static(c.stages[0].kind), exact = c.time.step && !c.time.given();
  StepBound bound{};
  if (!exact && first_is_dynamics) {
    State state = built.state;
    const Stage stage = build_stage(c, built.model, 0, state);
    bound = step_bound(built.model, state, stage);
    if (step.dt == 0.0) step.dt = stage.dt;
  } else if (c.time.given()) {
    bound = step_bound(built.model, built.state);
    if (step.dt == 0.0) step.dt = c.time.given()->resolve(built.model.T_0);
  }
  // of a body that is not at hand: as if the step had not been fitted to the stage's times
  step.critical = bound.dt > 0.0 ? bound.dt : step.dt / c.time.fraction;
  return step;
}

Lines facts_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary,
               const StepFacts& step) {
  const Model& model = built.model;
  const bool si = model.units == UnitSystem::si;
  const auto bonds = summary ? summary->bonds : static_cast<std::int64_t>(built.state.bonds.size());
  Lines lines{{"Specimen", specimen_in_words(c)},
              {"Size", fmt::format("{} particle{}, {} bond{}", model.particles(),
                                   model.particles() == 1 ? "" : "s", bonds, bonds == 1 ? "" : "s")},
              {"Bonds", bonds_in_words(c)}};
  if (std::string strengths = strengths_in_words(c); !strengths.empty())
    lines.push_back({"Bonds break", std::move(strengths)});
  lines.push_back({"Contacts", contacts_in_words(model)});
  lines.push_back({"Units", si ? "SI" : "reduced (no units)"});
  if (model.T_0 > 0.0) lines.push_back({"T_0", fmt::format("{:.6g}{}", model.T_0, si ? " s" : "")});
  if (step.dt > 0.0) lines.push_back({"Time step", step_in_words(step, model)});
  for (std::size_t k = 0; k < c.stages.size(); ++k) {
    const bool ended = summary && k < summary->stages.size();
    lines.push_back({fmt::format("Stage \"{}\"", c.stages[k].name),
                     stage_in_words(c.stages[k], ended ? &summary->stages[k] : nullptr, si ? " s" : "")});
  }
  return lines;
}

Lines results_of(const RunSummary& summary) {
  const bool si = summary.units == UnitSystem::si;
  Lines lines;
  for (const StageSummary& s : summary.stages) {
    if (s.statics) add_static_results(s, si, lines);
    if (s.critical_force)
      lines.push_back({fmt::format("Peak force of stage \"{}\"", s.name),
                       fmt::format("{:.6g}{}, at t = {:.6g}{}", *s.critical_force, si ? " N" : "",
                                   s.peak_time.value_or(s.time), si ? " s" : "")});
  }
  for (const WallSummary& w : summary.walls)
    lines.push_back(
        {fmt::format("Force on wall \"{}\"", w.name),
         fmt::format("{:.6g}{} at most, in the rows of history.csv", w.largest_force, si ? " N" : "")});
  if (summary.cell) {
    const auto all = [](const SymmetricParts& x) {
      std::string text;
      for (std::size_t k = 0; k < x.size(); ++k)
        text += fmt::format("{}{} {:.4g}", k > 0 ? ", " : "", cell_component_names[k], x[k]);
      return text;
    };
    const CellValues& cell = summary.cell->values;
    lines.push_back({"Volume of the cell", fmt::format("{:.6g}{}", cell.volume, si ? " m^3" : "")});
    lines.push_back({"Strain of the cell", all(cell.strain)});
    lines.push_back({"Stress of the body", all(cell.stress) + (si ? " Pa" : "")});
  }
  if (summary.passage) {
    const PassageSummary& p = *summary.passage;
    const char* kg = si ? " kg" : "";
    lines.push_back({"Particles at the end", fmt::format("{}", p.present)});
    lines.push_back(
        {"Came in", fmt::format("{} particles, mass {:.6g}{}, energy {:.6g}{}", p.mass.particles_in,
                                p.mass.mass_in, kg, p.inserted, si ? " J" : "")});
    lines.push_back(
        {"Taken out", fmt::format("{} particles, mass {:.6g}{}, energy {:.6g}{}", p.mass.particles_out,
                                  p.mass.mass_out, kg, p.removed, si ? " J" : "")});
    for (const PassageSummary::OfSource& s : p.sources)
      lines.push_back({fmt::format("Source \"{}\"", s.name),
                       fmt::format("{} of {} bodies came in{}", s.came_in, s.bodies,
                                   s.due > 0 ? fmt::format("; {} more were due", s.due) : "")});
  }
  if (any_balance_of_energy(summary))
    lines.push_back(
        {"Largest error of the energy balance", fmt::format("{:.2g}", summary.energy_balance_error)});
  lines.push_back({"Strained bonds",
                   fmt::format("{} at the end, {} at any time", summary.strained, summary.ever_strained)});
  lines.push_back(
      {"Snapped bonds", fmt::format("{} at the end, {} at any time", summary.snapped, summary.ever_snapped)});
  return lines;
}

}  // namespace vbond::page
