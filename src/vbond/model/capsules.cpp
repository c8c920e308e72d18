#include "vbond/model/capsules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "vbond/core/sized_points.hpp"

namespace vbond {

bool any_capsules(const ContactModel& contact, const PerBond<Bond>& bonds) {
  return particles_touch(contact) &&
         std::any_of(bonds.begin(), bonds.end(), [](const Bond& b) { return b.capsule > 0.0; });
}

std::vector<char> particles_of_fibres(std::size_t particles, const PerBond<Bond>& bonds) {
  std::vector<char> of_fibre;
  for (const Bond& b : bonds)
    if (b.capsule > 0.0) {
      of_fibre.resize(particles, 0);
      of_fibre[b.i.value] = of_fibre[b.j.value] = 1;
    }
  return of_fibre;
}

std::optional<CapsuleMistake> capsule_mistake(const ContactModel& contact, double capsule, double distance) {
  if (!particles_touch(contact))
    return CapsuleMistake{
        "nothing touches in this case: capsules are touched by other particles and capsules",
        "add [contact] with a law, and pairs = \"unbonded\", or leave capsule_radius out"};
  if (contact.adhesion != AdhesionForm::none)
    return CapsuleMistake{"capsules do not adhere: their contacts take no adhesion",
                          "leave contact.adhesion out, or capsule_radius"};
  if (contact.keeps_overlap)
    return CapsuleMistake{"capsules that a bond leaves as it breaks keep no overlap",
                          "use contact.overlap_at_break = \"felt\", or no capsule_radius"};
  if (!(capsule < distance))
    return CapsuleMistake{
        "the radius of a capsule must be smaller than the distance of its two particles: a bent fibre would "
        "touch itself",
        fmt::format("use capsule_radius below {:.6g}, better half of it, or longer bonds", distance)};
  return std::nullopt;
}

std::optional<CapsuleMistake> capsule_mistake(const Model& model, const Bond& bond, double distance) {
  if (!(bond.capsule > 0.0)) return std::nullopt;
  if (model.material_of(bond.i) != model.material_of(bond.j))
    return CapsuleMistake{"a capsule is of one material, and its two particles are of two",
                          "give both particles one material, or the bond no capsule_radius"};
  return capsule_mistake(model.contact, bond.capsule, distance);
}

FibreParts::FibreParts(const Model& model, const PerBond<Bond>& bonds)
    : bonded_balls_touch_(model.contact.pairs == ContactPairs::all),
      capsules_(model.particles(), 0),
      of_fibre_(particles_of_fibres(model.particles(), bonds)),
      start_(model.particles() + 1, 0) {
  of_fibre_.resize(model.particles(), 0);
  PerParticle<double> thinnest(model.radius);
  for (const Bond& b : bonds)
    if (!b.broken) ++start_[b.i.value + 1], ++start_[b.j.value + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  entries_.resize(start_.back());
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  for (const BondId k : bonds.ids()) {
    const Bond& b = bonds[k];
    if (b.broken) continue;
    const bool touches = b.capsule > 0.0;
    const auto part = touches ? static_cast<std::uint32_t>(parts_.size()) : none;
    entries_[next[b.i.value]++] = {b.j, part};
    entries_[next[b.j.value]++] = {b.i, part};
    if (!touches) continue;
    parts_.push_back({std::min(b.i, b.j), std::max(b.i, b.j), b.capsule, k});
    for (const ParticleId p : {b.i, b.j})
      thinnest[p] = capsules_[p]++ == 0 ? b.capsule : std::min(thinnest[p], b.capsule);
  }
  for (const ParticleId p : capsules_.ids())  // one with one capsule is its end and no more
    if (capsules_[p] != 1 && thinnest[p] > 0.0) parts_.push_back({p, p, thinnest[p], {}});
}

template <class Visit>
void FibreParts::for_capsules_of(ParticleId p, Visit visit) const {
  for (std::size_t e = start_[p.value]; e < start_[p.value + 1]; ++e)
    if (entries_[e].capsule != none) visit(parts_[entries_[e].capsule]);
}

bool FibreParts::bonded(ParticleId p, ParticleId o) const {
  for (std::size_t e = start_[p.value]; e < start_[p.value + 1]; ++e)
    if (entries_[e].other == o) return true;
  return false;
}

/// Two bodies; what is bonded to one end of the other does not touch it, so that a fibre may bend.
bool FibreParts::may_touch(const FibrePart& x, const FibrePart& y) const {
  if (x.i == y.i || x.i == y.j || x.j == y.i || x.j == y.j) return false;
  if (!x.is_capsule() && !y.is_capsule()) {
    if (of_fibre_[x.i.value] == 0 && of_fibre_[y.i.value] == 0) return false;  // Contacts sees to them
    return bonded_balls_touch_ || !bonded(x.i, y.i);
  }
  return !bonded(x.i, y.i) && !bonded(x.i, y.j) && !bonded(x.j, y.i) && !bonded(x.j, y.j);
}

/// Of a body against a particle within a fibre: 1 less the capsules there that the body may touch.
int FibreParts::weight_of_line(const FibrePart& body, ParticleId p) const {
  int faces = 0;
  for_capsules_of(p, [&](const FibrePart& c) { faces += may_touch(body, c) ? 1 : 0; });
  return faces > 0 ? 1 - faces : 0;
}

int FibreParts::weight(const FibrePart& x, const FibrePart& y) const {
  const bool body_x = is_body(x), body_y = is_body(y);
  if (body_x && body_y) return may_touch(x, y) ? 1 : 0;
  if (body_x) return weight_of_line(x, y.i);
  if (body_y) return weight_of_line(y, x.i);
  int faces = 0, lines = 0;
  for_capsules_of(x.i, [&](const FibrePart& c) {
    lines += weight_of_line(c, y.i);
    for_capsules_of(y.i, [&](const FibrePart& d) { faces += may_touch(c, d) ? 1 : 0; });
  });
  for_capsules_of(y.i, [&](const FibrePart& d) { lines += weight_of_line(d, x.i); });
  return faces > 0 ? 1 - faces - lines : 0;
}

std::vector<FibrePair> FibreParts::near_pairs(const PerParticle<Vec3d>& r, double margin) const {
  std::vector<Vec3d> middle;
  std::vector<double> reach;
  for (const FibrePart& p : parts_) {
    middle.push_back(0.5 * (r[p.i] + r[p.j]));
    reach.push_back(0.5 * norm(between(r, p.i, p.j)) + p.R);
  }
  std::vector<FibrePair> pairs;
  for_overlapping_pairs(middle, reach, margin, [&](std::size_t k, std::size_t l, double) {
    const FibrePart &x = parts_[k], &y = parts_[l];
    if (!x.is_capsule() && !y.is_capsule() && of_fibre_[x.i.value] == 0 && of_fibre_[y.i.value] == 0) return;
    const NearestOnSegments at = nearest_on_segments(r[x.i], r[x.j], r[y.i], r[y.j]);
    if (at.distance2 > sq(x.R + y.R + margin)) return;
    const int w = weight(x, y);
    if (w != 0)
      pairs.push_back(
          {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(l), w, is_body(x) && is_body(y)});
  });
  return pairs;
}

std::string FibreParts::name_of(std::uint32_t part) const {
  const FibrePart& p = parts_[part];
  if (!p.is_capsule()) return fmt::format("particle {}", p.i.value);
  return fmt::format("bond {} (particles {}, {})", p.bond.value, p.i.value, p.j.value);
}

void merge(std::vector<FibreContact>& contacts) {
  const auto place = [](const FibreContact& c) {
    return std::tuple(c.a.i, c.a.j, c.b.i, c.b.j, c.a.R, c.b.R);
  };
  const auto key = [&](const FibreContact& c) {  // those of bodies first, in order of their parts
    return std::tuple_cat(place(c), std::tuple(!c.body, c.first, c.second));
  };
  std::sort(contacts.begin(), contacts.end(),
            [&](const FibreContact& x, const FibreContact& y) { return key(x) < key(y); });
  std::size_t merged = 0;
  for (std::size_t k = 0; k < contacts.size();) {
    FibreContact all = contacts[k];
    for (++k; k < contacts.size() && place(contacts[k]) == place(all); ++k) all.weight += contacts[k].weight;
    all.body = all.body && all.weight > 0;
    if (all.weight != 0) contacts[merged++] = all;
  }
  contacts.resize(merged);
}

std::vector<FibreContact> fibre_contacts(const Model& model, const PerBond<Bond>& bonds,
                                         const PerParticle<Vec3d>& r) {
  std::vector<FibreContact> contacts;
  if (!any_capsules(model.contact, bonds)) return contacts;
  const FibreParts fibres(model, bonds);
  for (const FibrePair& pair : fibres.near_pairs(r, 0.0))
    if (const auto c = contact_of(fibres.parts(), pair, [&r](ParticleId p) { return r[p]; }))
      contacts.push_back(*c);
  merge(contacts);
  return contacts;
}

double fibre_energy(const Model& model, const PerBond<Bond>& bonds, const PerParticle<Vec3d>& r) {
  double U = 0.0;
  const TouchForms forms = fibre_forms(model.contact);
  for (const FibreContact& c : fibre_contacts(model, bonds, r)) {
    const Touching<double> p = touching_of(model, c, [&r](ParticleId q) {
      return MovingPoint{r[q], {}, {}};
    });
    U += c.weight * normal_energy(forms, touch_numbers(model, c.a.i, c.b.i), p.R, p.overlap);
  }
  return U;
}

}  // namespace vbond
