#include "vbond/model/drop.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace vbond {

std::optional<std::string> mistake_in_dropped(const State& s) {
  for (std::size_t k = 0; k < s.dropped.size(); ++k)
    if (s.dropped[k].value >= s.r.size() || (k > 0 && !(s.dropped[k - 1] < s.dropped[k])))
      return "particle " + std::to_string(s.dropped[k].value) +
             " is dropped: those that are must be particles of the state, in increasing order";
  if (s.dropped.empty()) return std::nullopt;
  for (const Bond& b : s.bonds)
    if (!b.broken && (is_dropped(s, b.i) || is_dropped(s, b.j)))
      return "a bond joins particles " + std::to_string(b.i.value) + " and " + std::to_string(b.j.value) +
             ", one of which is dropped";
  return std::nullopt;
}

bool can_do_without(const Stage& stage, ParticleId p) {
  if (stage.stops.distance && (stage.stops.distance->i == p || stage.stops.distance->j == p)) return false;
  return std::none_of(stage.supports.begin(), stage.supports.end(), [p](const Support& s) {
    return std::find(s.particles.begin(), s.particles.end(), p) != s.particles.end();
  });
}

std::optional<std::vector<std::pair<ParticleId, std::string>>> to_be_dropped(
    const Stage& stage, const std::vector<LostParticle>& lost) {
  std::map<ParticleId, std::string> found;
  for (const LostParticle& l : lost)
    if (!l.other) {
      if (!can_do_without(stage, l.p)) return std::nullopt;
      found.emplace(l.p, l.why);
    }
  for (const LostParticle& l : lost) {
    if (!l.other || found.count(l.p) > 0 || found.count(*l.other) > 0) continue;
    const bool first = can_do_without(stage, l.p);
    if (!first && !can_do_without(stage, *l.other)) return std::nullopt;
    found.emplace(first ? l.p : *l.other,
                  "it has passed through particle " + std::to_string((first ? *l.other : l.p).value));
  }
  return std::vector<std::pair<ParticleId, std::string>>(found.begin(), found.end());
}

std::vector<BondEvent> drop(const std::vector<ParticleId>& particles, State& s) {
  s.dropped.insert(s.dropped.end(), particles.begin(), particles.end());
  std::sort(s.dropped.begin(), s.dropped.end());
  s.dropped.erase(std::unique(s.dropped.begin(), s.dropped.end()), s.dropped.end());
  PerParticle<char> goes(s.r.size(), 0);
  for (const ParticleId p : particles) goes[p] = 1;
  std::vector<BondEvent> broken;
  for (const BondId k : s.bonds.ids()) {
    Bond& b = s.bonds[k];
    if (b.broken || (goes[b.i] == 0 && goes[b.j] == 0)) continue;
    if (is_cracked(b)) {  // it has broken before
      b.broken = true;
      continue;
    }
    broken.push_back(breaking_event(b, k, s.clock.step, s.r[b.i], bond_pose(b, s), history_of_bond(s, k)));
    broken.back().cause = {};  // not by its loads
    b.broken = true;
    b.mode = broken.back().cause.mode;
  }
  for (const ParticleId p : particles) {
    s.v[p] = s.omega[p] = {};
    if (!s.spin.empty()) s.spin[p] = {};
  }
  std::erase_if(s.contact_history,
                [&s](const PairMemory& m) { return is_dropped(s, m.i) || is_dropped(s, m.j); });
  std::erase_if(s.fibre_history, [&goes](const FibreMemory& m) {
    return goes[m.a_i] != 0 || goes[m.a_j] != 0 || goes[m.b_i] != 0 || goes[m.b_j] != 0;
  });
  std::erase_if(s.wall_history, [&s](const WallMemory& m) { return is_dropped(s, m.p); });
  s.loads = s.damping = s.local_damping = {};
  return broken;
}

}  // namespace vbond
