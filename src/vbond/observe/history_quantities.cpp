#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "vbond/observe/quantities.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {
namespace {

using Values = HistoryValues;

template <class T>
Cell cell_of(const std::optional<T>& x) {
  if constexpr (std::is_integral_v<T>)
    return x ? Cell(std::int64_t{*x}) : Cell();
  else
    return x ? Cell(*x) : Cell();
}

template <std::size_t k>
Cell cell_strain(const Values& v) {
  return v.cell ? Cell(v.cell->strain[k]) : Cell();
}
template <std::size_t k>
Cell cell_stress_of(const Values& v) {
  return v.cell ? Cell(v.cell->stress[k]) : Cell();
}

/// Empty where there is none.
void add_known(const SymmetricParts& parts, std::vector<Cell>& to) {
  for (const double x : parts) to.push_back(std::isfinite(x) ? Cell(x) : Cell());
}
void add3(const Vec3d& x, std::vector<Cell>& to) {
  to.insert(to.end(), {x.x, x.y, x.z});
}
void add3(const std::optional<Vec3d>& x, std::vector<Cell>& to) {
  if (!x) return to.resize(to.size() + 3);
  add3(*x, to);
}

// In the order of the columns. New ones stand behind the others: a file of an earlier version gets them there
// too.
constexpr HistoryQuantity columns[] = {
    {"step", unit::none, "steps since the start of the run",
     [](const Values& v) -> Cell { return v.clock.step; }},
    {"time", unit::time, "time since the start of the run",
     [](const Values& v) -> Cell { return v.clock.time(); }},
    {"kinetic_translation", unit::energy, "kinetic energy of translation",
     [](const Values& v) -> Cell { return v.energies.kinetic_translation; }},
    {"kinetic_rotation", unit::energy, "kinetic energy of rotation",
     [](const Values& v) -> Cell { return v.energies.kinetic_rotation; }},
    {"U_L", unit::energy, "energy of the bonds: stretching",
     [](const Values& v) -> Cell { return v.energies.U_L; }},
    {"U_B", unit::energy, "energy of the bonds: bending and shear",
     [](const Values& v) -> Cell { return v.energies.U_B; }},
    {"U_T", unit::energy, "energy of the bonds: torsion",
     [](const Values& v) -> Cell { return v.energies.U_T; }},
    {"contact", unit::energy, "energy of the contacts",
     [](const Values& v) -> Cell { return v.energies.contact; }},
    {"dissipated", unit::energy,
     "taken out by damping and flow so far, and contact energy given up when a pair is bonded; at rest by "
     "bonds that yield or soften, since they were made",
     [](const Values& v) -> Cell { return v.books.dissipated; }},
    {"work_loads", unit::energy, "work of point forces, moments and gravity so far",
     [](const Values& v) -> Cell { return v.books.work_loads; }},
    {"work_supports", unit::energy,
     "work of supports, prescribed velocities, imposed strain and changes of temperature so far",
     [](const Values& v) -> Cell { return v.books.work_supports; }},
    {"total", unit::energy, "kinetic + bonds + contact",
     [](const Values& v) -> Cell { return v.energies.total(); }},
    {"balance_error", unit::none,
     "(total + dissipated + released + removed - work - inserted - total at the start) / largest energy "
     "brought in so far; 0 while there is none",
     [](const Values& v) -> Cell { return v.balance_error; }},
    {"bonds", unit::none, "number of bonds", [](const Values& v) -> Cell { return v.bonds; }},
    {"strained", unit::none, "bonds that are now past 45 degrees but not past 90; see below",
     [](const Values& v) -> Cell { return v.ranges.strained; }},
    {"snapped", unit::none, "bonds that are now past 90 degrees; see below",
     [](const Values& v) -> Cell { return v.ranges.snapped; }},
    {"peak_average", unit::force,
     "last block average of the quantity a peak is watched in; 0 without such a stop or before the first "
     "block",
     [](const Values& v) -> Cell { return v.peak_average; }},
    {"load_factor", unit::none, "of a static point; empty in dynamics",
     [](const Values& v) { return cell_of(v.load_factor); }, Only::statics},
    {"unstable", unit::none,
     "negative eigenvalues of the tangent at a static point, 0 if it is stable; empty where they were not "
     "counted, and in dynamics",
     [](const Values& v) { return cell_of(v.unstable); }, Only::statics},
    {"released", unit::energy,
     "energy of bonds as they broke so far, less that of contacts that this switched on; of a stage of "
     "fracture what its breaks took out of the body so far",
     [](const Values& v) -> Cell { return v.books.released; }, Only::breaks},
    {"broken", unit::none, "bonds that have broken so far", [](const Values& v) -> Cell { return v.broken; },
     Only::breaks},
    {"fragments", unit::none,
     "parts of all bodies that unbroken bonds hold together; contacts do not count; a particle without bonds "
     "is one",
     [](const Values& v) { return v.fragments ? Cell(v.fragments->number) : Cell(); }, Only::breaks},
    {"largest_fragment", unit::none, "mass of the heaviest fragment over that of all particles",
     [](const Values& v) { return v.fragments ? Cell(v.fragments->largest_share) : Cell(); }, Only::breaks},
    {"cell_volume", unit::volume, "volume of the cell",
     [](const Values& v) { return v.cell ? Cell(v.cell->volume) : Cell(); }, Only::cell},
    {"cell_density", unit::density, "mass of the particles over it",
     [](const Values& v) { return v.cell ? Cell(v.cell->density) : Cell(); }, Only::cell},
    {"cell_strain_xx", unit::none, "deformation gradient of the cell against its edges at the start, less 1",
     cell_strain<0>, Only::cell},
    {"cell_strain_yy", unit::none, "the same", cell_strain<1>, Only::cell},
    {"cell_strain_zz", unit::none, "the same", cell_strain<2>, Only::cell},
    {"cell_strain_yz", unit::none, "component yz of the deformation gradient", cell_strain<3>, Only::cell},
    {"cell_strain_xz", unit::none, "component xz of it", cell_strain<4>, Only::cell},
    {"cell_strain_xy", unit::none, "component xy of it", cell_strain<5>, Only::cell},
    {"cell_stress_xx", unit::stress,
     "Cauchy's stress of the body, tension positive: the sum of r_ij f_i over bonds and contacts of "
     "particles, with "
     "elastic "
     "forces and friction, less what particles carry that move beside the cell, over its volume; the "
     "symmetric "
     "part",
     cell_stress_of<0>, Only::cell},
    {"cell_stress_yy", unit::stress, "the same", cell_stress_of<1>, Only::cell},
    {"cell_stress_zz", unit::stress, "the same", cell_stress_of<2>, Only::cell},
    {"cell_stress_yz", unit::stress, "the same", cell_stress_of<3>, Only::cell},
    {"cell_stress_xz", unit::stress, "the same", cell_stress_of<4>, Only::cell},
    {"cell_stress_xy", unit::stress, "the same", cell_stress_of<5>, Only::cell},
    {"particles", unit::none, "that take part: those that have not come in yet or are gone do not count",
     [](const Values& v) -> Cell { return v.present; }, Only::passage},
    {"particles_in", unit::none, "that have come in so far",
     [](const Values& v) -> Cell { return v.mass.particles_in; }, Only::passage},
    {"particles_out", unit::none, "that sinks took out so far",
     [](const Values& v) -> Cell { return v.mass.particles_out; }, Only::passage},
    {"mass_in", unit::mass, "mass that has come in so far",
     [](const Values& v) -> Cell { return v.mass.mass_in; }, Only::passage},
    {"mass_out", unit::mass, "mass that was taken out so far",
     [](const Values& v) -> Cell { return v.mass.mass_out; }, Only::passage},
    {"momentum_in_x", unit::momentum, "momentum that has come in so far",
     [](const Values& v) -> Cell { return v.mass.momentum_in.x; }, Only::passage},
    {"momentum_in_y", unit::momentum, "the same",
     [](const Values& v) -> Cell { return v.mass.momentum_in.y; }, Only::passage},
    {"momentum_in_z", unit::momentum, "the same",
     [](const Values& v) -> Cell { return v.mass.momentum_in.z; }, Only::passage},
    {"momentum_out_x", unit::momentum, "momentum that went with particles so far",
     [](const Values& v) -> Cell { return v.mass.momentum_out.x; }, Only::passage},
    {"momentum_out_y", unit::momentum, "the same",
     [](const Values& v) -> Cell { return v.mass.momentum_out.y; }, Only::passage},
    {"momentum_out_z", unit::momentum, "the same",
     [](const Values& v) -> Cell { return v.mass.momentum_out.z; }, Only::passage},
    {"inserted", unit::energy, "energy of bodies as they came in so far",
     [](const Values& v) -> Cell { return v.books.inserted; }, Only::passage},
    {"removed", unit::energy, "energy that went with particles that were taken out so far",
     [](const Values& v) -> Cell { return v.books.removed; }, Only::passage},
};

std::vector<std::string> names_of_stressed(const OutputPlan& plan) {
  std::vector<std::string> names;
  for (const StressedGroup& g : plan.stresses) names.push_back(g.group.name);
  return names;
}

std::vector<std::string> names_of_losses(const OutputPlan& plan) {
  std::vector<std::string> names;
  for (const Loss cause : plan.losses) names.emplace_back(to_text(cause));
  return names;
}

template <auto groups>
std::vector<std::string> names_of(const OutputPlan& plan) {
  std::vector<std::string> names;
  for (const Group& g : plan.*groups) names.push_back(g.name);
  return names;
}

std::vector<GroupQuantity> before_terms() {
  return {
      {"reaction",
       "GROUP",
       {{"fx", unit::force, "force and moment (about the origin) that supports exert on the group"},
        {"fy", unit::force},
        {"fz", unit::force},
        {"mx", unit::moment},
        {"my", unit::moment},
        {"mz", unit::moment}},
       names_of<&OutputPlan::reactions>,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) {
         add3(v.reactions[k].force, to), add3(v.reactions[k].moment, to);
       }},
      {"axial_force",
       "GROUP",
       {{"", unit::force,
         "mean F.d of unbroken bonds and cells of joints with both ends in it, 0 without any; tension "
         "positive"}},
       names_of<&OutputPlan::axial_force>,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) { to.emplace_back(v.axial_force[k]); }},
      {"displacement",
       "GROUP",
       {{"x", unit::length,
         "position less position at the start: of a particle, or the mean over those of a group that "
         "sinks have not taken out; empty where none is left"},
        {"y", unit::length},
        {"z", unit::length}},
       names_of<&OutputPlan::displacements>,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) { add3(v.displacements[k], to); }},
  };
}

