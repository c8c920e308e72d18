#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "shell.hpp"
#include "test_command.hpp"
#include "vbond/case/arguments.hpp"
#include "vbond/labtest/request.hpp"

#include <fmt/format.h>

namespace vbond::app {
namespace {

using labtest::Kind;

/// False after telling that it is none.
bool is_bare_in_reduced(Arguments& arguments, const char* option, const std::string& text, UnitSystem units) {
  if (units != UnitSystem::reduced || text.find_first_not_of("0123456789.eE+-") == std::string::npos)
    return true;
  arguments.problem(option, text, "is no bare number, and the case is in reduced units",
                    "write a bare number");
  return false;
}

/// Options turned into numbers; all mistakes are told at once.
class Requested {
 public:
  Requested(const TestOptions& o, UnitSystem units) : o_(o), units_(units) {}

  /// One, or of triaxial tests one for each pressure.
  std::vector<labtest::Request> requests() {
    labtest::Request r;
    r.kind = kind();
    r.axis = direction(o_.axis);
    if (!o_.across.empty()) r.across = direction(o_.across);
    if (r.across == r.axis)
      arguments_.problem("--across", o_.across, "is along the axis of the specimen",
                         "give another direction");
    const bool ends = r.kind == Kind::tension || r.kind == Kind::compression;
    if (r.across && ends) only("--across", o_.across, "shear, bend3 and brazilian");
    r.at_rest = !o_.motion;
    r.ends = o_.ends == "grip" ? labtest::Ends::grip : labtest::Ends::slide;
    if (r.ends == labtest::Ends::grip && !ends) only("--ends", o_.ends, "tension and compression");
    r.strain = positive("--strain", o_.strain, keys::pure);
    if (r.strain && *r.strain >= 1.0) arguments_.problem("--strain", o_.strain, "must be < 1", "e.g. 0.02");
    if (r.strain && r.at_rest && *r.strain <= labtest::elastic_strain)
      arguments_.problem("--strain", o_.strain,
                         fmt::format("must be > {:g}, that of the stage for moduli", labtest::elastic_strain),
                         "give a larger one, or leave it out");
    r.rate = positive("--rate", o_.rate, keys::frequency);
    r.area = positive("--area", o_.area, keys::area);
    r.depth = positive("--depth", o_.depth, keys::length);
    r.span = positive("--span", o_.span, keys::length);
    if (r.span && r.kind != Kind::bend3) only("--span", o_.span, "bend3");
    r.notch = notch();
    if (!o_.notch.empty() && r.kind != Kind::bend3) only("--notch", o_.notch, "bend3");
    r.modulus = positive("--E", o_.modulus, keys::stress);
    if (!o_.damping.empty()) r.damping = within("--damping", o_.damping, 0.0, true);
    if (!o_.drop.empty()) r.drop = within("--drop", o_.drop, 0.0, false);
    r.frames = o_.frames;
    std::vector<labtest::Request> all = with_pressures(r);
    arguments_.throw_if_any();
    return all;
  }

 private:
  Kind kind() const {
    for (const Kind k : {Kind::tension, Kind::compression, Kind::shear, Kind::bend3, Kind::brazilian})
      if (o_.kind == labtest::to_text(k)) return k;
    return Kind::triaxial;
  }
  std::vector<labtest::Request> with_pressures(const labtest::Request& r) {
    if (r.kind != Kind::triaxial) {
      if (!o_.pressures.empty()) only("--pressure", o_.pressures.front(), "triaxial");
      return {r};
    }
    if (o_.pressures.empty())
      arguments_.problem(
          "vbond test triaxial", "", "needs the pressure all round",
          units_ == UnitSystem::si ? "give --pressure, as in --pressure \"10 MPa\"" : "give --pressure");
    std::vector<labtest::Request> all;
    for (const std::string& text : o_.pressures) {
      if (!is_bare_in_reduced(arguments_, "--pressure", text, units_)) continue;
      all.push_back(r);
      all.back().pressure = arguments_.number(text, "--pressure", keys::stress);
      if (all.back().pressure < 0.0)
        arguments_.problem("--pressure", text, "must be >= 0", "a pressure > 0 presses on the body");
      for (std::size_t k = 0; k + 1 < all.size(); ++k)
        if (all[k].pressure == all.back().pressure)
          arguments_.problem("--pressure", text, "is given already", "give each pressure once");
    }
    return all;
  }
  /// A share ends with %: a bare number is a length.
  std::optional<labtest::NotchDepth> notch() {
    if (!o_.notch.ends_with('%')) {
      const auto depth = positive("--notch", o_.notch, keys::length);
      return depth ? std::optional(labtest::NotchDepth{*depth, false}) : std::nullopt;
    }
    const double share = arguments_.number(o_.notch, "--notch", keys::pure);
    if (!(share > 0.0 && share < 1.0) && !std::isnan(share))
      arguments_.problem("--notch", o_.notch, "must be > 0 % and < 100 % of the height of the beam",
                         "e.g. \"50 %\"");
    return labtest::NotchDepth{share, true};
  }
  static int direction(const std::string& name) { return name == "x" ? 0 : name == "y" ? 1 : 2; }
  void only(const char* option, const std::string& text, const char* kinds) {
    arguments_.problem(option, text, std::string("is for ") + kinds, "leave it out");
  }
  std::optional<double> positive(const char* option, const std::string& text, keys::Dimension dimension) {
    if (text.empty()) return std::nullopt;
    return positive_argument(arguments_, option, text, dimension, units_);
  }
  /// A number below 1 and above a bound, or from it on.
  double within(const char* option, const std::string& text, double low, bool including) {
    const double x = arguments_.number(text, option, keys::pure);
    if (x >= 1.0 || x < low || (x == low && !including))
      arguments_.problem(option, text, including ? "must be >= 0 and < 1" : "must be > 0 and < 1",
                         "e.g. 0.5");
    return x;
  }

  const TestOptions& o_;
  UnitSystem units_;
  Arguments arguments_;
};

}  // namespace

std::optional<double> positive_argument(Arguments& arguments, const char* option, const std::string& text,
                                        const keys::Dimension& dimension, UnitSystem units) {
  if (text.empty() || !is_bare_in_reduced(arguments, option, text, units)) return std::nullopt;
  return arguments.positive(text, option, dimension);
}

std::vector<labtest::Request> requests_of(const TestOptions& options, UnitSystem units) {
  return Requested(options, units).requests();
}

// without --E, which changes neither case nor run: the same run can be evaluated with another one
std::string test_command_of(const RunOptions& options, const TestOptions& o) {
  std::string text = "vbond test " + o.kind + " " + shell_word(options.case_file.filename().string());
  const auto add = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += std::string(" ") + name + " " + shell_word(value);
  };
  for (const std::string& change : options.changes) add("--set", change);
  add("--axis", o.axis), add("--across", o.across), add("--ends", o.ends == "slide" ? "" : o.ends);
  if (o.motion) text += " --motion";
  add("--strain", o.strain), add("--drop", o.drop), add("--area", o.area), add("--depth", o.depth);
  add("--span", o.span), add("--notch", o.notch);
  add("--rate", o.rate), add("--damping", o.damping);
  for (const std::string& pressure : o.pressures) add("--pressure", pressure);
  if (o.frames) text += " --frames";
  return text;
}

}  // namespace vbond::app
