#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "vbond/observe/detail/static_json.hpp"

namespace vbond {
namespace {

const char* list_of(PointKind kind) {
  return kind == PointKind::limit_point ? "limit_points" : "bifurcations";
}

void add_special_points(const StaticResult& r, Json& j) {
  j["limit_points"] = Json::array();
  j["bifurcations"] = Json::array();
  for (const SpecialPoint& s : r.special_points) {
    Json point = {{"load_factor", s.load_factor}, {"point", s.point}};
    if (s.unstable_before) point["unstable_before"] = *s.unstable_before;
    if (s.unstable_after) point["unstable_after"] = *s.unstable_after;
    if (s.gap > 0.0) point["gap"] = s.gap;
    j[list_of(s.kind)].push_back(std::move(point));
  }
}

/// Without a force on a group there are load factors only.
void add_critical_loads(const StaticResult& r, Json& j) {
  Json factors = Json::array(), kinds = Json::array(), gaps = Json::array(), estimates = Json::array(),
       forces = Json::array(), displacements = Json::array(), reactions = Json::array();
  bool any_force = false;
  for (const CriticalLoad& c : r.critical_loads) {
    factors.push_back(c.load_factor);
    kinds.push_back(c.kind == PointKind::limit_point ? "limit point" : "bifurcation");
    gaps.push_back(c.gap);
    estimates.push_back(c.estimate ? Json(*c.estimate) : Json());
    forces.push_back(c.force);
    any_force |= c.force != 0.0;
    if (!c.reaction) continue;
    displacements.push_back(*c.displacement);
    reactions.push_back(*c.reaction);
  }
  j["critical_load_factors"] = factors;
  j["critical_kinds"] = kinds;
  j["critical_gaps"] = gaps;
  j["linear_estimates"] = estimates;
  j["searched_to"] = r.searched_to;
  if (any_force) j["critical_forces"] = forces;
  if (reactions.empty()) return;
  j["critical_displacements"] = displacements;
  j["critical_reactions"] = reactions;
}

Json to_json(const Wave& w) {
  return {{"wave_vector", to_json(w.q)}, {"phases", to_json(w.edges)}};
}

/// Rigid motions are only counted; an unstable mode has frequency 0 and a negative square. Of one wave, from
/// 1, or where there is none.
void add_frequencies(const StaticResult& r, int wave, Json& j) {
  Json omega = Json::array(), omega2 = Json::array(), frequencies = Json::array();
  int rigid = 0;
  for (const NaturalMode& m : r.modes) {
    if (m.wave != wave) continue;
    if (m.rigid) {
      ++rigid;
      continue;
    }
    omega.push_back(m.omega);
    omega2.push_back(m.omega2);
    frequencies.push_back(m.omega / (2.0 * std::numbers::pi));
  }
  j["rigid_modes"] = rigid;
  j["frequencies"] = frequencies;
  j["omega"] = omega;
  j["omega_squared"] = omega2;
}

void add_frequencies(const StaticResult& r, Json& j) {
  if (r.waves.empty()) return add_frequencies(r, 0, j);
  j["waves"] = Json::array();
  for (const Wave& w : r.waves) {
    Json& of_wave = j["waves"].emplace_back(to_json(w));
    add_frequencies(r, static_cast<int>(j["waves"].size()), of_wave);
  }
}

/// Those that critical loads are found for, and which one each of them is of.
void add_critical_waves(const StaticResult& r, Json& j) {
  if (r.waves.empty()) return;
  j["waves"] = Json::array();
  for (const Wave& w : r.waves) j["waves"].push_back(to_json(w));
  j["critical_waves"] = Json::array();
  for (const CriticalLoad& c : r.critical_loads) j["critical_waves"].push_back(c.wave);
}

Json to_json(const BondUse& u) {
  return {{"bond", u.bond.value},
          {"particles", {u.i.value, u.j.value}},
          {"utilisation", u.utilisation},
          {"load_factor", u.load_factor}};
}

BondUse bond_use(const Json& j) {
  const auto number = [](const Json& n) { return static_cast<std::uint32_t>(small_number(n)); };
  const Json& particles = j.at("particles");
  return {BondId{number(j.at("bond"))}, ParticleId{number(particles.at(0))},
          ParticleId{number(particles.at(1))}, j.at("utilisation").get<double>(),
          j.at("load_factor").get<double>()};
}

Json to_json(const BrokenBond& b) {
  Json j = to_json(b.use);
  j["point"] = b.point;
  j["avalanche"] = b.avalanche;
  j["load"] = b.load;
  if (b.load_factor_after) j["load_factor_after"] = *b.load_factor_after;
  if (b.load_after) j["load_after"] = *b.load_after;
  j["shares"] = {b.shares.tension, b.shares.shear, b.shares.bending, b.shares.torsion, b.shares.compression};
  j["section"] = {b.section.N, b.section.V, b.section.M_b, b.section.M_t};
  j["middle"] = to_json(b.middle);
  j["direction"] = to_json(b.direction);
  j["held"] = b.held;
  j["released"] = b.released;
  j["work"] = b.work;
  j["stored"] = b.stored;
  return j;
}

BrokenBond broken_bond(const Json& j) {
  BrokenBond b;
  b.use = bond_use(j);
  b.point = small_number(j.at("point"));
  b.avalanche = small_number(j.at("avalanche"));
  b.load = j.at("load").get<double>();
  if (j.contains("load_factor_after")) b.load_factor_after = j["load_factor_after"].get<double>();
  if (j.contains("load_after")) b.load_after = j["load_after"].get<double>();
  const auto all = [&j](const char* key, std::initializer_list<double*> to) {
    std::size_t k = 0;
    for (double* x : to) *x = j.at(key).at(k++).get<double>();
  };
  StrengthShares& s = b.shares;
  all("shares", {&s.tension, &s.shear, &s.bending, &s.torsion, &s.compression});
  all("section", {&b.section.N, &b.section.V, &b.section.M_b, &b.section.M_t});
  b.middle = vector_from(j.at("middle"));
  b.direction = vector_from(j.at("direction"));
  b.held = j.at("held").get<double>();
  b.released = j.at("released").get<double>();
  b.work = j.at("work").get<double>();
  b.stored = j.at("stored").get<double>();
  return b;
}

Json to_json(const FractureResult& f) {
  Json j;
  if (!f.reason.empty()) j["reason"] = f.reason;
  j["breaks"] = f.breaks.size();
  j["avalanches"] = f.avalanches;
  j["largest_avalanche"] = f.largest_avalanche;
  if (!f.breaks.empty()) {
    j["first_break_load_factor"] = f.breaks.front().use.load_factor;
    j["first_break_load"] = f.breaks.front().load;
  }
  j["peak_load"] = f.peak_load;
  j["peak_load_factor"] = f.peak_load_factor;
  j["released_parts"] = f.released_parts;
  const FractureBooks& b = f.books;
  j["energy"] = {{"initial", b.initial},       {"work", b.work},         {"stored", b.stored},
                 {"dissipated", b.dissipated}, {"released", b.released}, {"largest", b.largest},
                 {"balance_error", b.error()}};
  j["broken_bonds"] = Json::array();
  for (const BrokenBond& broken : f.breaks) j["broken_bonds"].push_back(to_json(broken));
  return j;
}

FractureResult fracture_result(const Json& j) {
  FractureResult f;
  f.reason = j.value("reason", "");
  f.avalanches = small_number(j.at("avalanches"));
  f.largest_avalanche = small_number(j.at("largest_avalanche"));
  f.peak_load = j.at("peak_load").get<double>();
  f.peak_load_factor = j.at("peak_load_factor").get<double>();
  f.released_parts = small_number(j.at("released_parts"));
  const Json& b = j.at("energy");
  f.books = {b.at("initial").get<double>(), b.at("work").get<double>(),     b.at("stored").get<double>(),
             b.value("dissipated", 0.0),    b.at("released").get<double>(), b.at("largest").get<double>()};
  for (const Json& broken : j.at("broken_bonds")) f.breaks.push_back(broken_bond(broken));
  return f;
}

std::optional<int> count_if_known(const Json& j, const char* key) {
  return j.contains(key) ? std::optional<int>(small_number(j.at(key))) : std::nullopt;
}

/// The list of this name, which must have n members.
const Json& list_of_length(const Json& j, const char* key, std::size_t n) {
  const Json& list = j.at(key);
  if (!list.is_array() || list.size() != n)
    throw IoError(std::string(key) + " is not a list of " + std::to_string(n));
  return list;
}

std::vector<SpecialPoint> special_points(const Json& j) {
  std::vector<SpecialPoint> points;
  for (const PointKind kind : {PointKind::limit_point, PointKind::bifurcation})
    for (const Json& s : j.at(list_of(kind)))
      points.push_back({kind, s.at("load_factor").get<double>(), small_number(s.at("point")),
                        count_if_known(s, "unstable_before"), count_if_known(s, "unstable_after"),
                        s.value("gap", 0.0)});
  std::stable_sort(points.begin(), points.end(),
                   [](const SpecialPoint& a, const SpecialPoint& b) { return a.point < b.point; });
  return points;
}

std::vector<CriticalLoad> critical_loads(const Json& j) {
  std::vector<CriticalLoad> loads;
  const Json& factors = j.at("critical_load_factors");
  const std::size_t n = factors.size();
  const Json &kinds = list_of_length(j, "critical_kinds", n), &gaps = list_of_length(j, "critical_gaps", n),
             &estimates = list_of_length(j, "linear_estimates", n);
  const auto if_there = [&](const char* key) {
    return j.contains(key) ? &list_of_length(j, key, n) : nullptr;
  };
  const Json *waves = if_there("critical_waves"), *forces = if_there("critical_forces"),
             *displacements = if_there("critical_displacements"), *reactions = if_there("critical_reactions");
  for (std::size_t k = 0; k < n; ++k) {
    CriticalLoad c;
    c.load_factor = factors.at(k).get<double>();
    if (kinds.at(k) == "limit point") c.kind = PointKind::limit_point;
    c.gap = gaps.at(k).get<double>();
    if (!estimates.at(k).is_null()) c.estimate = estimates.at(k).get<double>();
    if (waves) c.wave = small_number(waves->at(k));
    if (forces) c.force = forces->at(k).get<double>();
    if (displacements) c.displacement = displacements->at(k).get<double>();
    if (reactions) c.reaction = reactions->at(k).get<double>();
    loads.push_back(c);
  }
  return loads;
}

std::vector<NaturalMode> natural_modes(const Json& j, int wave) {
  constexpr std::int64_t most_rigid =
      1'000'000;  // a mode is searched for with all degrees of freedom at once
  std::vector<NaturalMode> modes(static_cast<std::size_t>(whole_number(j.at("rigid_modes"), most_rigid)));
  for (NaturalMode& m : modes) m.rigid = true, m.wave = wave;
  const Json& omega = j.at("omega");
  const Json& omega2 = list_of_length(j, "omega_squared", omega.size());
  for (std::size_t k = 0; k < omega.size(); ++k) {
    NaturalMode m;
    m.omega = omega.at(k).get<double>();
    m.omega2 = omega2.at(k).get<double>();
    m.wave = wave;
    modes.push_back(m);
  }
  return modes;
}

void read_waves(const Json& j, StaticResult& r) {
  for (const Json& w : j.at("waves"))
    r.waves.push_back({vector_from(w.at("wave_vector")), vector_from(w.at("phases"))});
}

void read_modes(const Json& j, StaticResult& r) {
  if (!j.contains("waves")) return void(r.modes = natural_modes(j, 0));
  read_waves(j, r);
  int wave = 0;
  for (const Json& w : j["waves"])
    for (NaturalMode& m : natural_modes(w, ++wave)) r.modes.push_back(std::move(m));
}

}  // namespace

const char* to_text(StageKind kind) {
  switch (kind) {
    case StageKind::dynamics: return "dynamics";
    case StageKind::equilibrium: return "equilibrium";
    case StageKind::path: return "path";
    case StageKind::buckling: return "buckling";
    case StageKind::modes: return "modes";
    case StageKind::fracture: return "fracture";
  }
  return "dynamics";
}

Json to_json(const StaticSummary& s) {
  const StaticResult& r = s.result;
  Json j{{"kind", to_text(s.kind)},      {"ended", r.ended},
         {"load_factor", r.load_factor}, {"points", r.points},
         {"iterations", r.iterations},   {"factors", r.factors},
         {"solver", r.solver},           {"left_saddle", r.left_saddle}};
  if (r.solver_iterations > 0) j["solver_iterations"] = r.solver_iterations;
  if (s.kind == StageKind::equilibrium) j["jumped"] = r.jumped;
  if (s.kind == StageKind::equilibrium && r.unstable) j["neutral"] = r.neutral;
  if (r.free_turns > 0) j["free_turns"] = r.free_turns;
  if (r.unstable) j["unstable"] = *r.unstable;
  if (r.smallest_eigenvalue) j["smallest_eigenvalue"] = *r.smallest_eigenvalue;
  if (!s.failure.empty()) j["failure"] = s.failure;
  if (s.kind == StageKind::path) add_special_points(r, j);
  if (s.kind == StageKind::buckling) add_critical_loads(r, j), add_critical_waves(r, j);
  if (s.kind == StageKind::modes) add_frequencies(r, j);
  if (r.most_used) j["most_used_bond"] = to_json(*r.most_used);
  if (s.kind == StageKind::fracture) j["fracture"] = to_json(r.fracture);
  return j;
}

StaticSummary static_summary(const Json& j) {
  StaticSummary s;
  s.kind = named(j.at("kind"), std::array{StageKind::equilibrium, StageKind::path, StageKind::buckling,
                                          StageKind::modes, StageKind::fracture});
  StaticResult& r = s.result;
  r.ended = j.at("ended").get<std::string>();
  r.load_factor = j.at("load_factor").get<double>();
  r.points = small_number(j.at("points"));
  r.iterations = small_number(j.at("iterations"));
  if (j.contains("factors")) r.factors = small_number(j["factors"]);
  r.solver = j.at("solver").get<std::string>();
  if (j.contains("solver_iterations")) r.solver_iterations = small_number(j["solver_iterations"]);
  r.neutral = j.value("neutral", false);
  if (j.contains("free_turns")) r.free_turns = small_number(j["free_turns"]);
  r.jumped = j.value("jumped", false);
  r.left_saddle = j.at("left_saddle").get<bool>();
  r.unstable = count_if_known(j, "unstable");
  if (j.contains("smallest_eigenvalue")) r.smallest_eigenvalue = j["smallest_eigenvalue"].get<double>();
  if (j.contains("failure")) s.failure = j["failure"].get<std::string>();
  if (s.kind == StageKind::path) r.special_points = special_points(j);
  if (s.kind == StageKind::buckling) {
    r.critical_loads = critical_loads(j);
    r.searched_to = j.value("searched_to", 0.0);
    if (j.contains("waves")) read_waves(j, r);
    for (const CriticalLoad& c : r.critical_loads)
      if (static_cast<std::size_t>(c.wave) > r.waves.size()) throw IoError("a critical load has no wave");
  }
  if (s.kind == StageKind::modes) read_modes(j, r);
  if (j.contains("most_used_bond")) r.most_used = bond_use(j["most_used_bond"]);
  if (s.kind == StageKind::fracture) r.fracture = fracture_result(j.at("fracture"));
  return s;
}

}  // namespace vbond