std::vector<GroupQuantity> behind_terms() {
  return {
      {"grip",
       "GROUP",
       {{"Fx", unit::force, "force that a rigid support exerts on its group, inertia left out"},
        {"Fy", unit::force},
        {"Fz", unit::force},
        {"Mx", unit::moment, "the same moment, about the pivot where it is now"},
        {"My", unit::moment},
        {"Mz", unit::moment},
        {"angle", unit::angle, "that it has turned about its axis since the stage began"},
        {"work", unit::energy,
         "that it has done in the stage, a part of work_supports; empty in static stages"}},
       [](const OutputPlan& plan) { return plan.grips; },
       [](const Values& v, std::size_t k, std::vector<Cell>& to) {
         if (k >= v.grips.size() || !v.grips[k]) return to.resize(to.size() + 8);
         const GripView& g = *v.grips[k];
         add3(g.force, to), add3(g.moment, to), to.emplace_back(g.angle), to.push_back(cell_of(g.work));
       }},
      {"stress",
       "GROUP",
       {{"xx", unit::stress,
         "mean stress of the group, tension positive: the sum of x f over its particles' bonds and contacts, "
         "walls among them, where f acts on a particle at x from its centre, over the volume that is given; "
         "the symmetric part"},
        {"yy", unit::stress},
        {"zz", unit::stress},
        {"yz", unit::stress},
        {"zx", unit::stress},
        {"xy", unit::stress}},
       names_of_stressed,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) { add_known(v.stresses[k], to); }},
      {"strain",
       "GROUP",
       {{"xx", unit::none,
         "mean strain of the group since the start: Green's, of the deformation that fits its particles' "
         "displacements best; empty if they are in one plane"},
        {"yy", unit::none},
        {"zz", unit::none},
        {"yz", unit::none},
        {"zx", unit::none},
        {"xy", unit::none}},
       names_of_stressed,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) { add_known(v.strains[k], to); }},
      {"dissipated",
       "CAUSE",
       {{"", unit::energy,
         "the part of `dissipated` that went this way, for each cause that the case may have: "
         "`damping_axial`, `damping_shear`, `damping_bending`, `damping_torsion` of bonds (what their "
         "damping takes in a step, shared out as the powers in its middle); `bond_damping` (bonds of a "
         "program's own law that does not tell its channels); `yield_axial`, `yield_shear`, `yield_bending`, "
         "`yield_torsion`; `creep`; `softening`; `other_laws` (bonds of a program's own law that remember "
         "something); `drag` and `local_damping` of particles; `contact_damping`; `friction`, also of "
         "cracked "
         "bonds; `rolling` (and twisting); `adhesion`; `bonding` (contacts that end because the pair is "
         "bonded)"}},
       names_of_losses,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) { to.emplace_back(v.losses[k]); }},
      {"velocity",
       "GROUP",
       {{"x", unit::velocity,
         "velocity of a particle, or the mean over those of a group that are there; empty where none is, "
         "and in static stages"},
        {"y", unit::velocity},
        {"z", unit::velocity}},
       names_of<&OutputPlan::velocities>,
       [](const Values& v, std::size_t k, std::vector<Cell>& to) {
         if (k >= v.velocities.size()) return to.resize(to.size() + 3);
         add3(v.velocities[k], to);
       }},
  };
}

