
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "vbond/core/disjoint_sets.hpp"
#include "vbond/packing/skin.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/csv_table.hpp"
#include "vbond/setup/groups.hpp"
#include "vbond/setup/regions.hpp"
#include "vbond/setup/stage_resolver.hpp"
#include "vbond/setup/text_file.hpp"
#include "vbond/terms/pressure/pressed.hpp"
#include "vbond/terms/pressure/setup_facets.hpp"

namespace vbond {
namespace {

constexpr const char* pressure_rule = "pressure acts on the facets of a surface";

/// Particles that bonds within the group hold together, in increasing order, by their first ones. Particles
/// without a bond belong to no part; a group without any is one part, as of grains in a jacket.
std::vector<std::vector<ParticleId>> bonded_parts(const Group& group, const std::vector<char>& in_group,
                                                  const State& state) {
  DisjointSets<ParticleId> sets(in_group.size());
  PerParticle<char> is_bonded(in_group.size(), 0);
  bool any = false;
  for (const Bond& b : state.bonds)
    if (!b.broken && in_group[b.i.value] != 0 && in_group[b.j.value] != 0) {
      sets.join(b.i, b.j);
      is_bonded[b.i] = is_bonded[b.j] = 1;
      any = true;
    }
  std::map<ParticleId, std::vector<ParticleId>> parts;
  for (const ParticleId p : group.particles)
    if (any ? is_bonded[p] != 0 : !is_absent(state, p))
      parts[any ? sets.smallest(p) : ParticleId{0}].push_back(p);
  std::vector<std::vector<ParticleId>> all;
  for (auto& [first, part] : parts) all.push_back(std::move(part));
  return all;
}

Vec3d across_of(const PressureSpec& s) {
  return s.surface == PressedSurface::strips ? s.width * normalised(s.normal) : Vec3d{};
}

template <class T>
bool same(const std::optional<Placed<T>>& a, const std::optional<Placed<T>>& b) {
  return a.has_value() == b.has_value() && (!a || a->value == b->value);
}
bool same(const BoxRegion& a, const BoxRegion& b) {
  return a.min == b.min && a.max == b.max;
}
bool same(const SphereRegion& a, const SphereRegion& b) {
  return a.centre == b.centre && a.radius == b.radius;
}
bool same(const CylinderRegion& a, const CylinderRegion& b) {
  return a.from == b.from && a.to == b.to && a.radius == b.radius;
}
bool same(const PlaneRegion& a, const PlaneRegion& b) {
  return a.point == b.point && a.normal == b.normal && a.within == b.within;
}
bool same(const HalfSpaceRegion& a, const HalfSpaceRegion& b) {
  return a.point == b.point && a.normal == b.normal;
}
bool same(const MeshRegion& a, const MeshRegion& b) {
  return a.file.value == b.file.value && a.scale == b.scale && a.shift == b.shift;
}
bool same(const std::optional<FacetRegion>& a, const std::optional<FacetRegion>& b) {
  if (!a || !b) return !a && !b;
  const auto alike = [&b](const auto& region) {
    const auto* other = std::get_if<std::decay_t<decltype(region)>>(&b->region);
    return other != nullptr && same(region, *other);
  };
  return std::visit(alike, a->region);
}
/// Whether both say the same of their facets.
bool same_surface(const PressureSpec& a, const PressureSpec& b) {
  return a.surface == b.surface && a.group.value == b.group.value && a.width == b.width &&
         a.normal == b.normal && same(a.file, b.file) && a.inside == b.inside && a.longest == b.longest &&
         same(a.region, b.region);
}

/// The facets of an entry of the stage before that is of the same surface, if no bonds have been made since
/// that stage began; else none. A surface that is found anew may have other triangles, which share forces
/// among particles in another way, and would disturb a balance.
std::vector<Facet> facets_before(const StageResolver& resolver, const State& state,
                                 const PressureSpec& spec) {
  const Case& c = resolver.c;
  const auto k = static_cast<std::size_t>(&resolver.spec - c.stages.data());
  if (k == 0 || state.clock.stage_step != 0) return {};
  const StageSpec& before = c.stages[k - 1];
  const auto makes_bonds = [&](const BondSpec& set) { return makes_bonds_as_it_begins(set, resolver.spec); };
  if (std::any_of(c.bonds.begin(), c.bonds.end(), makes_bonds)) return {};
  if (!is_static(before.kind) && !bonding_rules(c, resolver.model, k - 1).empty()) return {};
  std::vector<Facet> facets;
  for (std::size_t of = 0; of < before.pressures.size() && facets.empty(); ++of)
    if (same_surface(before.pressures[of], spec))
      for (const PressedFacet& f : state.pressed)
        if (f.pressure == of) facets.push_back(f.facet());
  return facets;
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
    FoundFacets found{facets_before(resolver_, state_, spec_), {}, {}};
    if (found.facets.empty()) found = find_anew(*group, in_group);
    if (found.what.empty() && spec_.kind == PressureKind::central) refuse_no_centre(found);
    if (found.what.empty()) return std::move(found.facets);
    refuse(found.what, found.way_out);
    return {};
  }

