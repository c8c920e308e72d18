#include "vbond/observe/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "vbond/core/images.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/present.hpp"
#include "vbond/model/stress.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

/// Those of a group that have come in and that no sink has taken out: means are of these.
std::vector<ParticleId> those_there(const Group& group, const State& state) {
  const std::vector<ParticleId> without = left_out(state);
  std::vector<ParticleId> there;
  std::copy_if(group.particles.begin(), group.particles.end(), std::back_inserter(there),
               [&](ParticleId p) { return !std::binary_search(without.begin(), without.end(), p); });
  return there;
}

/// The mean over those of a group that are there, in all parts; nothing without any.
template <class Value>
std::optional<Vec3d> mean_of(const Group& group, const BodyPart& body, const Value& value) {
  const std::vector<ParticleId> there = those_there(group, body.state);
  if (there.empty()) return std::nullopt;
  Vec3d sum;
  for (const ParticleId p : there)
    if (body.has(p)) sum += value(p);
  return body.summed(sum) / static_cast<double>(there.size());
}

std::optional<Vec3d> mean_displacement(const Group& group, const Model& model, const BodyPart& body) {
  return mean_of(group, body,
                 [&](ParticleId p) { return body.state.r[p] - first_place(model, body.state, p); });
}

std::optional<Vec3d> mean_velocity(const Group& group, const BodyPart& body) {
  return mean_of(group, body, [&](ParticleId p) { return body.state.v[p]; });
}

/// That of a group now; 0 where nobody is left, who then has no stress.  [length^3]
double volume_now(const StressedGroup& g, const Model& model, const State& state) {
  if (!g.of_spheres || left_out(state).empty()) return g.volume;
  double spheres = 0.0;
  for (const ParticleId p : those_there(g.group, state)) spheres += sphere_volume(model, p);
  return spheres;
}

void add_stresses(const OutputPlan& plan, const Model& model, const BodyPart& body, HistoryValues& to) {
  const PerParticle<Tensor> stress = stress_times_volume(model, body);
  for (const StressedGroup& g : plan.stresses) {
    const double volume = volume_now(g, model, body.state);
    to.stresses.push_back(symmetric_part(mean_stress(body, stress, g.group.particles, volume)));
    const bool some_come_in = std::any_of(g.group.particles.begin(), g.group.particles.end(),
                                          [&model](ParticleId p) { return comes_in(model, p); });
    SymmetricParts strain;  // of particles that come in there is none: they had no places at the start
    strain.fill(std::numeric_limits<double>::quiet_NaN());
    to.strains.push_back(
        some_come_in ? strain : symmetric_part(mean_strain(model, body, those_there(g.group, body.state))));
  }
}

/// What particles are asked for one by one.
void add_means(const OutputPlan& plan, const BodyView& body, HistoryValues& to) {
  const bool stresses = plan.cell || !plan.stresses.empty();
  if (!stresses && plan.displacements.empty() && plan.velocities.empty()) return;
  const Model& model = body.model();
  const BodyPart part =
      body.part(Show::places, stresses && particles_touch(model.contact) ? reach_of_overlaps(model) : 0.0);
  if (plan.cell) to.cell = cell_values(model, part);
  for (const Group& g : plan.displacements) to.displacements.push_back(mean_displacement(g, model, part));
  if (body.balance() == nullptr)
    for (const Group& g : plan.velocities) to.velocities.push_back(mean_velocity(g, part));
  if (!plan.stresses.empty()) add_stresses(plan, model, part, to);
}

/// What terms say of the groups of the plan.
void add_terms(const OutputPlan& plan, const BodyView& body, HistoryValues& to) {
  for (const GroupQuantity& q : group_quantities())
    if (const auto groups = plan.of_terms.find(q.name); q.look != nullptr && groups != plan.of_terms.end())
      for (const Group& g : groups->second) q.look(body, g, to.of_terms[q.name].emplace_back());
}

