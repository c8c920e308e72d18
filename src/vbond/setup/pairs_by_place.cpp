// Pairs for bonds by where particles are: within a reach, and where fibres cross.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vbond/core/memory.hpp"
#include "vbond/setup/crossings.hpp"
#include "vbond/setup/detail/pair_selection.hpp"

namespace vbond {

std::vector<Pair> PairSelection::operator()(const WithinDistance& within) {
  if (!(within.distance > 0.0)) return refuse_value("distance", within.distance, "must be > 0");
  return near_pairs({within.distance, 0.0}, fmt::format("{}", within.distance), "distance");
}
std::vector<Pair> PairSelection::operator()(const WithinGap& within) {
  if (!(within.gap >= 0.0)) return refuse_value("gap", within.gap, "must be >= 0");
  if (lacks_radii("gap")) return {};
  return near_pairs({within.gap, 1.0}, fmt::format("a gap of {}", within.gap), "gap");
}
std::vector<Pair> PairSelection::operator()(const WithinFactor& within) {
  if (!(within.factor > 0.0)) return refuse_value("gap_factor", within.factor, "must be > 0");
  if (lacks_radii("gap_factor")) return {};
  return near_pairs({0.0, within.factor}, fmt::format("{} (R_i + R_j)", within.factor), "gap_factor");
}

/// The bonds; fibres have a capsule. Where none has one, fibres are the bonds that specimens bring, as
/// thick as the thinner of their particles.
PerBond<Bond> PairSelection::fibres() const {
  PerBond<Bond> bonds = state.bonds;
  if (std::any_of(bonds.begin(), bonds.end(), [](const Bond& b) { return capsule_of(b) > 0.0; }))
    return bonds;
  for (Bond& b : bonds)
    if (b.set < c.bonds.size() && std::holds_alternative<SpecimenPairs>(c.bonds[b.set].select.value))
      set_capsule(b, std::min(model.radius[b.i], model.radius[b.j]));
  return bonds;
}

SelectedPairs PairSelection::crossings(double gap) {
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
        place(),
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
void PairSelection::refuse_no_crossing(double gap, const PerBond<Bond>& bonds, Within within) {
  double thickest = 0.0;
  for (const Bond& b : bonds) thickest = std::max(thickest, capsule_of(b));
  const std::string what = fmt::format("bonds \"{}\": crossing_gap = {}", spec.name, gap);
  if (!(thickest > 0.0))
    return problems.add(place(), what,
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
  problems.add(place(), what + ": no fibres are so near",
               fmt::format("between groups \"{}\" and \"{}\": {}; fibres are not counted whose particles are "
                           "bonded there already",
                           spec.between[0].value, spec.between[1].value, nearest),
               "use a larger crossing_gap, or press the fibres together first and bond them with when = "
               "\"stage\"");
}

std::vector<Pair> PairSelection::refuse_value(const char* key, double value, const char* rule) {
  problems.add(place(), fmt::format("bonds \"{}\": {} = {}", spec.name, key, value), rule,
               "use a little more than the spacing");
  return {};
}

/// Whether a selection by radii meets particles without; reports the first.
bool PairSelection::lacks_radii(const char* key) {
  for (const ParticleId p : model.radius.ids()) {
    if (!(in_a[p.value] || in_b[p.value]) || model.radius[p] > 0.0) continue;
    problems.add(place(),
                 fmt::format("bonds \"{}\": {}: particle {} of specimen \"{}\" has radius {}", spec.name, key,
                             p.value, c.specimens[model.specimen[p]].name, model.radius[p]),
                 "surfaces are those of spheres: every particle of the two groups needs a radius > 0",
                 "give the specimen a radius, or select by distance");
    return true;
  }
  return false;
}

std::vector<Pair> PairSelection::near_pairs(const BondReach& reach, const std::string& within,
                                            const char* key) {
  const bool of_some = some != nullptr && !spec.faces.only;  // cells are those of all particles
  std::vector<Pair> pairs = pairs_in_memory(reach, within, of_some ? some : nullptr);
  if (pairs.empty() && spec.when == BondTime::start && !of_some) {
    std::string nearest = "none within 16 times that distance";
    const double R = mean_radius();
    for (double d = 2.0; d <= 16.0 && pairs.empty(); d *= 2.0) {
      pairs = pairs_in_memory({d * reach(R, R), 0.0}, within);
      double least = INFINITY;
      for (const Pair& pair : pairs) least = std::min(least, apart(pair));
      if (!pairs.empty()) nearest = fmt::format("the nearest are {:.6g}{} apart", least, unit_of_apart());
    }
    problems.add(place(), fmt::format("bonds \"{}\": no pair is within {}", spec.name, within),
                 fmt::format("between groups \"{}\" and \"{}\": {}", spec.between[0].value,
                             spec.between[1].value, nearest),
                 fmt::format("use a larger {} or other groups", key));
    return {};
  }
  if (spec.faces.only) {
    const std::size_t near = pairs.size();
    keep_those_that_share_faces(model, state, spec.faces.least, shared, pairs);
    if (near > 0 && pairs.empty() && spec.when == BondTime::start)
      problems.add(spec.place, fmt::format("bonds \"{}\": least_face = {}", spec.name, spec.faces.least),
                   fmt::format("none of the {} pairs within {} has cells with so large a face", near, within),
                   "use a smaller least_face, or a larger distance, gap or gap_factor");
  }
  const auto is_bonded = [this](const Pair& p) { return bonded.count(p) > 0; };
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_bonded), pairs.end());
  return pairs;
}

/// How far apart two particles are, as the selection measures it.
double PairSelection::apart(const Pair& p) const {
  const double d = norm(between(state, p.i, p.j, p.image_j)), R = model.radius[p.i] + model.radius[p.j];
  if (std::holds_alternative<WithinGap>(spec.select.value)) return d - R;
  return std::holds_alternative<WithinFactor>(spec.select.value) ? d / R : d;
}
const char* PairSelection::unit_of_apart() const {
  return std::holds_alternative<WithinFactor>(spec.select.value) ? " (R_i + R_j)" : "";
}

double PairSelection::mean_radius() const {
  double sum = 0.0;
  for (const ParticleId p : model.radius.ids()) sum += model.radius[p];
  return sum / static_cast<double>(model.particles());
}

/// Refuses more than memory holds before it holds them: a distance in a wrong unit joins everything to
/// everything.
std::vector<Pair> PairSelection::pairs_in_memory(const BondReach& reach, const std::string& within,
                                                 const PerParticle<char>* of_some) const {
  const double limit = memory_limit(), most = limit / static_cast<double>(sizeof(Pair) + sizeof(Bond));
  try {
    if (of_some != nullptr) return pairs_within(model, state, reach, in_a, in_b, most, *of_some);
    return pairs_within(model, state, reach, in_a, in_b, most);
  } catch (const std::length_error&) {
    throw CaseError(
        {place(),
         fmt::format("bonds \"{}\": more than {:.3g} pairs of {} particles are within {}", spec.name, most,
                     state.r.size(), within),
         fmt::format("bonds of that many take more memory than the {:.3g} GiB there may be", limit / 0x1p30),
         "use a little more than the spacing; is the distance in the right unit?"});
  }
}

}  // namespace vbond
