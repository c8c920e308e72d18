#include "vbond/terms/pressure/setup_pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "vbond/packing/skin.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/regions.hpp"
#include "vbond/setup/text_file.hpp"
#include "vbond/terms/pressure/pressed.hpp"
#include "vbond/terms/pressure/setup_facets.hpp"

namespace vbond {
namespace {

constexpr const char* pressure_rule = "pressure acts on the facets of a surface";

Vec3d across_of(const PressureSpec& s) {
  return s.surface == PressedSurface::strips ? s.width * normalised(s.normal) : Vec3d{};
}

/// Finds the facets of one entry.
class FacetFinder {
 public:
  FacetFinder(const StageResolver& resolver, const State& state, const PressureSpec& spec)
      : resolver_(resolver), state_(state), spec_(spec) {}

  std::vector<Facet> find() {
    const Group* group = resolver_.model.find_group(spec_.group.value);
    if (group == nullptr) return {};  // told already
    const std::vector<char> in_group = membership(*group, resolver_.model);
    FoundFacets found = surface(*group, in_group);
    if (found.what.empty() && spec_.surface == PressedSurface::triangles)
      found = facing_alike(std::move(found.facets));
    if (found.what.empty() && spec_.surface != PressedSurface::skin)
      found = facing_away(std::move(found.facets), across_of(spec_), spec_.inside, state_.r);
    if (found.what.empty() && spec_.region) keep_in_region(found);
    if (found.what.empty()) return std::move(found.facets);
    refuse(found.what, found.way_out);
    return {};
  }

 private:
  void refuse(const std::string& what, const std::string& way_out) const {
    if (what != told_in_file)
      resolver_.problems.add(spec_.place,
                             fmt::format("pressure on group \"{}\": {}", spec_.group.value, what),
                             pressure_rule, way_out);
  }

  FoundFacets surface(const Group& group, const std::vector<char>& in_group) const {
    switch (spec_.surface) {
      case PressedSurface::strips: return strips_of(state_, in_group);
      case PressedSurface::triangles:
        return spec_.file ? from_file(in_group) : triangles_of(state_, in_group);
      case PressedSurface::skin: return skin(group, in_group);
    }
    return {};
  }