/// Columns of terms stand among the others, where those of walls have always been.
const std::vector<GroupQuantity>& of_groups() {
  static const std::vector<GroupQuantity> all = [] {
    std::vector<GroupQuantity> q = before_terms();
    Terms::for_each([&]<class T>(T) { T::add_columns(q); });
    for (GroupQuantity& next : behind_terms()) q.push_back(std::move(next));
    return q;
  }();
  return all;
}

/// Components without a meaning of their own share that of the last one before them that has one.
const char* meaning_of(const GroupQuantity& q, const GroupQuantity::Component& c) {
  const GroupQuantity::Component* with = &c;
  while (with->meaning == nullptr && with != q.components.data()) --with;
  return with->meaning;
}

/// Whether a column is one of NAME.GROUP.COMPONENT.
bool is_column_of(std::string_view column, const GroupQuantity& q, std::string_view component) {
  const std::string begin = std::string(q.name) + '.',
                    end = component.empty() ? "" : '.' + std::string(component);
  return column.size() > begin.size() + end.size() && column.starts_with(begin) && column.ends_with(end);
}

}  // namespace

const char* to_text(Loss cause) {
  switch (cause) {
    case Loss::bond_damping: return "bond_damping";
    case Loss::yield_axial: return "yield_axial";
    case Loss::yield_shear: return "yield_shear";
    case Loss::yield_bending: return "yield_bending";
    case Loss::yield_torsion: return "yield_torsion";
    case Loss::creep: return "creep";
    case Loss::softening: return "softening";
    case Loss::other_laws: return "other_laws";
    case Loss::drag: return "drag";
    case Loss::local_damping: return "local_damping";
    case Loss::contact_damping: return "contact_damping";
    case Loss::friction: return "friction";
    case Loss::rolling: return "rolling";
    case Loss::adhesion: return "adhesion";
    case Loss::bonding: return "bonding";
    case Loss::damping_axial: return "damping_axial";
    case Loss::damping_shear: return "damping_shear";
    case Loss::damping_bending: return "damping_bending";
    case Loss::damping_torsion: return "damping_torsion";
  }
  return "";
}

