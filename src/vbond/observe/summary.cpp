#include "vbond/observe/summary.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <type_traits>

#include "vbond/core/error.hpp"
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/observe/detail/static_json.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {
namespace {

constexpr std::array all_reasons{StopReason::running,     StopReason::duration, StopReason::distance,
                                 StopReason::peak,        StopReason::rest,     StopReason::breaks,
                                 StopReason::interrupted, StopReason::diverged};

Json to_json(const StageSummary& s) {
  if (s.statics) {
    Json j{{"name", s.name}};
    j.update(to_json(*s.statics));
    j["time"] = s.time;
    return j;
  }
  Json j{{"name", s.name}, {"stop", to_text(s.stop)}, {"steps", s.steps}, {"dt", s.dt}, {"time", s.time}};
  if (s.critical_force) j["critical_force"] = *s.critical_force;
  if (s.peak_time) j["peak_time"] = *s.peak_time;
  if (!s.failure.empty()) j["failure"] = s.failure;
  return j;
}

StageSummary stage_from(const Json& j) {
  StageSummary s;
  s.name = j.at("name").get<std::string>();
  s.time = j.at("time").get<double>();
  if (j.contains("kind")) {
    s.statics = static_summary(j);
    return s;
  }
  s.stop = named(j.at("stop"), all_reasons);
  s.steps = whole_number(j.at("steps"));
  s.dt = j.at("dt").get<double>();
  if (j.contains("critical_force")) s.critical_force = j["critical_force"].get<double>();
  if (j.contains("peak_time")) s.peak_time = j["peak_time"].get<double>();
  if (j.contains("failure")) s.failure = j["failure"].get<std::string>();
  return s;
}

/// An absent number has no key.
void add(Json& j, const char* key, const std::optional<double>& x) {
  if (x) j[key] = *x;
}
std::optional<double> number_at(const Json& j, const char* key) {
  return j.contains(key) ? std::optional(j[key].get<double>()) : std::nullopt;
}

void add(Json& j, const BreakSummary& b) {
  j["broken"] = b.broken;
  add(j, "first_break_time", b.first.first_time);
  add(j, "first_break_load", b.first.first_load);
  add(j, "peak_load", b.peak_load);
}
BreakSummary breaks_from(const Json& j) {
  return {whole_number(j.at("broken")),
          {number_at(j, "first_break_time"), number_at(j, "first_break_load"), {}},
          number_at(j, "peak_load")};
}

Json to_json(const WallSummary& w) {
  return {{"name", w.name},
          {"force", to_json(w.force)},
          {"moment", to_json(w.moment)},
          {"displacement", to_json(w.displacement)},
          {"work", w.work},
          {"largest_force", w.largest_force}};
}
WallSummary wall_from(const Json& j) {
  return {j.at("name").get<std::string>(),   vector_from(j.at("force")), vector_from(j.at("moment")),
          vector_from(j.at("displacement")), j.at("work").get<double>(), j.at("largest_force").get<double>()};
}

/// Six components by their names.
Json components_json(const SymmetricParts& x) {
  Json j;
  for (std::size_t k = 0; k < x.size(); ++k) j[cell_component_names[k]] = x[k];
  return j;
}
SymmetricParts components_from(const Json& j) {
  SymmetricParts x{};
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = j.at(cell_component_names[k]).get<double>();
  return x;
}

/// One number as such, several as a list.
Json to_json(const SpecimenFigures& s) {
  Json j = Json::object();
  for (const auto& [name, numbers] : s.figures)
    if (numbers.size() == 1)
      j[name] = numbers[0];
    else
      j[name] = numbers;
  return j;
}
SpecimenFigures figures_from(const std::string& specimen, const Json& j) {
  SpecimenFigures s{specimen, {}};
  for (const auto& [name, numbers] : j.items())
    if (numbers.is_array())
      s.figures.emplace_back(name, numbers.get<std::vector<double>>());
    else
      s.figures.emplace_back(name, std::vector<double>{numbers.get<double>()});
  return s;
}

Json to_json(const CellSummary& c) {
  Json j{{"volume", c.values.volume},
         {"density", c.values.density},
         {"strain", components_json(c.values.strain)},
         {"stress", components_json(c.values.stress)}};
  for (std::size_t k = 0; k < 3; ++k) j[std::string(1, "abc"[k])] = to_json(c.edges[k]);
  return j;
}
CellSummary cell_from(const Json& j) {
  CellSummary c{.edges = {},
                .values = {j.at("volume").get<double>(), j.at("density").get<double>(),
                           components_from(j.at("strain")), components_from(j.at("stress"))}};
  for (std::size_t k = 0; k < 3; ++k) c.edges[k] = vector_from(j.at(std::string(1, "abc"[k])));
  return c;
}

/// visit(key, member) for each number.
template <class Packing, class Visit>
void for_numbers(Packing& p, Visit visit) {
  visit("grains", p.grains), visit("rattlers", p.rattlers), visit("removed", p.removed),
      visit("grown", p.grown);
  visit("porosity", p.porosity), visit("core_porosity", p.core_porosity);
  visit("least_radius", p.least_radius), visit("mean_radius", p.mean_radius);
  visit("largest_radius", p.largest_radius), visit("size_factor", p.size_factor);
  visit("sizes_off", p.sizes_off), visit("contacts", p.contacts);
  visit("backbone_contacts", p.backbone_contacts), visit("overlap", p.overlap), visit("pressure", p.pressure);
  visit("rdf_step", p.rdf_step);
  visit("least_cell_volume", p.least_cell_volume), visit("mean_cell_volume", p.mean_cell_volume);
  visit("largest_cell_volume", p.largest_cell_volume), visit("cell_faces", p.cell_faces);
  visit("least_local_porosity", p.least_local_porosity), visit("mean_local_porosity", p.mean_local_porosity);
  visit("largest_local_porosity", p.largest_local_porosity);
}
Json to_json(const PackingSummary& p) {
  Json j{{"name", p.name}};
  for_numbers(p, [&j](const char* key, const auto& x) { j[key] = x; });
  j["neighbours"] = p.neighbours;
  j["rdf"] = p.rdf;
  return j;
}
PackingSummary packing_from(const Json& j) {
  PackingSummary p;
  p.name = j.at("name").get<std::string>();
  for_numbers(p,
              [&j](const char* key, auto& x) { x = j.at(key).get<std::remove_reference_t<decltype(x)>>(); });
  p.neighbours = j.at("neighbours").get<std::vector<std::array<double, 2>>>();
  p.rdf = j.at("rdf").get<std::vector<double>>();
  return p;
}

Json to_json(const PassageSummary& p) {
  const auto vector = [](const Vec3d& x) { return Json::array({x.x, x.y, x.z}); };
  Json j{{"particles", p.present},
         {"particles_in", p.mass.particles_in},
         {"particles_out", p.mass.particles_out},
         {"mass_in", p.mass.mass_in},
         {"mass_out", p.mass.mass_out},
         {"momentum_in", vector(p.mass.momentum_in)},
         {"momentum_out", vector(p.mass.momentum_out)},
         {"inserted", p.inserted},
         {"removed", p.removed},
         {"sources", Json::array()}};
  for (const PassageSummary::OfSource& s : p.sources)
    j["sources"].push_back({{"name", s.name}, {"bodies", s.bodies}, {"came_in", s.came_in}, {"due", s.due}});
  return j;
}
PassageSummary passage_from(const Json& j) {
  const auto vector = [](const Json& x) {
    return Vec3d{x.at(0).get<double>(), x.at(1).get<double>(), x.at(2).get<double>()};
  };
  PassageSummary p;
  p.present = whole_number(j.at("particles"));
  p.mass.particles_in = whole_number(j.at("particles_in"));
  p.mass.particles_out = whole_number(j.at("particles_out"));
  p.mass.mass_in = j.at("mass_in").get<double>();
  p.mass.mass_out = j.at("mass_out").get<double>();
  p.mass.momentum_in = vector(j.at("momentum_in"));
  p.mass.momentum_out = vector(j.at("momentum_out"));
  p.inserted = j.at("inserted").get<double>();
  p.removed = j.at("removed").get<double>();
  for (const Json& s : j.at("sources"))
    p.sources.push_back({s.at("name").get<std::string>(), whole_number(s.at("bodies")),
                         whole_number(s.at("came_in")), whole_number(s.at("due"))});
  return p;
}

}  // namespace

std::string to_json(const RunSummary& r) {
  Json j{{"title", r.title},
         {"version", r.version},
         {"units", r.units == UnitSystem::si ? "SI" : "reduced"},
         {"particles", r.particles},
         {"bonds", r.bonds},
         {"T0", r.T_0},
         {"stages", Json::array()}};
  for (const StageSummary& s : r.stages) {
    j["stages"].push_back(to_json(s));
    for (const char* key : {"critical_forces", "critical_reactions", "frequencies"})
      if (const Json& stage = j["stages"].back(); stage.contains(key) && !stage[key].empty())
        j[key] = stage[key];
    if (!s.critical_force) continue;
    j["critical_force"] = *s.critical_force;
    j["peak_time"] = s.peak_time.value_or(s.time);
  }
  j["energy_balance_error"] = r.energy_balance_error;
  j["strained"] = r.strained;
  j["snapped"] = r.snapped;
  if (r.breaks) add(j, *r.breaks);
  for (const SpecimenFigures& s : r.specimens) j["specimens"][s.specimen] = to_json(s);
  for (const WallSummary& w : r.walls) j["walls"].push_back(to_json(w));
  if (r.cell) j["cell"] = to_json(*r.cell);
  if (r.passage) j["passage"] = to_json(*r.passage);
  for (const PackingSummary& p : r.packings) j["packings"].push_back(to_json(p));
  for (const auto& [cause, energy] : r.dissipated) j["dissipated"][cause] = energy;
  j["ever_strained"] = r.ever_strained;
  j["ever_snapped"] = r.ever_snapped;
  j["ever_overlapping"] = r.ever_overlapping;
  j["ever_stretched"] = r.ever_stretched;
  if (r.dropped) j["dropped"] = *r.dropped;
  j["too_fast"] = r.too_fast;
  j["bond_steps_per_second"] =
      r.stepping_seconds > 0.0 ? static_cast<double>(r.bond_steps) / r.stepping_seconds : 0.0;
  j["instruction_set"] = r.instruction_set;
  if (!r.blas_kernel.empty()) j["blas_kernel"] = r.blas_kernel;
  j["threads"] = r.threads;
  j["threads_used"] = r.threads_used;
  j["wall_time"] = Json::object();
  for (const PhaseTime& p : r.wall_time) j["wall_time"][p.name] = p.seconds;
  // text that is not UTF-8, as a title may be, is replaced by U+FFFD rather than refused at the end of a run
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void write_summary(const std::filesystem::path& path, const RunSummary& summary) {
  replace_file(path, to_json(summary));
}

RunSummary read_summary(const std::filesystem::path& path) {
  const std::string text = read_all(path);
  try {
    const Json j = Json::parse(text);
    RunSummary r;
    r.title = j.at("title").get<std::string>();
    r.version = j.at("version").get<std::string>();
    r.units = j.at("units").get<std::string>() == "SI" ? UnitSystem::si : UnitSystem::reduced;
    r.particles = whole_number(j.at("particles"));
    r.bonds = whole_number(j.at("bonds"));
    r.T_0 = j.at("T0").get<double>();
    for (const Json& stage : j.at("stages")) r.stages.push_back(stage_from(stage));
    r.energy_balance_error = j.at("energy_balance_error").get<double>();
    r.strained = whole_number(j.at("strained"));
    r.snapped = whole_number(j.at("snapped"));
    r.ever_strained = whole_number(j.at("ever_strained"));
    r.ever_snapped = whole_number(j.at("ever_snapped"));
    if (j.contains("ever_overlapping"))  // runs of 0.1 have none
      r.ever_overlapping = whole_number(j["ever_overlapping"]);
    if (j.contains("ever_stretched"))  // nor have they these
      r.ever_stretched = whole_number(j["ever_stretched"]);
    if (j.contains("broken")) r.breaks = breaks_from(j);
    if (j.contains("walls"))
      for (const Json& wall : j["walls"]) r.walls.push_back(wall_from(wall));
    if (j.contains("specimens"))
      for (const auto& [name, figures] : j["specimens"].items())
        r.specimens.push_back(figures_from(name, figures));
    if (j.contains("cell")) r.cell = cell_from(j["cell"]);
    if (j.contains("passage")) r.passage = passage_from(j["passage"]);
    if (j.contains("packings"))
      for (const Json& packing : j["packings"]) r.packings.push_back(packing_from(packing));
    if (j.contains("dissipated"))
      for (const auto& [cause, energy] : j["dissipated"].items())
        r.dissipated.emplace_back(cause, energy.get<double>());
    if (j.contains("dropped")) r.dropped = whole_number(j["dropped"]);
    r.too_fast = j.value("too_fast", 0.0);
    return r;
  } catch (const Json::exception& e) {
    throw IoError(path.string() + ": is not a run.json of vbond: " + e.what());
  } catch (const IoError& e) {
    throw IoError(path.string() + ": is not a run.json of vbond: " + e.what());
  }
}

std::vector<StageSummary> read_stages_before(const std::filesystem::path& path, std::int32_t stage) {
  std::vector<StageSummary> stages = read_summary(path).stages;
  if (static_cast<std::int32_t>(stages.size()) > stage) stages.resize(static_cast<std::size_t>(stage));
  return stages;
}

}  // namespace vbond
