#include "vbond/dynamics/contacts.hpp"

#include <algorithm>
#include <utility>

namespace vbond {
namespace {

ContactRule rule_of(const ContactModel& contact, const PerParticle<double>& all,
                    const PerRow<double>& radius) {
  using Kind = ContactRule::Kind;
  const auto [min, max] = std::minmax_element(all.begin(), all.end());
  const Kind if_not_equal = contact.law == ContactLaw::hertz ? Kind::by_radii : Kind::same_law;
  return {.kind = *min == *max ? Kind::alike : if_not_equal,
          .law = contact_law(contact, *max, *max),
          .E_star = effective_modulus(contact.E, contact.nu),
          .radius = radius.data()};
}

}  // namespace

Contacts::Contacts(const Model& model, const Order& order, const BondIndex& index, const StepKernel& kernel,
                   const std::vector<Support>& supports)
    : model_(model), order_(order), index_(index), kernel_(kernel) {
  if (!particles_touch(model.contact) || model.particles() == 0) return;
  for (Row k{0}; k.value < order.known; ++k.value) radius_.push_back(model.radius[order.particle[k]]);
  const double R_max = *std::max_element(model.radius.begin(), model.radius.end());
  if (!(R_max > 0.0)) return;
  if (is_elastic(model.contact, model.materials))
    rule_ = rule_of(model.contact, model.radius, radius_);
  else
    touches_.emplace(model, ContactMasses(model, supports), order, kernel);

  bodies_ = RigidBodies(model.particles(), carried_by(supports));
  const auto keep = [&order, &index, bodies = bodies_,
                     unbonded = model.contact.pairs == ContactPairs::unbonded](Row i, Row* first, Row* last) {
    const ParticleId p = order.particle[i];
    if (order.own < order.known)
      last = std::remove_if(first, last, [&](Row j) { return !is_worked_out_here(order, i, j); });
    if (index.of_fibre(p)) return first;  // Capsules sees to it
    if (bodies.any())
      last = std::remove_if(first, last, [&](Row j) {
        return bodies.are_one(p, order.particle[j], order.image(j) - order.image(i));
      });
    if (index.any_fibres())
      last = std::remove_if(first, last, [&](Row j) { return index.of_fibre(order.particle[j]); });
    if (!unbonded) return last;
    return std::remove_if(first, last, [&](Row j) {
      return index.bonded(p, order.particle[j], order.image(j) - order.image(i));
    });
  };
  // For equal radii a fifth of the reach: rebuilds are rare, lists stay short. Where sizes differ small
  // particles are many, and a skin of the large ones would fill their lists.
  double R_sum = 0.0;
  for (const double R : model.radius) R_sum += R;
  const double skin = 0.4 * R_sum / static_cast<double>(model.particles());
  reach_ = 2.0 * R_max + (touches_ ? touches_->reach() : 0.0) + skin;
  PerRow<double> reaching = radius_;
  if (touches_)
    for (const Row k : reaching.ids()) reaching[k] += 0.5 * touches_->reach();
  list_.emplace(std::move(reaching), skin, keep);
}

void Contacts::refresh(std::span<const PoseRow> pose, const Team& team, double way) {
  if (!list_) return;
  const bool anew = list_->refresh(pose, team, way);
  if (touches_ && anew) touches_->list(*list_, team);
}

void Contacts::bonds_changed() {
  if (list_ && (model_.contact.pairs == ContactPairs::unbonded || index_.any_fibres())) list_->invalidate();
}

Contacts::Touch Contacts::unbonded(Row i, Row j, const Bodies& bodies) {
  if (!list_ || model_.contact.pairs != ContactPairs::unbonded) return {};
  if (std::max(i, j).value >= order_.known) return {};  // of other parts
  if (index_.of_fibre(order_.particle[i]) || index_.of_fibre(order_.particle[j])) return {};
  if (are_one(i, j)) {
    unbonded_in_body(i, j, bodies);
    return {};
  }
  if (is_worked_out_here(order_, i, j)) {
    list_->add(i, j);
    if (touches_) unbonded_.emplace_back(i, j);
  }
  if (i.value >= order_.own) return {};
  const Vec3d r_ij = bodies.between(i, j);
  const double distance = norm(r_ij), overlap = radius_[i] + radius_[j] - distance;
  if (!(overlap > 0.0) || model_.contact.keeps_overlap) return {};
  if (touches_) return {touches_->energy(i, j, bodies), touches_->first_force(i, j, bodies)};
  const HertzContact<double> h = contact_law(model_.contact, radius_[i], radius_[j]);
  return {contact_energy(h, overlap), -(contact_force(h, overlap) / distance) * r_ij};
}

/// A pair of one rigid body, which may be one no more in a later stage.
void Contacts::unbonded_in_body(Row i, Row j, const Bodies& bodies) {
  const auto [p, q] = std::minmax(order_.particle[i], order_.particle[j]);
  std::erase_if(at_rest_, [p = p, q = q](const PairMemory& m) { return m.i == p && m.j == q; });
  const double overlap = radius_[i] + radius_[j] - norm(bodies.between(i, j));
  if (model_.contact.keeps_overlap && overlap > 0.0 && is_worked_out_here(order_, i, j))
    at_rest_.push_back({.i = p, .j = q, .kept = overlap});
}

std::vector<PairMemory> Contacts::collect() const {
  if (!touches_) return {};
  std::vector<PairMemory> all = touches_->collect();
  if (at_rest_.empty()) return all;
  const bool unbonded = model_.contact.pairs == ContactPairs::unbonded;
  for (const PairMemory& m : at_rest_)
    if (!unbonded || !index_.bonded(m.i, m.j)) all.push_back(m);
  std::sort(all.begin(), all.end(),
            [](const PairMemory& a, const PairMemory& b) { return place_of(a) < place_of(b); });
  return all;
}

void Contacts::restore(const std::vector<PairMemory>& memories) {
  if (!touches_) return;
  touches_->restore(memories);
  at_rest_.clear();
  for (const PairMemory& m : memories)
    if (bodies_.are_one(m.i, m.j, m.image_j) && order_.has(m.i)) at_rest_.push_back(m);
}

void Contacts::list_unbonded(const Bodies& bodies, const Team& team) {
  if (unbonded_.empty()) return;
  touches_->list(*list_, team);
  for (const auto& [i, j] : unbonded_) {
    const double distance = norm(bodies.between(i, j));
    touches_->keep_overlap(i, j, std::max(0.0, radius_[i] + radius_[j] - distance));
    if (model_.contact.adhesion != AdhesionForm::none && !model_.contact.keeps_overlap)
      touches_->note_touching(i, j, bodies);
  }
  unbonded_.clear();
}

bool Contacts::add_loads(RowRange rows, const PoseRow* pose, LoadRow* load) {
  if (!touches_) return list_ && kernel_.add_contact_loads(rule_, list_->rows(), rows, pose, load);
  touches_->add_loads(rows, load);
  return false;  // told by work_out()
}

std::vector<std::pair<Row, Row>> Contacts::deep_pairs(RowRange rows, std::span<const PoseRow> pose) const {
  std::vector<std::pair<Row, Row>> deep;
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (const Row j : list_->of(Row{k}))
      if (k < j.value &&
          norm2(between(pose[k], pose[j.value])) < sq(deep_part * (radius_[Row{k}] + radius_[j])))
        deep.emplace_back(Row{k}, j);
  return deep;
}

double Contacts::energy(Row i, Row j, const Bodies& bodies) const {
  if (!list_ || are_one(i, j)) return 0.0;
  if (touches_) return touches_->energy(i, j, bodies);
  const double overlap = radius_[i] + radius_[j] - norm(bodies.between(i, j));
  return overlap > 0.0 ? contact_energy(contact_law(model_.contact, radius_[i], radius_[j]), overlap) : 0.0;
}

double Contacts::energy(const Bodies& bodies) const {
  if (touches_) return touches_->energy(bodies);
  double U = 0.0;
  if (!list_) return U;
  for (const Row i : radius_.ids())
    for (const Row j : list_->of(i))
      if (i < j) U += energy(i, j, bodies);
  return U;
}

}  // namespace vbond
