#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "calibrate_strengths.hpp"
#include "campaign.hpp"
#include "or_null.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"

namespace vbond::app {
namespace {

using Json = nlohmann::ordered_json;
using labtest::StrengthEvaluation;
using labtest::StrengthFactors;
using labtest::StrengthSearch;
using labtest::StrengthSearchEnd;

std::string cell(const std::optional<double>& x) {
  return x ? fmt::format("{:.6g}", *x) : "-";
}
const char* unit(const Case& c) {
  return c.units == UnitSystem::si ? " Pa" : "";
}

const char* to_text(StrengthSearchEnd end) {
  switch (end) {
    case StrengthSearchEnd::reached: return "reached";
    case StrengthSearchEnd::no_strength: return "no strength";
    case StrengthSearchEnd::out_of_reach: return "out of reach";
    case StrengthSearchEnd::jumps: return "jumps";
    case StrengthSearchEnd::grains: return "grains";
    case StrengthSearchEnd::no_scaling: return "no scaling";
    case StrengthSearchEnd::given_up: return "given up";
  }
  return "";
}

std::size_t tests_of(const Calibrated& all) {
  std::size_t n = 0;
  for (const TestsOfFactors& t : all.tests) n += t.folders.size();
  return n;
}

/// The keys that the sets of bonds are to have.
void print_keys(const Calibrated& all, const StrengthFactors& factors) {
  std::size_t set = all.c.bonds.size();
  for (const BondLimit& limit : all.limits) {
    if (limit.set != set) fmt::print("\n[[bonds]]  # {}\n", printable(all.c.bonds[limit.set].name));
    set = limit.set;
    fmt::print("strength.{} = {:.6g}\n", limit.key, limit.with(factors));
  }
}

void print_moduli(const char* test, const std::optional<labtest::TestResult>& result, const Case& c) {
  if (!result) return;
  fmt::print("{:<12}E {}{}   nu {}\n", test, cell(result->modulus), unit(c), cell(result->nu));
}

void print_tested(const Calibrated& all, std::size_t k) {
  const StrengthEvaluation& e = all.evaluations[k];
  const auto say_one = [&](const char* name, const std::optional<double>& x, const char* root = "") {
    if (x) fmt::print("{} {:.6g}{}{}\n", name, *x, unit(all.c), all.c.units == UnitSystem::si ? root : "");
  };
  fmt::print("\nTested with these:\n");
  say_one("tensile strength", e.found.strengths.tensile);
  say_one("compressive strength", e.found.strengths.compressive);
  say_one("fracture toughness", e.found.strengths.toughness, " m^0.5");
  if (e.ratio()) fmt::print("ratio {:.4g}\n", *e.ratio());
  print_moduli("tension", all.tests[k].tension, all.c);
  print_moduli("compression", all.tests[k].compression, all.c);
}

/// What else changes the ratio of strengths, for more or for less of it.
std::string other_ways(const Calibrated& all, bool more) {
  std::string share;
  for (const BondLimit& limit : all.limits)
    if (const StrengthSpec& s = *all.c.bonds[limit.set].strength; s.moments && *s.moments > 0.0)
      share = fmt::format(" (now {:.3g})", *s.moments);
  return more ? "what raises it further: a smaller moment_share" + share +
                    ", more bonds to each grain (gap_factor), or flat joints with friction (flat_joint)"
              : "what lowers it further: a larger moment_share" + share +
                    ", or fewer bonds to each grain (gap_factor)";
}

std::string last_without_strength(const Calibrated& all) {
  for (std::size_t k = all.evaluations.size(); k-- > 0;)
    if (!all.evaluations[k].found.why.empty())
      return fmt::format("with factors {:.6g} and {:.6g}: {}", all.evaluations[k].factors.tension,
                         all.evaluations[k].factors.shear, all.evaluations[k].found.why);
  return "";
}

/// Toughness and strength that do not go together in this body, and the grains with which they would.
std::string failure_by_grains(const Calibrated& all, const StrengthSearch& search) {
  const labtest::Strengths &asked = all.goal.asked, &found = search.all[*search.nearest].found.strengths;
  const double by = labtest::larger_grains(asked, found);
  const char* root = all.c.units == UnitSystem::si ? " Pa m^0.5" : "";
  const char* name = asked.tensile ? "tensile" : "compressive";
  return fmt::format(
      "fracture toughness {:.6g}{} does not go with the {} strength that is asked for: with that this body "
      "has "
      "{:.6g}{}\n"
      "  both go in proportion to the limits of bonds, and toughness over strength goes as the root of the "
      "grain size\n"
      "  grains {:.3g} times as large would have it, in a beam so large, too; or ask for one of the two",
      *asked.toughness, root, name, *found.toughness, root, by);
}

/// Why the search has not reached what is asked for, and what to do.
std::string failure_of(const Calibrated& all, const StrengthSearch& search) {
  const labtest::Strengths& asked = all.goal.asked;
  const bool both = asked.tensile && asked.compressive;
  const double wanted = both ? *asked.compressive / *asked.tensile : 0.0;
  const std::string looked = search.ratios ? fmt::format("ratios from {:.4g} to {:.4g} were found",
                                                         search.ratios->first, search.ratios->second)
                                           : "";
  const auto lines = [](std::string text, const std::string& more) {
    return more.empty() ? text : text + "\n  " + more;
  };
  switch (search.end) {
    case StrengthSearchEnd::reached: return "";
    case StrengthSearchEnd::no_strength:
      return lines(lines("a test has no strength, and the search ends there", last_without_strength(all)),
                   looked);
    case StrengthSearchEnd::out_of_reach: {
      const bool more = search.ratios && wanted > search.ratios->second;
      const bool between = !more && search.ratios && wanted > search.ratios->first;
      return lines(
          lines(fmt::format("compressive over tensile strength = {:.4g} cannot be had by strengths of "
                            "these bonds alone",
                            wanted),
                looked),
          between ? "" : other_ways(all, more));
    }
    case StrengthSearchEnd::jumps:
      return lines(
          fmt::format(
              "between factors of shear over tension of {:.6g} and {:.6g} the ratio of strengths jumps "
              "from {:.4g} to {:.4g}, over {:.4g}",
              search.jump->first.factors.shear / search.jump->first.factors.tension,
              search.jump->second.factors.shear / search.jump->second.factors.tension,
              *search.jump->first.ratio(), *search.jump->second.ratio(), wanted),
          "bonds break one by one: take a larger --within, or a body of more grains");
    case StrengthSearchEnd::grains: return failure_by_grains(all, search);
    case StrengthSearchEnd::no_scaling:
      return lines(
          "strengths do not follow the factors to the tolerance that is asked for",
          "they do where strains are small, and tests in motion slow: take a larger --within, or see "
          "the notes of the tests");
    case StrengthSearchEnd::given_up:
      return lines(
          fmt::format("after {} pairs of factors strengths are not those asked for", all.evaluations.size()),
          "take a larger --within, or a body of more grains");
  }
  return "";
}

}  // namespace

// ---- limits -----------------------------------------------------------------------------------------------

std::optional<labtest::TestResult>& TestsOfFactors::of(labtest::Kind kind) {
  if (kind == labtest::Kind::tension) return tension;
  return kind == labtest::Kind::compression ? compression : bending;
}

double BondLimit::with(const labtest::StrengthFactors& factors) const {
  const double x = given * (in_tension ? factors.tension : factors.shear);
  return std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr);
}

