#include "vbond/dynamics/capsule_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "vbond/core/disjoint_sets.hpp"
#include "vbond/core/images.hpp"
#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/physics/touch_mass.hpp"

namespace vbond {
namespace {

bool same_place(const FibrePlace& a, const FibrePlace& b) {
  return a.i == b.i && a.j == b.j && a.R == b.R;
}
bool same_places(const FibreContact& x, const FibreContact& y) {
  return same_place(x.a, y.a) && same_place(x.b, y.b);
}
/// Whether both pairs of places have a particle in common: a contact may have slid from one to the other
/// within a step. What repeats with the cell is the same contact wherever it is.
bool joined(const FibrePlace& a, const FibrePlace& b, const FibrePlace& now_a, const FibrePlace& now_b) {
  const auto share_end = [](const FibrePlace& x, const FibrePlace& y, const Image& n) {
    const ImageOf i = carried(y.i, n), j = carried(y.j, n);
    return x.i == i || x.i == j || x.j == i || x.j == j;
  };
  for (const ImageOf& was : {a.i, a.j})
    for (const ImageOf& is : {now_a.i, now_a.j})
      if (const Image n = was.image - is.image; was.particle == is.particle && share_end(b, now_b, n))
        return true;
  return false;
}
/// The order in which merge() leaves contacts.
bool comes_before(const FibreContact& x, const FibreContact& y) {
  const auto key = [](const FibreContact& c) { return std::tie(c.a.i, c.a.j, c.b.i, c.b.j, c.a.R, c.b.R); };
  return key(x) < key(y);
}

/// Those of a row stay in their order.
std::vector<Capsules::Share> in_order_of_rows(const std::vector<Capsules::Share>& shares) {
  std::vector<std::pair<std::size_t, std::size_t>> order;  // rows and places
  order.reserve(shares.size());
  for (std::size_t k = 0; k < shares.size(); ++k) order.emplace_back(shares[k].row, k);
  std::sort(order.begin(), order.end());
  std::vector<Capsules::Share> sorted;
  sorted.reserve(shares.size());
  for (const auto& [row, k] : order) sorted.push_back(shares[k]);
  return sorted;
}

/// Normals within 60 degrees: of a contact that has slid on, not of one on another side.
constexpr double same_side = 0.5;

}  // namespace

Capsules::Capsules(const Model& model, const Stage& stage, const Bodies& bodies, const CellEdges& cell)
    : model_(model),
      stage_(stage),
      bodies_(bodies),
      cell_(cell),
      forms_(fibre_forms(model.contact)),
      materials_(std::max<std::uint32_t>(1, static_cast<std::uint32_t>(model.materials.size()))) {
  if (!particles_touch(model.contact)) return;
  for (std::uint32_t first = 0; first < materials_; ++first)
    for (std::uint32_t second = 0; second < materials_; ++second)
      numbers_.push_back(touch_numbers(model.contact, model.materials, first, second));
}

void Capsules::bonds_changed(const PerBond<Bond>& bonds) {
  any_ = any_capsules(model_.contact, bonds);
  const FibreParts before = std::exchange(fibres_, any_ ? FibreParts(model_, bonds) : FibreParts());
  listed_ = listed_ && fibres_.parts() == before.parts();
  if (listed_) take_near_pairs();  // other bonds change who may touch, not who is near
  if (!any_ || listed_) return;
  masses_ = ContactMasses(model_, stage_.supports);
  double sum = 0.0;  // as of other contacts: few large balls must not fill the lists of many thin fibres
  for (const FibrePart& p : fibres_.parts()) sum += p.R;
  skin_ = 0.6 * sum / static_cast<double>(fibres_.parts().size());
}

void Capsules::refresh() {
  if (!any_) return;
  gone_ = listed_ ? way_since_listed() : std::numeric_limits<double>::infinity();
  if (!(gone_ < 0.5 * skin_)) list_near_pairs(), gone_ = 0.0;
  look_at_ = may_have_come_nearer_by(2.0 * gone_);  // each of two has gone so far at most
}

/// The first near pairs: those that were no farther apart than that as they were listed.
std::size_t Capsules::may_have_come_nearer_by(double way) const {
  const double limit = way + 1e-9 * skin_;  // as rounded
  const auto end = std::partition_point(near_.begin(), near_.end(),
                                        [limit](const FibrePair& pair) { return pair.gap <= limit; });
  return static_cast<std::size_t>(end - near_.begin());
}

void Capsules::list_near_pairs() {
  listed_ = false;
  near_.clear();
  auto r = finite_places();
  if (!r) return;  // the check of loads will tell
  near_bodies_ = fibres_.near_bodies(*r, cell_, skin_);
  listed_at_ = cell_;
  if (!cell_.empty())
    farthest_image_ =
        farthest_images(cell_, model_.cell.periodic, r->values(), fibres_.reach(*r, cell_) + 2.0 * skin_);
  r_listed_ = *std::move(r);
  listed_ = true;
  take_near_pairs();
}

/// From the bodies that are near.
void Capsules::take_near_pairs() {
  near_ = fibres_.near_pairs(near_bodies_, r_listed_, listed_at_, skin_);
  std::sort(near_.begin(), near_.end(), [](const FibrePair& a, const FibrePair& b) { return a.gap < b.gap; });
  apart_along_.assign(near_.size(), {});
}

/// Of a particle since near pairs were listed, and of images with the cell; infinite where one is nowhere.
double Capsules::way_since_listed() const {
  double farthest2 = 0.0;
  for (const ParticleId p : r_listed_.ids()) {
    const double way2 = norm2(between(r_listed_[p], bodies_.pose[row(p)].r));
    if (!(way2 <= farthest2)) farthest2 = way2;
    if (std::isnan(way2)) return std::numeric_limits<double>::infinity();
  }
  return std::sqrt(farthest2) + way_of_images();
}

/// Of all particles, if all are at finite places.
std::optional<PerParticle<Vec3d>> Capsules::finite_places() const {
  PerParticle<Vec3d> r(model_.particles());
  for (const ParticleId p : r.ids()) {
    r[p] = bodies_.pose[row(p)].r;
    if (!is_finite(r[p])) return std::nullopt;
  }
  return r;
}

/// How far images have gone with the cell since near pairs were listed.
double Capsules::way_of_images() const {
  double way = 0.0;
  for (std::size_t k = 0; k < cell_.size(); ++k)
    way += farthest_image_[k] * norm(cell_[k].along - listed_at_[k].along);
  return way;
}

Touching<double> Capsules::touching(const FibreContact& c) const {
  Touching<double> p = touching_of(model_, c, [this](const ImageOf& of) {
    return MovingPoint{place(of), velocity(of), bodies_.motion[row(of.particle)].omega};
  });
  p.m = 1.0 / (masses_.per_mass(c.a) + masses_.per_mass(c.b));
  undamp_if_none_is_free(p);
  return p;
}

const TouchNumbers<double>& Capsules::numbers(const FibreContact& c) const {
  return numbers_[model_.material_of(c.a.i.particle) * materials_ + model_.material_of(c.b.i.particle)];
}

/// All that overlap now, each thread looking at its share of near pairs. Two that are apart mostly are along
/// the line that they were apart along before.
std::vector<FibreContact> Capsules::find(const Team& team) {
  of_part_.resize(team.parts().size());
  team.for_parts([&](const Part& part) {
    std::vector<FibreContact>& found = of_part_[part.index];
    found.clear();
    const std::size_t n = look_at_, shares = of_part_.size();
    for (std::size_t k = n * part.index / shares; k < n * (part.index + 1) / shares; ++k) {
      const PlacedPair of = placed(fibres_.parts(), near_[k], [this](const ImageOf& p) { return place(p); });
      const double apart = (1.0 + 1e-9) * (of.x.R + of.y.R);  // as rounded
      if (farther_apart_along(apart_along_[k], of.x_i, of.x_j, of.y_i, of.y_j, apart)) continue;
      const NearestOnSegments at = of.nearest();
      if (const auto c = contact_at(near_[k], of, at))
        found.push_back(*c);
      else
        apart_along_[k] = between(on_segment(of.x_i, of.x_j, at.s), on_segment(of.y_i, of.y_j, at.t)) /
                          std::sqrt(at.distance2);
    }
  });
  std::vector<FibreContact> all;
  for (const auto& found : of_part_) all.insert(all.end(), found.begin(), found.end());
  merge(all);
  return all;
}

/// What was remembered goes to the contact at the same places; else to one that it may have slid to, by which
/// it is the likest. What nobody takes has parted. Only contacts of bodies remember.
std::vector<Capsules::Contact> Capsules::with_history(const std::vector<FibreContact>& found,
                                                      std::vector<Contact>& parted) {
  std::vector<Contact> now(found.size());
  std::vector<std::size_t> fresh;
  auto old = contacts_.begin();
  for (std::size_t k = 0; k < found.size(); ++k) {
    static_cast<FibreContact&>(now[k]) = found[k];
    while (old != contacts_.end() && comes_before(*old, found[k])) {
      if (old->body) parted.push_back(*old);
      ++old;
    }
    const bool same = old != contacts_.end() && same_places(*old, found[k]);
    if (same && old->body && found[k].body) {
      now[k].normal = old->normal, now[k].history = old->history;
      ++old;
    } else if (found[k].body) {
      fresh.push_back(k);
    }
  }
  for (; old != contacts_.end(); ++old)
    if (old->body) parted.push_back(*old);
  for (const std::size_t k : fresh) {
    const Vec3d n = touching(now[k]).n;
    auto best = parted.end();
    double likeness = same_side;
    for (auto c = parted.begin(); c != parted.end(); ++c) {
      const double of_c = dot(c->normal, n);
      const bool slid = of_c > 0.0 ? joined(c->a, c->b, now[k].a, now[k].b)
                                   : joined(c->a, c->b, now[k].b, now[k].a);  // seen from the other
      if (slid && std::abs(of_c) > likeness) likeness = std::abs(of_c), best = c;
    }
    if (best == parted.end()) continue;
    const bool turned = dot(best->normal, n) < 0.0;
    now[k].normal = turned ? -best->normal : best->normal;
    now[k].history = turned ? seen_from_the_other(best->history) : best->history;
    parted.erase(best);
  }
  return now;
}

/// In a region of overlap that reaches over several bonds, contacts of bodies press more than what is left
/// when the others have made up for it. Friction goes by the latter: its limit is this part of mu times the
/// force.
std::vector<double> Capsules::friction_shares(const std::vector<Touching<double>>& touchings) const {
  std::vector<double> share(contacts_.size(), 1.0);
  if (std::all_of(contacts_.begin(), contacts_.end(), [](const Contact& c) { return c.body; })) return share;
  using PairOfEnds = std::tuple<ParticleId, ParticleId, Image>;  // of both fibres, seen from the lower one
  std::vector<std::pair<PairOfEnds, std::uint32_t>> at;          // and contact
  for (std::uint32_t k = 0; k < contacts_.size(); ++k)
    for_shares(contacts_[k].a, [&](const ImageOf& p, double) {
      for_shares(contacts_[k].b, [&](const ImageOf& q, double) {
        at.emplace_back(std::min(PairOfEnds(p.particle, q.particle, q.image - p.image),
                                 PairOfEnds(q.particle, p.particle, p.image - q.image)),
                        k);
      });
    });
  std::sort(at.begin(), at.end());
  using Index = Id<struct FibreContactTag>;
  DisjointSets<Index> regions(contacts_.size());
  for (std::size_t k = 1; k < at.size(); ++k)
    if (at[k - 1].first == at[k].first) regions.join(Index{at[k - 1].second}, Index{at[k].second});
  std::vector<double> left(contacts_.size(), 0.0), bodies = left;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Touching<double>& p = touchings[k];
    const double N = normal_force(forms_, numbers(contacts_[k]), p.R, p.overlap).F;
    left[regions.smallest(Index{k}).value] += contacts_[k].weight * N;
    if (contacts_[k].body) bodies[regions.smallest(Index{k}).value] += N;
  }
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (const std::size_t r = regions.smallest(Index{k}).value; bodies[r] > 0.0)
      share[k] = std::clamp(left[r] / bodies[r], 0.0, 1.0);
  return share;
}

