// Pairs by how near particles are, and by the faces of their Voronoi cells.
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "vbond/core/images.hpp"
#include "vbond/core/threads.hpp"
#include "vbond/packing/voronoi.hpp"
#include "vbond/setup/bond_pairs.hpp"

namespace vbond {

std::vector<Pair> pairs_within(const std::vector<Vec3d>& r, double distance, const std::vector<char>& in_a,
                               const std::vector<char>& in_b, double most, const CellEdges& cell,
                               const Periodic& periodic) {
  std::vector<Pair> pairs;
  for_near_images(cell, periodic, r, distance, [&](std::size_t i, std::size_t j, const Image& n, double) {
    if (!((in_a[i] && in_b[j]) || (in_a[j] && in_b[i]))) return;
    if (static_cast<double>(pairs.size()) >= most) throw std::length_error("too many pairs");
    pairs.push_back({ParticleId{i}, ParticleId{j}, n});
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Pair> pairs_within(const std::vector<Vec3d>& r, const std::vector<double>& radius,
                               const BondReach& reach, const std::vector<char>& in_a,
                               const std::vector<char>& in_b, double most, const CellEdges& cell,
                               const Periodic& periodic) {
  const double of_points = reach.limit(0.0, 0.0);
  if (!(reach.factor > 0.0)) return pairs_within(r, of_points, in_a, in_b, most, cell, periodic);
  std::vector<double> sizes;
  for (const double R : radius) sizes.push_back(0.5 * (reach.limit(R, R) - of_points));
  std::vector<Pair> pairs;
  for_overlapping_images(cell, periodic, r, sizes, of_points,
                         [&](std::size_t i, std::size_t j, const Image& n, double) {
                           if (!((in_a[i] && in_b[j]) || (in_a[j] && in_b[i]))) return;
                           if (static_cast<double>(pairs.size()) >= most)
                             throw std::length_error("too many pairs");
                           pairs.push_back({ParticleId{i}, ParticleId{j}, n});
                         });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Pair> pairs_within(const Model& model, const State& state, const BondReach& reach,
                               const std::vector<char>& in_a, const std::vector<char>& in_b, double most) {
  if (!any_absent(state))
    return pairs_within(state.r.values(), model.radius.values(), reach, in_a, in_b, most, state.cell,
                        model.cell.periodic);
  std::vector<ParticleId> of;
  std::vector<Vec3d> r;
  std::vector<double> radius;
  std::vector<char> of_a, of_b;
  for (const ParticleId p : state.r.ids()) {
    if (is_absent(state, p)) continue;
    of.push_back(p), r.push_back(state.r[p]), radius.push_back(model.radius[p]);
    of_a.push_back(in_a[p.value]), of_b.push_back(in_b[p.value]);
  }
  std::vector<Pair> pairs = pairs_within(r, radius, reach, of_a, of_b, most, state.cell, model.cell.periodic);
  for (Pair& p : pairs) p.i = of[p.i.value], p.j = of[p.j.value];
  return pairs;
}

namespace {

/// Particles, and images of them, that may be within reach of some.
struct Candidates {
  std::vector<Vec3d> r;
  std::vector<ParticleId> of;
  std::vector<Image> image;   // none of an open body
  std::size_t particles = 0;  // come first
};

Candidates candidates_near(const Model& model, const State& state, const PerParticle<char>& some,
                           double reach) {
  const double farthest = reach * (1.0 + 1e-9);  // more than rounding of sums of reaches
  Candidates near;
  BoundingBox box;
  if (state.cell.empty()) {
    for (const ParticleId p : state.r.ids())
      if (some[p] != 0) box.add(state.r[p]);
    for (const ParticleId p : state.r.ids())
      if (box.is_near(state.r[p], farthest)) near.r.push_back(state.r[p]), near.of.push_back(p);
    near.particles = near.of.size();
    return near;
  }
  const NearImages all = near_images(state.cell, model.cell.periodic, state.r.values(), reach);
  for (std::size_t k = 0; k < all.points; ++k)
    if (some[ParticleId{k}] != 0) box.add(all.r[k]);
  for (std::size_t k = 0; k < all.r.size(); ++k) {
    if (!box.is_near(all.r[k], farthest)) continue;
    near.particles += k < all.points ? 1 : 0;
    near.r.push_back(all.r[k]), near.of.push_back(ParticleId{all.of[k]}), near.image.push_back(all.image[k]);
  }
  return near;
}

}  // namespace

std::vector<Pair> pairs_within(const Model& model, const State& state, const BondReach& reach,
                               const std::vector<char>& in_a, const std::vector<char>& in_b, double most,
                               const PerParticle<char>& some) {
  const bool by_size = reach.factor > 0.0;
  const double of_points = reach.limit(0.0, 0.0);
  double R = 0.0;
  for (const double radius : model.radius) R = std::max(R, radius);
  const Candidates near = candidates_near(model, state, some, reach.limit(R, R));
  std::vector<double> sizes(near.r.size(), 0.0);
  for (std::size_t k = 0; by_size && k < sizes.size(); ++k) {
    const double radius = model.radius[near.of[k]];
    sizes[k] = 0.5 * (reach.limit(radius, radius) - of_points);
  }
  SizedPoints points(sizes, of_points);
  points.sort(near.r);
  std::vector<Pair> pairs;
  const auto look = [&](std::size_t p, std::size_t q) {
    const ParticleId i = near.of[p], j = near.of[q];
    const Image n = near.image.empty() ? Image{} : near.image[q] - near.image[p];
    const bool is_found_elsewhere = q < near.particles ? j <= i : i > j || (i == j && n < Image{});
    if (is_found_elsewhere || !((in_a[i.value] && in_b[j.value]) || (in_a[j.value] && in_b[i.value]))) return;
    const double d2 = norm2(between(near.r[p], near.r[q]));
    if (by_size ? d2 < sq(sizes[p] + sizes[q] + of_points) : d2 <= sq(of_points)) {
      if (static_cast<double>(pairs.size()) >= most) throw std::length_error("too many pairs");
      pairs.push_back({i, j, n});
    }
  };
  for (std::size_t p = 0; p < near.particles; ++p)
    if (some[near.of[p]] != 0)
      points.scan_near(p, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
        for (; first != last; ++first) look(p, first->i);
      });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

const packing::VoronoiCells& SharedCells::of(const Model& model, const State& state,
                                             const std::vector<Vec3d>& r, const std::vector<double>& radius,
                                             double margin) {
  const Periodic& periodic = model.cell.periodic;
  const bool is_open = state.cell.empty() || !(periodic[0] && periodic[1] && periodic[2]);
  if (cells_ && (!is_open || margin_ == margin)) return *cells_;
  margin_ = margin;
  cells_ = packing::voronoi_cells(packing::space_around(r, radius, margin, state.cell, periodic), r, radius,
                                  threads_or_all(threads_));
  return *cells_;
}

void keep_those_that_share_faces(const Model& model, const State& state, double least, SharedCells& shared,
                                 std::vector<Pair>& pairs) {
  std::vector<Vec3d> r;
  std::vector<double> radius;
  std::vector<std::size_t> place(state.r.size(), state.r.size());  // among those that still take part
  for (const ParticleId p : state.r.ids()) {
    if (is_absent(state, p)) continue;
    place[p.value] = r.size();
    r.push_back(state.r[p]), radius.push_back(model.radius[p]);
  }
  if (r.empty() || pairs.empty()) return;
  double farthest = 0.0;  // half of it is room for a whole face between two particles of the surface
  for (const Pair& p : pairs) farthest = std::max(farthest, norm(between(state, p.i, p.j, p.image_j)));
  const packing::VoronoiCells& cells = shared.of(model, state, r, radius, 0.5 * farthest);
  std::erase_if(pairs, [&](const Pair& p) {
    if (is_absent(state, p.i) || is_absent(state, p.j)) return true;
    for (const packing::VoronoiFace& f : cells.faces_of(place[p.i.value]))
      if (f.of == place[p.j.value] && f.image == p.image_j)
        return f.area < least * norm2(between(state, p.i, p.j, p.image_j));
    return true;
  });
}

}  // namespace vbond
