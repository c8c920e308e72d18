#include "vbond/model/fibre_rings.hpp"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "vbond/core/disjoint_sets.hpp"

namespace vbond {

std::optional<RingOfContact> ring_of_contact(const Model& model, const State& s) {
  if (!any_capsules(model.contact, s.bonds)) return std::nullopt;
  const FibreParts fibres(model, s.bonds);
  const auto place = [&s](const ImageOf& p) { return place_of(s.r, s.cell, p); };
  std::vector<FibreContact> contacts;
  for (const FibrePair& pair : fibres.near_pairs(s.r, s.cell, 0.0))
    if (const auto c = contact_of(fibres.parts(), pair, place)) contacts.push_back(*c);

  // contacts are in one region if they have a particle of either fibre in common
  using PairOfEnds = std::tuple<ParticleId, ParticleId, Image>;
  std::vector<std::pair<PairOfEnds, std::size_t>> at;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const FibreContact& c = contacts[k];
    for (const ImageOf& p : {c.a.i, c.a.j})
      for (const ImageOf& q : {c.b.i, c.b.j})
        at.emplace_back(std::min(PairOfEnds(p.particle, q.particle, q.image - p.image),
                                 PairOfEnds(q.particle, p.particle, p.image - q.image)),
                        k);
  }
  std::sort(at.begin(), at.end());
  using Index = Id<struct ContactOfRegionTag>;
  DisjointSets<Index> regions(contacts.size());
  for (std::size_t k = 1; k < at.size(); ++k)
    if (at[k - 1].first == at[k].first) regions.join(Index{at[k - 1].second}, Index{at[k].second});

  std::vector<int> characteristic(contacts.size(), 0);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    characteristic[regions.smallest(Index{k}).value] += contacts[k].weight;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const FibreContact& c = contacts[k];
    if (!c.body || characteristic[regions.smallest(Index{k}).value] > 0) continue;
    return RingOfContact{fibres.name_of(c.first), fibres.name_of(c.second), c.a.i.particle, c.b.i.particle};
  }
  return std::nullopt;
}

}  // namespace vbond