std::span<const HistoryQuantity> history_quantities() {
  return columns;
}

std::span<const GroupQuantity> group_quantities() {
  return of_groups();
}

GroupQuantity term_quantity(const char* name, std::vector<GroupQuantity::Component> components,
                            void (*look)(const BodyView&, const Group&, std::vector<Cell>& to)) {
  const std::string key = name;
  const auto names = [key](const OutputPlan& plan) {
    std::vector<std::string> of;
    if (const auto groups = plan.of_terms.find(key); groups != plan.of_terms.end())
      for (const Group& g : groups->second) of.push_back(g.name);
    return of;
  };
  const auto add = [key](const Values& v, std::size_t k, std::vector<Cell>& to) {
    const std::vector<Cell>& cells = v.of_terms.at(key)[k];
    to.insert(to.end(), cells.begin(), cells.end());
  };
  return {name, "GROUP", std::move(components), names, add, look};
}

std::optional<ColumnFacts> facts_of_column(std::string_view name) {
  for (const HistoryQuantity& q : columns)
    if (name == q.name) return ColumnFacts{q.unit, q.meaning};
  for (const GroupQuantity& q : of_groups())
    for (const GroupQuantity::Component& c : q.components)
      if (is_column_of(name, q, c.name)) return ColumnFacts{c.unit, meaning_of(q, c)};
  return std::nullopt;
}

}  // namespace vbond
