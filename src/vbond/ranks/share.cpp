#include "vbond/ranks/share.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "vbond/dynamics/kernel.hpp"

namespace vbond {
namespace {

std::size_t blocks_of(std::size_t rows) {
  return (rows + block_rows - 1) / block_rows;
}
Team one_thread(std::size_t rows) {
  return {rows, std::vector<std::size_t>(blocks_of(filled_up(rows)), block_rows), 1};
}

Model part_of(const Model& whole, const std::vector<ParticleId>& particles, std::size_t own) {
  Model part;
  for (std::size_t k = 0; k < own; ++k) {
    part.mass.push_back(whole.mass[particles[k]]);
    part.inertia.push_back(whole.inertia[particles[k]]);
    part.r_0.push_back(whole.r_0[particles[k]]);
  }
  return part;
}

/// The stage with only those particles of supports and loads that are here, by their places.
Stage part_of(const Stage& whole, const std::vector<ParticleId>& particles, std::size_t own) {
  std::vector<std::pair<ParticleId, ParticleId>> place;
  for (std::size_t k = 0; k < own; ++k) place.emplace_back(particles[k], ParticleId{k});
  std::sort(place.begin(), place.end());
  const auto keep = [&place](std::vector<ParticleId>& of) {
    std::vector<ParticleId> kept;
    for (const ParticleId p : of) {
      const auto at = std::lower_bound(place.begin(), place.end(), std::pair(p, ParticleId{}));
      if (at != place.end() && at->first == p) kept.push_back(at->second);
    }
    of = std::move(kept);
  };
  Stage part = whole;
  for (Support& s : part.supports) keep(s.particles);
  for (PointLoad& l : part.loads) keep(l.particles);
  return part;
}

}  // namespace

Share::Share(const Model& whole, const Stage& stage, const PerBond<Bond>& bonds, Holding holding)
    : particles_(std::move(holding.particles)),
      own_(holding.own.size()),
      model_(part_of(whole, particles_, own_)),
      stage_(part_of(stage, particles_, own_)),
      bodies_(model_),
      team_(one_thread(own_)),
      with_ghosts_(one_thread(bodies_.pose.size() + particles_.size() - own_)),
      held_(std::move(holding.bonds)),
      supports_(stage_, bodies_, team_),
      applied_(stage_, bodies_, team_),
      damping_(stage_, bodies_) {
  Order& order = bodies_.order;
  for (std::size_t k = own_; k < particles_.size(); ++k)
    order.row.push_back(Row{bodies_.pose.size() + k - own_});
  for (const Row row : order.row) rows_.push_back(row.value);
  const std::size_t rows = filled_up(bodies_.pose.size() + particles_.size() - own_);
  bodies_.pose.resize(rows);
  bodies_.load.resize(rows);

  State state;
  for (const Motion& m : holding.own) {
    state.r.push_back(m.r), state.q.push_back(m.q);
    state.v.push_back(m.v), state.omega.push_back(m.omega);
    start_.push_back(m.r);
  }
  for (const HeldBond& held : held_) {
    Bond bond = bonds[held.bond];
    bond.i = held.i, bond.j = held.j;
    state.bonds.push_back(bond);
  }
  bodies_.read(state);
  packs_.arrange(state, order, with_ghosts_);
  bonds_ = std::move(state.bonds);
}

Motion Share::motion(std::size_t k) const {
  const std::uint32_t row = rows_[k];
  return {bodies_.pose[row].r, bodies_.pose[row].q, bodies_.motion[row].v, bodies_.motion[row].omega};
}

void Share::kick(const Block& b) {
  sums_.poison += step_kernel().kick(b.rows, 0.5 * stage_.dt, bodies_.inverse.data(), bodies_.load.data(),
                                     bodies_.motion.data());
}

void Share::move(std::int64_t stage_step) {
  const double dt = stage_.dt;
  sums_ = {};
  supports_.set_times(stage_step, dt);
  applied_.set_times(stage_step, dt);
  team_.for_blocks([&](const Block& b) {
    sums_.dissipated += damping_.slow_down(b.rows);
    sums_.work_supports += supports_.hold(b, Instant::start);
    kick(b);
    sums_.work_supports += supports_.hold_after_kick(b, Instant::start, Instant::middle, dt / 2);
    step_kernel().drift(b.rows, dt, bodies_.motion.data(), bodies_.pose.data());
    sums_.work_loads += applied_.work(b, dt);
  });
}

void Share::add_bond_loads(bool in_step) {
  breaking_.clear();
  std::memset(static_cast<void*>(bodies_.load.data()), 0, bodies_.load.size() * sizeof(LoadRow));
  for (const Part& part : with_ghosts_.parts()) {
    BondSweep sweep{part.rows, bodies_.pose.data(), bodies_.load.data()};
    for (std::size_t b = part.first_block; b < part.last_block; ++b)
      packs_.add_loads(with_ghosts_.block(b), sweep, {}, in_step ? &breaking_ : nullptr);
  }
}

std::vector<BondId> Share::broken() const {
  std::vector<BondId> all;
  for (const BondId b : breaking_) all.push_back(held_[b.value].bond);
  return all;
}

void Share::take_out_broken() {
  for (const BondId b : breaking_) {
    packs_.remove(b);
    bonds_[b].broken = true;
  }
}

StepSums Share::finish() {
  team_.for_blocks([&](const Block& b) {
    applied_.add(b, Instant::end);
    kick(b);
    sums_.work_supports += supports_.hold_after_kick(b, Instant::middle, Instant::end, 0.5 * stage_.dt);
    sums_.dissipated += damping_.slow_down(b.rows);
    sums_.work_supports += supports_.hold(b, Instant::end);
  });
  return sums_;
}

void Share::add_applied_loads(std::int64_t stage_step) {
  applied_.set_times(stage_step, stage_.dt);
  team_.for_blocks([&](const Block& b) { applied_.add(b, Instant::start); });
}

std::optional<ParticleId> Share::without_finite_load() const {
  std::optional<ParticleId> found;
  for (std::size_t k = 0; k < own_; ++k) {
    const LoadRow& load = bodies_.load[rows_[k]];
    if (is_finite(load.F) && is_finite(load.M)) continue;
    if (!found || particles_[k] < *found) found = particles_[k];
  }
  return found;
}

double Share::way2() const {
  double most = 0.0;
  for (std::size_t k = 0; k < own_; ++k) most = std::max(most, norm2(bodies_.pose[rows_[k]].r - start_[k]));
  return most;
}

double Share::longest_bond() const {
  double longest2 = 0.0;
  for (const Bond& b : bonds_)
    if (!b.broken)
      longest2 =
          std::max(longest2, norm2(bodies_.pose[rows_[b.i.value]].r - bodies_.pose[rows_[b.j.value]].r));
  return std::sqrt(longest2);
}

}  // namespace vbond
