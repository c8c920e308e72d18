#include "vbond/setup/case_sources.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "vbond/core/nearest.hpp"
#include "vbond/model/free_room.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/setup/motion_stages.hpp"
#include "vbond/setup/regions.hpp"
#include "vbond/terms/walls/mesh_surface.hpp"

namespace vbond {
namespace {

// ---- regions ------------------------------------------------------------------------------------------

/// Whether a region holds a sphere as a whole, and the box around it.
struct SpaceMaker {
  const RegionOwner& owner;

  Space operator()(const BoxRegion& b) const {
    return {{b.min, b.max}, [b](const Vec3d& r, double R) {
              return b.min.x + R <= r.x && r.x <= b.max.x - R && b.min.y + R <= r.y && r.y <= b.max.y - R &&
                     b.min.z + R <= r.z && r.z <= b.max.z - R;
            }};
  }
  Space operator()(const SphereRegion& s) const {
    BoundingBox box;
    box.add(s.centre, s.radius);
    return {box, [s](const Vec3d& r, double R) { return norm(between(s.centre, r)) <= s.radius - R; }};
  }
  Space operator()(const CylinderRegion& c) const {
    inside_of(c, owner);  // which refuses one without length
    const Vec3d axis = between(c.from, c.to), e = normalised(axis);
    const double length = norm(axis);
    const auto wide = [&](double x) { return c.radius * std::sqrt(std::max(0.0, 1.0 - x * x)); };
    const Vec3d room{wide(e.x), wide(e.y), wide(e.z)};
    BoundingBox box;
    for (const Vec3d& end : {c.from, c.to}) box.add(end - room), box.add(end + room);
    return {box, [=](const Vec3d& r, double R) {
              const Vec3d d = between(c.from, r);
              const double along = dot(d, e);
              return R <= along && along <= length - R && norm(d - along * e) <= c.radius - R;
            }};
  }
  Space operator()(const MeshRegion& m) const {
    ClosedMesh mesh = closed_mesh(m, owner);
    const auto surface = std::make_shared<const WallSurface>(MeshWall{mesh.surface});
    return {box_around(mesh.surface.corners), [inside = mesh.inside, surface](const Vec3d& r, double R) {
              if (!(*inside)(r)) return false;
              std::vector<WallTouch> touches;
              if (R > 0.0 && surface->may_touch(r, R)) surface->touches(r, R, touches);
              return touches.empty();
            }};
  }
  template <class Endless>
  Space operator()(const Endless& region) const {  // planes and half-spaces: of sinks, of points
    return {{}, [inside = inside_of(region, owner)](const Vec3d& r, double) { return inside(r); }};
  }
};

template <class Regions>
std::shared_ptr<const Space> space_of(const Regions& region, const RegionOwner& owner) {
  return std::make_shared<const Space>(
      std::visit([&](const auto& r) { return SpaceMaker{owner}(r); }, region));
}

// ---- bodies -------------------------------------------------------------------------------------------

const PlacedSpecimen* find_specimen(const Placed<std::string>& name, const std::vector<PlacedSpecimen>& all,
                                    Problems& problems) {
  std::vector<std::string> known;
  for (const PlacedSpecimen& s : all) {
    known.push_back(s.spec->name);
    if (s.spec->name == name.value) return &s;
  }
  const auto near = nearest_name(name.value, known);
  problems.add(name.place, fmt::format("there is no specimen \"{}\"", name.value),
               fmt::format("the specimens are {}", fmt::join(known, ", ")),
               near ? fmt::format("did you mean \"{}\"?", *near) : "use one of them");
  return nullptr;
}

const SourceSpec& spec_of(const Case& c, const Source& source) {
  return *std::find_if(c.sources.begin(), c.sources.end(),
                       [&](const SourceSpec& of) { return of.name == source.name; });
}

}  // namespace

std::optional<ParticleId> first_that_comes_in(const std::string& group, const Model& model) {
  const Group* g = model.find_group(group);
  if (g == nullptr || model.sources.empty()) return std::nullopt;
  for (const ParticleId p : g->particles)
    if (comes_in(model, p)) return p;
  return std::nullopt;
}

std::string of_source(const Model& model, ParticleId p) {
  for (const Source& s : model.sources)
    if (s.body_of(p)) return fmt::format("particle {} comes in from source \"{}\"", p.value, s.name);
  return {};
}

void add_sources(const Case& c, const std::vector<PlacedSpecimen>& specimens, Built& built,
                 Problems& problems) {
  std::set<std::string> taken;
  for (const SourceSpec& spec : c.sources) {
    const PlacedSpecimen* specimen = find_specimen(spec.specimen, specimens, problems);
    if (specimen == nullptr) continue;
    if (!taken.insert(spec.specimen.value).second) {
      problems.add(spec.specimen.place,
                   fmt::format("source \"{}\": specimen \"{}\" comes in from another source already",
                               spec.name, spec.specimen.value),
                   "a source has bodies of its own",
                   "name another specimen; one like it may have another name");
      continue;
    }
    Source source;
    source.name = spec.name;
    for (std::size_t k = 0; k < specimen->points.r.size(); ++k)
      source.body.push_back(ParticleId{specimen->first + k});
    if (source.body.empty()) {
      problems.add(
          spec.specimen.place,
          fmt::format("source \"{}\": specimen \"{}\" has no particles", spec.name, spec.specimen.value),
          "a body that comes in has some", "name another specimen");
      continue;
    }
    if (!specimen->points.v.empty() || !specimen->points.omega.empty())
      built.notes.push_back(
          fmt::format("source \"{}\": velocities of the file of specimen \"{}\" do not count: "
                      "bodies come in with those of the source",
                      spec.name, spec.specimen.value));
    try {
      const RegionOwner owner{c.file, spec.place, fmt::format("source \"{}\"", spec.name), built.notes};
      source.region = space_of(spec.region, owner);
    } catch (const CaseError& e) {
      problems.add(e);
      continue;
    }
    source.whole = spec.whole;
    source.turned = spec.turned;
    source.velocity = spec.velocity;
    source.angular_velocity = spec.angular_velocity;
    source.velocity_spread = spec.velocity_spread;
    source.angular_velocity_spread = spec.angular_velocity_spread;
    constexpr std::uint64_t apart = 0x9E3779B97F4A7C15u;  // sources of one seed differ
    source.seed = spec.seed + apart * static_cast<std::uint64_t>(&spec - c.sources.data());
    source.tries = spec.tries;
    for (const ParticleId p : source.body) {
      built.state.waiting.push_back(p);
      built.state.v[p] = built.state.omega[p] = {};
    }
    built.model.sources.push_back(std::move(source));
  }
  std::sort(built.state.waiting.begin(), built.state.waiting.end());
}

void add_copies(const Case& c, Built& built) {
  Model& m = built.model;
  State& s = built.state;
  for (std::size_t k = 0; k < m.sources.size(); ++k) {
    Source& source = m.sources[k];
    source.bodies = static_cast<std::size_t>(spec_of(c, source).count);
    source.copies = ParticleId{m.particles()};
    std::vector<std::vector<std::size_t>> places(m.groups.size());  // of the body that a group has
    for (std::size_t g = 0; g < m.groups.size(); ++g)
      for (std::size_t n = 0; n < source.body.size(); ++n)
        if (std::binary_search(m.groups[g].particles.begin(), m.groups[g].particles.end(), source.body[n]))
          places[g].push_back(n);
    for (std::size_t body = 1; body < source.bodies; ++body) {
      const std::size_t first = m.particles();
      for (const ParticleId p : source.body) {
        s.waiting.push_back(ParticleId{m.particles()});
        m.mass.push_back(double{m.mass[p]});
        m.inertia.push_back(double{m.inertia[p]});
        m.radius.push_back(double{m.radius[p]});
        if (!m.principal.empty()) m.principal.push_back(PrincipalInertia{m.principal[p]});
        m.specimen.push_back(std::uint32_t{m.specimen[p]});
        if (!m.material.empty()) m.material.push_back(std::uint32_t{m.material[p]});
        m.r_0.push_back(Vec3d{m.r_0[p]});
        s.r.push_back(Vec3d{s.r[p]});
        s.q.push_back(Quatd{s.q[p]});
        s.v.push_back({});
        s.omega.push_back({});
      }
      for (std::size_t g = 0; g < m.groups.size(); ++g)
        for (const std::size_t n : places[g]) m.groups[g].particles.push_back(ParticleId{first + n});
    }
  }
}

void check_sources(const Case& c, Built& built, Problems& problems) {
  const Model& m = built.model;
  for (const Source& source : m.sources) {
    const SourceSpec& spec = spec_of(c, source);
    constexpr std::int64_t places = 200;
    bool fits = false, free = m.walls.empty();
    BoundingBox around;
    double largest = 0.0, mass = 0.0;
    for (const ParticleId p : source.body)
      around.add(m.r_0[p], m.radius[p]), largest = std::max(largest, m.radius[p]), mass += m.mass[p];
    State empty = built.state;  // but for walls
    empty.waiting.clear();
    for (const ParticleId p : empty.r.ids()) empty.waiting.push_back(p);
    const FreeRoom room(m, Stage{}, empty, source.region->box, largest);
    for (std::int64_t k = 0; k < places && !(fits && free); ++k) {
      const auto at = place_of_try(m, built.state, source, 0, 0, k);
      if (!at) break;
      fits = true;
      std::vector<FreeRoom::Ball> balls;
      for (std::size_t n = 0; n < at->r.size(); ++n) balls.push_back({at->r[n], m.radius[source.body[n]]});
      free = free || room.has_room_for(balls);
    }
    const Vec3d size = around.high - around.low, region = source.region->box.high - source.region->box.low;
    if (!fits)
      problems.add(
          spec.place, fmt::format("source \"{}\": no body fits into its region", source.name),
          fmt::format("the body is {:.4g} x {:.4g} x {:.4g} as it stands, the region {:.4g} x {:.4g} x "
                      "{:.4g}, and all of a body must be inside of it",
                      size.x, size.y, size.z, region.x, region.y, region.z),
          "use a larger region, fit = \"centre\", or orientation = \"given\"");
    else if (!free)
      built.notes.push_back(
          fmt::format("source \"{}\": at {} places in its region a body would touch a wall: nothing comes in "
                      "unless the walls "
                      "move away",
                      source.name, places));
    std::string text = fmt::format("source \"{}\": {} bod{} of {} particle{} and {} bond{}, mass {:.6g} each",
                                   source.name, source.bodies, source.bodies == 1 ? "y" : "ies",
                                   source.body.size(), source.body.size() == 1 ? "" : "s",
                                   source.bonds.size(), source.bonds.size() == 1 ? "" : "s", mass);
    if (spec.rate > 0.0)
      text += fmt::format(", {:.6g} of them in a unit of time: all are due after {:.6g}", spec.rate,
                          static_cast<double>(source.bodies) / spec.rate);
    built.notes.push_back(text);
  }
}

void resolve_passage(const Case& c, const Model& model, std::size_t k, Stage& stage, Problems& problems) {
  const StageSpec& spec = c.stages[k];
  const auto is_here = [&spec](const VisitSpec& v) {
    return v.stages.empty() || std::any_of(v.stages.begin(), v.stages.end(),
                                           [&](const auto& name) { return name.value == spec.name; });
  };
  const auto visits_of = [&](const VisitSpec& v, const SourcePlace& place) {
    Visits visits;
    if (v.from) visits.from = look_up_time(*v.from, model, "from", place, problems);
    if (v.until) visits.until = look_up_time(*v.until, model, "until", place, problems);
    if (v.every) visits.every = look_up_time(*v.every, model, "every", place, problems);
    if (!(visits.from <= visits.until))
      problems.add(place, fmt::format("from = {:.6g}, until = {:.6g}", visits.from, visits.until),
                   "it ends after it has begun", "exchange them, or leave one out");
    return visits;
  };
  for (const SourceSpec& s : c.sources) {
    const auto at = std::find_if(model.sources.begin(), model.sources.end(),
                                 [&s](const Source& of) { return of.name == s.name; });
    if (!is_here(s.visits) || at == model.sources.end()) continue;
    stage.inflows.push_back(
        {static_cast<std::size_t>(at - model.sources.begin()), s.rate, visits_of(s.visits, s.place)});
  }
  for (const SinkSpec& s : c.sinks) {
    if (!is_here(s.visits)) continue;
    const Group* group = look_up_group(s.group, model, problems);
    if (group == nullptr) continue;
    std::vector<std::string> notes;
    try {
      const RegionOwner owner{c.file, s.place, fmt::format("sink \"{}\"", s.name), notes};
      Sink sink{s.name, space_of(s.region, owner), s.outside, {}, visits_of(s.visits, s.place)};
      if (group->particles.size() < model.particles()) sink.particles = membership(*group, model);
      stage.sinks.push_back(std::move(sink));
    } catch (const CaseError& e) {
      problems.add(e);
    }
  }
  if (spec.cell && (!stage.inflows.empty() || !stage.sinks.empty()))
    problems.add(spec.place, fmt::format("stage \"{}\" moves the cell while particles come or go", spec.name),
                 "what comes in stands beside the flow of the cell, and its energy would not be known",
                 "give source and sink `stages` in which the cell stands still");
}

}  // namespace vbond
