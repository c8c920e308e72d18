#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "or_null.hpp"
#include "test_command.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/labtest/envelope.hpp"
#include "vbond/labtest/result.hpp"

namespace vbond::app {
namespace {

using Json = nlohmann::ordered_json;
using labtest::Kind;

Json of(const std::optional<labtest::CurvePoint>& p) {
  if (!p) return {};
  return {{"stress", p->stress}, {"strain", p->strain}, {"force", p->force}};
}

const char* modulus_name(Kind kind) {
  return kind == Kind::shear ? "G" : "E";
}

/// What the stress at the peak is called.
const char* strength_name(Kind kind) {
  switch (kind) {
    case Kind::tension: return "tensile strength";
    case Kind::compression: return "compressive strength";
    case Kind::shear: return "shear strength";
    case Kind::bend3: return "modulus of rupture";
    case Kind::brazilian: return "Brazilian tensile strength";
    case Kind::triaxial: return "deviator at the peak";
  }
  return "";
}

/// The same where a note says that it is not that strength.
const char* peak_name(Kind kind, bool in_doubt) {
  return in_doubt ? "2 P/(pi D L) at the peak" : strength_name(kind);
}

/// "12.3 Pa"; in reduced units the number alone.
class Units {
 public:
  explicit Units(UnitSystem units) : si_(units == UnitSystem::si) {}
  std::string stress(double x) const { return fmt::format("{:.7g}{}", x, si_ ? " Pa" : ""); }
  std::string force(double x) const { return fmt::format("{:.7g}{}", x, si_ ? " N" : ""); }
  std::string length(double x) const { return fmt::format("{:.6g}{}", x, si_ ? " m" : ""); }
  std::string area(double x) const { return fmt::format("{:.6g}{}", x, si_ ? " m^2" : ""); }
  std::string toughness(double x) const { return fmt::format("{:.7g}{}", x, si_ ? " Pa m^0.5" : ""); }
  std::string per_area(double x) const { return fmt::format("{:.7g}{}", x, si_ ? " J/m^2" : ""); }
  std::string rate(double x) const { return fmt::format("{:.4g}{}", x, si_ ? " 1/s" : ""); }

