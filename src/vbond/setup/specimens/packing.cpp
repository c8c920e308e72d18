#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "vbond/core/threads.hpp"
#include "vbond/packing/pack.hpp"
#include "vbond/setup/packing_vessel.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {
namespace {

constexpr double deviations = 3.0;  // to either side, where the case does not say more

struct LawOf {
  packing::SizeLaw operator()(const EqualGrains& g) const { return packing::EqualSizes{g.radius}; }
  packing::SizeLaw operator()(const UniformGrains& g) const {
    return packing::UniformSizes{g.radii[0], g.radii[1]};
  }
  packing::SizeLaw operator()(const NormalGrains& g) const {
    return packing::NormalSizes{g.mean, g.deviation, g.from.value_or(g.mean - deviations * g.deviation),
                                g.to.value_or(g.mean + deviations * g.deviation)};
  }
  packing::SizeLaw operator()(const LognormalGrains& g) const {
    const double most = std::exp(deviations * g.deviation);
    return packing::LognormalSizes{g.median, g.deviation, g.from.value_or(g.median / most),
                                   g.to.value_or(g.median * most)};
  }
  packing::SizeLaw operator()(const CurveGrains& g) const {
    packing::TableSizes t{{}, g.by_mass};
    for (std::size_t k = 0; k < std::min(g.radii.size(), g.passing.size()); ++k)
      t.points.emplace_back(g.radii[k], g.passing[k]);
    return t;
  }
};

packing::Kind kind_of(const GrainSpec& g, double density) {
  try {
    return {g.name, packing::Sizes(std::visit(LawOf{}, g.sizes)), g.share, g.density.value_or(density)};
  } catch (const std::invalid_argument& e) {
    throw CaseError({g.place, fmt::format("sizes of grains \"{}\"", g.name), e.what(), "correct them"});
  }
}

packing::Request request_of(const PackingSpecimen& s, double density, int threads) {
  packing::Request q;
  for (const GrainSpec& g : s.grains) q.kinds.push_back(kind_of(g, density));
  switch (s.share_by) {
    case GrainShares::volume: q.share_by = packing::ShareBy::volume; break;
    case GrainShares::mass: q.share_by = packing::ShareBy::mass; break;
    case GrainShares::number: q.share_by = packing::ShareBy::number; break;
  }
  switch (s.floaters) {
    case FloatingGrains::keep: q.floaters = packing::Floaters::keep; break;
    case FloatingGrains::remove: q.floaters = packing::Floaters::remove; break;
    case FloatingGrains::grow: q.floaters = packing::Floaters::grow; break;
  }
  if (s.jammed)
    q.until = packing::UntilJammed{
        s.particles ? std::optional(static_cast<std::size_t>(*s.particles)) : std::nullopt, s.overlap};
  else if (s.particles)
    q.until = packing::ToNumber{static_cast<std::size_t>(*s.particles)};
  else
    q.until = packing::ToPorosity{s.porosity.value_or(0.0)};
  q.overlap = s.overlap.value_or(q.overlap);
  q.neighbours = static_cast<int>(s.neighbours);
  q.gap = s.gap;
  q.seed = s.seed;
  q.threads = threads_or_all(threads);
  return q;
}

/// jammed: it was asked for. Else nothing holds the grains, and all rattle.
void add_notes(const std::string& who, const packing::Packing& p, bool jammed,
               std::vector<std::string>& notes) {
  const packing::Measured& is = p.is;
  std::string text = fmt::format("{}: {} grains with radii {:.6g} to {:.6g}, porosity {:.6g}", who,
                                 p.r.size(), is.least_radius, is.largest_radius, is.porosity);
  if (is.core_porosity >= 0.0 && is.core_porosity != is.porosity)
    text += fmt::format(", deeper than a mean radius below walls {:.3f}", is.core_porosity);
  if (std::abs(p.size_factor - 1.0) > 1e-12)
    text += fmt::format("; sizes are those asked for times {:.6g}", p.size_factor);
  notes.push_back(text);
  text = fmt::format("{}: neighbours of a grain", who);
  for (std::size_t k = 0; k < is.gaps.size(); ++k)
    text += fmt::format("{} {:.2f} within {}", k > 0 ? "," : "", is.neighbours[k], is.gaps[k]);
  notes.push_back(text + " of the sum of radii");
  notes.push_back(fmt::format("{}: {:.3f} contacts of a grain{}, largest overlap {:.2g} of a radius", who,
                              is.contacts, jammed ? fmt::format(", {} rattlers", is.rattlers) : "",
                              std::max(is.largest_overlap, is.largest_wall_overlap)));
  if (is.cells)
    notes.push_back(
        fmt::format("{}: cells of {:.4g} to {:.4g} times their mean volume, with a porosity of {:.3f} to "
                    "{:.3f}, and {:.2f} faces",
                    who, is.cells->least / is.cells->mean, is.cells->largest / is.cells->mean,
                    is.cells->least_porosity, is.cells->largest_porosity, is.cells->faces));
  if (p.removed > 0)
    notes.push_back(
        fmt::format("{}: {} floaters taken away: the porosity is that without them", who, p.removed));
  if (p.grown > 0)
    notes.push_back(
        fmt::format("{}: {} floaters grown, by up to {:.3g} times: the porosity is that with them", who,
                    p.grown, p.largest_growth));
  if (p.sizes_off > 0.01)
    notes.push_back(
        fmt::format("{}: so few grains follow the curve of sizes to {:.2g} only", who, p.sizes_off));
}

}  // namespace

SpecimenPoints make_packing(const PackingSpecimen& s, const SpecimenSpec& spec, const CellSpec* cell,
                            const std::string& case_file, int threads) {
  SpecimenPoints points;
  packing::Request request = request_of(s, spec.density.value_or(1.0), threads);
  request.vessel = vessel_of(s, spec.place, cell, case_file, points.notes);
  if (!(request.vessel.frame_volume() > 0.0)) return points;
  packing::Packing p;
  try {
    p = packing::pack(request);
  } catch (const packing::Refused& e) {
    throw CaseError({spec.place, fmt::format("packing \"{}\": {}", spec.name, e.what()), e.rule, e.way_out});
  }
  p.is.cells = packing::measure_cells(request.vessel, p.r, p.radius, request.threads);
  points.r = p.r;
  points.radius = p.radius;
  const bool of_grains =
      std::any_of(s.grains.begin(), s.grains.end(), [](const auto& g) { return g.density.has_value(); });
  for (std::size_t k = 0; k < s.grains.size(); ++k) {
    std::vector<std::int64_t> members;
    for (std::size_t i = 0; i < p.kind.size(); ++i)
      if (p.kind[i] == k) members.push_back(static_cast<std::int64_t>(i));
    if (!members.empty()) points.parts.emplace_back(s.grains[k].name, std::move(members));
  }
  for (std::size_t i = 0; i < p.r.size() && of_grains; ++i)
    points.mass.push_back(4.0 / 3.0 * std::numbers::pi * std::pow(p.radius[i], 3) *
                          request.kinds[p.kind[i]].density);
  add_notes(fmt::format("packing \"{}\"", spec.name), p, s.jammed, points.notes);
  points.packing = std::move(p);
  return points;
}

}  // namespace vbond
