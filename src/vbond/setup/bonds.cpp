#include "vbond/setup/bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "vbond/model/bond_sums.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/joint_cells.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/touching.hpp"

namespace vbond {
namespace {

/// The first mistake of a bond set is told in full, the others are counted.
struct FirstAndCount {
  std::string what;
  std::size_t count = 0;
  void note(const std::string& text) {
    if (count++ == 0) what = text;
  }
  std::string text() const { return count == 1 ? what : fmt::format("{} (and {} more)", what, count - 1); }
};

/// Of the points that a bond joins.
double distance_of(const BondSite& i, const BondSite& j) {
  return norm(between(i.r + i.offset, j.r + j.offset));
}

std::string length_left(const BondRecipe& recipe, const BondSite& i, const BondSite& j) {
  const bool surfaces = recipe.attachment == Attachment::surfaces || recipe.attachment == Attachment::neck;
  return fmt::format("particles {} and {} are {:.6g} apart with R_i = {:.6g}, R_j = {:.6g}", i.id.value,
                     j.id.value, distance_of(i, j), surfaces ? i.radius : recipe.R_i,
                     surfaces ? j.radius : recipe.R_j);
}

/// Why no length is left for a bond, and what to do.
struct NoLength {
  const char *rule, *way_out;
};
NoLength no_length_of(const BondRecipe& recipe) {
  if (recipe.attachment == Attachment::neck)
    return {
        "no length is left for the bond: the mean gap of the surfaces over its section, radius <= R_i and "
        "R_j, "
        "must be > 0",
        "let the particles overlap less, give the section a factor nearer to 1 (but <= the smaller radius), "
        "or "
        "bond at the centres"};
  if (recipe.attachment == Attachment::surfaces)
    return {
        "no length is left for the bond: a = distance - R_i - R_j must be > 0",
        "grains that touch or overlap slightly: attach = \"neck\" takes the length from the section; or bond "
        "at the centres, use smaller radii, or a larger spacing"};
  return {"no length is left for the bond: a = distance - R_i - R_j must be > 0",
          "bond at the centres, use smaller radii or attachment distances, or a larger spacing"};
}

bool has_stable_rest(const BondStiffness<double>& c) {
  return std::isfinite(c.c_A + c.c_D + c.c_B + c.c_T) && c.c_A > 0.0 && c.c_D >= 0.0 && c.c_B >= 0.0 &&
         c.c_T >= 0.0;
}

/// What contacts have stored in friction and rolling.  [energy]
double stored_slip(const Model& model, const State& state) {
  double U = 0.0;
  if (!state.contact_history.empty())
    for_touching_pairs(model, state, [&](ParticleId i, ParticleId j, const Image& n, double) {
      if (const PairMemory* memory = memory_of(state, i, j, n))
        U += history_energy(touch_forms(model.contact), touch_numbers(model, i, j),
                            touch_history(memory->history));
    });
  if (!state.fibre_history.empty())
    for (const auto& [c, touching, history] : fibre_touches(model, state))
      U += history_energy(fibre_forms(model.contact), touch_numbers(model, c.a.i.particle, c.b.i.particle),
                          touch_history(history));
  return U;
}

/// unbooked: takes up what is to be booked; null: it is booked.
void make_bonds_of(const Case& c, std::size_t set, const Model& model, State& state,
                   const SelectedPairs& selected, Problems& problems, std::vector<UnbookedBond>* unbooked);

}  // namespace

double longest_softening_bond(const Softening& s, double c_A, double a, double weakness) {
  return s.any() ? a * c_A * s.length / s.force * sq(1.0 + weakness) : INFINITY;
}

void refuse_snap_back(const BondSpec& spec, const std::string& what, double longest, Problems& problems) {
  problems.add(
      spec.softening->place, fmt::format("bonds \"{}\": softening: {}", spec.name, what),
      "its force would fall faster than the bond springs back: a < 2 E G_f/s_c^2 must hold",
      fmt::format("use bonds shorter than {:.4g}, a larger fracture_energy or a smaller tension", longest));
}

void refuse_broken_by_prestrain(const BondSpec& spec, const std::string& what, Problems& problems) {
  problems.add(spec.place,
               fmt::format("bonds \"{}\": prestrain = {}: {}", spec.name, spec.recipe.prestrain, what),
               "its prestrain alone uses up the strength, so that it is broken as it is made",
               "use a prestrain nearer to 0, or a larger strength");
}

void add_bonds(const Case& c, std::size_t set, const Model& model, State& state, Problems& problems,
               SharedCells& shared) {
  make_bonds(c, set, model, state, select_pairs(c, set, model, state, problems, shared), problems);
}

void make_bonds(const Case& c, std::size_t set, const Model& model, State& state,
                const SelectedPairs& selected, Problems& problems) {
  make_bonds_of(c, set, model, state, selected, problems, nullptr);
}

std::vector<UnbookedBond> make_some_bonds(const Case& c, std::size_t set, const Model& model, State& state,
                                          const SelectedPairs& selected, Problems& problems) {
  std::vector<UnbookedBond> unbooked;
  make_bonds_of(c, set, model, state, selected, problems, &unbooked);
  return unbooked;
}

namespace {

void make_bonds_of(const Case& c, std::size_t set, const Model& model, State& state,
                   const SelectedPairs& selected, Problems& problems, std::vector<UnbookedBond>* unbooked) {
  const BondSpec& spec = c.bonds[set];
  BondRecipe recipe = spec.recipe;
  recipe.set = static_cast<std::uint16_t>(set);
  const std::vector<BondRecipe> cells = recipes_of(recipe);
  FirstAndCount no_length, no_radius, unstable, snapping, no_capsule, broken;
  CapsuleMistake of_capsule;
  const EnergyBooks books = state.books;
  const bool whole = unbooked == nullptr;  // else nothing is a capsule, and nothing has slipped yet
  const double U = whole ? potential_energies(model, state).contact : 0.0,
               flowed = whole ? dissipated_by_flow(state) : 0.0,
               slip = whole ? stored_slip(model, state) : 0.0;
  double longest = INFINITY;  // of bonds that soften
  state.bonds.reserve(state.bonds.size() + selected.pairs.size() * cells.size());
  const auto make = [&](std::size_t k) {
    const Pair& pair = selected.pairs[k];
    if (is_absent(state, pair.i) || is_absent(state, pair.j)) return;
    const auto [site_i, site_j] = sites_of(selected, k, model, state);
    bool bare = false;
    for (const BondSite& site : {site_i, site_j})
      if (recipe.needs_radii() && !(site.radius > 0.0)) {
        no_radius.note(fmt::format("particle {} has radius {}", site.id.value, site.radius));
        bare = true;
      }
    if (bare) return;
    const auto bond = make_bond(cells.front(), site_i, site_j);
    if (!bond) {
      no_length.note(length_left(recipe, site_i, site_j));
      return;
    }
    if (breaks_by_prestrain(recipe, site_i, site_j))
      broken.note(fmt::format("the bond of particles {} and {}", pair.i.value, pair.j.value));
    const BondStiffness<double> stiff = stiffness_of(*bond);
    if (!has_stable_rest(stiff))
      unstable.note(fmt::format("particles {} and {}: c_A = {:.6g}, c_D = {:.6g}, c_B = {:.6g}, c_T = {:.6g}",
                                pair.i.value, pair.j.value, stiff.c_A, stiff.c_D, stiff.c_B, stiff.c_T));
    const double longest_now =
        longest_softening_bond(recipe.rules.softening, stiff.c_A, bond->a, weakness_of(*bond));
    if (!(bond->a < longest_now)) {
      snapping.note(
          fmt::format("the bond of particles {} and {} is {:.6g} long", pair.i.value, pair.j.value, bond->a));
      longest = std::min(longest, longest_now);
    }
    const double distance = distance_of(site_i, site_j);
    if (const auto mistake = capsule_mistake(model, *bond, distance)) {
      if (no_capsule.count == 0) of_capsule = *mistake;
      no_capsule.note(fmt::format("particles {} and {} are {:.6g} apart, the capsule's radius is {:.6g}",
                                  pair.i.value, pair.j.value, distance, capsule_of(*bond)));
    }
    const EnergyOfNewBond energy = take_up_bond(model, *bond, recipe, state);
    if (whole)
      book(energy, state.books);
    else if (energy.any())
      unbooked->push_back({BondId{state.bonds.size() - 1}, energy});
    for (std::size_t cell = 1; cell < cells.size(); ++cell)  // made at rest; repulsion is given up once
      take_up_bond(model, *make_bond(cells[cell], site_i, site_j), recipe, state);
  };
  for (std::size_t k = 0; k < selected.pairs.size(); ++k) make(k);
  if (any_capsules(model.contact, state.bonds)) {  // what others touch changes, too
    state.books.dissipated = books.dissipated + (dissipated_by_flow(state) - flowed);
    state.books.lost = books.lost;
    state.books.lose(Loss::bonding, U - potential_energies(model, state).contact);
  }
  if (whole) state.books.lose(Loss::bonding, slip - stored_slip(model, state));
  const auto report = [&](const FirstAndCount& found, const char* rule, const char* way_out) {
    if (found.count > 0)
      problems.add(spec.place, fmt::format("bonds \"{}\": {}", spec.name, found.text()), rule, way_out);
  };
  report(no_length, no_length_of(recipe).rule, no_length_of(recipe).way_out);
  const bool of_surfaces = recipe.attachment == Attachment::surfaces || recipe.attachment == Attachment::neck;
  report(no_radius,
         of_surfaces ? "a bond between surfaces needs radii > 0"
                     : "a section or modulus that follows the radii of particles needs radii > 0",
         of_surfaces ? "give the specimen a radius, or bond at the centres"
                     : "give the specimen a radius, or the section a diameter, and k_n in place of E");
  report(unstable, "rest must be a minimum of the energy: c_A > 0 and c_D, c_B, c_T >= 0",
         "for the V-model B2 > -B3/2; give other parameters");
  report(no_capsule, of_capsule.rule.c_str(), of_capsule.way_out.c_str());
  if (snapping.count > 0) refuse_snap_back(spec, snapping.text(), longest, problems);
  if (broken.count > 0) refuse_broken_by_prestrain(spec, broken.text(), problems);
}

}  // namespace

bool expect_bonds(const Case& c, std::size_t set, const Model& model, State& state, Problems& problems) {
  const BondSpec& spec = c.bonds[set];
  if (spec.reach() || std::holds_alternative<AtCrossings>(spec.select.value)) return false;
  BondRecipe recipe = spec.recipe;
  recipe.set = static_cast<std::uint16_t>(set);
  const std::vector<BondRecipe> cells = recipes_of(recipe);
  bool all = true;
  SharedCells shared;
  const SelectedPairs selected = select_pairs(c, set, model, state, problems, shared);
  for (std::size_t k = 0; k < selected.pairs.size(); ++k) {
    const auto [i, j] = sites_of(selected, k, model, state);
    if (is_waiting(state, i.id) || is_waiting(state, j.id)) continue;
    for (const BondRecipe& cell : cells)
      if (const auto bond = make_bond(cell, i, j))
        state.bonds.push_back(*bond);
      else
        all = false;
  }
  if (!state.bond_history.empty()) state.bond_history.resize(state.bonds.size());
  return all;
}

std::vector<std::string> notes_on_prestrain(const Case& c, const Model& model, const BodyPart& body) {
  const State& state = body.state;
  constexpr std::uint32_t sample = 1000;
  std::vector<std::string> notes;
  for (std::size_t set = 0; set < c.bonds.size(); ++set) {
    const BondSpec& spec = c.bonds[set];
    if (spec.recipe.prestrain == 0.0 || !(spec.recipe.weibull.modulus > 0.0)) continue;
    if (spec.when == BondTime::start) {
      const auto all = count_bonds(body, [&](const Bond& b) { return b.set == set; });
      const auto weak = count_bonds(body, [&](const Bond& b) {
        return b.set == set &&
               breaks_as_made(b, bond_site(model, state, b.i), bond_site(model, state, b.j, image_of_j(b)));
      });
      if (weak > 0)
        notes.push_back(
            fmt::format("bonds \"{}\": {} of {} are weaker than what their prestrain brings, and "
                        "break in the first step",
                        spec.name, weak, all));
      continue;
    }
    const std::optional<BondReach> reach = spec.reach();
    if (!reach || model.particles() == 0) continue;
    const double R = *std::min_element(model.radius.begin(), model.radius.end()), distance = (*reach)(R, R);
    std::uint32_t weak = 0;
    for (std::uint32_t k = 0; k < sample; ++k) {
      const BondSite i{ParticleId{2 * k}, {}, {}, R, 1.0, 1.0},
          j{ParticleId{2 * k + 1}, {distance, 0, 0}, {}, R, 1.0, 1.0};
      if (const auto bond = make_bond(spec.recipe, i, j)) weak += breaks_as_made(*bond, i, j);
    }
    if (weak > 0)
      notes.push_back(
          fmt::format("bonds \"{}\": some {:.2g} % at the distance {:.6g} are weaker than what their "
                      "prestrain brings, and {}",
                      spec.name, 100.0 * weak / sample, distance,
                      spec.when == BondTime::approach ? "are not made" : "break as they are made"));
  }
  return notes;
}

std::optional<double> first_c_A(const Case& c, const Model& model, const State& state) {
  if (!state.bonds.empty()) {
    const Bond& first = state.bonds[BondId{0}];
    const FlatJoint& joint = c.bonds.size() > first.set ? c.bonds[first.set].recipe.flat_joint : FlatJoint{};
    if (!joint.any()) return stiffness_of(first).c_A;
    double c_A = 0.0;  // of the whole section: its cells follow one another
    for (std::size_t k = 0; k < std::min(joint_cells(joint).size(), state.bonds.size()); ++k)
      c_A += stiffness_of(state.bonds[BondId{k}]).c_A;
    return c_A;
  }
  if (c.bonds.empty() || model.particles() == 0) return std::nullopt;
  const BondSpec& spec = c.bonds.front();
  double distance = 1.0;
  BondRadii radii{model.radius[ParticleId{0}], model.radius[ParticleId{0}]};
  if (const auto reach = spec.reach()) {
    distance = (*reach)(radii.i, radii.j);
  } else {
    Problems reported_elsewhere;
    SharedCells cells;
    const SelectedPairs selected = select_pairs(c, 0, model, state, reported_elsewhere, cells);
    if (selected.pairs.empty()) return std::nullopt;
    const auto [i, j] = sites_of(selected, 0, model, state);
    distance = distance_of(i, j);
    radii = {i.radius, j.radius};
  }
  const double a = bond_lengths(spec.recipe, distance, radii).a;
  if (!(a > 0.0) || (spec.recipe.needs_radii() && !(std::min(radii.i, radii.j) > 0.0))) return std::nullopt;
  return stiffness_of(spec.recipe, a, radii).c_A;
}

}  // namespace vbond