/// The columns of a group or a wall.
std::vector<std::string> names_of(const GroupQuantity& q, const std::string& of) {
  std::vector<std::string> names;
  for (const GroupQuantity::Component& c : q.components)
    names.push_back(fmt::format("{}.{}{}{}", q.name, of, *c.name != '\0' ? "." : "", c.name));
  return names;
}

/// Those of the plan; nothing for one that this stage has not.
std::vector<std::optional<GripView>> grips_of(const OutputPlan& plan, const std::vector<GripView>& now) {
  std::vector<std::optional<GripView>> grips;
  for (const std::string& group : plan.grips) {
    const auto grip =
        std::find_if(now.begin(), now.end(), [&](const GripView& g) { return g.group == group; });
    grips.push_back(grip != now.end() ? std::optional(*grip) : std::nullopt);
  }
  return grips;
}

/// What went by the causes of the plan; not worked out without any.
std::vector<double> losses_of(const OutputPlan& plan, const BodyView& body) {
  std::vector<double> parts;
  if (plan.losses.empty()) return parts;
  const Losses lost = losses_of(body);
  for (const Loss cause : plan.losses) parts.push_back(lost[cause]);
  return parts;
}

/// Where the components of a vector stand in a row; nothing if a column is not there.
using VectorColumns = std::optional<std::array<std::size_t, 3>>;
VectorColumns vector_columns(const std::vector<std::string>& columns, const std::string& of,
                             const std::array<const char*, 3>& components) {
  std::array<std::size_t, 3> found{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = index_of(columns, of + '.' + components[k]);
    if (!at) return std::nullopt;
    found[k] = *at;
  }
  return found;
}
std::optional<Vec3d> vector_in(const std::vector<std::string>& cells, const VectorColumns& columns) {
  if (!columns) return std::nullopt;
  const auto number = [&](std::size_t k) { return csv_number<double>(cells[(*columns)[k]]); };
  const auto x = number(0), y = number(1), z = number(2);
  return x && y && z ? std::optional(Vec3d{*x, *y, *z}) : std::nullopt;
}

/// Takes the size of a force up in the largest one so far.
void take_up(const Vec3d& force, double& largest) {
  largest = std::max(largest, norm(force));
}
void take_up(const Vec3d& force, std::optional<double>& largest) {
  take_up(force, largest ? *largest : largest.emplace(0.0));
}

}  // namespace

CellValues cell_values(const Model& model, const BodyPart& body) {
  const State& state = body.state;
  CellValues of{.volume = volume(state.cell)};
  for (const ParticleId p : model.mass.ids())
    if (body.has(p) && !is_absent(state, p)) of.density += model.mass[p] / of.volume;
  body.all.sum({&of.density, 1});
  of.strain = cell_components(cell_gradient(model.cell, state.cell));
  for (std::size_t k = 0; k < 3; ++k) of.strain[k] -= 1.0;
  of.stress = symmetric_part(cell_stress(model, body));
  return of;
}

std::vector<std::string> history_columns(const OutputPlan& plan) {
  std::vector<std::string> names;
  for (const HistoryQuantity& q : history_quantities())
    if (is_in(q.cases, plan)) names.emplace_back(q.name);
  for (const GroupQuantity& q : group_quantities())
    for (const std::string& of : q.names(plan))
      for (std::string& name : names_of(q, of)) names.push_back(std::move(name));
  return names;
}

std::vector<Cell> history_row(const OutputPlan& plan, const HistoryValues& values) {
  std::vector<Cell> cells;
  for (const HistoryQuantity& q : history_quantities())
    if (is_in(q.cases, plan)) cells.push_back(q.value(values));
  for (const GroupQuantity& q : group_quantities())
    for (std::size_t k = 0; k < q.names(plan).size(); ++k) q.add(values, k, cells);
  return cells;
}

std::string history_header(const OutputPlan& plan) {
  std::vector<std::string> columns;
  for (const std::string& name : history_columns(plan)) columns.push_back(csv_quoted(name));
  return csv_line(columns);
}

