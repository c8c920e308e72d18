#include "vbond/packing/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "vbond/core/images.hpp"
#include "vbond/core/random.hpp"
#include "vbond/packing/voronoi.hpp"

namespace vbond::packing {
namespace {

using Pairs = std::vector<std::array<std::size_t, 2>>;

/// Contacts between grains, and of each grain with walls: gaps up to `touching_gap`.
void find_contacts(const Vessel& vessel, const std::vector<Vec3d>& r, const std::vector<double>& radius,
                   double touching_gap, Measured& is) {
  const std::size_t n = r.size();
  Pairs pairs;
  std::vector<int> touching(n, 0), walls(n, 0);
  for_overlapping_images(vessel.cell, vessel.periodic, r, radius, touching_gap,
                         [&](std::size_t i, std::size_t j, const Image&, double d2) {
                           const double delta = radius[i] + radius[j] - std::sqrt(d2);
                           if (!(delta > -touching_gap)) return;
                           pairs.push_back({i, j});
                           ++touching[i], ++touching[j];
                           is.largest_overlap =
                               std::max(is.largest_overlap, delta / std::min(radius[i], radius[j]));
                         });
  std::vector<Feel> feels;
  for (std::size_t i = 0; i < n; ++i) {
    feels.clear();
    vessel.feel(r[i], radius[i] + touching_gap, feels);
    walls[i] = static_cast<int>(feels.size());
    touching[i] += walls[i];
    for (const Feel& f : feels)
      is.largest_wall_overlap = std::max(is.largest_wall_overlap, (radius[i] - f.depth) / radius[i]);
  }
  is.contacts =
      static_cast<double>(std::accumulate(touching.begin(), touching.end(), 0)) / static_cast<double>(n);

  constexpr int holds = 4;  // contacts hold a sphere in space
  std::vector<char> free(n, 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < n; ++i)
      if (!free[i] && touching[i] < holds) free[i] = 1, changed = true;
    touching = walls;
    for (const auto& [i, j] : pairs)
      if (!free[i] && !free[j]) ++touching[i], ++touching[j];
  }
  is.rattlers = static_cast<std::size_t>(std::count(free.begin(), free.end(), 1));
  int sum = 0;  // ends of contacts; those at walls have two as well
  for (std::size_t i = 0; i < n; ++i) sum += free[i] ? 0 : touching[i] + walls[i];
  if (is.rattlers < n) is.backbone_contacts = sum / static_cast<double>(n - is.rattlers);
}

/// Stratified: a random point in each of many equal parts of the frame.
double porosity_deeper_than(const Vessel& vessel, double depth, const std::vector<Vec3d>& r,
                            const std::vector<double>& radius) {
  constexpr int parts = 96;
  const double largest = *std::max_element(radius.begin(), radius.end());
  std::vector<Vec3d> at = r;
  std::vector<double> R = radius;
  if (!vessel.cell.empty()) {
    std::vector<Vec3d> from_corner = r;
    for (Vec3d& x : from_corner) x -= vessel.corner;
    const NearImages images = near_images(vessel.cell, vessel.periodic, from_corner, largest);
    at = images.r;
    for (Vec3d& x : at) x += vessel.corner;
    R.clear();
    for (const std::size_t k : images.of) R.push_back(radius[k]);
  }
  const CellGrid grid(at, largest);
  Random random(1);
  std::size_t points = 0, empty = 0;
  for (int a = 0; a < parts; ++a)
    for (int b = 0; b < parts; ++b)
      for (int c = 0; c < parts; ++c) {
        const double x = random.uniform(), y = random.uniform(), z = random.uniform();
        const Vec3d p = vessel.at({(a + x) / parts, (b + y) / parts, (c + z) / parts});
        if (!(vessel.depth(p) > depth)) continue;
        ++points;
        bool within = false;
        grid.scan_near(p, [&](const CellGrid::Point* first, const CellGrid::Point* last) {
          for (const CellGrid::Point* q = first; q != last && !within; ++q)
            within = norm2(q->r - p) < sq(R[q->i]);
        });
        empty += !within;
      }
  return points > 0 ? static_cast<double>(empty) / static_cast<double>(points) : -1.0;
}

void find_neighbours(const Vessel& vessel, const std::vector<Vec3d>& r, const std::vector<double>& radius,
                     Measured& is) {
  std::vector<double> wide = radius;
  for (double& R : wide) R *= Measured::gaps.back();
  std::array<double, Measured::gaps.size()> count{};
  std::vector<char> has_any(r.size(), 0);
  for_overlapping_images(vessel.cell, vessel.periodic, r, wide, 0.0,
                         [&](std::size_t i, std::size_t j, const Image&, double d2) {
                           const double gap = std::sqrt(d2) / (radius[i] + radius[j]);
                           for (std::size_t k = 0; k < count.size(); ++k)
                             if (gap < Measured::gaps[k]) count[k] += 2.0;
                           if (gap < 1.05) has_any[i] = has_any[j] = 1;
                         });
  for (std::size_t k = 0; k < count.size(); ++k) is.neighbours[k] = count[k] / static_cast<double>(r.size());
  is.loners = static_cast<std::size_t>(std::count(has_any.begin(), has_any.end(), 0));
}

void find_rdf(const Vessel& vessel, const std::vector<Vec3d>& r, Measured& is) {
  const double D = 2.0 * is.mean_radius, reach = Measured::rdf_reach * D, step = Measured::rdf_step * D;
  std::vector<char> deep(r.size(), 1);
  for (std::size_t i = 0; i < r.size() && !vessel.walls.empty(); ++i) deep[i] = vessel.depth(r[i]) > reach;
  const auto grains = static_cast<double>(std::count(deep.begin(), deep.end(), 1));
  if (grains < 1.0) return;
  std::vector<double> count(static_cast<std::size_t>(std::lround(reach / step)), 0.0);
  for_near_images(vessel.cell, vessel.periodic, r, reach,
                  [&](std::size_t i, std::size_t j, const Image&, double d2) {
                    const auto k = static_cast<std::size_t>(std::sqrt(d2) / step);
                    if (k < count.size()) count[k] += deep[i] + deep[j];
                  });
  const double per_volume = grains / volume_deeper_than(vessel, vessel.walls.empty() ? 0.0 : reach);
  for (std::size_t k = 0; k < count.size(); ++k) {
    const double a = static_cast<double>(k) * step, b = a + step;
    count[k] /= grains * per_volume * 4.0 / 3.0 * std::numbers::pi * (b * b * b - a * a * a);
  }
  is.rdf = std::move(count);
}

}  // namespace

