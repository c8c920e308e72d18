#include "vbond/case/published_bonds.hpp"

#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "vbond/case/arguments.hpp"
#include "vbond/case/node.hpp"

namespace vbond {
namespace {

std::string line(const char* key, double value) {
  return fmt::format("{} = {}\n", key, keys::number_text(value));
}

/// Options of one program that stand with another.
void refuse_foreign_options(const PublishedBonds& b, Arguments& arguments) {
  const std::vector<std::pair<const char*, const std::string*>> of_pfc{
      {"--pb_kn", &b.pb_kn},         {"--pb_ks", &b.pb_ks},     {"--pb_emod", &b.pb_emod},
      {"--pb_kratio", &b.pb_kratio}, {"--pb_rmul", &b.pb_rmul}, {"--pb_ten", &b.pb_ten},
      {"--pb_coh", &b.pb_coh},       {"--pb_fa", &b.pb_fa},     {"--pb_mcf", &b.pb_mcf}},
      of_edem{{"--normal-stiffness", &b.normal_stiffness},
              {"--shear-stiffness", &b.shear_stiffness},
              {"--normal-stress", &b.normal_stress},
              {"--shear-stress", &b.shear_stress},
              {"--disk-radius", &b.disk_radius}};
  const bool pfc = b.program == "pfc";
  for (const auto& [option, text] : pfc ? of_edem : of_pfc)
    if (!text->empty())
      arguments.problem(option, *text, pfc ? "belongs to --from edem" : "belongs to --from pfc",
                        "leave it out, or take that program");
}

/// All bonds at contacts, and what every bond per area has.
std::string beginning(const PublishedBonds& b, Arguments& arguments) {
  double gap = 0.0;
  if (!b.gap.empty()) {
    gap = arguments.number(b.gap, "--gap", keys::length);
    if (gap < 0.0) arguments.problem("--gap", b.gap, "must be >= 0", "0 bonds particles that touch");
  }
  return "[[bonds]]\n" + fmt::format("gap = {}", keys::number_text(gap)) +
         "  # of the surfaces that were bonded: --gap\n"
         "attach = \"neck\"  # at the contact point, as long as the cement in the section\n"
         "theory = \"parallel\"  # c_A = A k_n, c_D = A k_s, c_B = J k_n, c_T = J_p k_s\n"
         "# with A = pi r^2, J = pi r^4/4, J_p = 2 J of a section of radius r\n";
}

/// Strengths, if both are there; what is missing is said and not made up.
std::string strengths(const std::optional<double>& tension, const std::optional<double>& shear,
                      double friction, const std::optional<double>& moment_share, const char* names) {
  if (!tension && !shear)
    return fmt::format("# no strengths: {} are not given, and the bonds do not break\n", names);
  if (!tension || !shear)
    return fmt::format(
        "# no strength: of {} only the one of {} is given ({}). With the other one add:\n"
        "# strength = {{ criterion = \"stress\", tension = ..., shear = ... }}\n",
        names, tension ? "tension" : "shear", keys::number_text(tension ? *tension : *shear));
  const std::string moments =
      moment_share ? fmt::format(", moment_share = {}", keys::number_text(*moment_share)) : std::string{};
  if (friction > 0.0)
    return "# breaks by N/A + b M_b r/J >= tension_limit or V/A + b |M_t| r/J_p >= cohesion - (N/A) tan "
           "phi\n" +
           fmt::format(
               "strength = {{ criterion = \"mohr-coulomb\", cohesion = {}, friction_angle = {}, "
               "tension_limit = "
               "{}{} }}\n",
               keys::number_text(*shear), keys::number_text(friction), keys::number_text(*tension), moments);
  return "# breaks by N/A + b M_b r/J >= tension or V/A + b |M_t| r/J_p >= shear\n" +
         fmt::format("strength = {{ criterion = \"stress\", tension = {}, shear = {}{} }}\n",
                     keys::number_text(*tension), keys::number_text(*shear), moments);
}

std::string of_pfc(const PublishedBonds& b, Arguments& arguments) {
  const auto optional = [&](const std::string& text, const char* option, const keys::Dimension& d) {
    return text.empty() ? std::nullopt : std::optional(arguments.positive(text, option, d));
  };
  const auto per_area = keys::stiffness_per_area;
  const std::optional<double> k_n = optional(b.pb_kn, "--pb_kn", per_area),
                              k_s = optional(b.pb_ks, "--pb_ks", per_area),
                              E = optional(b.pb_emod, "--pb_emod", keys::stress),
                              ratio = optional(b.pb_kratio, "--pb_kratio", keys::pure),
                              factor = optional(b.pb_rmul, "--pb_rmul", keys::pure),
                              tension = optional(b.pb_ten, "--pb_ten", keys::stress),
                              cohesion = optional(b.pb_coh, "--pb_coh", keys::stress);
  if (!(k_n && k_s && !E && !ratio) && !(E && ratio && !k_n && !k_s))
    arguments.problem("--from pfc", "", "needs either --pb_kn and --pb_ks, or --pb_emod and --pb_kratio",
                      "e.g. --pb_emod \"72 GPa\" --pb_kratio 2.5");
  double friction = 0.0;
  if (!b.pb_fa.empty()) {  // PFC has degrees, without a unit
    friction = arguments.number(b.pb_fa, "--pb_fa", keys::pure) * std::numbers::pi / 180.0;
    if (friction < 0.0 || friction >= 1.5)
      arguments.problem("--pb_fa", b.pb_fa, "must be from 0 to below 85 degrees",
                        "PFC's pb_fa is in degrees");
  }
  double moments = 1.0;
  if (!b.pb_mcf.empty()) {
    moments = arguments.number(b.pb_mcf, "--pb_mcf", keys::pure);
    if (moments < 0.0 || moments > 1.0)
      arguments.problem("--pb_mcf", b.pb_mcf, "must be from 0 to 1", "PFC's default is 1");
  }
  std::string text =
      "# PFC's linearpbond. Its linear contact (emod, kratio, fric) acts beside the bond and is not here.\n";
  text += beginning(b, arguments);
  if (k_n && k_s) text += line("k_n", *k_n) + line("k_s", *k_s);
  if (E && ratio)
    text += "# k_n = E/(R_i + R_j), k_s = k_n/stiffness_ratio\n" + line("E", *E) +
            line("stiffness_ratio", *ratio);
  text +=
      fmt::format("section = {{ shape = \"circle\", factor = {} }}  # r = factor min(R_i, R_j): pb_rmul\n",
                  keys::number_text(factor.value_or(1.0)));
  return text + strengths(tension, cohesion, friction, moments, "pb_ten and pb_coh");
}

std::string of_edem(const PublishedBonds& b, Arguments& arguments) {
  const auto needed = [&](const std::string& text, const char* option, const keys::Dimension& d,
                          const char* example) {
    if (!text.empty()) return arguments.positive(text, option, d);
    arguments.problem("--from edem", "", std::string("needs ") + option,
                      std::string("e.g. ") + option + example);
    return 1.0;
  };
  const double k_n = needed(b.normal_stiffness, "--normal-stiffness", keys::stiffness_per_area, " 1e10"),
               k_s = needed(b.shear_stiffness, "--shear-stiffness", keys::stiffness_per_area, " 1e10"),
               r = needed(b.disk_radius, "--disk-radius", keys::length, " \"0.5 mm\"");
  std::optional<double> tension, shear;
  if (!b.normal_stress.empty())
    tension = arguments.positive(b.normal_stress, "--normal-stress", keys::stress);
  if (!b.shear_stress.empty()) shear = arguments.positive(b.shear_stress, "--shear-stress", keys::stress);
  return "# EDEM's Hertz-Mindlin with bonding: stiffnesses per area S_n, S_t; its J is the polar moment 2 J "
         "of here.\n" +
         beginning(b, arguments) + line("k_n", k_n) + line("k_s", k_s) +
         fmt::format("section = {{ shape = \"circle\", diameter = {} }}  # twice the bonded disk radius\n",
                     keys::number_text(2.0 * r)) +
         strengths(tension, shear, 0.0, std::nullopt, "critical normal and shear stress");
}

}  // namespace

std::string bonds_as_published(const PublishedBonds& b) {
  Arguments arguments;
  if (b.program != "pfc" && b.program != "edem")
    arguments.problem("--from", b.program, "must be pfc or edem", "other programs: docs/from-other-codes.md");
  arguments.throw_if_any();
  refuse_foreign_options(b, arguments);
  const std::string text = b.program == "pfc" ? of_pfc(b, arguments) : of_edem(b, arguments);
  arguments.throw_if_any();
  return text;
}

}  // namespace vbond
