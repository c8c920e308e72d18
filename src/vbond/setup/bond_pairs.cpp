#include "vbond/setup/bond_pairs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include "vbond/core/images.hpp"
#include "vbond/core/memory.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/setup/crossings.hpp"
#include "vbond/setup/csv_table.hpp"
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
  return in_order({b.i, b.j, b.image_j});
}

struct HashOfPair {
  std::size_t operator()(const Pair& p) const {
    const auto ends = static_cast<std::uint64_t>(p.i.value) << 32 | p.j.value;
    const Image& n = p.image_j;
    return std::hash<std::uint64_t>{}(ends + 0x9E3779B97F4A7C15u *
                                                 static_cast<std::uint64_t>(n.a + 3 * n.b + 9 * n.c));
  }
};

const SourcePlace& place_of_selection(const BondSpec& spec) {
  return spec.select.place.file.empty() ? spec.place : spec.select.place;
}

/// Whether particles of a CSV specimen have other numbers than rows of its file.
bool cuts_a_file(const Case& c) {
  return std::any_of(c.specimens.begin(), c.specimens.end(), [](const SpecimenSpec& s) {
    return !s.cut.empty() && std::holds_alternative<CsvSpecimen>(s.shape);
  });
}

/// Selects the pairs of one bond set.
struct Selection {
  const Case& c;
  const BondSpec& spec;
  std::uint32_t set;
  const Model& model;
  const State& state;
  Problems& problems;
  SharedCells& shared;
  std::vector<char> in_a, in_b;
  std::unordered_map<Pair, std::uint32_t, HashOfPair> bonded;  ///< by which set
  const char* way_out = "use a number in that range";          ///< where there is no such particle

  bool joins_groups(ParticleId i, ParticleId j) const {
    return (in_a[i.value] && in_b[j.value]) || (in_a[j.value] && in_b[i.value]);
  }

  std::vector<Pair> operator()(const WithinDistance& within) {
    if (!(within.distance > 0.0)) return refuse_value("distance", within.distance, "must be > 0");
    return near_pairs({within.distance, 0.0}, fmt::format("{}", within.distance), "distance");
  }
  std::vector<Pair> operator()(const WithinGap& within) {
    if (!(within.gap >= 0.0)) return refuse_value("gap", within.gap, "must be >= 0");
    if (lacks_radii("gap")) return {};
    return near_pairs({within.gap, 1.0}, fmt::format("a gap of {}", within.gap), "gap");
  }
  std::vector<Pair> operator()(const WithinFactor& within) {
    if (!(within.factor > 0.0)) return refuse_value("gap_factor", within.factor, "must be > 0");
    if (lacks_radii("gap_factor")) return {};
    return near_pairs({0.0, within.factor}, fmt::format("{} (R_i + R_j)", within.factor), "gap_factor");
  }

  /// Of crossings also where they are.
  SelectedPairs select() {
    if (const auto* at = std::get_if<AtCrossings>(&spec.select.value)) return crossings(at->gap);
    return {std::visit(*this, spec.select.value), {}};
  }
  std::vector<Pair> operator()(const AtCrossings& at) { return crossings(at.gap).pairs; }

  /// The bonds; fibres have a capsule. Where none has one, fibres are the bonds that specimens bring, as
  /// thick as the thinner of their particles.
  PerBond<Bond> fibres() const {
    PerBond<Bond> bonds = state.bonds;
    if (std::any_of(bonds.begin(), bonds.end(), [](const Bond& b) { return b.capsule > 0.0; })) return bonds;
    for (Bond& b : bonds)
      if (b.set < c.bonds.size() && std::holds_alternative<SpecimenPairs>(c.bonds[b.set].select.value))
        b.capsule = std::min(model.radius[b.i], model.radius[b.j]);
    return bonds;
  }

