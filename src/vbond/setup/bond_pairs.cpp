#include "vbond/setup/bond_pairs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>

#include "vbond/core/images.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/detail/pair_selection.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond {

Pair in_order(const Pair& p) {
  const Pair other{p.j, p.i, -p.image_j};
  return p.i < p.j || (p.i == p.j && p.image_j > other.image_j) ? p : other;
}

std::pair<BondSite, BondSite> sites_of(const SelectedPairs& selected, std::size_t k, const Model& model,
                                       const State& state) {
  const Pair& p = selected.pairs[k];
  std::pair sites(bond_site(model, state, p.i), bond_site(model, state, p.j, p.image_j));
  if (selected.crossings.empty()) return sites;
  const CrossingPoints& at = selected.crossings[k];
  sites.first.offset = at.offset_i, sites.first.radius = at.R_i;
  sites.second.offset = at.offset_j, sites.second.radius = at.R_j;
  return sites;
}

namespace {

Pair pair_of(const Bond& b) {
  return in_order({b.i, b.j, image_of_j(b)});
}

/// Whether particles of a CSV specimen have other numbers than rows of its file.
bool cuts_a_file(const Case& c) {
  return std::any_of(c.specimens.begin(), c.specimens.end(), [](const SpecimenSpec& s) {
    return !s.cut.empty() && std::holds_alternative<CsvSpecimen>(s.shape);
  });
}

}  // namespace

std::vector<Pair> PairSelection::operator()(const ListedPairs& listed) {
  std::vector<Pair> pairs;
  for (const auto& [i, j] : listed.pairs) take(i, j, place(), pairs);
  return ordered(std::move(pairs));
}

std::vector<Pair> PairSelection::operator()(const PairsFile& pairs_file) {
  const auto file = beside_case(c.file, pairs_file.file);
  const CsvTable table = read_csv(file, place(), {{"i", true}, {"j", true}}, {false, "rename or remove it"});
  PairNumbers numbers(static_cast<std::int64_t>(model.particles()));
  std::vector<std::optional<std::array<std::int64_t, 2>>> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto i = to_integer(table.fields[0][row]), j = to_integer(table.fields[1][row]);
    if (i && j) numbers.see(*i), numbers.see(*j);
    rows.push_back(i && j ? std::optional(std::array{*i, *j}) : std::nullopt);
  }
  way_out = cuts_a_file(c) ? "particles are numbered after the cuts; let bonds of a CSV specimen go with it: "
                             "bonds_file of the specimen, and from_specimen = true here"
                           : numbers.way_out();
  std::vector<Pair> pairs;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const SourcePlace at{file.string(), table.lines[row], 1};
    if (rows[row])
      take((*rows[row])[0], (*rows[row])[1], at, pairs);
    else
      problems.add(at, "the row is not two whole numbers", "i and j are particle numbers from 0",
                   "correct the row");
  }
  return ordered(std::move(pairs));
}

/// The files are read again: bonds of a later stage come from them too, and the model does not keep them.
std::vector<Pair> PairSelection::operator()(const SpecimenPairs& wanted) {
  std::vector<Pair> pairs;
  std::set<std::int64_t> types;
  std::size_t brought = 0, meant = 0;
  AcrossBoundary across;
  for (const SpecimenSpec& specimen : c.specimens) {
    if (!brings_bonds(specimen)) continue;
    const auto first = model.find_group(specimen.name)->particles.front().value;
    for (const FileBond& bond : make_specimen(specimen, c).bonds) {
      ++brought;
      if (bond.type != no_bond_type) types.insert(bond.type);
      if (wanted.bond_type && bond.type != *wanted.bond_type) continue;
      const ParticleId p{first + static_cast<std::size_t>(bond.pair[0])},
          q{first + static_cast<std::size_t>(bond.pair[1])};
      if (!joins_groups(p, q)) continue;
      ++meant;
      take(p.value, q.value, place(), pairs);
      if (bond.across > 0.0 && across.count++ == 0) across.i = p, across.j = q, across.length = bond.across;
    }
  }
  if (across.count > 0 && state.cell.empty()) refuse_across_boundary(across);
  if (meant == 0) refuse_none_brought(brought, wanted.bond_type, types);
  return ordered(std::move(pairs));
}

/// None of the bonds that specimens bring is meant: why.
void PairSelection::refuse_none_brought(std::size_t brought, std::optional<std::int64_t> type,
                                        const std::set<std::int64_t>& types) {
  const auto refuse = [&](const std::string& what, const std::string& rule, const char* instead) {
    problems.add(place(), fmt::format("bonds \"{}\": {}", spec.name, what), rule, instead);
  };
  if (brought == 0)
    refuse("no specimen brings bonds",
           "LAMMPS data files with a Bonds section do, CSV specimens with a bonds_file, the kinds cylinder, "
           "cone, sphere and fibres, and random sheets",
           "select by distance or by pairs");
  else if (type && types.empty())
    refuse(fmt::format("no bond of type {}", *type), "the bonds that the specimens bring have no types",
           "leave bond_type out");
  else if (type)
    refuse(fmt::format("no bond of type {}", *type),
           fmt::format("between these groups the files have none; they have the bond types {}",
                       fmt::join(types, ", ")),
           "choose one of these, or other groups");
  else
    refuse(
        fmt::format("none of the {} bonds that specimens bring is meant", brought),
        fmt::format("none joins the groups \"{}\" and \"{}\"", spec.between[0].value, spec.between[1].value),
        "choose other groups");
}

