#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "commands.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/observe/bond_list.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/run/run.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {
namespace {

/// What the bond style of the plugin cannot do.
void refuse_what_lammps_lacks(const Case& c, const Model& model, const BondList& list) {
  std::vector<Problem> problems;
  const SourcePlace file{c.file, 0, 0};
  for (const ParticleId p : model.mass.ids())
    if (model.is_top(p)) {
      problems.push_back({file, "particles with three moments of inertia",
                          "LAMMPS' atoms of style bpm/sphere have one", "give them one"});
      break;
    }
  if (!c.sources.empty() || !c.sinks.empty())
    problems.push_back({!c.sources.empty() ? c.sources.front().place : c.sinks.front().place,
                        "particles that come in or are taken out during the run",
                        "a data file has the body as it is at the start",
                        "export a case without [[source]] and [[sink]]"});
  if (model.cell.any())
    problems.push_back({c.cell ? c.cell->place : file, "a periodic cell",
                        "the list of bonds names particles, and not which of their images a bond joins",
                        "export an open body"});
  for (const BondSpec& set : c.bonds)
    if (set.recipe.flat_joint.any())
      problems.push_back(
          {set.place, fmt::format("bonds \"{}\": flat_joint", set.name),
           "the cells of a joint are several bonds of one pair, which LAMMPS does not tell apart",
           "export the case without flat_joint"});
  for (const BondKind& kind : list.kinds)
    if (kind.law->remembers() && kind.law->crack == nullptr)  // flat joints are told above
      problems.push_back({file, fmt::format("bonds of the law {}", kind.law->name),
                          "bond_style vbond has bonds that remember nothing: without yield, creep, softening",
                          "export the case without these keys"});
  if (!problems.empty()) throw CaseError(std::move(problems));
}

/// The longest bond, or the largest diameter.  [length]
double longest_reach(const Model& model, const BondList& list) {
  double longest = 2.0 * *std::max_element(model.radius.begin(), model.radius.end());
  for (const Bond& b : list.bonds) {
    double reach = b.a + std::abs(b.R_i) + std::abs(b.R_j);
    for (const double o : offsets_of(b)) reach += std::abs(o);
    longest = std::max(longest, reach);
  }
  return longest;
}

/// A LAMMPS data file for atom_style bpm/sphere, with the moments of inertia as the section Inertia.
std::string data_file(const Case& c, const Model& model, const State& state, const BondList& list) {
  const BoundingBox box = box_around(state.r);
  const double margin = longest_reach(model, list);
  std::string text = fmt::format(
      "# {}, exported by vbond\n\n{} atoms\n1 atom types\n{} bonds\n{} bond types\n\n", printable(c.title),
      model.particles(), list.bonds.size(), std::max<std::size_t>(1, list.kinds.size()));
  const auto out = std::back_inserter(text);
  const auto extent = [&](const char* axis, double low, double high) {
    fmt::format_to(out, "{:.17g} {:.17g} {}lo {}hi\n", low - margin, high + margin, axis, axis);
  };
  extent("x", box.low.x, box.high.x), extent("y", box.low.y, box.high.y), extent("z", box.low.z, box.high.z);
  text += "\nAtoms # bpm/sphere\n\n";  // id molecule type diameter density x y z
  for (const ParticleId p : state.r.ids()) {
    const double R = model.radius[p], volume = 4.0 / 3.0 * std::numbers::pi * R * R * R;
    const double density = R > 0.0 ? model.mass[p] / volume : model.mass[p];  // as LAMMPS reads it for points
    const Vec3d& r = state.r[p];
    fmt::format_to(out, "{} 0 1 {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", p.value + 1, 2.0 * R, density,
                   r.x, r.y, r.z);
  }
  text += "\nVelocities\n\n";
  for (const ParticleId p : state.r.ids()) {
    const Vec3d &v = state.v[p], &omega = state.omega[p];
    fmt::format_to(out, "{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", p.value + 1, v.x, v.y, v.z,
                   omega.x, omega.y, omega.z);
  }
  text += "\nInertia\n\n";
  for (const ParticleId p : state.r.ids()) fmt::format_to(out, "{} {:.17g}\n", p.value + 1, model.inertia[p]);
  if (list.bonds.empty()) return text;
  text += "\nBonds\n\n";
  for (std::size_t n = 0; n < list.bonds.size(); ++n)
    fmt::format_to(out, "{} {} {} {}\n", n + 1, list.kind[n] + 1, list.bonds[n].i.value + 1,
                   list.bonds[n].j.value + 1);
  return text;
}

std::string input_file(const Case& c, const Model& model, const BondList& list, const Stage& stage) {
  const double longest = longest_reach(model, list);
  const bool breaks = std::any_of(list.bonds.begin(), list.bonds.end(), can_break);
  return fmt::format(
      R"(# {title}, exported by vbond: bodies, bonds and velocities. Supports, loads and contacts are yours to add.
# lmp -in body.lammps, with the packages BPM, MOLECULE and PLUGIN, and the folder of vbondplugin.so in
# LAMMPS_PLUGIN_PATH
variable      steps index {steps}     # -var steps N
units         {units}
atom_style    bpm/sphere
boundary      s s s
newton        on off
special_bonds lj 0 1 1 coul 1 1 1
comm_modify   vel yes cutoff {cutoff:.6g}
neighbor      {skin:.6g} bin
fix           inertia all property/atom d_inertia
read_data     body.data fix inertia NULL Inertia
pair_style    zero {longest:.6g}
pair_coeff    * *
bond_style    vbond bonds body.bonds break {breaks}
bond_coeff    * listed
fix           move all vbond/nve
timestep      {dt:.17g}
thermo_style  custom step ke f_move pe bonds   # kinetic energy of translation and rotation, energy of bonds
thermo_modify norm no lost/bond ignore
thermo        $(ceil(v_steps/10))
run           ${{steps}}
)",
      fmt::arg("title", printable(c.title)),
      fmt::arg("steps",
               std::isfinite(stage.stops.duration) ? steps_in(stage.stops.duration, stage.dt) : 1000),
      fmt::arg("units", model.units == UnitSystem::si ? "si" : "lj"), fmt::arg("cutoff", 2.0 * longest),
      fmt::arg("skin", 0.3 * longest), fmt::arg("longest", longest),
      fmt::arg("breaks", breaks ? "yes" : "no"), fmt::arg("dt", stage.dt));
}