HistoryValues history_values(const OutputPlan& plan, const BodyView& body) {
  const BalancePoint* const at_rest = body.balance();
  const std::vector<ParticleId> without = left_out(body.taken(), body.waiting());
  const BodyPart bonded = body.part(Show::bonds);
  HistoryValues values{
      .clock = body.clock(),
      .books = body.books(),
      .mass = body.mass(),
      .present =
          static_cast<std::int64_t>(body.model().particles() - body.dropped().size() - body.waiting().size()),
      .energies = body.energies(),
      .balance_error = body.balance_error(),
      .losses = losses_of(plan, body),
      .bonds = count_bonds(bonded),
      .ranges = count_ranges(body),
      .fragments = plan.breaks ? std::optional(count_fragments(body.model(), bonded, without)) : std::nullopt,
      .broken = plan.breaks ? count_broken(bonded) : 0,
      .peak_average = body.peak().last,
      .load_factor = at_rest ? std::optional(at_rest->load_factor) : std::nullopt,
      .unstable = at_rest ? at_rest->unstable : std::nullopt,
      .reactions = {},
      .axial_force = {},
      .displacements = {},
      .velocities = {},
      .stresses = {},
      .strains = {},
      .walls = body.walls(),
      .cell = {},
      .grips = plan.grips.empty() ? std::vector<std::optional<GripView>>{} : grips_of(plan, body.grips()),
      .of_terms = {}};
  for (const Group& g : plan.reactions) values.reactions.push_back(body.reaction(g.particles));
  for (const Group& g : plan.axial_force)
    values.axial_force.push_back(mean_axial_force(body.part(), g.particles));
  add_means(plan, body, values);
  add_terms(plan, body, values);
  return values;
}

HistoryWriter::HistoryWriter(const OutputPlan& plan, std::optional<std::int64_t> resume_step)
    : plan_(plan),
      largest_on_walls_(plan.walls.size()),
      file_(plan.folder / "history.csv",
            {.what = "a history",
             .columns = history_columns(plan),
             .ordered_by = "step",
             .necessary = {"step", "time", "balance_error"},
             .facts = facts_of_column,
             .looker = [this](const std::vector<std::string>& columns) { return looker(columns); }},
            plan.units, resume_step) {}

/// Takes from the rows of an earlier run what those to come go on with.
CsvWriter::Look HistoryWriter::looker(const std::vector<std::string>& columns) {
  const std::size_t step = index_of(columns, "step").value(),
                    error = index_of(columns, "balance_error").value();
  VectorColumns force;
  if (!plan_.reactions.empty())
    force = vector_columns(columns, "reaction." + plan_.reactions[0].name, {"fx", "fy", "fz"});
  std::vector<VectorColumns> on_walls;
  for (const std::string& wall : plan_.walls)
    on_walls.push_back(vector_columns(columns, "wall." + wall, {"Fx", "Fy", "Fz"}));
  return [this, step, error, force, on_walls](const std::vector<std::string>& cells) {
    const auto balance_error = csv_number<double>(cells[error]);
    if (!balance_error) return false;
    last_step_ = csv_number<std::int64_t>(cells[step]).value();
    largest_balance_error_ = std::max(largest_balance_error_, std::abs(*balance_error));
    if (const auto F = vector_in(cells, force)) take_up(*F, largest_load_);
    for (std::size_t w = 0; w < on_walls.size(); ++w)
      if (const auto F = vector_in(cells, on_walls[w])) take_up(*F, largest_on_walls_[w]);
    return true;
  };
}

void HistoryWriter::write(const HistoryValues& values) {
  file_.write(history_row(plan_, values));
  last_step_ = values.clock.step;
  largest_balance_error_ = std::max(largest_balance_error_, std::abs(values.balance_error));
  if (!values.reactions.empty()) take_up(values.reactions[0].force, largest_load_);
  for (std::size_t w = 0; w < std::min(values.walls.size(), largest_on_walls_.size()); ++w)
    take_up(values.walls[w].force, largest_on_walls_[w]);
}

}  // namespace vbond