void PairSelection::refuse_across_boundary(const AcrossBoundary& b) {
  problems.add(
      place(),
      fmt::format("bonds \"{}\": {} bonds of the file go through a boundary of its periodic box; the "
                  "first, of particles {} and {}, would be {:.6g} long and is {:.6g} through the boundary",
                  spec.name, b.count, b.i.value, b.j.value, norm(between(state, b.i, b.j)), b.length),
      "nothing is periodic here: such a bond would join two ends of the body",
      "take these bonds out of the section Bonds and hold or load the particles that they leave; where the "
      "body only lies across the boundary, write the file with image flags, which unwrap it");
}

/// One explicit pair, if it can be bonded.
void PairSelection::take(std::int64_t number_i, std::int64_t number_j, const SourcePlace& place,
                         std::vector<Pair>& pairs) {
  const std::string what = fmt::format("bonds \"{}\"", spec.name);
  const auto i = look_up_particle(number_i, model, what, place, problems, way_out);
  const auto j = look_up_particle(number_j, model, what, place, problems, way_out);
  if (!i || !j) return;
  const auto refuse = [&](const char* rule, const char* way_out) {
    problems.add(place, fmt::format("{}: pair {}, {}", what, number_i, number_j), rule, way_out);
  };
  if (i == j && state.cell.empty()) return refuse("a bond joins two different particles", "correct the pair");
  if (!joins_groups(*i, *j))
    return refuse("the pair does not join the two groups of `between`", "correct the pair or the groups");
  const Image image = nearest_image(*i, *j);
  if (!state.cell.empty() && as_near(state.cell, model.cell.periodic, state.r[*i], state.r[*j], image))
    return refuse("two images of the second particle are equally near to the first: which one is meant?",
                  "use `distance`, which bonds all that are near, or more cells of the lattice");
  const Pair pair = in_order({*i, *j, image});
  const auto [earlier, is_new] = bonded.emplace(pair, new_pair);
  if (is_new)
    pairs.push_back(pair);
  else if (earlier->second == new_pair)
    refuse("the pair is there twice", "remove one of them");
  else if (earlier->second != set)
    refuse("the pair is bonded already by another bond set", "remove it from one of the two");
}

/// Pairs that are named are of the images that are nearest to each other.
Image PairSelection::nearest_image(ParticleId i, ParticleId j) const {
  return state.cell.empty() ? Image{}
                            : vbond::nearest_image(state.cell, model.cell.periodic, state.r[i], state.r[j]);
}

std::vector<Pair> PairSelection::ordered(std::vector<Pair> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

namespace {

/// Keeps this share of the pairs.
void leave_out(const BondShare& share, SelectedPairs& selected) {
  if (!(share.part < 1.0)) return;
  SelectedPairs kept;
  for (std::size_t k = 0; k < selected.pairs.size(); ++k) {
    const Pair& p = selected.pairs[k];
    if (!(pair_variate(share.seed, p.i, p.j, p.image_j) < share.part)) continue;
    kept.pairs.push_back(p);
    if (!selected.crossings.empty()) kept.crossings.push_back(selected.crossings[k]);
  }
  selected = std::move(kept);
}

}  // namespace

SelectedPairs select_pairs(const Case& c, std::size_t set, const Model& model, const State& state,
                           Problems& problems, SharedCells& shared, std::span<const SelectedPairs> before,
                           const PerParticle<char>* some) {
  const BondSpec& spec = c.bonds[set];
  const Group* a = look_up_group(spec.between[0], model, problems);
  const Group* b = look_up_group(spec.between[1], model, problems);
  if (a == nullptr || b == nullptr) return {};
  PairSelection selection{c,
                          spec,
                          static_cast<std::uint32_t>(set),
                          model,
                          state,
                          problems,
                          shared,
                          membership(*a, model),
                          membership(*b, model),
                          {},
                          some};
  for (const Bond& bond : state.bonds) selection.bonded[pair_of(bond)] = bond.set;
  for (std::uint32_t k = 0; k < before.size(); ++k)
    for (const Pair& pair : before[k].pairs) selection.bonded[pair] = k;
  try {
    SelectedPairs selected = selection.select();
    const std::size_t all = selected.pairs.size();
    leave_out(spec.share, selected);
    if (all > 0 && selected.pairs.empty() && some == nullptr)
      problems.add(spec.place, fmt::format("bonds \"{}\": share = {}", spec.name, spec.share.part),
                   fmt::format("leaves none of {} pairs", all), "use a larger share, or another seed");
    return selected;
  } catch (const CaseError& e) {  // of a file
    problems.add(e);
    return {};
  }
}

std::vector<std::string> notes_on_pairs(const Case& c) {
  std::vector<std::string> notes;
  for (const BondSpec& spec : c.bonds)
    if (std::holds_alternative<PairsFile>(spec.select.value) && cuts_a_file(c))
      notes.push_back(
          fmt::format("bonds \"{}\": the pairs of its file are numbers of particles after the cuts, not "
                      "of rows of the specimen's file; those are pairs of its bonds_file",
                      spec.name));
  return notes;
}

}  // namespace vbond