  FoundFacets from_file(const std::vector<char>& in_group) const {
    const auto file = beside_case(resolver_.c.file, spec_.file->value);
    const CsvTable table = read_csv(file, spec_.file->place, {{"i", true}, {"j", true}, {"k", true}},
                                    {false, "rename or remove it"});
    FoundFacets found;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      std::array<ParticleId, 3> corner;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::optional<std::int64_t> n = to_integer(table.fields[c][row]);
        const bool known = n && *n >= 0 && *n < static_cast<std::int64_t>(in_group.size());
        if (!known || in_group[static_cast<std::size_t>(*n)] == 0) {
          resolver_.problems.add(
              {file.string(), table.lines[row], 1},
              fmt::format("{} is no particle of group \"{}\"", table.fields[c][row], spec_.group.value),
              "i, j and k are particle numbers from 0, of that group", "correct the row");
          return {{}, told_in_file, {}};
        }
        corner[c] = ParticleId{static_cast<std::size_t>(*n)};
      }
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
        resolver_.problems.add({file.string(), table.lines[row], 1}, "a triangle has a particle twice",
                               "it has three different corners", "correct or remove the row");
        return {{}, told_in_file, {}};
      }
      found.facets.push_back({corner[0], corner[1], corner[2]});
    }
    if (found.facets.empty()) return {{}, "its file has no triangles", "add rows i, j, k"};
    return found;
  }

  /// Nothing if there are neither bonds nor radii.
  std::optional<double> longest(const Group& group, const std::vector<char>& in_group) const {
    if (spec_.longest) return spec_.longest;
    constexpr double times_neighbours = 1.2;
    double sum = 0.0, bonds = 0.0, radii = 0.0;
    for (const Bond& b : state_.bonds)
      if (!b.broken && in_group[b.i.value] != 0 && in_group[b.j.value] != 0)
        sum += norm(between(state_, b)), bonds += 1.0;
    if (bonds > 0.0) return times_neighbours * sum / bonds;
    for (const ParticleId p : group.particles) radii += resolver_.model.radius[p];
    if (!(radii > 0.0)) return std::nullopt;
    return 2.0 * times_neighbours * radii / static_cast<double>(group.particles.size());
  }

  FoundFacets skin(const Group& group, const std::vector<char>& in_group) const {
    const std::optional<double> radius = longest(group, in_group);
    if (!radius) return {{}, "its particles have no bonds and no radii", "give longest"};
    std::vector<Vec3d> r;
    for (const ParticleId p : group.particles) r.push_back(state_.r[p]);
    const std::optional<packing::Skin> skin = packing::skin_of(r, *radius);
    if (!skin)
      return {
          {}, "no tetrahedra of its particles fit together", "choose another longest, or move a particle"};
    FoundFacets found;
    for (const auto& [i, j, k] : skin->triangles)
      found.facets.push_back({group.particles[i], group.particles[j], group.particles[k]});
    if (found.facets.empty())
      return {{},
              fmt::format("no four of its particles have a sphere through them of radius {:.4g}, or less",
                          *radius),
              "use a larger longest; sheets take surface = \"triangles\", chains \"strips\""};
    return found;
  }

  void keep_in_region(FoundFacets& found) const {
    std::vector<std::string> notes;
    const RegionOwner owner{resolver_.c.file, spec_.region->place, "the region of a pressure", notes};
    const Inside inside =
        std::visit([&](const auto& region) { return inside_of(region, owner); }, spec_.region->region);
    std::erase_if(found.facets, [&](const Facet& f) {
      Vec3d middle = state_.r[f.i] + state_.r[f.j];
      if (!f.is_strip()) middle += state_.r[f.k];
      return !inside(middle / f.corners());
    });
    if (found.facets.empty())
      found = {{}, "no facet of the surface lies in the region", "move or enlarge the region"};
  }

  static constexpr const char* told_in_file = "its file is wrong";

  const StageResolver& resolver_;
  const State& state_;
  const PressureSpec& spec_;
};

void refuse_passage(const StageResolver& resolver, const PressureSpec& s) {
  const char* same = "it acts on the same particles throughout a stage";
  if (is_static(resolver.spec.kind)) return;
  if (resolver.c.watch.on_unphysical == OnUnphysical::drop)
    resolver.problems.add(s.place, "pressure in a stage that drops particles", same,
                          "use watch.on_unphysical = \"stop\": none may be dropped");
  if (!resolver.c.sources.empty() || !resolver.c.sinks.empty())
    resolver.problems.add(s.place, "pressure in a case with sources or sinks", same,
                          "make two cases of it: bodies that come in, then their last state under pressure");
}

}  // namespace

std::vector<Pressure> resolve_pressures(const StageResolver& resolver) {
  std::vector<Pressure> resolved;
  for (const PressureSpec& s : resolver.spec.pressures) {
    resolver.particles(s.group);
    if (resolver.model.cell.any())
      resolver.problems.add(s.place, "a periodic body takes no pressure", "its surface would cross the cell",
                            "give the cell a stress: cell = {xx = ...}");
    refuse_passage(resolver, s);
    resolved.push_back({s.group.value,
                        {},
                        s.pressure,
                        resolver.function(s.factor, s.place),
                        s.constant,
                        s.kind,
                        s.centre,
                        across_of(s)});
  }
  return resolved;
}

void find_facets(const StageResolver& resolver, const State& state, std::vector<Pressure>& pressures) {
  for (std::size_t k = 0; k < pressures.size(); ++k)
    pressures[k].facets = FacetFinder(resolver, state, resolver.spec.pressures[k]).find();
}

}  // namespace vbond
