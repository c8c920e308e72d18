#include "vbond/terms/pressure/pressed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {
namespace {

auto places(const PerParticle<Vec3d>& r) {
  return [&r](ParticleId p) { return r[p]; };
}

std::vector<ParticleId> corners_of(const Facet& f) {
  return f.is_strip() ? std::vector<ParticleId>{f.i, f.j} : std::vector<ParticleId>{f.i, f.j, f.k};
}

/// What points along the radius alone: so a half that is cut at a plane of symmetry is pressed as the whole.
Vec3d parts_towards_centre(const Pressure& pressure, const Facet& f, const Vec3d& area,
                           const PerParticle<Vec3d>& r) {
  if (pressure.kind != PressureKind::central) return {};
  const auto part = [&](ParticleId p) {
    const Vec3d way = between(r[p], pressure.centre);
    return -dot(area, way) / (norm(way) * f.corners());
  };
  return {part(f.i), part(f.j), f.is_strip() ? 0.0 : part(f.k)};
}

}  // namespace

std::vector<PressedFacet> facets_as_found(const std::vector<Pressure>& pressures,
                                          const PerParticle<Vec3d>& r) {
  std::vector<PressedFacet> all;
  for (std::uint32_t k = 0; k < pressures.size(); ++k)
    for (const Facet& f : pressures[k].facets) {
      const Vec3d area = area_of(f, pressures[k].across, places(r));
      all.push_back({k, f.i, f.j, f.k, area, parts_towards_centre(pressures[k], f, area, r)});
    }
  return all;
}

bool belong_to(const std::vector<PressedFacet>& facets, const std::vector<Pressure>& pressures) {
  std::vector<std::size_t> count(pressures.size(), 0);
  std::vector<char> points(pressures.size(), 0);
  for (const PressedFacet& f : facets) {
    if (f.pressure >= pressures.size()) return false;
    if (f.towards != Vec3d{}) points[f.pressure] = 1;
    const std::vector<Facet>& named = pressures[f.pressure].facets;
    const std::size_t number = count[f.pressure]++;
    if (!named.empty() && (number >= named.size() || named[number] != f.facet())) return false;
  }
  for (std::size_t k = 0; k < pressures.size(); ++k)
    if (count[k] == 0 || (!pressures[k].facets.empty() && count[k] != pressures[k].facets.size()) ||
        (pressures[k].kind == PressureKind::central && points[k] == 0))
      return false;
  return true;
}

bool is_closed(const std::vector<Facet>& facets) {
  std::map<std::pair<ParticleId, ParticleId>, int> open;  // times an edge is run along from low to high
  std::map<ParticleId, int> ends;
  for (const Facet& f : facets) {
    if (f.is_strip()) {
      ++ends[f.i], --ends[f.j];
      continue;
    }
    for (const auto& [p, q] : {std::pair{f.i, f.j}, {f.j, f.k}, {f.k, f.i}})
      open[std::minmax(p, q)] += p < q ? 1 : -1;
  }
  const auto none = [](const auto& entry) { return entry.second == 0; };
  return std::all_of(open.begin(), open.end(), none) && std::all_of(ends.begin(), ends.end(), none);
}

/// The volume by the divergence of the place: of a prism over strips that of two of its components.
SurfaceSize size_of(const std::vector<Facet>& facets, const Vec3d& across, const PerParticle<Vec3d>& r) {
  SurfaceSize size;
  if (facets.empty()) return size;
  const Vec3d origin = r[facets.front().i];
  for (const Facet& f : facets) {
    const Vec3d area = area_of(f, across, places(r));
    Vec3d middle;
    for (const ParticleId p : corners_of(f)) middle += between(origin, r[p]) / f.corners();
    size.area += norm(area);
    size.volume += dot(middle, area) / (f.is_strip() ? 2.0 : 3.0);
  }
  return size;
}

PressedSurfaces::PressedSurfaces(const std::vector<Pressure>& pressures, std::vector<PressedFacet> facets)
    : pressures_(&pressures), facets_(std::move(facets)) {
  std::vector<std::tuple<ParticleId, std::uint32_t, std::size_t, double>> all;
  for (std::size_t k = 0; k < facets_.size(); ++k) {
    const PressedFacet& f = facets_[k];
    all.emplace_back(f.i, f.pressure, k, f.towards.x);
    all.emplace_back(f.j, f.pressure, k, f.towards.y);
    if (!f.facet().is_strip()) all.emplace_back(f.k, f.pressure, k, f.towards.z);
  }
  std::sort(all.begin(), all.end());
  for (const auto& [p, pressure, facet, towards] : all) {
    if (shares_.empty() || shares_.back().p != p || shares_.back().pressure != pressure)
      shares_.push_back({p, pressure, of_shares_.size(), of_shares_.size(), {}});
    shares_.back().dead -= facets_[facet].area / facets_[facet].facet().corners();
    shares_.back().towards += towards;
    of_shares_.push_back(facet);
    ++shares_.back().last;
  }
}

double lambda_of_pressures(const std::vector<Pressure>& pressures, const PerParticle<double>& mass,
                           const PerParticle<Vec3d>& r, double duration) {
  if (pressures.empty()) return 0.0;
  PerParticle<double> row(r.size(), 0.0);
  const PressedSurfaces surfaces(pressures, facets_as_found(pressures, r));
  for (const PressedSurfaces::Share& s : surfaces.shares()) {
    const Pressure& of = pressures[s.pressure];
    double factor = std::abs(of.factor(duration));
    for (const TimeFunction::Point& p : of.factor.points) factor = std::max(factor, std::abs(p.factor));
    const double p = factor * std::abs(of.pressure);
    if (of.kind == PressureKind::central)
      row[s.p] += p * std::abs(s.towards) / norm(between(r[s.p], of.centre));
  }
  for (const PressedFacet& f : surfaces.facets()) {
    const Pressure& of = pressures[f.pressure];
    if (of.kind != PressureKind::follower) continue;
    double factor = std::abs(of.factor(duration)), turns = 0.0;
    for (const TimeFunction::Point& p : of.factor.points) factor = std::max(factor, std::abs(p.factor));
    const Facet facet = f.facet();
    for (int b = 0; b < static_cast<int>(facet.corners()); ++b)
      turns += norm(turn_of_force(facet, of.across, b, places(r)));
    for (const ParticleId p : corners_of(facet)) row[p] += factor * std::abs(of.pressure) * turns;
  }
  double lambda = 0.0;
  for (const ParticleId p : row.ids()) lambda = std::max(lambda, row[p] / mass[p]);
  return lambda;
}

std::string in_words(const Pressure& pressure, const PerParticle<Vec3d>& r) {
  const SurfaceSize size = size_of(pressure.facets, pressure.across, r);
  const bool strips = !pressure.facets.empty() && pressure.facets.front().is_strip();
  std::string text = fmt::format("{} {} of group \"{}\"", pressure.facets.size(),
                                 strips ? "strips" : "triangles", pressure.group);
  if (is_closed(pressure.facets))
    text += fmt::format(", closed: area {:.6g}, volume {:.6g}", size.area, size.volume);
  else
    text += fmt::format(", with free edges: area {:.6g}", size.area);
  return text;
}

AddedFrequency PressureTerm::added_frequency(const Model& model, const State& state, const Stage& stage,
                                             double dt_without) {
  if (!std::isfinite(dt_without)) return {};
  return {lambda_of_pressures(stage.pressures, model.mass, state.r, stage.stops.duration), "pressure"};
}

}  // namespace vbond