  SelectedPairs crossings(double gap) {
    SelectedPairs selected;
    const PerBond<Bond> bonds = fibres();
    const auto within = [&](double margin) {
      std::vector<Crossing> found = crossings_within(model, state, bonds, margin);
      std::erase_if(found, [&](const Crossing& x) { return !joins_groups(x.pair.i, x.pair.j); });
      return found;
    };
    std::vector<Crossing> found;
    try {
      found = within(gap);
      if (found.empty() && spec.when == BondTime::start) refuse_no_crossing(gap, bonds, within);
    } catch (const std::length_error&) {
      problems.add(
          place_of_selection(spec),
          fmt::format("bonds \"{}\": crossing_gap = {} reaches far beyond the next fibres", spec.name, gap),
          "it must be below ten times the longest bond of a fibre, and each of these bonds have at most some "
          "200 "
          "others within it",
          "use a part of a diameter; is the gap in the right unit?");
    }
    for (const Crossing& x : found)
      if (bonded.count(x.pair) == 0) selected.pairs.push_back(x.pair), selected.crossings.push_back(x.points);
    return selected;
  }
  template <class Within>
  void refuse_no_crossing(double gap, const PerBond<Bond>& bonds, Within within) {
    double thickest = 0.0;
    for (const Bond& b : bonds) thickest = std::max(thickest, b.capsule);
    const std::string what = fmt::format("bonds \"{}\": crossing_gap = {}", spec.name, gap);
    if (!(thickest > 0.0))
      return problems.add(
          place_of_selection(spec), what,
          "there are no fibres: bonds with a capsule_radius, or that specimens bring "
          "(from_specimen) between particles with a radius",
          "give the bonds of the fibres capsule_radius, in a set before this one; or select by "
          "distance or gap");
    const double farther = std::max(2.0 * thickest, 2.0 * gap);
    const std::vector<Crossing> found = within(farther);
    const auto least = std::min_element(found.begin(), found.end(),
                                        [](const Crossing& x, const Crossing& y) { return x.gap < y.gap; });
    const std::string nearest = found.empty()
                                    ? fmt::format("none is within {:.6g} either", farther)
                                    : fmt::format("the nearest fibres have a gap of {:.6g}", least->gap);
    problems.add(
        place_of_selection(spec), what + ": no fibres are so near",
        fmt::format("between groups \"{}\" and \"{}\": {}; fibres are not counted whose particles are "
                    "bonded there already",
                    spec.between[0].value, spec.between[1].value, nearest),
        "use a larger crossing_gap, or press the fibres together first and bond them with when = "
        "\"stage\"");
  }

  std::vector<Pair> refuse_value(const char* key, double value, const char* rule) {
    problems.add(place_of_selection(spec), fmt::format("bonds \"{}\": {} = {}", spec.name, key, value), rule,
                 "use a little more than the spacing");
    return {};
  }

  /// Whether a selection by radii meets particles without; reports the first.
  bool lacks_radii(const char* key) {
    for (const ParticleId p : model.radius.ids()) {
      if (!(in_a[p.value] || in_b[p.value]) || model.radius[p] > 0.0) continue;
      problems.add(place_of_selection(spec),
                   fmt::format("bonds \"{}\": {}: particle {} of specimen \"{}\" has radius {}", spec.name,
                               key, p.value, c.specimens[model.specimen[p]].name, model.radius[p]),
                   "surfaces are those of spheres: every particle of the two groups needs a radius > 0",
                   "give the specimen a radius, or select by distance");
      return true;
    }
    return false;
  }

