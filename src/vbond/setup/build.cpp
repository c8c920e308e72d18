#include "vbond/setup/build.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "vbond/model/mistakes.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/case_cell.hpp"
#include "vbond/setup/case_sources.hpp"
#include "vbond/setup/detail/build_checks.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/inertia.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/own_bonds.hpp"
#include "vbond/setup/source_bonds.hpp"
#include "vbond/setup/stage_step.hpp"
#include "vbond/setup/velocities.hpp"
#include "vbond/terms/walls/setup_walls.hpp"

namespace vbond {
namespace {

std::vector<PlacedSpecimen> place_specimens(const Case& c, int threads) {
  Problems problems;
  std::vector<PlacedSpecimen> placed;
  std::size_t first = 0;
  for (const SpecimenSpec& spec : c.specimens) {
    try {
      placed.push_back({&spec, first, make_specimen(spec, c, threads)});
      first += placed.back().points.r.size();
    } catch (const CaseError& e) {
      problems.add(e);
    }
  }
  if (c.specimens.empty())
    problems.add({c.file, 0, 0}, "the case has no specimen", "there is nothing to compute",
                 "add a [[specimens]] table");
  problems.throw_if_any();
  return placed;
}

/// Mass, inertia and radius of the particles of one specimen, from the case or from its file.
class Properties {
 public:
  Properties(const PlacedSpecimen& s, Problems& problems) : s_(s), problems_(problems) {
    const SpecimenSpec& spec = *s.spec;
    given_once("radius", (spec.radius != 0.0) + !s.points.radius.empty(), false);
    // of a wall and of fibres, masses and perhaps inertias are those that the density gives
    const bool made = spec.thickness.has_value() || std::holds_alternative<FibresSpecimen>(spec.shape);
    given_once("mass", spec.mass.has_value() + (spec.density && !made) + !s.points.mass.empty(), true);
    given_once("inertia", times_inertia_is_given(spec, s.points), false);
  }

  double radius(std::size_t i) const {
    return s_.points.radius.empty() ? s_.spec->radius : s_.points.radius[i];
  }

  double mass(std::size_t i) const {
    if (!s_.points.mass.empty()) return s_.points.mass[i];
    const double factor = s_.points.mass_factor.empty() ? 1.0 : s_.points.mass_factor[i];
    if (s_.spec->mass) return factor * *s_.spec->mass;
    const double R = radius(i);
    return factor * 4.0 / 3.0 * std::numbers::pi * R * R * R * s_.spec->density.value_or(0.0);
  }

  PrincipalInertia inertia(std::size_t i) const {
    return inertia_of(*s_.spec, s_.points, i, mass(i), radius(i));
  }

  /// True if particle i can move; else the reason is recorded.
  bool check(std::size_t i) const {
    const auto finite_positive = [](double x) { return x > 0.0 && std::isfinite(x); };
    if (!is_finite(s_.points.r[i]))
      return refuse(i, "its position is not finite", "positions are finite numbers", "correct the position");
    if (!(radius(i) >= 0.0) || !std::isfinite(radius(i)))
      return refuse(i, fmt::format("radius = {}", radius(i)), "must be >= 0", "correct the radius");
    if (!finite_positive(mass(i)))
      return refuse(i, fmt::format("mass = {}", mass(i)), "must be > 0 and finite",
                    !s_.spec->density ? "give a positive mass"
                    : s_.spec->thickness
                        ? "a surface shares its mass by its triangles, and this particle has "
                          "none: give mass in place of density"
                        : "a density needs a positive radius");
    const Vec3d I = inertia(i).moments;
    if (!finite_positive(least_of(I)) || !finite_positive(largest_of(I)))
      return refuse(i, fmt::format("inertia = {}", least_of(I)),
                    "must be > 0 and finite; by default 2/5 m R^2",
                    "give the specimen an inertia, or a positive radius");
    if (!keep_the_triangle_inequality(I))
      return refuse(i, fmt::format("moments of inertia {}, {}, {}", I.x, I.y, I.z),
                    "none may be above the sum of the other two: no mass has such ones", "correct them");
    return true;
  }

 private:
  void given_once(const char* what, int times, bool required) const {
    if (times > 1)
      problems_.add(
          s_.spec->place, fmt::format("specimen \"{}\": {} is given more than once", s_.spec->name, what),
          "it comes from the case (mass or density) or from the specimen's file", "give it in one place");
    if (times < 1 && required)
      problems_.add(s_.spec->place, fmt::format("specimen \"{}\" has no mass", s_.spec->name),
                    "it comes from mass, density, or the specimen's file", "give mass or density");
  }

  bool refuse(std::size_t i, const std::string& what, const char* rule, const char* way_out) const {
    problems_.add(s_.spec->place, fmt::format("specimen \"{}\", its particle {}: {}", s_.spec->name, i, what),
                  rule, way_out);
    return false;
  }