 private:
  bool si_;
};

void line(const std::string& name, const std::string& value) {
  fmt::print("{:<27}{}\n", name, value);
}

void print_specimen(const labtest::MadeTest& t, const Units& u) {
  const Kind kind = t.request.kind;
  const char axis = "xyz"[t.request.axis], along = "xyz"[t.direction];
  if (kind == Kind::brazilian)
    line("disc", fmt::format("axis {}, loaded along {}, diameter {}, thickness {}", axis, along,
                             u.length(t.length), u.length(t.height)));
  else if (kind == Kind::bend3)
    line("beam", fmt::format("along {}, loaded along {}, {}, span {}", axis, along, t.section->text(),
                             u.length(t.length)));
  else
    line("specimen", fmt::format("along {}{}, section {}, area {}, {} between the middles of its ends", axis,
                                 kind == Kind::shear ? fmt::format(", sheared along {}", along) : "",
                                 t.section->text(), u.area(t.section->area), u.length(t.length)));
  if (t.notch)
    line("notch", fmt::format("depth {}, {:.4g} of the height; {} bonds left out, {} stay",
                              u.length(t.notch->depth), t.notch->share(), t.notch->left_out, t.notch->stay));
  if (kind == Kind::triaxial)
    line("pressure", u.stress(t.request.pressure) +
                         (t.confinement ? fmt::format("   on the sides of the section; {} on the skin",
                                                      u.stress(t.confinement->applied))
                                        : ""));
  if (t.request.at_rest)
    line("how", "at rest");
  else
    line("how", fmt::format("in motion, {} of strain", u.rate(t.rate)));
}

void print_toughness(const labtest::Toughness& toughness, const Units& u) {
  if (toughness.K_Ic) line("fracture toughness K_Ic", u.toughness(*toughness.K_Ic));
  if (toughness.G_Ic) line("G_Ic = K_Ic^2/E", u.per_area(*toughness.G_Ic));
  if (toughness.work_of_fracture) line("work of fracture", u.per_area(*toughness.work_of_fracture));
}

std::string fragments_of(const labtest::TestResult& r) {
  return fmt::format("; {:.0f} fragment{}, the largest has {:.3g} of the mass", *r.fragments,
                     *r.fragments == 1.0 ? "" : "s", r.largest_fragment.value_or(0.0));
}

void print_point(const char* name, const std::optional<labtest::CurvePoint>& p, const Units& u) {
  if (p)
    line(name, fmt::format("at a stress of {}, a strain of {:.6g}", u.stress(p->stress), p->strain + 0.0));
}

}  // namespace

void print_result(const labtest::MadeTest& t, const labtest::TestResult& r, UnitSystem units) {
  const Units u(units);
  const Kind kind = t.request.kind;
  print_specimen(t, u);
  if (r.modulus)
    line(modulus_name(kind),
         u.stress(*r.modulus) +
             (r.modulus_by_ends ? fmt::format("   by the way of the ends {}", u.stress(*r.modulus_by_ends))
                                : ""));
  if (r.nu)
    line("nu", fmt::format("{:.6g}   along {} {:.6g}, along {} {:.6g}", *r.nu, "xyz"[t.across], *r.nu_across,
                           "xyz"[t.third], *r.nu_third));
  if (r.toughness) print_toughness(*r.toughness, u);
  if (r.peak) {
    line(t.notch ? "stress of a whole section" : peak_name(kind, r.peak_in_doubt),
         fmt::format("{}   at a strain of {:.6g}, a force of {}{}", u.stress(r.peak->stress), r.peak->strain,
                     u.force(r.peak->force), r.peak_in_doubt ? ": no tensile strength, see the notes" : ""));
  } else if (t.breaks) {
    line("largest stress", fmt::format("{}   at a strain of {:.6g}: no strength, see the notes",
                                       u.stress(r.largest.stress), r.largest.strain + 0.0));
  }
  print_point("first break", r.first_break, u);
  if (r.first_break_at)
    line("", fmt::format("in {}, at ({}, {}, {})", printable(r.first_break_at->mode),
                         u.length(r.first_break_at->place.x), u.length(r.first_break_at->place.y),
                         u.length(r.first_break_at->place.z)));
  print_point("1 % of breaks at the peak", r.one_percent, u);
  if (t.breaks)
    line("broken bonds", fmt::format("{}, {} of them before the peak{}", r.breaks, r.breaks_before_peak,
                                     r.fragments ? fragments_of(r) : ""));
  if (r.splitting)
    line("splitting",
         fmt::format(
             "first break {:.3g} radii from the loaded diameter, {:.3g} along it from the middle; all on "
             "average {:.3g} from it; {:.3g} in tension",
             r.splitting->first_from_plane, r.splitting->first_from_middle, r.splitting->mean_from_plane,
             r.splitting->in_tension));
  if (r.inertia)
    line("inertia",
         fmt::format("kinetic energy over work {:.2g} at the peak, at most {:.2g} before; ends differ by "
                     "{:.2g} of the peak",
                     r.inertia->at_peak, r.inertia->largest, r.inertia->ends_differ));
  for (const auto* notes : {&t.notes, &r.notes})
    for (const std::string& note : *notes) line("note", printable(note));
}

std::string result_as_json(const labtest::MadeTest& t, const labtest::TestResult& r, UnitSystem units,
                           const std::string& case_file) {
  const Kind kind = t.request.kind;
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}, {"case", case_file}};
  j["units"] = units == UnitSystem::si ? "SI" : "reduced";
  j["test"] = labtest::to_text(kind);
  j["axis"] = std::string(1, "xyz"[t.request.axis]), j["loaded_along"] = std::string(1, "xyz"[t.direction]);
  j["at_rest"] = t.request.at_rest;
  if (!t.request.at_rest) j["strain_rate"] = t.rate;
  j["end_strain"] = t.end_strain;
  if (kind == Kind::triaxial) {
    j["pressure"] = t.request.pressure;
    j["pressure_on_skin"] = t.confinement ? t.confinement->applied : 0.0;
    j["pressure_along_axis"] = t.confinement ? t.confinement->axial : 0.0;
  }
  j["length"] = t.length;
  if (t.section)
    j["section"] = {{"shape", t.section->text()}, {"area", t.section->area}, {"extent", t.section->extent}};
  if (kind == Kind::brazilian) j["thickness"] = t.height;
  if (kind == Kind::bend3) j["height"] = t.height;
  j["stress_per_force"] = t.stress_per_force, j["strain_per_way"] = t.strain_per_way;
  j[modulus_name(kind)] = or_null(r.modulus),
  j[std::string(modulus_name(kind)) + "_by_ends"] = or_null(r.modulus_by_ends);
  j["nu"] = or_null(r.nu);
  if (r.nu)
    j["nu_by_direction"] = {{std::string(1, "xyz"[t.across]), *r.nu_across},
                            {std::string(1, "xyz"[t.third]), *r.nu_third}};
  j["stress_before"] = r.stress_before;
  j["strength"] = r.peak && !t.notch ? Json(r.peak->stress) : Json();
  j["peak"] = of(r.peak), j["largest"] = of(std::optional(r.largest));
  j["first_break"] = of(r.first_break), j["one_percent_of_breaks"] = of(r.one_percent);
  if (r.first_break_at) {
    const Vec3d& at = r.first_break_at->place;
    j["first_break_at"] = {{"place", {at.x, at.y, at.z}}, {"mode", r.first_break_at->mode}};
  } else {
    j["first_break_at"] = nullptr;
  }
  j["breaks"] = r.breaks, j["breaks_before_peak"] = r.breaks_before_peak;
  j["fragments"] = or_null(r.fragments), j["largest_fragment"] = or_null(r.largest_fragment);
  if (t.notch) {
    const labtest::Notch& n = *t.notch;
    j["notch"] = {{"depth", n.depth},
                  {"share", n.share()},
                  {"plane", n.plane},
                  {"left_out", n.left_out},
                  {"stay", n.stay},
                  {"ligament", n.ligament()},
                  {"K_per_force", n.toughness_per_force}};
    const labtest::Toughness told = r.toughness.value_or(labtest::Toughness{});
    j["notch"]["compliance"] = told.compliance > 0.0 ? Json(told.compliance) : Json();
    j["K_Ic"] = or_null(told.K_Ic), j["G_Ic"] = or_null(told.G_Ic);
    j["work_of_fracture"] = or_null(told.work_of_fracture);
  }
  if (r.inertia)
    j["inertia"] = {{"at_peak", r.inertia->at_peak},
                    {"largest", r.inertia->largest},
                    {"ends_differ", r.inertia->ends_differ},
                    {"quasi_static", r.inertia->quasi_static()}};
  if (r.splitting)
    j["splitting"] = {{"first_from_plane", r.splitting->first_from_plane},
                      {"first_from_middle", r.splitting->first_from_middle},
                      {"mean_from_plane", r.splitting->mean_from_plane},
                      {"in_tension", r.splitting->in_tension}};
  j["ended"] = r.ended;
  j["notes"] = t.notes;
  for (const std::string& note : r.notes) j["notes"].push_back(note);
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print_envelope(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests, UnitSystem units) {
  const Units u(units);
  if (peaks.size() < tests)
    line("note", fmt::format("{} of {} tests have no peak, and are left out of the envelope",
                             tests - peaks.size(), tests));
  if (peaks.size() < 2) return line("note", "fewer than two peaks: no envelope");
  const char* exact = peaks.size() == 2 ? ", through two points" : "";
  if (const auto m = labtest::mohr_coulomb(peaks))
    line("Mohr-Coulomb",
         fmt::format("cohesion {}, friction angle {:.4g} deg, s1 without pressure {}; r^2 {:.4f}{}",
                     u.stress(m->cohesion), m->phi * 180.0 / std::numbers::pi, u.stress(m->ucs), m->r2,
                     exact));
  else
    line("note",
         "no Mohr-Coulomb line: the strength does not grow with the pressure, or is not positive without it");
  if (const auto h = labtest::hoek_brown(peaks))
    line("Hoek-Brown", fmt::format("m_i {:.5g}, uniaxial compressive strength {}; r^2 {:.4f}{}", h->m_i,
                                   u.stress(h->s_ci), h->r2, exact));
  else
    line("note", "no Hoek-Brown curve: the square of the deviator does not grow with the pressure");
}

std::string envelope_as_json(const std::vector<labtest::PeakStresses>& peaks, std::size_t tests,
                             UnitSystem units, const std::string& case_file) {
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}, {"case", case_file}};
  j["units"] = units == UnitSystem::si ? "SI" : "reduced";
  j["test"] = "triaxial", j["tests"] = tests;
  j["peaks"] = Json::array();
  for (const labtest::PeakStresses& p : peaks) j["peaks"].push_back({{"s3", p.s3}, {"s1", p.s1}});
  const auto m = labtest::mohr_coulomb(peaks);
  j["mohr_coulomb"] = m ? Json{{"cohesion", m->cohesion},
                               {"friction_angle_deg", m->phi * 180.0 / std::numbers::pi},
                               {"slope", m->slope},
                               {"s1_without_pressure", m->ucs},
                               {"r2", m->r2}}
                        : Json();
  const auto h = labtest::hoek_brown(peaks);
  j["hoek_brown"] = h ? Json{{"m_i", h->m_i}, {"s_ci", h->s_ci}, {"r2", h->r2}} : Json();
  return j.dump(2) + "\n";
}

}  // namespace vbond::app
