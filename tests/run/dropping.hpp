#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/spheres_and_walls.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/run.hpp"

/// Runs that drop particles, and bodies from which they are taken out by hand.
namespace vbond::drop_test {

using testing::Dice;
using testing::linear;
using testing::Specimen;

inline constexpr std::int64_t every = 10;  // steps between looks at the balance

inline std::shared_ptr<WatchObserver> watch(WatchRecord record = {}, double energy_error = 0.05) {
  OutputPlan plan;
  plan.energy_error = energy_error;
  plan.history_every = 1e9;
  plan.watch_every = every;
  return std::make_shared<WatchObserver>(plan, Watch::Tell{}, std::move(record));
}

inline Stage dropping(double dt, double duration) {
  Stage stage = testing::plain_stage(dt, duration);
  stage.on_unphysical = OnUnphysical::drop;
  return stage;
}

/// A run of one stage, watched as the program does it.
struct Watched {
  std::shared_ptr<WatchObserver> observer;
  vbond::Run run;
  std::vector<std::string> told;
  Watched(const Specimen& s, const Stage& stage, int threads = 1, WatchRecord record = {})
      : observer(watch(std::move(record))), run(s.model, s.state, {stage}, threads) {
    run.add_observer(observer);
    RunHooks hooks;
    hooks.tell = [this](const std::string& text) { told.push_back(text); };
    run.set_hooks(std::move(hooks));
  }
};

/// What the books say is missing.  [energy]
inline double missing(const Simulation& run) {
  const EnergyBooks& b = run.books();
  return run.energies().total() + b.dissipated + b.released - b.work_loads - b.work_supports - b.at_start;
}

/// The same body and moment without these particles, in a numbering of its own.
inline Specimen without(const Specimen& s, const std::vector<ParticleId>& gone) {
  std::vector<std::optional<ParticleId>> now(s.model.particles());
  std::vector<ParticleId> stay;
  for (const ParticleId p : s.model.mass.ids())
    if (std::find(gone.begin(), gone.end(), p) == gone.end()) {
      now[p.value] = ParticleId{stay.size()};
      stay.push_back(p);
    }
  Specimen rest;
  rest.model = s.model;
  const auto keep = [&stay](auto& column) {
    auto all = column;
    if (all.empty()) return;
    column.resize(stay.size());
    for (std::size_t k = 0; k < stay.size(); ++k) column[ParticleId{k}] = all[stay[k]];
  };
  Model& m = rest.model;
  keep(m.mass), keep(m.inertia), keep(m.radius), keep(m.r_0), keep(m.material), keep(m.principal);
  m.groups = {{"all", {}}};
  for (const ParticleId p : m.mass.ids()) m.groups[0].particles.push_back(p);
  rest.state = s.state;
  State& t = rest.state;
  keep(t.r), keep(t.v), keep(t.q), keep(t.omega), keep(t.spin), keep(t.temperature);
  t.loads = t.damping = t.local_damping = {};
  t.bonds.resize(0), t.bond_history.resize(0), t.warm_bonds.clear();
  for (const BondId k : s.state.bonds.ids()) {
    Bond b = s.state.bonds[k];
    if (!now[b.i.value] || !now[b.j.value]) continue;
    b.i = *now[b.i.value], b.j = *now[b.j.value];
    t.bonds.push_back(b);
    for (WarmBond w : s.state.warm_bonds)
      if (w.bond == k) {
        w.bond = BondId{t.bonds.size() - 1};
        t.warm_bonds.push_back(w);
      }
    if (!s.state.bond_history.empty()) t.bond_history.push_back(s.state.bond_history[k]);
  }
  t.contact_history.clear(), t.wall_history.clear();
  for (PairMemory p : s.state.contact_history)
    if (now[p.i.value] && now[p.j.value]) {
      p.i = *now[p.i.value], p.j = *now[p.j.value];
      t.contact_history.push_back(p);
    }
  for (WallMemory w : s.state.wall_history)
    if (now[w.p.value]) {
      w.p = *now[w.p.value];
      t.wall_history.push_back(w);
    }
  return rest;
}

/// What the watch has seen, in the numbering of without().
inline WatchRecord without(const WatchRecord& record, const std::vector<ParticleId>& gone) {
  const auto now = [&gone](ParticleId p) {
    const auto before = std::count_if(gone.begin(), gone.end(), [p](ParticleId q) { return q < p; });
    return ParticleId{p.value - static_cast<std::size_t>(before)};
  };
  const auto stays = [&gone](ParticleId p) { return std::find(gone.begin(), gone.end(), p) == gone.end(); };
  WatchRecord rest;
  for (const auto& [pair, deep] : record.deep)
    if (stays(pair.first) && stays(pair.second)) rest.deep[{now(pair.first), now(pair.second)}] = deep;
  return rest;
}

}  // namespace vbond::drop_test