  const PlacedSpecimen& s_;
  Problems& problems_;
};

/// A column that grows takes up to half as much again.
void reserve_particles(const std::vector<PlacedSpecimen>& specimens, Model& model) {
  std::size_t particles = 0;
  for (const PlacedSpecimen& s : specimens) particles += s.points.r.size();
  model.mass.reserve(particles), model.inertia.reserve(particles), model.radius.reserve(particles);
  model.specimen.reserve(particles), model.r_0.reserve(particles);
}

void add_particles(const PlacedSpecimen& s, std::uint32_t number, Built& built, Problems& problems) {
  const std::size_t before = problems.count();
  const Properties properties(s, problems);
  if (problems.count() > before) return;
  Model& model = built.model;
  for (std::size_t i = 0; i < s.points.r.size(); ++i) {
    if (!properties.check(i)) return;  // one report per specimen
    model.mass.push_back(properties.mass(i));
    const PrincipalInertia inertia = properties.inertia(i);
    const ParticleId p{model.inertia.size()};
    model.inertia.push_back(least_of(inertia.moments));
    if (!model.principal.empty()) model.principal.push_back(inertia);
    if (!all_equal(inertia.moments)) make_top(model, p, inertia);
    model.radius.push_back(properties.radius(i));
    model.specimen.push_back(number);
    model.r_0.push_back(s.points.r[i]);
  }
}

/// The state has orientations and velocities of these particles alone, which are as new; null: of all.
void hold_motion(State& state, const PerParticle<Vec3d>::Some& some, std::size_t particles) {
  const auto hold = [&](auto& column) {
    if (some != nullptr)
      column.hold(some);
    else
      column.assign(particles, {});
  };
  hold(state.q), hold(state.v), hold(state.omega);
}

/// Orientations and velocities of those particles that the state has them of.
void set_motion(const std::vector<PlacedSpecimen>& specimens, const Model& model, State& state) {
  for (const ParticleId p : model.specimen.ids()) {
    if (!state.q.holds(p)) continue;
    const PlacedSpecimen& s = specimens[model.specimen[p]];
    const SpecimenPoints& of = s.points;
    const std::size_t i = p.value - s.first;
    state.q[p] = of.orientations.empty() ? of.q : normalised(of.q * of.orientations[i]);
    if (!of.v.empty()) state.v[p] = of.v[i];
    if (!of.omega.empty()) state.omega[p] = of.omega[i];
  }
}

/// The model has their points, and nobody asks for pieces of them any more: what set_motion() takes is left.
void keep_motion_alone(std::vector<PlacedSpecimen>& specimens) {
  for (PlacedSpecimen& s : specimens) {
    SpecimenPoints left;
    left.q = s.points.q, left.orientations = std::move(s.points.orientations);
    left.v = std::move(s.points.v), left.omega = std::move(s.points.omega);
    s.points = std::move(left);
  }
}

/// Bonds that a file tells apart and the case does not are made alike.
void note_bond_types(const Case& c, const std::vector<PlacedSpecimen>& specimens, Built& built) {
  std::set<std::int64_t> types;
  for (const PlacedSpecimen& s : specimens)
    for (const FileBond& bond : s.points.bonds)
      if (bond.type != no_bond_type) types.insert(bond.type);
  if (types.size() < 2) return;
  for (const BondSpec& b : c.bonds)
    if (const auto* pairs = std::get_if<SpecimenPairs>(&b.select.value); pairs && !pairs->bond_type)
      built.notes.push_back(fmt::format(
          "bonds \"{}\": the bond types {} of the file are made alike; bond_type takes one of them", b.name,
          fmt::join(types, ", ")));
}

/// 2 pi sqrt(m / c_A); 0 if there is none, and then no time may be given in it.
double natural_time(const Case& c, const Built& built, Problems& problems) {
  const double two_pi = 2.0 * std::numbers::pi;
  State of_first;  // if this process may not have it
  if (built.own) of_first.bonds = built.own->first;
  const auto c_A = !of_first.bonds.empty() ? first_c_A(c, built.model, of_first)
                   : built.model.sources.empty()
                       ? first_c_A(c, built.model, built.state)
                       : first_c_A(c, built.model, with_bonds_to_come(built.model, built.state));
  if (!c_A || !(*c_A > 0.0)) return c.units == UnitSystem::reduced ? two_pi : 0.0;
  const double m = built.model.mass[ParticleId{0}], T_0 = two_pi * std::sqrt(m / *c_A);
  constexpr double largest = 1e60;  // as of the numbers of a case
  if (!(T_0 > 1.0 / largest && T_0 < largest))
    problems.add(
        c.bonds.front().place, fmt::format("T0 = {:.6g}", T_0),
        fmt::format("T0 = 2 pi sqrt(m / c_A) must lie between 1e-60 and 1e60; here m = {:.6g} and the "
                    "first bond has c_A = {:.6g}",
                    m, *c_A),
        "look for a missing or misplaced unit in mass, E or the section");
  return T_0;
}

}  // namespace

namespace {

Built build_body(const Case& c, int threads, const KeepOwnBonds* processes);

}  // namespace

Built build(const Case& c, int threads) {
  return build_body(c, threads, nullptr);
}

Built build(const Case& c, int threads, const KeepOwnBonds& processes) {
  if (processes.all.ranks() == 1 || !may_keep_own_bonds(c)) return build(c, threads);
  try {
    Built built = build_body(c, threads, &processes);
    const bool sound = mistakes_in(built.model, built.state).empty();
    if (!processes.all.any(!sound)) return built;
  } catch (const CaseError&) {
    // told of the whole body, below
  }
  return build(c, threads);
}

double count_particles(const Case& c) {
  double n = 0.0;
  for (const SpecimenSpec& s : c.specimens) {
    const auto source = std::find_if(c.sources.begin(), c.sources.end(),
                                     [&s](const SourceSpec& of) { return of.specimen.value == s.name; });
    n += count_points(s) * (source == c.sources.end() ? 1.0 : static_cast<double>(source->count));
  }
  return n;
}

namespace {

Built build_body(const Case& c, int threads, const KeepOwnBonds* processes) {
  Problems problems;
  Built built;
  Model& model = built.model;
  State& state = built.state;
  model.units = c.units;
  model.contact = c.contact;

  std::vector<PlacedSpecimen> specimens = place_specimens(c, threads);
  reserve_particles(specimens, model);
  std::uint32_t number = 0;
  for (const PlacedSpecimen& s : specimens) {
    add_particles(s, number++, built, problems);
    built.notes.insert(built.notes.end(), s.points.notes.begin(), s.points.notes.end());
    if (s.points.packing) {
      built.packings.emplace_back(s.spec->name, *s.points.packing);
      built.packings.back().second.r = {}, built.packings.back().second.radius = {};
    }
    if (!s.points.figures.empty()) built.figures.push_back({s.spec->name, s.points.figures});
    if (!c.cell)
      built.notes.insert(built.notes.end(), s.points.notes_on_open_bodies.begin(),
                         s.points.notes_on_open_bodies.end());
  }
  note_bond_types(c, specimens, built);
  const bool motion_later =
      processes != nullptr && may_keep_own_motion(c);  // known to few: see own_bonds.hpp
  const auto know_motion_of = [&](const std::vector<ParticleId>& some) {
    hold_motion(state, std::make_shared<IdSet<ParticleId>>(model.particles(), some), model.particles());
  };
  if (motion_later)
    know_motion_of({});
  else
    hold_motion(state, nullptr, model.particles());
  if (problems.none()) set_motion(specimens, model, state);
  add_sources(c, specimens, built, problems);
  problems.throw_if_any();
  add_cell(c, specimens, built, problems);
  check_periodic(c, model, problems);
  problems.throw_if_any();
  state.r = model.r_0;
  const PerParticle<char> slice =
      processes != nullptr ? slice_of(state.r, processes->all) : PerParticle<char>{};
  check_distinct(c, model, state, processes != nullptr ? &slice : nullptr, problems);
  check_contact(c, model, problems);
  add_materials(c, specimens, model, problems);
  add_walls(c, built, problems);
  add_groups(c, specimens, model, built.notes, problems);
  const auto throw_if_any = [&problems, processes] {  // each process finds its own
    if (processes != nullptr)
      throw_if_any_has(problems, processes->all);
    else
      problems.throw_if_any();
  };
  if (processes != nullptr) processes->meet();
  throw_if_any();
  add_copies(c, built);
  if (!c.cell) keep_motion_alone(specimens);

  const auto know_only = [&](const std::vector<ParticleId>& some) {  // and second ends of own bonds
    if (may_keep_own_first_places(c))
      model.r_0.hold(std::make_shared<IdSet<ParticleId>>(model.particles(), some));
    if (!motion_later) return;
    know_motion_of(some);
    set_motion(specimens, model, state);
  };
  SharedCells shared(threads);
  if (processes != nullptr)
    built.own = std::make_shared<BondsFromSetUp>(
        make_own_bonds(c, model, state, slice, *processes, know_only, problems, shared));
  else
    for (std::size_t set = 0; set < c.bonds.size(); ++set)
      if (c.bonds[set].when == BondTime::start) add_bonds_at_start(c, set, built, problems, shared);
  check_pairs_of_sources(c, model, problems);
  check_overlaps(c, built, built.body(), problems);
  for (const Source& source : model.sources) check_overlaps(c, built, body_alone(built, source), problems);
  model.T_0 = natural_time(c, built, problems);
  add_velocities(c, model, state, problems);
  check_turned_pieces(c, specimens, built, problems);
  check_stages(c, model, problems);
  check_output(c, model, problems);
  check_case_of_sources(c, problems);
  check_output_of_sources(c, model, problems);
  throw_if_any();
  check_sources(c, built, problems);
  check_durations(c, built, problems);
  throw_if_any();
  for (std::string& note : notes_on_pairs(c)) built.notes.push_back(std::move(note));
  for (std::string& note : notes_on_prestrain(c, model, built.body())) built.notes.push_back(std::move(note));
  return built;
}

}  // namespace

}  // namespace vbond