/// What of the first stage, and of the body, the files do not have.
void print_left_out(const Case& c, const Model& model, const Stage& stage) {
  std::vector<std::string> left_out;
  const auto note = [&](bool has, const char* what) {
    if (has && std::find(left_out.begin(), left_out.end(), what) == left_out.end())
      left_out.emplace_back(what);
  };
  note(particles_touch(model.contact), "contacts");
  note(!model.walls.empty(), "walls");
  note(!stage.supports.empty(), "supports");
  note(!stage.loads.empty(), "loads");
  note(norm2(stage.gravity) > 0.0, "gravity");
  note(stage.b_translation > 0.0 || stage.b_rotation > 0.0 || stage.local_damping > 0.0,
       "damping of particles");
  Terms::for_each([&]<class T>(T) { note(static_cast<const StagePart<T>&>(stage).any(), T::key); });
  note(!stage.bonding.empty(), "bonds made on approach");
  note(c.stages.size() > 1, "later stages");
  std::string list;
  for (const std::string& what : left_out) list += (list.empty() ? "" : ", ") + what;
  if (!list.empty()) fmt::print("left out: {}\n", list);
}

}  // namespace

int export_lammps(const RunOptions& options, const std::filesystem::path& folder) {
  const Case c = read_case(options.case_file, options.changes);
  Built built = build(c);
  Run run(std::move(built.model), std::move(built.state), stages_of(c));
  const auto* stage = std::get_if<Stage>(&run.prepare());
  if (!stage)
    throw CaseError(Problem{c.stages.front().place, "the first stage is static", "LAMMPS computes motion",
                            "export a case that begins with a stage of kind = \"dynamics\""});
  const Model& model = run.model();
  const State& state = run.current();
  const BondList list = bond_list(state);
  refuse_what_lammps_lacks(c, model, list);
  make_folder(folder);
  const std::pair<const char*, std::string> files[] = {{"body.data", data_file(c, model, state, list)},
                                                       {"body.bonds", to_text(list)},
                                                       {"body.lammps", input_file(c, model, list, *stage)}};
  for (const auto& [name, text] : files)
    if (std::filesystem::exists(folder / name))
      throw IoError((folder / name).string() + " is there already: remove it, or choose another folder");
  for (const auto& [name, text] : files) replace_file(folder / name, text);
  fmt::print("{} particles and {} bonds of {} kinds in {}: lmp -in body.lammps\n", model.particles(),
             list.bonds.size(), list.kinds.size(), folder.string());
  print_left_out(c, model, *stage);
  return done;
}

}  // namespace vbond::app
