#include "vbond/dynamics/contacts.hpp"

#include <algorithm>
#include <utility>

namespace vbond {
namespace {

ContactRule rule_of(const ContactModel& contact, const PerRow<double>& radius) {
  using Kind = ContactRule::Kind;
  const auto [min, max] = std::minmax_element(radius.begin(), radius.end());
  const Kind if_not_equal = contact.law == ContactLaw::hertz ? Kind::by_radii : Kind::same_law;
  return {.kind = *min == *max ? Kind::alike : if_not_equal,
          .law = contact_law(contact, *max, *max),
          .E_star = effective_modulus(contact.E, contact.nu),
          .radius = radius.data()};
}

}  // namespace

Contacts::Contacts(const Model& model, const Order& order, const BondIndex& index, const StepKernel& kernel)
    : model_(model), order_(order), kernel_(kernel) {
  if (model.contact.law == ContactLaw::none || model.particles() == 0) return;
  for (const ParticleId p : order.particle) radius_.push_back(model.radius[p]);
  const double R_max = *std::max_element(radius_.begin(), radius_.end());
  if (!(R_max > 0.0)) return;
  rule_ = rule_of(model.contact, radius_);

  NeighbourList::Keep keep;
  if (model.contact.pairs == ContactPairs::unbonded)
    keep = [&order, &index](Row i, Row* first, Row* last) {
      return std::remove_if(first, last,
                            [&, p = order.particle[i]](Row j) { return index.bonded(p, order.particle[j]); });
    };
  const double skin = 0.4 * R_max;  // a fifth of the reach: rebuilds are rare, lists stay short
  list_.emplace(radius_, skin, std::move(keep));
}

void Contacts::refresh(std::span<const PoseRow> pose, const Team& team, double way) {
  if (!list_) return;
  if (!remembers()) {
    list_->refresh(pose, team, way);
    return;
  }
  std::vector<PairMemory> memories;
  if (!list_->refresh(pose, team, way, [&] { memories = collect(); })) return;
  restore(memories);
}

std::vector<PairMemory> Contacts::collect() const {
  std::vector<PairMemory> memories;
  for (std::size_t k = 0; k < radius_.size() && !history_.empty(); ++k)
    for (const Row j : list_->of(Row{k})) {
      const ParticleId p = order_.particle[Row{k}], o = order_.particle[j];
      const PairHistory& history = history_[*list_->place_of(Row{k}, j)];
      if (p < o && history != PairHistory{}) memories.push_back({p, o, history});
    }
  std::sort(memories.begin(), memories.end(), [](const PairMemory& a, const PairMemory& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  });
  return memories;
}

void Contacts::restore(const std::vector<PairMemory>& memories) {
  if (!remembers()) return;
  history_.assign(list_->places(), {});
  for (const PairMemory& m : memories) {
    const Row i = order_.row[m.i], j = order_.row[m.j];
    if (const auto place = list_->place_of(i, j)) history_[*place] = m.history;
    if (const auto place = list_->place_of(j, i)) history_[*place] = m.history;
  }
}

PairSweep Contacts::sweep(RowRange rows, const Bodies& b) const {
  return {.rows = rows,
          .near = list_->rows(),
          .pose = b.pose.data(),
          .rates = b.rates.data(),
          .particle = order_.particle.data(),
          .radius = radius_.data(),
          .mass = b.mass.data(),
          .load = nullptr,
          .damping = nullptr,
          .history = nullptr,
          .dt = 0.0};
}

double Contacts::add_inelastic(RowRange rows, const Bodies& bodies, LoadRow* load, LoadRow* damping,
                               double dt) {
  PairSweep s = sweep(rows, bodies);
  s.load = load, s.damping = damping, s.dt = dt;
  if (remembers()) s.history = history_.data();
  return inelastic()->add_loads(inelastic()->law, s);
}

void Contacts::bonds_changed() {
  if (list_ && model_.contact.pairs == ContactPairs::unbonded) list_->invalidate();
}

Contacts::Touch Contacts::unbonded(Row i, Row j, const Bodies& bodies) {
  if (!list_ || model_.contact.pairs != ContactPairs::unbonded) return {};
  if (remembers()) {
    const std::vector<PairMemory> memories = collect();
    list_->add(i, j);
    restore(memories);
  } else {
    list_->add(i, j);
  }
  const Vec3d r_ij = bodies.pose[j.value].r - bodies.pose[i.value].r;
  const double distance = norm(r_ij), overlap = radius_[i] + radius_[j] - distance;
  if (!(overlap > 0.0)) return {};
  const HertzContact<double> h = law(i, j);
  return {contact_energy(h, overlap), -(contact_force(h, overlap) / distance) * r_ij};
}

HertzContact<double> Contacts::law(Row i, Row j) const {
  return contact_law(model_.contact, radius_[i], radius_[j]);
}

bool Contacts::add_loads(RowRange rows, const PoseRow* pose, LoadRow* load) const {
  return list_ && kernel_.add_contact_loads(rule_, list_->rows(), rows, pose, load);
}

std::vector<std::pair<Row, Row>> Contacts::deep_pairs(RowRange rows, std::span<const PoseRow> pose) const {
  std::vector<std::pair<Row, Row>> deep;
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (const Row j : list_->of(Row{k}))
      if (k < j.value && norm2(pose[j.value].r - pose[k].r) < sq(deep_part * (radius_[Row{k}] + radius_[j])))
        deep.emplace_back(Row{k}, j);
  return deep;
}

double Contacts::energy(std::span<const PoseRow> pose) const {
  double U = 0.0;
  if (!list_) return U;
  for (const Row i : radius_.ids())
    for (const Row j : list_->of(i)) {
      const double overlap = radius_[i] + radius_[j] - norm(pose[j.value].r - pose[i.value].r);
      if (i < j && overlap > 0.0) U += contact_energy(law(i, j), overlap);
    }
  return U;
}

double Contacts::inelastic_energy(Row i, Row j, const Bodies& bodies) const {
  if (!remembers()) return 0.0;
  const RowsOfPair p = rows_of_pair(sweep({0, 0}, bodies), i.value, j.value);
  const auto place = list_->place_of(i, j);
  return p.touch && place ? inelastic()->energy(inelastic()->law, p.pair, history_[*place]) : 0.0;
}

double Contacts::inelastic_energy(const Bodies& bodies) const {
  double U = 0.0;
  if (!remembers()) return U;
  for (const Row i : radius_.ids())
    for (const Row j : list_->of(i))
      if (i < j) U += inelastic_energy(i, j, bodies);
  return U;
}

}  // namespace vbond