double volume_of(const std::vector<double>& radius) {
  double sum = 0.0;
  for (const double R : radius) sum += R * R * R;
  return 4.0 / 3.0 * std::numbers::pi * sum;
}

std::vector<int> count_neighbours(const Vessel& vessel, const std::vector<Vec3d>& r,
                                  const std::vector<double>& radius, double gap) {
  std::vector<double> wide = radius;
  for (double& R : wide) R *= gap;
  std::vector<int> count(r.size(), 0);
  for_overlapping_images(vessel.cell, vessel.periodic, r, wide, 0.0,
                         [&](std::size_t i, std::size_t j, const Image&, double) { ++count[i], ++count[j]; });
  return count;
}

Measured measure(const Vessel& vessel, double volume, const std::vector<Vec3d>& r,
                 const std::vector<double>& radius, double touching) {
  Measured is;
  is.volume = volume;
  if (r.empty()) return is;
  is.porosity = 1.0 - volume_of(radius) / volume;
  const auto [least, largest] = std::minmax_element(radius.begin(), radius.end());
  is.least_radius = *least, is.largest_radius = *largest;
  is.mean_radius = std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size());
  is.core_porosity =
      vessel.walls.empty() ? is.porosity : porosity_deeper_than(vessel, is.mean_radius, r, radius);
  find_contacts(vessel, r, radius, touching, is);
  find_neighbours(vessel, r, radius, is);
  find_rdf(vessel, r, is);
  return is;
}

std::optional<MeasuredCells> measure_cells(const Vessel& vessel, const std::vector<Vec3d>& r,
                                           const std::vector<double>& radius, int threads) {
  const auto space = space_of(vessel);
  if (!space || r.empty()) return std::nullopt;
  const VoronoiCells cells = voronoi_cells(*space, r, radius, threads);
  MeasuredCells is;
  is.least = is.least_porosity = std::numeric_limits<double>::infinity();
  is.largest_porosity = -is.least_porosity;
  std::size_t faces = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double V = cells.volume[i];
    is.least = std::min(is.least, V), is.largest = std::max(is.largest, V), is.mean += V;
    if (!(V > 0.0)) return std::nullopt;  // others have taken all of its place
    const double porosity = 1.0 - 4.0 / 3.0 * std::numbers::pi * radius[i] * radius[i] * radius[i] / V;
    is.least_porosity = std::min(is.least_porosity, porosity);
    is.largest_porosity = std::max(is.largest_porosity, porosity), is.mean_porosity += porosity;
    for (const VoronoiFace& f : cells.faces_of(i))
      faces +=
          f.area > MeasuredCells::least_face * norm2(between(r[i], r[f.of] + to_image(vessel.cell, f.image)));
  }
  const double count = static_cast<double>(r.size());
  is.mean /= count, is.mean_porosity /= count, is.faces = static_cast<double>(faces) / count;
  return is;
}

}  // namespace vbond::packing