/// The loads of one contact, to shares_.
TouchLosses<double> Capsules::work_out(Contact& c, const Touching<double>& p, double friction_share,
                                       double dt) {
  TouchNumbers<double> n = numbers(c);
  n.friction *= friction_share;
  Vec3d F;
  TouchLosses<double> lost;
  int elastic = c.weight;  // so often the elastic force, along the normal
  if (c.body) {
    const TouchLoads<double> l = touch(forms_, n, p, dt, touch_history(c.history));
    if (c.history[3] > 0.0 && dot(c.normal, p.n) < -same_side)
      passed_ = told(c.first, c.second, p.overlap, std::min(c.a.R, c.b.R));
    F = l.F;
    deep_ = deep_ || p.overlap > (1.0 - deep_part) * (c.a.R + c.b.R);
    if (dt > 0.0) lost = l.lost;
    c.history = numbers_of(l.history);
    c.normal = p.n;
    --elastic;
  }
  if (elastic != 0) F -= (elastic * normal_force(forms_, n, p.R, p.overlap).F) * p.n;
  share_loads(c, p, F, [this](const ImageOf& q, const Vec3d& force, const Vec3d& moment) {
    shares_.push_back({row(q.particle), force, moment, q.image});
  });
  return lost;
}

TouchLosses<double> Capsules::work_out(const Team& team, double dt) {
  if (!any_) return {};
  std::vector<Contact> parted;
  contacts_ = with_history(find(team), parted);
  shares_.clear();
  passed_.reset();
  deep_ = false;
  TouchLosses<double> lost;
  std::vector<Touching<double>> touchings;
  for (const Contact& c : contacts_) touchings.push_back(touching(c));
  const std::vector<double> share = friction_shares(touchings);
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    lost += work_out(contacts_[k], touchings[k], share[k], dt);
  shares_ = in_order_of_rows(shares_);
  if (dt > 0.0)
    for (const Contact& c : parted)
      lost += lost_on_parting(forms_, numbers(c), touching(c), dt, touch_history(c.history));
  return lost;
}

