#include "vbond/model/rigid_bodies.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "vbond/model/touching.hpp"

namespace vbond {
namespace {

/// Its vectors turned.
PairHistory turned(const Quatd& q, PairHistory h) {
  for (const std::size_t k : {0, 4, 8}) {
    const Vec3d x = rotate(q, Vec3d{h[k], h[k + 1], h[k + 2]});
    h[k] = x.x, h[k + 1] = x.y, h[k + 2] = x.z;
  }
  return h;
}

PairHistory without_damping(PairHistory h) {
  for (const std::size_t k : {4, 5, 6}) h[k] = 0.0;
  return h;
}

/// Calls visit(i, j, n, overlap) for all pairs that touch, and for those that adhesion holds beyond that.
template <class Visit>
void for_holding_pairs(const Model& model, const State& s, Visit&& visit) {
  for_touching_pairs(model, s, visit);
  if (model.contact.adhesion != AdhesionForm::jkr) return;
  for (const PairMemory& m : s.contact_history) {
    const double distance = norm(between(s, m.i, m.j, m.image_j));
    const double overlap = felt_overlap(model, s, m.i, m.j, m.image_j, distance);
    if (touch_history(m.history).a > 0.0 && !(overlap > 0.0)) visit(m.i, m.j, m.image_j, overlap);
  }
}

}  // namespace

std::vector<Carried> carried_by(const std::vector<Support>& supports) {
  std::map<ParticleId, std::int64_t> body_of;
  std::int64_t bodies = 0;
  for (const Support& s : supports) {
    if (!s.rigid) continue;
    const std::int64_t body = ++bodies;
    for (const ParticleId p : s.particles) {
      const auto [at, is_new] = body_of.emplace(p, body);
      const std::int64_t other = at->second;
      if (is_new || other == body) continue;
      for (auto& [q, of_q] : body_of)
        if (of_q == other) of_q = body;
    }
  }
  std::vector<Carried> carried;
  for (const auto& [p, body] : body_of) carried.push_back({p, body});
  return carried;
}

RigidBodies::RigidBodies(std::size_t particles, const std::vector<Carried>& carried) {
  if (carried.empty()) return;
  body_.resize(particles);
  for (const Carried& c : carried) body_[c.particle] = c.body;
}

BeforeHold::BeforeHold(const State& s)
    : carried_(s.carried),
      contact_history_(s.contact_history),
      books_(s.books),
      loads_{s.loads, s.damping, s.local_damping} {}

void BeforeHold::put_back(State& s) && {
  s.carried = std::move(carried_);
  s.contact_history = std::move(contact_history_);
  s.books = books_;
  s.loads = std::move(loads_[0]), s.damping = std::move(loads_[1]), s.local_damping = std::move(loads_[2]);
}

std::optional<BeforeHold> take_hold(const Model& model, const std::vector<Support>& supports, State& s) {
  return take_hold(
      model, supports, s, [](ParticleId) { return true; }, alone());
}

std::optional<BeforeHold> take_hold(const Model& model, const std::vector<Support>& supports, State& s,
                                    const std::function<bool(ParticleId)>& has, const Communicator& all) {
  std::vector<Carried> carried = carried_by(supports);
  if (carried == s.carried) return std::nullopt;
  BeforeHold before_hold(s);
  const RigidBodies before(model.particles(), s.carried), now(model.particles(), carried);
  s.carried.clear();  // so that all pairs are seen
  double gained = 0.0;
  for_holding_pairs(model, s, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    const bool was_out = before.are_one(i, j, n), is_out = now.are_one(i, j, n);
    if (was_out == is_out || !has(std::min(i, j))) return;
    const TouchForms forms = touch_forms(model.contact);
    const TouchNumbers<double> numbers = touch_numbers(model, i, j);
    double U = normal_energy(forms, numbers, reduced_radius(model.radius[i], model.radius[j]), overlap);
    if (const PairMemory* memory = memory_of(s, i, j, n))
      U += history_energy(forms, numbers, touch_history(memory->history));
    gained += was_out ? U : -U;
  });
  for (PairMemory& m : s.contact_history) {
    if (!has(std::min(m.i, m.j))) continue;
    const bool was_out = before.are_one(m.i, m.j, m.image_j), is_out = now.are_one(m.i, m.j, m.image_j);
    if (was_out && !is_out) m.history = turned(s.q[m.i], m.history);
    if (!was_out && is_out) m.history = without_damping(turned(conjugate(s.q[m.i]), m.history));
  }
  s.carried = std::move(carried);
  all.sum({&gained, 1});
  s.books.work_supports += gained;
  s.loads = s.damping = s.local_damping = {};  // of a stage under way that is given other supports
  return before_hold;
}

}  // namespace vbond
