#include "vbond/observe/checkpoint.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/rules.hpp"
#include "vbond/observe/detail/checkpoint_fibres.hpp"
#include "vbond/observe/detail/checkpoint_grips.hpp"
#include "vbond/observe/detail/checkpoint_heat.hpp"
#include "vbond/observe/detail/checkpoint_walls.hpp"
#include "vbond/observe/detail/h5.hpp"
#include "vbond/observe/detail/h5_file.hpp"
#include "vbond/observe/detail/h5_units.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/seal.hpp"

namespace vbond {
namespace {

constexpr std::int32_t format_version = 4;

// ---- the fields, listed once for writing and reading --------------------------------------------------

/// archive(path, value) for single values, archive.of_each(path, column, member) for columns.
template <class Archive, class C>
void visit_fields(Archive& archive, C& c) {
  auto& s = c.state;
  archive("/clock/step", s.clock.step);
  archive("/clock/stage_step", s.clock.stage_step);
  archive("/clock/stage", s.clock.stage);
  archive("/clock/stage_start", s.clock.stage_start);
  archive("/clock/dt", s.clock.dt);
  archive.of_each("/particles/r", s.r, std::identity{});
  archive.of_each("/particles/v", s.v, std::identity{});
  archive.of_each("/particles/q", s.q, std::identity{});
  archive.of_each("/particles/omega", s.omega, std::identity{});
  archive.of_each("/bonds/i", s.bonds, &Bond::i);
  archive.of_each("/bonds/j", s.bonds, &Bond::j);
  archive.of_each("/bonds/a", s.bonds, &Bond::a);
  archive.of_each("/bonds/R_i", s.bonds, &Bond::R_i);
  archive.of_each("/bonds/R_j", s.bonds, &Bond::R_j);
  archive.of_each("/bonds/coefficients", s.bonds, &Bond::coefficients);
  archive.of_each("/bonds/frame_i", s.bonds, &Bond::frame_i);
  archive.of_each("/bonds/frame_j", s.bonds, &Bond::frame_j);
  archive.of_each("/bonds/set", s.bonds, &Bond::set);
  archive.of_each("/bonds/broken", s.bonds, &Bond::broken);
  archive.of_each("/bonds/mode", s.bonds, &Bond::mode);
  archive("/books/at_start", s.books.at_start);
  archive("/books/dissipated", s.books.dissipated);
  archive("/books/released", s.books.released);
  archive("/books/work_loads", s.books.work_loads);
  archive("/books/work_supports", s.books.work_supports);
  archive("/books/largest", s.books.largest);
  archive("/peak/sum", s.peak.sum);
  archive("/peak/samples", s.peak.samples);
  archive("/peak/last", s.peak.last);
  archive("/peak/peak", s.peak.peak);
  archive("/peak/peak_time", s.peak.peak_time);
  archive("/peak/blocks", s.peak.blocks);
  archive("/rest/quiet_steps", s.rest.quiet_steps);
  archive("/breaks/in_stage", s.breaks);
  archive.of_each("/watch/worst", c.watch.bonds, &BondRecord::worst);
  archive.of_each("/watch/was_short", c.watch.bonds, &BondRecord::was_short);
  archive("/watch/strained", c.watch.strained);
  archive("/watch/snapped", c.watch.snapped);
  archive("/watch/shortened", c.watch.shortened);
}

/// The particles' constants: what must be the same for a checkpoint to fit a model.
template <class Archive, class M>
void visit_fingerprint(Archive& archive, M& m) {
  archive("/model/units", m.units);
  archive.of_each("/model/mass", m.mass, std::identity{});
  archive.of_each("/model/inertia", m.inertia, std::identity{});
  archive.of_each("/model/radius", m.radius, std::identity{});
  archive.of_each("/model/r_0", m.r_0, std::identity{});
}

// ---- parts that few runs have, and what must fit -----------------------------------------------------

/// Files have these columns only where moments of inertia differ.
template <class Archive, class M>
void visit_principal_inertia(Archive& archive, M& m) {
  archive.of_each("/model/principal_moments", m.principal, &PrincipalInertia::moments);
  archive.of_each("/model/principal_axes", m.principal, &PrincipalInertia::axes);
}

void check_fingerprint(H5Reader& reader, const Model& model) {
  const std::size_t n = reader.rows("/model/mass");
  if (n != model.particles())
    throw IoError(
        fmt::format("belongs to another case: it has {} particles, the case has {}", n, model.particles()));
  Model m;
  m.mass.resize(n), m.inertia.resize(n), m.radius.resize(n), m.r_0.resize(n);
  visit_fingerprint(reader, m);
  if (reader.has("/model/principal_moments")) m.principal.resize(n), visit_principal_inertia(reader, m);
  const char* differs = m.units != model.units                                         ? "units"
                        : m.mass != model.mass                                         ? "masses"
                        : m.inertia != model.inertia || m.principal != model.principal ? "moments of inertia"
                        : m.radius != model.radius                                     ? "radii"
                        : m.r_0 != model.r_0                                           ? "first positions"
                                                                                       : nullptr;
  if (differs)
    throw IoError(fmt::format("belongs to another case, or the case was changed: its {} differ", differs));
}

/// Laws by name, and for each bond the number of its law among them.
using LawNames = PerLaw<LawName>;
using LawNumbers = PerBond<std::uint8_t>;

void write_laws(H5Writer& writer, const State& state) {
  LawNames names;
  LawNumbers law;
  std::vector<const BondLaw*> seen;
  for (const Bond& b : state.bonds) {
    const auto at = std::find(seen.begin(), seen.end(), b.law);
    law.push_back(static_cast<std::uint8_t>(at - seen.begin()));
    if (at != seen.end()) continue;
    seen.push_back(b.law);
    names.push_back(law_name(b.law->name));
  }
  writer.of_each("/laws/name", names, std::identity{});
  writer.of_each("/bonds/law", law, std::identity{});
}

void read_laws(H5Reader& reader, State& state, std::span<const BondLaw* const> others) {
  LawNames names;
  LawNumbers law;
  names.resize(reader.rows("/laws/name"));
  law.resize(state.bonds.size());
  reader.of_each("/laws/name", names, std::identity{});
  reader.of_each("/bonds/law", law, std::identity{});
  PerLaw<const BondLaw*> laws;
  for (const LawName& name : names) {
    laws.push_back(find_law(text_of(name), others));
    if (laws[LawId{laws.size() - 1}] == nullptr)
      throw IoError(fmt::format("has bonds of a law \"{}\" that this program does not know", text_of(name)));
  }
  for (const BondId k : law.ids()) {
    if (law[k] >= laws.size()) throw IoError("is damaged: a bond is of no law");
    state.bonds[k].law = laws[LawId{law[k]}];
  }
}

/// Rules that bonds point to, and for each bond the number of its own. Files without rules have no such data.
using Rules = Column<Id<struct RulesOfFile>, RuleNumbers>;
using RulesOfBonds = PerBond<std::uint32_t>;

void write_rules(H5Writer& writer, const State& state) {
  Rules rules;
  RulesOfBonds of_bond;
  std::vector<const BondRules*> seen;
  for (const Bond& b : state.bonds) {
    const auto at = std::find(seen.begin(), seen.end(), b.rules);
    of_bond.push_back(static_cast<std::uint32_t>(at - seen.begin()));
    if (at != seen.end()) continue;
    seen.push_back(b.rules);
    rules.push_back(numbers_of(*b.rules));
  }
  if (seen.empty() || (seen.size() == 1 && seen[0] == &no_rules)) return;
  writer.of_each("/rules/numbers", rules, std::identity{});
  writer.of_each("/bonds/rules", of_bond, std::identity{});
}

void read_rules(H5Reader& reader, State& state) {
  if (!reader.has("/rules/numbers")) return;
  Rules numbers;
  RulesOfBonds of_bond;
  numbers.resize(reader.rows("/rules/numbers"));
  of_bond.resize(state.bonds.size());
  reader.of_each("/rules/numbers", numbers, std::identity{});
  reader.of_each("/bonds/rules", of_bond, std::identity{});
  std::vector<const BondRules*> rules;
  for (const RuleNumbers& row : numbers) {
    const std::optional<BondRules> read = rules_of(row);
    if (!read) throw IoError("is damaged: rules of bonds that cannot be");
    rules.push_back(&kept(*read));
  }
  for (const BondId k : of_bond.ids()) {
    if (of_bond[k] >= rules.size()) throw IoError("is damaged: a bond has no rules");
    state.bonds[k].rules = rules[of_bond[k]];
  }
}

/// What is dissipated by cause, in the order of Loss; only if it is not all zero.
using LossesOfFile = Column<Id<struct LossOfFile>, double>;

void write_losses(H5Writer& writer, const State& state) {
  const Losses& lost = state.books.lost;
  if (lost == Losses{}) return;
  writer.of_each("/books/lost", LossesOfFile({lost.of.begin(), lost.of.end()}), std::identity{});
}

void read_losses(H5Reader& reader, State& state) {
  if (!reader.has("/books/lost")) return;
  LossesOfFile lost;
  lost.resize(std::min(loss_count, reader.rows("/books/lost")));  // causes that came later stand at the end
  reader.of_each("/books/lost", lost, std::identity{});
  std::copy(lost.begin(), lost.end(), state.books.lost.of.begin());
}

using PairMemories = Column<Id<struct PairOfFile>, PairMemory>;
/// Files have these only where bonds or contacts are more than elastic, or moments of inertia differ.
void write_inelastic(H5Writer& writer, const State& state) {
  if (!state.spin.empty()) writer.of_each("/particles/spin", state.spin, std::identity{});
  if (!state.bond_history.empty()) writer.of_each("/bonds/history", state.bond_history, std::identity{});
  const auto write = [&writer](const char* F, const char* M, const Loads& loads) {
    if (loads.F.empty()) return;
    writer.of_each(F, loads.F, std::identity{});
    writer.of_each(M, loads.M, std::identity{});
  };
  if (!state.contact_history.empty()) {
    const PairMemories memories(state.contact_history);
    writer.of_each("/contacts/i", memories, &PairMemory::i);
    writer.of_each("/contacts/j", memories, &PairMemory::j);
    writer.of_each("/contacts/history", memories, &PairMemory::history);
    writer.of_each("/contacts/kept", memories, &PairMemory::kept);
  }
  write_fibres(writer, state);
  write("/loads/F", "/loads/M", state.loads);
  write("/loads/damping_F", "/loads/damping_M", state.damping);
  write("/loads/local_damping_F", "/loads/local_damping_M", state.local_damping);
  write_losses(writer, state);
}

void read_inelastic(H5Reader& reader, State& state) {
  if (reader.has("/particles/spin")) {
    state.spin.resize(state.r.size());
    reader.of_each("/particles/spin", state.spin, std::identity{});
  }
  if (reader.has("/bonds/history")) {
    state.bond_history.resize(state.bonds.size());
    reader.of_each("/bonds/history", state.bond_history, std::identity{});
  }
  const auto read = [&](const char* F, const char* M, Loads& loads) {
    if (!reader.has(F)) return;
    loads.F.resize(state.r.size());
    loads.M.resize(state.r.size());
    reader.of_each(F, loads.F, std::identity{});
    reader.of_each(M, loads.M, std::identity{});
  };
  if (reader.has("/contacts/i")) {
    PairMemories memories;
    memories.resize(reader.rows("/contacts/i"));
    reader.of_each("/contacts/i", memories, &PairMemory::i);
    reader.of_each("/contacts/j", memories, &PairMemory::j);
    reader.of_each("/contacts/history", memories, &PairMemory::history);
    reader.of_each("/contacts/kept", memories, &PairMemory::kept);
    for (const PairMemory& m : memories) {
      if (!(m.i < m.j) || m.j.value >= state.r.size())
        throw IoError("is damaged: a contact has impossible ends");
      state.contact_history.push_back(m);
    }
  }
  read_fibres(reader, state);
  read("/loads/F", "/loads/M", state.loads);
  read("/loads/damping_F", "/loads/damping_M", state.damping);
  read("/loads/local_damping_F", "/loads/local_damping_M", state.local_damping);
  read_losses(reader, state);
}

using Ends = PerBond<ParticleId>;  // one end of each pair

/// Files have these only where particles were dropped.
void write_dropped(H5Writer& writer, const State& state) {
  if (state.dropped.empty()) return;
  writer.of_each("/dropped/particle", Ends(state.dropped), std::identity{});
}

void read_dropped(H5Reader& reader, State& state) {
  if (!reader.has("/dropped/particle")) return;
  Ends dropped;
  dropped.resize(reader.rows("/dropped/particle"));
  reader.of_each("/dropped/particle", dropped, std::identity{});
  state.dropped.assign(dropped.begin(), dropped.end());
  if (const auto mistake = mistake_in_dropped(state)) throw IoError("is damaged: " + *mistake);
}

/// Files have these columns only where there are such pairs, so that the format is the one before them.
void write_overlapping(H5Writer& writer, const WatchRecord& watch) {
  if (watch.overlapping.empty()) return;
  Ends i, j;
  for (const auto& pair : watch.overlapping) i.push_back(pair.first), j.push_back(pair.second);
  writer.of_each("/watch/overlapping_i", i, std::identity{});
  writer.of_each("/watch/overlapping_j", j, std::identity{});
}

void read_overlapping(H5Reader& reader, WatchRecord& watch, std::size_t particles) {
  if (!reader.has("/watch/overlapping_i")) return;
  Ends i, j;
  i.resize(reader.rows("/watch/overlapping_i"));
  j.resize(i.size());
  reader.of_each("/watch/overlapping_i", i, std::identity{});
  reader.of_each("/watch/overlapping_j", j, std::identity{});
  for (const BondId k : i.ids()) {
    if (!(i[k] < j[k]) || j[k].value >= particles)
      throw IoError("is damaged: an overlap has impossible ends");
    watch.overlapping.insert({i[k], j[k]});
  }
}

/// The same for the rest of the watch's record that few runs have.
void write_rare(H5Writer& writer, const WatchRecord& watch) {
  PerBond<BondId> stretched;
  for (const BondId k : watch.stretched) stretched.push_back(k);
  if (!stretched.empty()) writer.of_each("/watch/stretched", stretched, std::identity{});
  if (watch.fastest != WatchRecord{}.fastest) writer("/watch/fastest", watch.fastest);
  if (watch.farthest_turn > 0.0) writer("/watch/farthest_turn", watch.farthest_turn);
  if (!watch.in_walls.empty()) {
    Ends particle;
    PerBond<std::uint32_t> wall;
    for (const auto& [p, w] : watch.in_walls) particle.push_back(p), wall.push_back(w);
    writer.of_each("/watch/in_wall_particle", particle, std::identity{});
    writer.of_each("/watch/in_wall_wall", wall, std::identity{});
  }
  if (watch.deep.empty()) return;
  Ends i, j;
  PerBond<DeepPair> deep;
  for (const auto& [pair, d] : watch.deep)
    i.push_back(pair.first), j.push_back(pair.second), deep.push_back(d);
  writer.of_each("/watch/deep_i", i, std::identity{});
  writer.of_each("/watch/deep_j", j, std::identity{});
  writer.of_each("/watch/deep_entered", deep, &DeepPair::entered);
  writer.of_each("/watch/deep_nearest", deep, &DeepPair::nearest);
  writer.of_each("/watch/deep_last_step", deep, &DeepPair::last_step);
}

void read_in_walls(H5Reader& reader, WatchRecord& watch, std::size_t particles) {
  if (!reader.has("/watch/in_wall_particle")) return;
  Ends particle;
  PerBond<std::uint32_t> wall;
  particle.resize(reader.rows("/watch/in_wall_particle"));
  wall.resize(particle.size());
  reader.of_each("/watch/in_wall_particle", particle, std::identity{});
  reader.of_each("/watch/in_wall_wall", wall, std::identity{});
  for (const BondId k : particle.ids()) {
    if (particle[k].value >= particles) throw IoError("is damaged: a wall is overlapped by no particle");
    watch.in_walls.insert({particle[k], wall[k]});
  }
}

void read_rare(H5Reader& reader, WatchRecord& watch, const State& state) {
  if (reader.has("/watch/stretched")) {
    PerBond<BondId> stretched;
    stretched.resize(reader.rows("/watch/stretched"));
    reader.of_each("/watch/stretched", stretched, std::identity{});
    for (const BondId k : stretched) {
      if (k.value >= state.bonds.size()) throw IoError("is damaged: a stretched bond is none of its bonds");
      watch.stretched.insert(k);
    }
  }
  if (reader.has("/watch/fastest")) reader("/watch/fastest", watch.fastest);
  if (reader.has("/watch/farthest_turn")) reader("/watch/farthest_turn", watch.farthest_turn);
  read_in_walls(reader, watch, state.r.size());
  if (!reader.has("/watch/deep_i")) return;
  Ends i, j;
  PerBond<DeepPair> deep;
  const std::size_t n = reader.rows("/watch/deep_i");
  i.resize(n), j.resize(n), deep.resize(n);
  reader.of_each("/watch/deep_i", i, std::identity{});
  reader.of_each("/watch/deep_j", j, std::identity{});
  reader.of_each("/watch/deep_entered", deep, &DeepPair::entered);
  reader.of_each("/watch/deep_nearest", deep, &DeepPair::nearest);
  reader.of_each("/watch/deep_last_step", deep, &DeepPair::last_step);
  for (const BondId k : i.ids()) {
    if (!(i[k] < j[k]) || j[k].value >= state.r.size())
      throw IoError("is damaged: a deep pair has impossible ends");
    watch.deep[{i[k], j[k]}] = deep[k];
  }
}

bool finite(const Vec3d& x) {
  return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z);
}

/// What no run can have been in, so that it is not found later and far away.
void check_sense(const Checkpoint& checkpoint) {
  const State& s = checkpoint.state;
  const Clock& c = s.clock;
  if (c.stage < 0 || c.stage_step < 0 || c.step < c.stage_step) throw IoError("is damaged: impossible clock");
  for (const Bond& b : s.bonds)
    if (b.i.value >= s.r.size() || b.j.value >= s.r.size() || b.i == b.j)
      throw IoError("is damaged: a bond has impossible ends");
  if (checkpoint.watch.bonds.size() > s.bonds.size()) throw IoError("is damaged: it watches missing bonds");
  for (const ParticleId p : s.r.ids()) {
    const Quatd& q = s.q[p];
    const double length = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    const bool spin_is_finite = s.spin.empty() || finite(s.spin[p]);
    if (!finite(s.r[p]) || !finite(s.v[p]) || !finite(s.omega[p]) || !spin_is_finite ||
        !(std::abs(length - 1.0) < 1e-6))
      throw IoError(fmt::format("is damaged: particle {} is in no place or turned by no rotation", p.value));
  }
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Model& model, const Checkpoint& checkpoint,
                      const std::string& program_version) {
  const H5Silence silence;
  try {
    H5Writer writer;
    visit_fingerprint(writer, model);
    if (!model.principal.empty()) visit_principal_inertia(writer, model);
    visit_fields(writer, checkpoint);
    write_laws(writer, checkpoint.state);
    write_rules(writer, checkpoint.state);
    write_inelastic(writer, checkpoint.state);
    write_dropped(writer, checkpoint.state);
    write_heat(writer, checkpoint.state);
    write_walls(writer, checkpoint.state);
    write_grips(writer, checkpoint.state);
    write_overlapping(writer, checkpoint.watch);
    write_rare(writer, checkpoint.watch);
    write_units(writer.file(), model.units);
    Replacement file(path);
    file.write(writer.bytes());
    write_seal(file.part(), format_version, program_version);
    file.publish(Sync::to_disk);
  } catch (const IoError& e) {
    std::error_code unknown;
    const bool older = std::filesystem::exists(path, unknown);
    throw IoError(path.string() +
                  (older ? ": there is no new checkpoint, an older one is still there: "
                         : ": there is no checkpoint, this would have been the first: ") +
                  e.what());
  }
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const Model& model,
                           std::span<const BondLaw* const> laws) {
  open_file(path, "rb");  // a missing or forbidden file is told in the system's words
  const H5Silence silence;
  try {
    check_seal(path, format_version);
    H5Reader reader(path);
    check_fingerprint(reader, model);
    Checkpoint c;
    const std::size_t n = model.particles();
    c.state.r.resize(n), c.state.v.resize(n), c.state.q.resize(n), c.state.omega.resize(n);
    c.state.bonds.resize(reader.rows("/bonds/i"));
    c.watch.bonds.resize(reader.rows("/watch/worst"));
    visit_fields(reader, c);
    read_laws(reader, c.state, laws);
    read_rules(reader, c.state);
    read_inelastic(reader, c.state);
    read_heat(reader, c.state);
    read_walls(reader, c.state);
    read_grips(reader, c.state);
    read_overlapping(reader, c.watch, n);
    read_rare(reader, c.watch, c.state);
    check_sense(c);
    read_dropped(reader, c.state);
    return c;
  } catch (const IoError& e) {
    throw IoError(path.string() + ": " + e.what());
  }
}

}  // namespace vbond