std::vector<BondLimit> limits_of(const Case& c) {
  std::vector<BondLimit> limits;
  std::vector<Problem> problems;
  for (std::size_t k = 0; k < c.bonds.size(); ++k) {
    const BondSpec& b = c.bonds[k];
    if (b.softening)
      problems.push_back(
          {b.softening->place, "bonds \"" + b.name + "\" soften",
           "what they bear follows from softening.tension and fracture_energy, which are no limits to "
           "multiply",
           "leave softening out; vbond fit varies such keys"});
    if (!b.strength) continue;
    const StrengthSpec& s = *b.strength;
    const auto add = [&](const char* key, double StrengthSpec::*of, bool in_tension) {
      if (s.*of > 0.0) limits.push_back({k, key, of, in_tension, s.*of});
    };
    switch (s.criterion) {
      case Criterion::mohr_coulomb:
        add("tension_limit", &StrengthSpec::tension, true);
        add("cohesion", &StrengthSpec::cohesion, false);
        break;
      case Criterion::stress:
      case Criterion::fibre:
        add("tension", &StrengthSpec::tension, true);
        add("shear", &StrengthSpec::shear, false);
        add("compression", &StrengthSpec::compression, false);
        break;
      default:
        problems.push_back(
            {b.place, "the strength of bonds \"" + b.name + "\" has no limits of stress",
             "strengths in tension and shear are found for the criteria mohr-coulomb, stress and "
             "fibre",
             "give strength = {criterion = \"mohr-coulomb\", tension_limit, cohesion, "
             "friction_angle}; vbond fit varies other keys"});
    }
  }
  if (limits.empty() && problems.empty())
    problems.push_back(
        {c.bonds.empty() ? SourcePlace{c.file, 0, 0} : c.bonds.front().place, "no bonds have a strength",
         "strengths of a body follow from those of its bonds",
         "give a first guess, as strength = {criterion = \"mohr-coulomb\", tension_limit = ..., "
         "cohesion = ..., friction_angle = ...}"});
  if (!problems.empty()) throw CaseError(std::move(problems));
  return limits;
}

Case with_factors(const Case& c, const std::vector<BondLimit>& limits,
                  const labtest::StrengthFactors& factors) {
  Case made = c;
  for (const BondLimit& limit : limits) (*made.bonds[limit.set].strength).*limit.of = limit.with(factors);
  return made;
}

