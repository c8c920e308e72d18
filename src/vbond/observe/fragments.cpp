#include "vbond/observe/fragments.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <utility>

#include "vbond/core/disjoint_sets.hpp"

namespace vbond {
namespace {

using Sets = DisjointSets<ParticleId>;

/// A sum with what the rounding of each addition leaves (Knuth, The Art of Computer Programming 2, 4.2.2): so
/// fragments of the same masses are equal, whichever parts have their particles.
struct MassSum {
  double plain = 0, left = 0;

  void add(double x) {
    const double sum = plain + x, of_x = sum - plain;
    left += (plain - (sum - of_x)) + (x - of_x);
    plain = sum;
  }
};

/// What one part has of a fragment.
struct Piece {
  ParticleId lowest;  // of the whole fragment
  std::int64_t particles = 0;
  MassSum mass;
};

template <class T>
void sort_out(std::vector<T>& all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

/// Joins what bonds hold together, so that own particles are in sets with the lowest of their fragments.
/// Returns those of fragments that several parts have particles of, in increasing order.
std::vector<ParticleId> join_by_bonds(const BodyPart& body, Sets& sets) {
  std::vector<ParticleId> across;  // second ends of own bonds, of other parts
  for (const Bond& b : body.state.bonds) {
    if (has_failed(b) || !body.has(b)) continue;
    sets.join(b.i, b.j);
    if (!body.has(b.j)) across.push_back(b.j);
  }
  if (body.all.ranks() == 1) return {};
  sort_out(across);
  std::vector<std::array<ParticleId, 2>> joined;  // such an end, and the lowest that a part knows with it
  for (const ParticleId p : across) joined.push_back({p, sets.smallest(p)});
  std::vector<ParticleId> ends = body.all.gather(across);
  sort_out(ends);
  for (const ParticleId p : ends)
    if (body.has(p)) joined.push_back({p, sets.smallest(p)});
  joined = body.all.gather(joined);
  for (const auto& [p, lowest] : joined) sets.join(p, lowest);
  std::vector<ParticleId> shared;
  for (const ParticleId p : ends) shared.push_back(sets.smallest(p));
  sort_out(shared);
  return shared;
}

/// Fragments in the order of their lowest particles: those that this part has alone, and all that several
/// have particles of.
struct Pieces {
  std::vector<Fragment> here, shared;
};

Pieces pieces_of(const Model& model, const BodyPart& body, const std::vector<ParticleId>& without,
                 Sets& sets) {
  const std::vector<ParticleId> shared = join_by_bonds(body, sets);
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  PerParticle<std::size_t> place(model.particles(), none);  // of the lowest ones
  std::vector<Piece> mine, torn;
  for (const ParticleId p : model.mass.ids()) {
    if (!body.has(p) || std::binary_search(without.begin(), without.end(), p)) continue;
    std::size_t& at = place[sets.smallest(p)];
    if (at == none) at = mine.size(), mine.push_back({sets.smallest(p), 0, {}});
    ++mine[at].particles;
    mine[at].mass.add(model.mass[p]);
  }
  const bool alone = body.all.ranks() == 1;
  const auto fragment = [alone](const Piece& p) {
    return Fragment{p.lowest, p.particles, alone ? p.mass.plain : p.mass.plain + p.mass.left};
  };
  Pieces pieces;
  for (const Piece& p : mine) {
    if (std::binary_search(shared.begin(), shared.end(), p.lowest))
      torn.push_back(p);
    else
      pieces.here.push_back(fragment(p));
  }
  torn = body.all.gather(torn);
  std::stable_sort(torn.begin(), torn.end(),
                   [](const auto& a, const auto& b) { return a.lowest < b.lowest; });
  for (std::size_t first = 0, last; first < torn.size(); first = last) {
    Piece whole = torn[first];
    for (last = first + 1; last < torn.size() && torn[last].lowest == whole.lowest; ++last) {
      whole.particles += torn[last].particles;
      whole.mass.add(torn[last].mass.plain);
      whole.mass.left += torn[last].mass.left;
    }
    pieces.shared.push_back(fragment(whole));
  }
  return pieces;
}

}  // namespace

Fragments find_fragments(const Model& model, const BodyPart& body, const std::vector<ParticleId>& without) {
  Sets sets(model.particles());
  const Pieces pieces = pieces_of(model, body, without, sets);
  Fragments fragments{.all = body.all.gather(pieces.here), .number = {}};
  fragments.all.insert(fragments.all.end(), pieces.shared.begin(), pieces.shared.end());
  std::sort(fragments.all.begin(), fragments.all.end(), [](const Fragment& a, const Fragment& b) {
    return a.mass > b.mass || (a.mass == b.mass && a.lowest < b.lowest);
  });
  PerParticle<std::int64_t> of_lowest(model.particles(), -1);
  for (std::size_t k = 0; k < fragments.all.size(); ++k)
    of_lowest[fragments.all[k].lowest] = static_cast<std::int64_t>(k);
  for (const ParticleId p : model.mass.ids()) {
    const bool counts = body.has(p) && !std::binary_search(without.begin(), without.end(), p);
    fragments.number.push_back(counts ? of_lowest[sets.smallest(p)] : -1);
  }
  return fragments;
}

FragmentCount count_fragments(const Model& model, const BodyPart& body,
                              const std::vector<ParticleId>& without) {
  Sets sets(model.particles());
  const Pieces pieces = pieces_of(model, body, without, sets);
  const auto masses_of = [](const std::vector<Fragment>& some) {
    std::vector<double> masses;
    for (const Fragment& f : some) masses.push_back(f.mass);
    std::sort(masses.begin(), masses.end(), std::greater<>());
    return masses;
  };
  std::array<double, 2> sums{static_cast<double>(pieces.here.size()), 0.0};  // how many, and their mass
  double largest = 0.0;
  for (const double mass : masses_of(pieces.here)) sums[1] += mass, largest = std::max(largest, mass);
  body.all.sum(sums);
  body.all.max({&largest, 1});
  for (const double mass : masses_of(pieces.shared)) sums[1] += mass, largest = std::max(largest, mass);
  const auto number = static_cast<std::int64_t>(sums[0]) + static_cast<std::int64_t>(pieces.shared.size());
  return {number, number == 0 ? 0.0 : largest / sums[1]};
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
    if (!has_failed(b))
      joined[b.i].push_back({b.j, image_of_j(b)}), joined[b.j].push_back({b.i, -image_of_j(b)});
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

/// Of what each part has of fragments, all of which have a centre.
void add_up(FragmentMotion& of, const Communicator& all) {
  std::vector<double> sums;
  for (std::size_t k = 0; k < of.centre.size(); ++k) {
    const Vec3d &r = of.centre[k].value(), &v = of.velocity[k];
    sums.insert(sums.end(), {r.x, r.y, r.z, v.x, v.y, v.z});
  }
  all.sum(sums);
  for (std::size_t k = 0; k < of.centre.size(); ++k) {
    const double* const x = &sums[6 * k];
    of.centre[k] = Vec3d{x[0], x[1], x[2]}, of.velocity[k] = {x[3], x[4], x[5]};
  }
}

}  // namespace

FragmentMotion motion_of(const Fragments& fragments, const Model& model, const BodyPart& body) {
  const State& state = body.state;
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
  if (!body.is_whole()) add_up(of, body.all);
  return of;
}

}  // namespace vbond