void Capsules::add_loads(RowRange rows, LoadRow* load) const {
  auto s = std::lower_bound(shares_.begin(), shares_.end(), rows.first,
                            [](const Share& x, std::size_t first) { return x.row < first; });
  for (; s != shares_.end() && s->row < rows.last; ++s) load[s->row].F += s->F, load[s->row].M += s->M;
}

void Capsules::take_loads(LoadRow* load) const {
  for (const Share& s : shares_) load[s.row].F -= s.F, load[s.row].M -= s.M;
}

std::array<Vec3d, 3> Capsules::edges_times_force(std::size_t rows) const {
  std::array<Vec3d, 3> sum{};
  for (const Share& s : shares_) {
    if (s.row >= rows || s.image.is_itself()) continue;
    sum[0] += double(s.image.a) * s.F, sum[1] += double(s.image.b) * s.F, sum[2] += double(s.image.c) * s.F;
  }
  return sum;
}

Tensor Capsules::virial(const std::vector<Share>& shares) const {
  std::vector<const Share*> in_order;  // of particles, which all processes have: the sum moves the cell
  for (const Share& s : shares) in_order.push_back(&s);
  std::stable_sort(in_order.begin(), in_order.end(), [this](const Share* a, const Share* b) {
    return bodies_.order.particle[Row{a->row}] < bodies_.order.particle[Row{b->row}];
  });
  Tensor sum;
  for (const Share* s : in_order) sum += dyad(s->F, bodies_.pose[s->row].r + to_image(cell_, s->image));
  return sum;
}

