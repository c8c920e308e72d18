#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "commands.hpp"
#include "homogenise_along.hpp"
#include "homogenise_report.hpp"
#include "prepare.hpp"
#include "report_command.hpp"
#include "vbond/case/arguments.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/report/page.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/statics/homogenise.hpp"
#include "vbond/statics/homogenise_body.hpp"
#include "vbond/statics/homogenise_sheet.hpp"

namespace vbond::app {
namespace {

using Json = nlohmann::ordered_json;

Json of(const IsotropicConstants& m) {
  return {{"K", m.K}, {"G", m.G}, {"E", m.E()}, {"nu", m.nu()}};
}
Json of(const Vec3d& a) {
  return {a.x, a.y, a.z};
}

constexpr std::pair<const char*, Vec3d> axes[] = {{"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};

Json json_of(const Homogenised& h, const ElasticConstants* C) {
  Json j{{"particles", h.particles},
         {"bonds", h.bonds},
         {"floating", h.floating},
         {"volume", h.volume},
         {"density", h.density},
         {"stress", h.stress},
         {"moved", h.moved},
         {"solver", h.solver},
         {"order", cell_component_names},
         {"C", h.C}};
  if (C == nullptr) return j;
  j["S"] = C->compliance();
  j["voigt"] = of(C->voigt()), j["reuss"] = of(C->reuss()), j["hill"] = of(C->hill());
  j["anisotropy"] = C->anisotropy();
  for (const auto& [name, n] : axes) j["E"][name] = C->youngs_modulus(n);
  const Directed least = C->least_youngs_modulus(), most = C->largest_youngs_modulus();
  j["E"]["least"] = least.value, j["E"]["least_along"] = of(least.along);
  j["E"]["largest"] = most.value, j["E"]["largest_along"] = of(most.along);
  for (const auto& [name, n] : axes)
    for (const auto& [other, m] : axes)
      if (name != other) {
        j["nu"][std::string(name) + other] = C->poissons_ratio(n, m);
        if (name < other) j["G"][std::string(name) + other] = C->shear_modulus(n, m);
      }
  for (const auto& [name, n] : axes)
    for (const Directed& wave : C->wave_speeds(n, h.density)) j["wave_speeds"][name].push_back(wave.value);
  return j;
}

void print_isotropic(const char* name, const IsotropicConstants& m) {
  fmt::print("  {:<8} {:<14.7g} {:<14.7g} {:<14.7g} {:<.6f}\n", name, m.K, m.G, m.E(), m.nu());
}

void print_constants(const Constants& C) {
  for (const auto& row : C)
    fmt::print(" {:14.6g}{:14.6g}{:14.6g}{:14.6g}{:14.6g}{:14.6g}\n", row[0], row[1], row[2], row[3], row[4],
               row[5]);
}

void print_averages(const ElasticConstants& C, bool si) {
  const auto title = [si](const char* name) { return name + std::string(si ? " [Pa]" : ""); };
  fmt::print("\nIsotropic  {:<14} {:<14} {:<14} nu\n", title("K"), title("G"), title("E"));
  print_isotropic("Voigt", C.voigt());
  print_isotropic("Reuss", C.reuss());
  print_isotropic("Hill", C.hill());
  fmt::print("Anisotropy 5 G_V/G_R + K_V/K_R - 6 = {:.6g}\n", C.anisotropy());
}

void print_directions(const ElasticConstants& C, double density, bool si) {
  const Directed least = C.least_youngs_modulus(), most = C.largest_youngs_modulus();
  fmt::print("\nYoung's modulus{}  x {:.7g}   y {:.7g}   z {:.7g}\n", si ? " [Pa]" : "",
             C.youngs_modulus(axes[0].second), C.youngs_modulus(axes[1].second),
             C.youngs_modulus(axes[2].second));
  for (const auto& [name, at] : {std::pair{"least", least}, std::pair{"largest", most}})
    fmt::print("  {:<14} {:.7g} along ({:.4f}, {:.4f}, {:.4f})\n", name, at.value, at.along.x, at.along.y,
               at.along.z);
  fmt::print("Waves{}, two of shear and one of pressure where directions allow\n", si ? " [m/s]" : "");
  for (const auto& [name, n] : axes) {
    const WaveSpeeds v = C.wave_speeds(n, density);
    fmt::print("  along {}        {:.6g}   {:.6g}   {:.6g}\n", name, v[0].value, v[1].value, v[2].value);
  }
}

using Sentences = std::vector<std::string>;

void print_lines(const Sentences& sentences) {
  for (const std::string& text : sentences) fmt::print("{}\n", text);
}

constexpr const char* was_moved =
    "The body was not in balance as the case makes it: this is the balance near it.";

std::string floating_in_words(std::size_t floating) {
  return fmt::format(
      "{} particles are of parts that hang together with none of their images: they carry nothing", floating);
}

Sentences facts_of(const Homogenised& h, bool si) {
  return {fmt::format("{} particles, {} bonds; volume {:.6g}{}, density {:.6g}{}; solver {}", h.particles,
                      h.bonds, h.volume, si ? " m^3" : "", h.density, si ? " kg/m^3" : "", h.solver),
          fmt::format("Stress{}  xx {:.4g}   yy {:.4g}   zz {:.4g}   yz {:.4g}   xz {:.4g}   xy {:.4g}",
                      si ? " [Pa]" : "", h.stress[0], h.stress[1], h.stress[2], h.stress[3], h.stress[4],
                      h.stress[5])};
}

Sentences remarks_on(const Homogenised& h) {
  Sentences all;
  if (h.floating > 0) all.push_back(floating_in_words(h.floating));
  if (h.moved) all.emplace_back(was_moved);
  return all;
}

void print(const Homogenised& h, const ElasticConstants* C, bool si) {
  const Sentences facts = facts_of(h, si);
  print_lines({facts[0]}), print_lines(remarks_on(h)), print_lines({facts[1]});
  fmt::print("\nC{}: xx yy zz yz xz xy, engineering shear\n", si ? " [Pa]" : "");
  print_constants(h.C);
  if (C == nullptr) return;
  print_averages(*C, si);
  print_directions(*C, h.density, si);
}

std::string no_others(const std::string& why) {
  return "nothing else follows from these constants: " + why;
}

void tell_of_others(const std::string& why) {
  fmt::print(stderr, "vbond: {}\n", no_others(why));
}

// ---- a cell that repeats in all directions ------------------------------------------------------------

void of_cell(const RunOptions& options, const Built& built, MaterialPage& page) {
  const Homogenised found = homogenise(built.model, built.state);
  std::string why;
  const std::optional<ElasticConstants> C = constants_of(found.C, why);
  const ElasticConstants* known = C ? &*C : nullptr;
  const bool si = built.model.units == UnitSystem::si;
  page = {json_of(found, known), facts_of(found, si), remarks_on(found), {}, {{"", "", C}}};
  if (!C) page.warnings.push_back(no_others(why));
  if (options.json) {
    fmt::print("{}\n", page.found.dump(2));
  } else {
    print_notes(built.notes);
    print(found, known, si);
  }
  if (!C) tell_of_others(why);
}

// ---- sheets -------------------------------------------------------------------------------------------

Json json_of(const HomogenisedSheet& h) {
  return {{"particles", h.particles},
          {"bonds", h.bonds},
          {"floating", h.floating},
          {"parts", h.parts},
          {"area", h.area},
          {"density", h.density},
          {"plane", h.plane},
          {"axes", {of(h.axes[0]), of(h.axes[1]), of(h.axes[2])}},
          {"solver", h.solver},
          {"order", {"11", "22", "12"}},
          {"A", h.A},
          {"B", h.B},
          {"D", h.D}};
}

Sentences facts_of(const HomogenisedSheet& h, bool si) {
  const auto name = [&h](std::size_t k) { return h.axes[k].x > 0.5 ? 'x' : h.axes[k].y > 0.5 ? 'y' : 'z'; };
  return {fmt::format("{} particles, {} bonds; area {:.6g}{}, mass per area {:.6g}{}; solver {}", h.particles,
                      h.bonds, h.area, si ? " m^2" : "", h.density, si ? " kg/m^2" : "", h.solver),
          fmt::format("1, 2 and the normal are {}, {} and {}; strain and curvature count at {} = {:.6g}{}",
                      name(0), name(1), name(2), name(2), h.plane, si ? " m" : "")};
}

Sentences remarks_on(const HomogenisedSheet& h) {
  Sentences all;
  if (h.floating > 0) all.push_back(floating_in_words(h.floating));
  if (h.parts > 1)
    all.push_back(fmt::format(
        "{} parts do not hang together with each other: B and D are as if they could not slide", h.parts));
  return all;
}

void print(const HomogenisedSheet& h, bool si) {
  print_lines(facts_of(h, si)), print_lines(remarks_on(h));
  for (const auto& [title, unit, C] : {std::tuple{"A, membrane forces by strain", " [N/m]", &h.A},
                                       {"B, membrane forces by curvature", " [N]", &h.B},
                                       {"D, moments by curvature", " [N m]", &h.D}}) {
    fmt::print("\n{}{}: 11 22 12, engineering shear and twist\n", title, si ? unit : "");
    for (const auto& row : *C) fmt::print(" {:14.6g}{:14.6g}{:14.6g}\n", row[0], row[1], row[2]);
  }
}

void of_sheet(const RunOptions& options, const Built& built, MaterialPage& page) {
  const HomogenisedSheet found = homogenise_sheet(built.model, built.state);
  const bool si = built.model.units == UnitSystem::si;
  page = {json_of(found), facts_of(found, si), remarks_on(found), {}, {}};
  if (options.json) {
    fmt::print("{}\n", page.found.dump(2));
  } else {
    print_notes(built.notes);
    print(found, si);
  }
}

// ---- finite bodies ------------------------------------------------------------------------------------

Json json_of(const Constants& C) {
  Json j{{"C", C}};
  std::string why;
  if (const auto known = constants_of(C, why)) {
    j["voigt"] = of(known->voigt()), j["reuss"] = of(known->reuss()), j["hill"] = of(known->hill());
    j["anisotropy"] = known->anisotropy();
  }
  return j;
}

Json json_of(const HomogenisedBody& h) {
  return {{"particles", h.particles},
          {"bonds", h.bonds},
          {"surface", h.surface},
          {"floating", h.floating},
          {"volume", h.volume},
          {"density", h.density},
          {"moved", h.moved},
          {"solver", h.solver},
          {"order", cell_component_names},
          {"by_displacement", json_of(h.by_displacement)},
          {"by_traction", json_of(h.by_traction)}};
}

Sentences facts_of(const HomogenisedBody& h, const std::string& volume_is, bool si) {
  return {
      fmt::format("{} particles, {} bonds; volume {:.6g}{} ({}), density {:.6g}{}; solver {}", h.particles,
                  h.bonds, h.volume, si ? " m^3" : "", volume_is, h.density, si ? " kg/m^3" : "", h.solver),
      fmt::format("{} particles are its surface", h.surface)};
}

Sentences remarks_on(const HomogenisedBody& h) {
  Sentences all;
  if (h.floating > 0)
    all.push_back(
        fmt::format("{} particles are of other parts than the largest: they count nowhere", h.floating));
  if (h.moved) all.emplace_back(was_moved);
  return all;
}

/// Both C with their keys in JSON.
std::array<std::tuple<const char*, const char*, const Constants*>, 2> both(const HomogenisedBody& h) {
  return {{{"by_displacement", "moves with the strain, which gives most", &h.by_displacement},
           {"by_traction", "bears uniform stress, which gives least", &h.by_traction}}};
}

void print(const HomogenisedBody& h, const std::string& volume_is, bool si) {
  print_lines(facts_of(h, volume_is, si)), print_lines(remarks_on(h));
  for (const auto& [key, title, C] : both(h)) {
    fmt::print("\nC{} if the surface {}: xx yy zz yz xz xy, engineering shear\n", si ? " [Pa]" : "", title);
    print_constants(*C);
    std::string why;
    if (const auto known = constants_of(*C, why))
      print_averages(*known, si);
    else
      tell_of_others(why);
  }
}

MaterialPage page_of(const HomogenisedBody& h, const std::string& volume_is, bool si) {
  MaterialPage page{json_of(h), facts_of(h, volume_is, si), remarks_on(h), {}, {}};
  for (const auto& [key, title, C] : both(h)) {
    std::string why;
    const auto known = constants_of(*C, why);
    const std::string name = std::string("If the surface ") + title;
    page.materials.push_back({key, name, known});
    if (!known) page.warnings.push_back(name + ": " + no_others(why));
  }
  return page;
}

void of_body(const RunOptions& options, const HomogeniseOptions& body, const Case& c, const Built& built,
             MaterialPage& page) {
  Arguments arguments;
  std::optional<double> volume;
  if (!body.volume.empty()) {
    volume = arguments.positive(body.volume, "--volume", keys::volume);
    if (c.units == UnitSystem::reduced &&
        body.volume.find_first_not_of("0123456789.eE+-") != std::string::npos)
      arguments.problem("--volume", body.volume, "has a unit, and the case is in reduced units",
                        "write a bare number");
  }
  const Group* group = nullptr;
  if (!body.surface.empty() && (group = built.model.find_group(body.surface)) == nullptr)
    arguments.problem("--surface", body.surface, "is no group of the case", "name one of [groups]");
  arguments.throw_if_any();
  const Model& m = built.model;
  const BodySurface surface = group != nullptr ? surface_of(m, built.state, group->particles,
                                                            volume ? *volume : volume_of_box(m, built.state))
                                               : surface_of_box(m, built.state, volume);
  const HomogenisedBody found = homogenise_body(m, built.state, surface);
  const char* volume_is = volume ? "as given" : "the box around its particles as the case makes it";
  const bool si = m.units == UnitSystem::si;
  page = page_of(found, volume_is, si);
  if (options.json) {
    fmt::print("{}\n", page.found.dump(2));
  } else {
    print_notes(built.notes);
    print(found, volume_is, si);
  }
}

}  // namespace

std::optional<ElasticConstants> constants_of(const Constants& C, std::string& why) {
  try {
    return ElasticConstants(C);
  } catch (const std::invalid_argument& e) {
    why = e.what();
    return std::nullopt;
  }
}

int homogenise(const RunOptions& options, const HomogeniseOptions& body) {
  std::string html;
  if (body.report) require_new_page(*body.report), html = page_template();  // refuses before it computes
  const Case c = read_case(options.case_file, options.changes);
  Built built = build(c);
  const auto& periodic = built.model.cell.periodic;
  const auto directions = built.model.cell.any() ? std::count(periodic.begin(), periodic.end(), true) : 0;
  if (directions > 0 && !(body.volume.empty() && body.surface.empty()))
    throw CaseError(Problem{{c.file, 0, 0},
                            "the body has a periodic cell",
                            "--volume and --surface are for bodies without one",
                            "leave them out"});
  if (body.along && directions < 3)
    throw CaseError(Problem{{c.file, 0, 0},
                            "the body has no cell that repeats in all directions",
                            "--along takes the balances of such a cell",
                            "leave it out, or give a [cell]: docs/cell.md"});
  if (body.along) return homogenise_along(c, std::move(built), options.threads);
  MaterialPage page;
  switch (directions) {
    case 0: of_body(options, body, c, built, page); break;
    case 2: of_sheet(options, built, page); break;
    case 3: of_cell(options, built, page); break;
    default:
      throw CaseError(
          Problem{{c.file, 0, 0},
                  "the cell is periodic in one direction: the body is a rod",
                  "constants are those of cells that repeat in three directions, of sheets, which "
                  "repeat in two, and of bodies without a cell",
                  "let it repeat in more directions, or leave [cell] out: docs/cell.md"});
  }
  if (!body.report) return done;
  page.notes.insert(page.notes.end(), built.notes.begin(), built.notes.end());
  replace_file(*body.report, page::material_page(html, as_json(page, c)), Sync::none);
  say("report in " + printable(body.report->string()) + "\n", options.json ? stderr : stdout);
  return done;
}

}  // namespace vbond::app