 private:
  FoundFacets find_anew(const Group& group, const std::vector<char>& in_group) const {
    FoundFacets found = surface(group, in_group);
    if (found.what.empty() && spec_.surface == PressedSurface::triangles)
      found = facing_alike(std::move(found.facets));
    if (found.what.empty() && spec_.surface != PressedSurface::skin)
      found = facing_away(std::move(found.facets), across_of(spec_), spec_.inside, state_.r);
    if (found.what.empty() && spec_.surface == PressedSurface::strips) refuse_inclined(found);
    if (found.what.empty() && spec_.region) keep_in_region(found);
    return found;
  }

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
    FoundFacets found;
    std::size_t outside = 0;
    ParticleId first_outside;
    for (const std::vector<ParticleId>& part : bonded_parts(group, in_group, state_)) {
      const std::string at = fmt::format("the part with particle {}", part.front().value);
      if (part.size() < 4)
        return {{},
                fmt::format("{} has {} particles, and no volume", at, part.size()),
                "name a group without it; sheets take surface = \"triangles\", chains \"strips\""};
      std::vector<Vec3d> r;
      for (const ParticleId p : part) r.push_back(state_.r[p]);
      const std::optional<packing::Skin> skin = packing::skin_of(r, *radius);
      if (!skin)
        return {{},
                "no tetrahedra of its particles fit together in " + at,
                "choose another longest, or move a particle"};
      if (skin->triangles.empty())
        return {{},
                fmt::format("no four particles of {} have a sphere through them of radius {:.4g}, or less",
                            at, *radius),
                "use a larger longest; sheets take surface = \"triangles\", chains \"strips\""};
      if (outside == 0 && !skin->outside.empty()) first_outside = part[skin->outside.front()];
      outside += skin->outside.size();
      for (const auto& [i, j, k] : skin->triangles) found.facets.push_back({part[i], part[j], part[k]});
    }
    if (outside > 0)
      return {{},
              fmt::format("{} bonded particle{} outside of the skin, the first is {}; longest is {:.4g}",
                          outside, outside == 1 ? " lies" : "s lie", first_outside.value, *radius),
              "use a larger longest, or name a group without them, whose skin is that of the rest alone"};
    return found;
  }

  void refuse_inclined(FoundFacets& found) const {
    constexpr double most = 3.0;
    double largest = 0.0;
    Facet at;
    for (const Facet& f : found.facets) {
      const double sine =
          std::abs(dot(normalised(between(state_.r[f.i], state_.r[f.j])), normalised(spec_.normal)));
      if (sine > largest) largest = sine, at = f;
    }
    const double degrees = std::asin(std::min(largest, 1.0)) * 180.0 / std::numbers::pi;
    if (degrees > most)
      found = {
          {},
          fmt::format("the bond of particles {} and {} is inclined by {:.3g} degrees to the plane of this "
                      "normal",
                      at.i.value, at.j.value, degrees),
          "give the normal of the plane in which the chain lies; it may be off by 3 degrees"};
  }

  /// At the centre a force has no direction; forces on what faces the centre would push the wrong way.
  void refuse_no_centre(FoundFacets& found) const {
    Pressure central;
    central.facets = found.facets, central.across = across_of(spec_);
    central.kind = PressureKind::central, central.centre = spec_.centre;
    const std::vector<Pressure> alone{central};
    const PressedSurfaces surface(alone, facets_as_found(alone, state_.r));
    const auto way = [&](ParticleId p) { return between(state_.r[p], spec_.centre); };
    double farthest = 0.0;
    for (const PressedSurfaces::Share& s : surface.shares()) farthest = std::max(farthest, norm(way(s.p)));
    constexpr double apart = 1e-6, rounding = 1e-9;
    for (const PressedSurfaces::Share& s : surface.shares()) {
      const double distance = norm(way(s.p));
      if (!(distance > apart * farthest))
        found = {
            {},
            fmt::format("particle {} is at the centre, where a central force has no direction", s.p.value),
            "move the centre, or use kind = \"dead\""};
      else if (s.towards < -rounding * norm(s.dead))
        found = {{},
                 fmt::format("at particle {} the surface faces the centre: a central force would push the "
                             "other way than the pressure",
                             s.p.value),
                 "choose another centre, a region of facets that face away from it, or kind = \"dead\""};
      if (!found.what.empty()) return;
    }
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

void PressureTerm::resolve(const StageResolver& resolver, StagePart<PressureTerm>& to) {
  for (const PressureSpec& s : resolver.spec.pressures) {
    resolver.particles(s.group);
    if (resolver.model.cell.any())
      resolver.problems.add(s.place, "a periodic body takes no pressure", "its surface would cross the cell",
                            "give the cell a stress: cell = {xx = ...}");
    refuse_passage(resolver, s);
    to.pressures.push_back({s.group.value,
                            {},
                            s.pressure,
                            resolver.function(s.factor, s.place),
                            s.constant,
                            s.kind,
                            s.centre,
                            across_of(s)});
  }
}

void PressureTerm::complete(const StageResolver& resolver, const State& state, StagePart<PressureTerm>& to) {
  for (std::size_t k = 0; k < to.pressures.size(); ++k) {
    std::vector<Facet>& facets = to.pressures[k].facets;
    facets.clear();
    if (state.clock.stage_step != 0)  // under way: those that it began with
      for (const PressedFacet& f : state.pressed)
        if (f.pressure == k) facets.push_back(f.facet());
    if (facets.empty()) facets = FacetFinder(resolver, state, resolver.spec.pressures[k]).find();
  }
}

}  // namespace vbond
