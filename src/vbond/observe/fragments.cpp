#include "vbond/observe/fragments.hpp"

#include <algorithm>
#include <cstddef>

#include "vbond/core/disjoint_sets.hpp"

namespace vbond {

Fragments find_fragments(const Model& model, const PerBond<Bond>& bonds,
                         const std::vector<ParticleId>& without) {
  DisjointSets<ParticleId> sets(model.particles());
  for (const Bond& b : bonds)
    if (!has_failed(b)) sets.join(b.i, b.j);

  std::vector<Fragment> found;  // in the order of their lowest particles
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  PerParticle<std::size_t> place(model.particles(), none);
  for (const ParticleId p : model.mass.ids()) {
    if (std::binary_search(without.begin(), without.end(), p)) continue;
    const ParticleId lowest = sets.smallest(p);
    if (lowest == p) place[p] = found.size(), found.push_back({p});
    place[p] = place[lowest];
    ++found[place[p]].particles;
    found[place[p]].mass += model.mass[p];
  }
  std::vector<std::size_t> order(found.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&found](std::size_t a, std::size_t b) { return found[a].mass > found[b].mass; });

  Fragments fragments;
  std::vector<std::int64_t> number(found.size());
  for (const std::size_t k : order) {
    number[k] = static_cast<std::int64_t>(fragments.all.size());
    fragments.all.push_back(found[k]);
  }
  for (const std::size_t k : place) fragments.number.push_back(k == none ? -1 : number[k]);
  return fragments;
}

FragmentCount count_fragments(const Model& model, const PerBond<Bond>& bonds,
                              const std::vector<ParticleId>& without) {
  const std::vector<Fragment> all = find_fragments(model, bonds, without).all;
  double mass = 0.0;
  for (const Fragment& f : all) mass += f.mass;
  return {static_cast<std::int64_t>(all.size()), all.empty() ? 0.0 : all.front().mass / mass};
}

namespace {

/// Which image of each particle stands with the lowest one of its fragment, as bonds join them; and the
/// fragments of which no such images agree.
struct Whole {
  PerParticle<Image> image;
  std::vector<char> endless;
};

Whole along_bonds(const Fragments& fragments, const State& s) {
  Whole whole{PerParticle<Image>(s.r.size()), std::vector<char>(fragments.all.size(), 0)};
  if (s.cell.empty()) return whole;
  PerParticle<std::vector<ImageOf>> joined(s.r.size());
  for (const Bond& b : s.bonds)
    if (!has_failed(b)) joined[b.i].push_back({b.j, b.image_j}), joined[b.j].push_back({b.i, -b.image_j});
  PerParticle<char> seen(s.r.size(), 0);
  for (std::size_t k = 0; k < fragments.all.size(); ++k) {
    std::vector<ParticleId> next{fragments.all[k].lowest};
    seen[next.back()] = 1;
    while (!next.empty()) {
      const ParticleId p = next.back();
      next.pop_back();
      for (const ImageOf& o : joined[p]) {
        const Image n = whole.image[p] + o.image;
        if (seen[o.particle]) {
          if (whole.image[o.particle] != n) whole.endless[k] = 1;
          continue;
        }
        seen[o.particle] = 1, whole.image[o.particle] = n;
        next.push_back(o.particle);
      }
    }
  }
  return whole;
}

}  // namespace

FragmentMotion motion_of(const Fragments& fragments, const Model& model, const State& state) {
  const std::size_t n = fragments.all.size();
  FragmentMotion of{std::vector<std::optional<Vec3d>>(n, Vec3d{}), std::vector<Vec3d>(n)};
  const Whole whole = along_bonds(fragments, state);
  for (const ParticleId p : model.mass.ids()) {
    if (fragments.number[p] < 0) continue;
    const auto k = static_cast<std::size_t>(fragments.number[p]);
    const double share = model.mass[p] / fragments.all[k].mass;
    const Image image = whole.endless[k] ? Image{} : whole.image[p];
    *of.centre[k] += share * place_of(state.r, state.cell, {p, image});
    of.velocity[k] += share * (state.v[p] + image_velocity(state.cell, image));
  }
  for (std::size_t k = 0; k < n; ++k)
    if (whole.endless[k]) of.centre[k].reset();
  return of;
}

}  // namespace vbond
