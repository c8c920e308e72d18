#include "vbond/setup/source_bonds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/model/passage.hpp"
#include "vbond/setup/bonds.hpp"
#include "vbond/setup/case_sources.hpp"

namespace vbond {
namespace {

bool lists_pairs(const BondSpec& b) {
  const auto& select = b.select.value;
  return std::holds_alternative<ListedPairs>(select) || std::holds_alternative<PairsFile>(select) ||
         std::holds_alternative<SpecimenPairs>(select);
}

/// The body as it waits, alone in open space, with the bonds that it has so far.
State alone(const Built& built, const Source& source, const PerBond<Bond>& bonds) {
  State s = built.state;
  s.cell.clear();
  s.dropped.clear();
  s.waiting.clear();
  for (const ParticleId p : s.r.ids())
    if (!source.body_of(p) || *source.body_of(p) != 0) s.waiting.push_back(p);
  s.bonds = bonds;
  s.bond_history = {};
  s.warm_bonds = {};
  return s;
}

PerBond<Bond> bonds_so_far(const Built& built, const Source& source) {
  const State waiting = alone(built, source, {});
  PerBond<Bond> bonds;
  for (const SourceBond& b : source.bonds)
    if (const auto bond = bond_of_body(built.model, waiting, source, 0, b)) bonds.push_back(*bond);
  return bonds;
}

/// Takes down the bonds that a set makes inside of the first body; mistakes are those of any bonds.
void take_down(const Case& c, std::size_t set, const SelectedPairs& selected, const State& waiting,
               Built& built, Source& source, Problems& problems) {
  if (selected.pairs.empty()) return;
  if (c.bonds[set].recipe.flat_joint.any())
    return problems.add(c.bonds[set].place, fmt::format("bonds \"{}\": flat_joint", c.bonds[set].name),
                        "bodies of a source come in with whole bonds",
                        "leave flat_joint out for these bodies, or put them there from the start");
  State made = waiting;
  make_bonds(c, set, built.model, made, selected, problems);
  BondRecipe recipe = c.bonds[set].recipe;
  recipe.set = static_cast<std::uint16_t>(set);
  source.recipes.push_back(recipe);
  const auto number = static_cast<std::uint32_t>(source.recipes.size() - 1);
  const auto place = [&source](ParticleId p) {
    return static_cast<std::uint32_t>(std::lower_bound(source.body.begin(), source.body.end(), p) -
                                      source.body.begin());
  };
  for (std::size_t k = 0; k < selected.pairs.size(); ++k) {
    const auto [i, j] = sites_of(selected, k, built.model, waiting);
    source.bonds.push_back({place(i.id), place(j.id), number, i.offset, j.offset, i.radius, j.radius});
  }
}

/// Pairs of a list, where every first body stands as it waits.
void add_listed(const Case& c, std::size_t set, Built& built, Problems& problems) {
  const BondSpec& spec = c.bonds[set];
  State with_bodies = built.state;
  std::vector<ParticleId> others;
  for (const ParticleId p : built.state.waiting) {
    bool first = false;
    for (const Source& s : built.model.sources)
      first = first || s.body_of(p) == std::optional<std::size_t>(0);
    if (!first) others.push_back(p);
  }
  with_bodies.waiting = std::move(others);
  SharedCells none;  // a list needs no cells
  const SelectedPairs selected = select_pairs(c, set, built.model, with_bodies, problems, none);
  SelectedPairs here;
  std::vector<SelectedPairs> inside(built.model.sources.size());
  for (const Pair& pair : selected.pairs) {
    const bool i_comes = comes_in(built.model, pair.i), j_comes = comes_in(built.model, pair.j);
    if (!i_comes && !j_comes) {
      here.pairs.push_back(pair);
      continue;
    }
    bool found = false;
    for (std::size_t s = 0; s < inside.size(); ++s)
      if (built.model.sources[s].body_of(pair.i) == std::optional<std::size_t>(0) &&
          built.model.sources[s].body_of(pair.j) == std::optional<std::size_t>(0)) {
        inside[s].pairs.push_back({pair.i, pair.j, {}});
        found = true;
      }
    if (!found)
      problems.add(
          spec.select.place.file.empty() ? spec.place : spec.select.place,
          fmt::format("bonds \"{}\": pair {}, {}", spec.name, pair.i.value, pair.j.value),
          of_source(built.model, i_comes ? pair.i : pair.j) +
              ": it is not there as the run begins, and only bonds inside of its body come in with it",
          "bond particles of the specimen that the source names with each other; or let bonds be made as "
          "particles come near each other: when = \"approach\"");
  }
  if (!here.pairs.empty()) make_bonds(c, set, built.model, built.state, here, problems);
  for (std::size_t s = 0; s < inside.size(); ++s) {
    Source& source = built.model.sources[s];
    take_down(c, set, inside[s], body_alone(built, source), built, source, problems);
  }
}

bool has_both_ends(const Case& c, std::size_t set, const Model& model, auto is_meant) {
  for (const auto& name : c.bonds[set].between) {
    const Group* g = model.find_group(name.value);
    if (g == nullptr || std::none_of(g->particles.begin(), g->particles.end(), is_meant)) return false;
  }
  return true;
}

}  // namespace

State body_alone(const Built& built, const Source& source) {
  return alone(built, source, bonds_so_far(built, source));
}

void add_bonds_at_start(const Case& c, std::size_t set, Built& built, Problems& problems,
                        SharedCells& shared) {
  if (built.model.sources.empty()) return add_bonds(c, set, built.model, built.state, problems, shared);
  if (lists_pairs(c.bonds[set])) return add_listed(c, set, built, problems);
  // Nearness counts among particles that are there, and inside of each body: nothing is near a body that
  // waits.
  Problems of_all;
  bool any = false;
  const auto select = [&](const State& state) {
    Problems found;
    SharedCells cells = shared.anew();
    SelectedPairs selected = select_pairs(c, set, built.model, state, found, cells);
    any = any || !selected.pairs.empty();
    if (of_all.none()) of_all.add(found.shown());
    return selected;
  };
  const auto is_here = [&built](ParticleId p) { return !is_waiting(built.state, p); };
  if (has_both_ends(c, set, built.model, is_here))
    make_bonds(c, set, built.model, built.state, select(built.state), problems);
  for (Source& source : built.model.sources) {
    const auto is_of_body = [&source](ParticleId p) {
      return source.body_of(p) == std::optional<std::size_t>(0);
    };
    if (source.body.size() < 2 || !has_both_ends(c, set, built.model, is_of_body)) continue;
    const State waiting = body_alone(built, source);
    take_down(c, set, select(waiting), waiting, built, source, problems);
  }
  if (any) return;
  if (of_all.none()) select(built.state);  // groups that have nobody: as it is told without sources
  problems.add(of_all.shown());
}

void check_pairs_of_sources(const Case& c, const Model& model, Problems& problems) {
  if (model.sources.empty()) return;
  for (const BondSpec& spec : c.bonds) {
    const auto* listed = std::get_if<ListedPairs>(&spec.select.value);
    const bool from_file = std::holds_alternative<PairsFile>(spec.select.value) ||
                           std::holds_alternative<SpecimenPairs>(spec.select.value);
    if (spec.when == BondTime::start || (!listed && !from_file)) continue;
    std::optional<ParticleId> wrong;
    if (listed)
      for (const auto& pair : listed->pairs)
        for (const std::int64_t p : pair)
          if (!wrong && p >= 0 && p < static_cast<std::int64_t>(model.particles()) &&
              comes_in(model, ParticleId{static_cast<std::size_t>(p)}))
            wrong = ParticleId{static_cast<std::size_t>(p)};
    if (from_file)
      for (const auto& group : spec.between)
        if (!wrong) wrong = first_that_comes_in(group.value, model);
    if (wrong)
      problems.add(
          spec.place, fmt::format("bonds \"{}\": pairs that are named", spec.name),
          of_source(model, *wrong) + ": which of its bodies are there as a stage begins is not known",
          from_file ? "leave its specimen out of `between`, or make the bonds with when = \"start\""
                    : "select by distance or gap; or make bonds inside of the body with when = \"start\"");
  }
}

}  // namespace vbond