  std::vector<Pair> near_pairs(const BondReach& reach, const std::string& within, const char* key) {
    std::vector<Pair> pairs = pairs_in_memory(reach, within);
    if (pairs.empty() && spec.when == BondTime::start) {
      std::string nearest = "none within 16 times that distance";
      const double R = mean_radius();
      for (double d = 2.0; d <= 16.0 && pairs.empty(); d *= 2.0) {
        pairs = pairs_in_memory({d * reach(R, R), 0.0}, within);
        double least = INFINITY;
        for (const Pair& pair : pairs) least = std::min(least, apart(pair));
        if (!pairs.empty()) nearest = fmt::format("the nearest are {:.6g}{} apart", least, unit_of_apart());
      }
      problems.add(place_of_selection(spec),
                   fmt::format("bonds \"{}\": no pair is within {}", spec.name, within),
                   fmt::format("between groups \"{}\" and \"{}\": {}", spec.between[0].value,
                               spec.between[1].value, nearest),
                   fmt::format("use a larger {} or other groups", key));
      return {};
    }
    if (spec.faces.only) {
      const std::size_t near = pairs.size();
      keep_those_that_share_faces(model, state, spec.faces.least, shared, pairs);
      if (near > 0 && pairs.empty() && spec.when == BondTime::start)
        problems.add(
            spec.place, fmt::format("bonds \"{}\": least_face = {}", spec.name, spec.faces.least),
            fmt::format("none of the {} pairs within {} has cells with so large a face", near, within),
            "use a smaller least_face, or a larger distance, gap or gap_factor");
    }
    const auto is_bonded = [this](const Pair& p) { return bonded.count(p) > 0; };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_bonded), pairs.end());
    return pairs;
  }

  /// How far apart two particles are, as the selection measures it.
  double apart(const Pair& p) const {
    const double d = norm(between(state, p.i, p.j, p.image_j)), R = model.radius[p.i] + model.radius[p.j];
    if (std::holds_alternative<WithinGap>(spec.select.value)) return d - R;
    return std::holds_alternative<WithinFactor>(spec.select.value) ? d / R : d;
  }
  const char* unit_of_apart() const {
    return std::holds_alternative<WithinFactor>(spec.select.value) ? " (R_i + R_j)" : "";
  }

  double mean_radius() const {
    double sum = 0.0;
    for (const ParticleId p : model.radius.ids()) sum += model.radius[p];
    return sum / static_cast<double>(model.particles());
  }

  /// Refuses more than memory holds before it holds them: a distance in a wrong unit joins everything to
  /// everything.
  std::vector<Pair> pairs_in_memory(const BondReach& reach, const std::string& within) const {
    const double limit = memory_limit(), most = limit / static_cast<double>(sizeof(Pair) + sizeof(Bond));
    try {
      return pairs_within(model, state, reach, in_a, in_b, most);
    } catch (const std::length_error&) {
      throw CaseError({place_of_selection(spec),
                       fmt::format("bonds \"{}\": more than {:.3g} pairs of {} particles are within {}",
                                   spec.name, most, state.r.size(), within),
                       fmt::format("bonds of that many take more memory than the {:.3g} GiB there may be",
                                   limit / 0x1p30),
                       "use a little more than the spacing; is the distance in the right unit?"});
    }
  }

  std::vector<Pair> operator()(const ListedPairs& listed) {
    std::vector<Pair> pairs;
    for (const auto& [i, j] : listed.pairs) take(i, j, place_of_selection(spec), pairs);
    return ordered(std::move(pairs));
  }

  std::vector<Pair> operator()(const PairsFile& pairs_file) {
    const auto file = beside_case(c.file, pairs_file.file);
    const CsvTable table =
        read_csv(file, place_of_selection(spec), {{"i", true}, {"j", true}}, {false, "rename or remove it"});
    PairNumbers numbers(static_cast<std::int64_t>(model.particles()));
    std::vector<std::optional<std::array<std::int64_t, 2>>> rows;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const auto i = to_integer(table.fields[0][row]), j = to_integer(table.fields[1][row]);
      if (i && j) numbers.see(*i), numbers.see(*j);
      rows.push_back(i && j ? std::optional(std::array{*i, *j}) : std::nullopt);
    }
    way_out = cuts_a_file(c)
                  ? "particles are numbered after the cuts; let bonds of a CSV specimen go with it: "
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
  std::vector<Pair> operator()(const SpecimenPairs& wanted) {
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
        take(p.value, q.value, place_of_selection(spec), pairs);
        if (bond.across > 0.0 && across.count++ == 0) across.i = p, across.j = q, across.length = bond.across;
      }
    }
    if (across.count > 0 && state.cell.empty()) refuse_across_boundary(across);
    if (meant == 0) refuse_none_brought(brought, wanted.bond_type, types);
    return ordered(std::move(pairs));
  }

  /// None of the bonds that specimens bring is meant: why.
  void refuse_none_brought(std::size_t brought, std::optional<std::int64_t> type,
                           const std::set<std::int64_t>& types) {
    const auto refuse = [&](const std::string& what, const std::string& rule, const char* instead) {
      problems.add(place_of_selection(spec), fmt::format("bonds \"{}\": {}", spec.name, what), rule, instead);
    };
    if (brought == 0)
      refuse(
          "no specimen brings bonds",
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
      refuse(fmt::format("none of the {} bonds that specimens bring is meant", brought),
             fmt::format("none joins the groups \"{}\" and \"{}\"", spec.between[0].value,
                         spec.between[1].value),
             "choose other groups");
  }

  /// Bonds of a file that go through the boundary of its box: how many, and the first.
  struct AcrossBoundary {
    std::size_t count = 0;
    ParticleId i, j;
    double length = 0;
  };

  void refuse_across_boundary(const AcrossBoundary& b) {
    problems.add(
        place_of_selection(spec),
        fmt::format("bonds \"{}\": {} bonds of the file go through a boundary of its periodic box; the "
                    "first, of particles {} and {}, would be {:.6g} long and is {:.6g} through the boundary",
                    spec.name, b.count, b.i.value, b.j.value, norm(between(state, b.i, b.j)), b.length),
        "nothing is periodic here: such a bond would join two ends of the body",
        "take these bonds out of the section Bonds and hold or load the particles that they leave; where the "
        "body only lies across the boundary, write the file with image flags, which unwrap it");
  }

  /// One explicit pair, if it can be bonded.
  void take(std::int64_t number_i, std::int64_t number_j, const SourcePlace& place,
            std::vector<Pair>& pairs) {
    const std::string what = fmt::format("bonds \"{}\"", spec.name);
    const auto i = look_up_particle(number_i, model, what, place, problems, way_out);
    const auto j = look_up_particle(number_j, model, what, place, problems, way_out);
    if (!i || !j) return;
    const auto refuse = [&](const char* rule, const char* way_out) {
      problems.add(place, fmt::format("{}: pair {}, {}", what, number_i, number_j), rule, way_out);
    };
    if (i == j && state.cell.empty())
      return refuse("a bond joins two different particles", "correct the pair");
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
  Image nearest_image(ParticleId i, ParticleId j) const {
    return state.cell.empty() ? Image{}
                              : vbond::nearest_image(state.cell, model.cell.periodic, state.r[i], state.r[j]);
  }

  static std::vector<Pair> ordered(std::vector<Pair> pairs) {
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  static constexpr std::uint32_t new_pair = 0xffffffff;  // no bond set has this number
};

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
                           Problems& problems, SharedCells& shared) {
  const BondSpec& spec = c.bonds[set];
  const Group* a = look_up_group(spec.between[0], model, problems);
  const Group* b = look_up_group(spec.between[1], model, problems);
  if (a == nullptr || b == nullptr) return {};
  Selection selection{c,
                      spec,
                      static_cast<std::uint32_t>(set),
                      model,
                      state,
                      problems,
                      shared,
                      membership(*a, model),
                      membership(*b, model),
                      {}};
  for (const Bond& bond : state.bonds) selection.bonded[pair_of(bond)] = bond.set;
  try {
    SelectedPairs selected = selection.select();
    const std::size_t all = selected.pairs.size();
    leave_out(spec.share, selected);
    if (all > 0 && selected.pairs.empty())
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