double Capsules::energy() const {
  double U = 0.0;
  for (const Contact& c : contacts_) {
    const Touching<double> p = touching(c);
    const TouchNumbers<double>& n = numbers(c);
    U += c.weight * normal_energy(forms_, n, p.R, p.overlap);
    if (c.body) U += history_energy(forms_, n, touch_history(c.history));
  }
  return U;
}

std::vector<FibreMemory> Capsules::collect() const {
  std::vector<FibreMemory> memories;
  for (const Contact& c : contacts_) {
    if (!c.body) continue;
    memories.push_back(memory_at(c.a, c.b));
    memories.back().normal = c.normal, memories.back().history = c.history;
  }
  return memories;
}

void Capsules::restore(const std::vector<FibreMemory>& memories) {
  if (!any_) return;
  for (const FibreMemory& m : memories) {
    Contact c;
    std::tie(c.a, c.b) = places_of(m);
    c.first = c.second = 0, c.weight = 1, c.body = true;
    c.normal = m.normal, c.history = m.history;
    auto at = std::lower_bound(contacts_.begin(), contacts_.end(), c, comes_before);
    if (at == contacts_.end() || !same_places(*at, c))
      contacts_.insert(at, c);
    else
      at->normal = m.normal, at->history = m.history;
  }
}

}  // namespace vbond