std::vector<std::string> changes_of(const std::vector<BondLimit>& limits,
                                    const labtest::StrengthFactors& factors) {
  std::vector<std::string> changes;
  for (const BondLimit& limit : limits)
    changes.push_back(fmt::format("bonds[{}].strength.{}={:.6g}", limit.set, limit.key, limit.with(factors)));
  return changes;
}

// ---- what is printed --------------------------------------------------------------------------------------

void print_head(const Calibrated& all) {
  const labtest::Strengths& asked = all.goal.asked;
  fmt::print("asked for  ");
  if (asked.tensile) fmt::print("tensile strength {:.6g}{}   ", *asked.tensile, unit(all.c));
  if (asked.compressive) fmt::print("compressive strength {:.6g}{}   ", *asked.compressive, unit(all.c));
  if (asked.tensile && asked.compressive) fmt::print("ratio {:.4g}   ", *asked.compressive / *asked.tensile);
  if (asked.toughness)
    fmt::print("fracture toughness {:.6g}{}   ", *asked.toughness,
               all.c.units == UnitSystem::si ? " Pa m^0.5" : "");
  fmt::print("within {:g}\n", all.goal.within);
  fmt::print("tests {}, in {}\n\n", all.asked.test.motion ? "in motion" : "at rest", all.folder.string());
  fmt::print("{:>4}  {:>12} {:>12}   {:>13} {:>13} {:>9}{}\n", "", "tension by", "shear by", "tensile",
             "compressive", "ratio", asked.toughness ? "     toughness" : "");
  std::fflush(stdout);
}

void print_evaluation(const Calibrated& all) {
  const StrengthEvaluation& e = all.evaluations.back();
  const labtest::Strengths& s = e.found.strengths;
  fmt::print("{:>4}  {:>12.6g} {:>12.6g}   {:>13} {:>13} {:>9}{}\n", all.evaluations.size(),
             e.factors.tension, e.factors.shear, cell(s.tensile), cell(s.compressive),
             e.ratio() ? fmt::format("{:.4g}", *e.ratio()) : "-",
             all.goal.asked.toughness ? fmt::format(" {:>13}", cell(s.toughness)) : "");
  if (!e.found.why.empty()) fmt::print("      no strength: {}\n", printable(e.found.why));
  std::fflush(stdout);
}

void print_search(const Calibrated& all, const StrengthSearch& search) {
  if (search.end == StrengthSearchEnd::reached) {
    print_keys(all, search.all[*search.nearest].factors);
    print_tested(all, *search.nearest);
  } else {
    std::fflush(stdout);
    say("vbond: " + printable(failure_of(all, search)) + "\n", stderr);
    if (search.nearest) {
      say("  the nearest that was found takes:\n", stderr);
      print_keys(all, search.all[*search.nearest].factors);
      print_tested(all, *search.nearest);
    }
  }
  fmt::print("{} tests, in {}; result in {}\n", tests_of(all), all.folder.string(),
             (all.folder / "result.json").string());
  std::fflush(stdout);
}

std::string strengths_as_json(const Calibrated& all, const StrengthSearch* search) {
  const labtest::Strengths& asked = all.goal.asked;
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}};
  j["case"] = all.options.case_file.filename().string(), j["command"] = all.command;
  j["units"] = all.c.units == UnitSystem::si ? "SI" : "reduced";
  j["at_rest"] = !all.asked.test.motion;
  j["asked"] = {{"tensile", or_null(asked.tensile)},
                {"compressive", or_null(asked.compressive)},
                {"toughness", or_null(asked.toughness)},
                {"within", all.goal.within}};
  j["end"] = search != nullptr ? Json(to_text(search->end)) : Json();
  j["tests"] = tests_of(all);
  j["evaluations"] = Json::array();
  for (std::size_t k = 0; k < all.evaluations.size(); ++k) {
    const StrengthEvaluation& e = all.evaluations[k];
    j["evaluations"].push_back({{"factors", {{"tension", e.factors.tension}, {"shear", e.factors.shear}}},
                                {"tensile", or_null(e.found.strengths.tensile)},
                                {"compressive", or_null(e.found.strengths.compressive)},
                                {"toughness", or_null(e.found.strengths.toughness)},
                                {"ratio", or_null(e.ratio())},
                                {"why", e.found.why.empty() ? Json() : Json(e.found.why)},
                                {"folders", all.tests[k].folders}});
  }
  if (search == nullptr) return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  j["ratios"] = search->ratios ? Json{search->ratios->first, search->ratios->second} : Json();
  j["nearest"] = Json();
  if (search->nearest) {
    const std::size_t k = *search->nearest;
    const auto moduli = [](const std::optional<labtest::TestResult>& r) {
      return r ? Json{{"E", or_null(r->modulus)}, {"nu", or_null(r->nu)}} : Json();
    };
    j["nearest"] = {{"evaluation", k},
                    {"changes", changes_of(all.limits, search->all[k].factors)},
                    {"tension", moduli(all.tests[k].tension)},
                    {"compression", moduli(all.tests[k].compression)}};
  }
  const std::string failure = failure_of(all, *search);
  j["failure"] = failure.empty() ? Json() : Json(failure);
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vbond::app
