#include "vbond/model/capsules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"

namespace vbond {

bool any_capsules(const ContactModel& contact, const PerBond<Bond>& bonds) {
  return particles_touch(contact) &&
         std::any_of(bonds.begin(), bonds.end(), [](const Bond& b) { return capsule_of(b) > 0.0; });
}

std::vector<char> particles_of_fibres(std::size_t particles, const PerBond<Bond>& bonds) {
  std::vector<char> of_fibre;
  for (const Bond& b : bonds)
    if (capsule_of(b) > 0.0) {
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
  if (!(capsule_of(bond) > 0.0)) return std::nullopt;
  if (model.material_of(bond.i) != model.material_of(bond.j))
    return CapsuleMistake{"a capsule is of one material, and its two particles are of two",
                          "give both particles one material, or the bond no capsule_radius"};
  return capsule_mistake(model.contact, capsule_of(bond), distance);
}

namespace {

bool overlap(const BoundingBox& a, const BoundingBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

}  // namespace

FibreContact in_order(const FibreContact& contact) {
  const auto begun_by = [](const FibrePlace& first, const FibrePlace& second) {
    const Image n = -first.i.image;
    FibrePlace a = first, b = second;
    a.i = carried(a.i, n), a.j = carried(a.j, n), b.i = carried(b.i, n), b.j = carried(b.j, n);
    return std::pair(a, b);
  };
  const auto ends = [](const std::pair<FibrePlace, FibrePlace>& p) {
    return std::tuple(p.first.i, p.first.j, p.second.i, p.second.j);
  };
  const auto one_way = begun_by(contact.a, contact.b), other_way = begun_by(contact.b, contact.a);
  FibreContact c = contact;
  std::tie(c.a, c.b) = one_way;
  if (!(ends(other_way) < ends(one_way))) return c;
  std::tie(c.a, c.b) = other_way;
  std::swap(c.first, c.second);
  return c;
}

FibreParts::FibreParts(const Model& model, const PerBond<Bond>& bonds)
    : periodic_(model.cell.periodic),
      bonded_balls_touch_(model.contact.pairs == ContactPairs::all),
      capsules_(model.particles(), 0),
      within_(model.particles(), none),
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
    const bool touches = capsule_of(b) > 0.0;
    const auto part = touches ? static_cast<std::uint32_t>(parts_.size()) : none;
    const bool i_first = b.i < b.j || (b.i == b.j && image_of_j(b) > Image{});
    entries_[next[b.i.value]++] = {{b.j, image_of_j(b)}, part, i_first ? Image{} : image_of_j(b)};
    entries_[next[b.j.value]++] = {{b.i, -image_of_j(b)}, part, i_first ? -image_of_j(b) : Image{}};
    if (!touches) continue;
    if (i_first)
      parts_.push_back({{b.i, {}}, {b.j, image_of_j(b)}, capsule_of(b), k});
    else
      parts_.push_back({{b.j, {}}, {b.i, -image_of_j(b)}, capsule_of(b), k});
    for (const ParticleId p : {b.i, b.j})
      thinnest[p] = capsules_[p]++ == 0 ? capsule_of(b) : std::min(thinnest[p], capsule_of(b));
  }
  for (const ParticleId p : capsules_.ids())  // one with one capsule is its end and no more
    if (capsules_[p] != 1 && thinnest[p] > 0.0) {
      if (capsules_[p] > 1) within_[p] = static_cast<std::uint32_t>(parts_.size());
      parts_.push_back({{p, {}}, {p, {}}, thinnest[p], {}});
    }
}

template <class Visit>
void FibreParts::for_capsules_of(const ImageOf& p, Visit visit) const {
  for (std::size_t e = start_[p.particle.value]; e < start_[p.particle.value + 1]; ++e)
    if (entries_[e].capsule != none)
      visit(carried(parts_[entries_[e].capsule], p.image + entries_[e].of_part));
}

bool FibreParts::bonded(const ImageOf& p, const ImageOf& o) const {
  const ImageOf other = carried(o, -p.image);
  for (std::size_t e = start_[p.particle.value]; e < start_[p.particle.value + 1]; ++e)
    if (entries_[e].other == other) return true;
  return false;
}

bool FibreParts::may_touch(const FibrePart& x, const FibrePart& y) const {
  if (x.i == y.i || x.i == y.j || x.j == y.i || x.j == y.j) return false;
  if (!x.is_capsule() && !y.is_capsule()) {
    if (!is_of_fibre(x) && !is_of_fibre(y)) return false;  // Contacts sees to them
    return bonded_balls_touch_ || !bonded(x.i, y.i);
  }
  return !bonded(x.i, y.i) && !bonded(x.i, y.j) && !bonded(x.j, y.i) && !bonded(x.j, y.j);
}

/// Of a body against a particle within a fibre: 1 less the capsules there that the body may touch.
int FibreParts::weight_of_line(const FibrePart& body, const ImageOf& p) const {
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

/// Between one part and image n of another; < 0: they overlap.
double FibreParts::gap(std::uint32_t first, std::uint32_t second, const Image& n, const PerParticle<Vec3d>& r,
                       const CellEdges& cell) const {
  const FibrePart &x = parts_[first], y = carried(parts_[second], n);
  const auto at = [&](const ImageOf& p) { return place_of(r, cell, p); };
  return std::sqrt(nearest_on_segments(at(x.i), at(x.j), at(y.i), at(y.j)).distance2) - (x.R + y.R);
}

std::vector<FibrePair> FibreParts::near_bodies(const PerParticle<Vec3d>& r, const CellEdges& cell,
                                               double margin) const {
  std::vector<Vec3d> middle;
  std::vector<double> reach;
  std::vector<BoundingBox> box;  // with what may touch
  std::vector<std::uint32_t> bodies;
  for (std::uint32_t k = 0; k < parts_.size(); ++k) {
    const FibrePart& p = parts_[k];
    if (!is_body(p)) continue;
    const Vec3d r_i = place_of(r, cell, p.i), r_j = place_of(r, cell, p.j);
    bodies.push_back(k);
    middle.push_back(0.5 * (r_i + r_j));
    reach.push_back(0.5 * norm(between(r_i, r_j)) + p.R);
    box.emplace_back();
    for (const Vec3d& end : {r_i, r_j}) box.back().add(end, (1.0 + 1e-9) * p.R + 0.5 * margin);
  }
  std::vector<FibrePair> near;
  for_overlapping_images(cell, periodic_, middle, reach, margin,
                         [&](std::size_t a, std::size_t b, const Image& n, double) {
                           const std::uint32_t k = bodies[a], l = bodies[b];
                           if (!is_of_fibre(parts_[k]) && !is_of_fibre(parts_[l])) return;
                           if (n.is_itself() && !overlap(box[a], box[b])) return;
                           if (const double apart = gap(k, l, n, r, cell); apart <= margin)
                             near.push_back({k, l, n, 0, true, apart});
                         });
  return near;
}

/// A particle within fibres is nearer to nobody than its capsules are. So what it is near to follows from
/// them, and it counts only where they may touch.
std::vector<FibrePair> FibreParts::near_pairs(const std::vector<FibrePair>& bodies,
                                              const PerParticle<Vec3d>& r, const CellEdges& cell,
                                              double margin) const {
  std::vector<FibrePair> pairs;
  std::vector<std::tuple<std::uint32_t, std::uint32_t, Image>> within;  // pairs with particles within fibres
  for (FibrePair pair : bodies) {
    pair.weight = weight(parts_[pair.first], carried(parts_[pair.second], pair.of_second));
    if (pair.weight == 0) continue;
    pairs.push_back(pair);
    add_particles_within(pair.first, pair.second, pair.of_second, within);
  }
  std::sort(within.begin(), within.end());
  within.erase(std::unique(within.begin(), within.end()), within.end());
  for (const auto& [k, l, n] : within) {
    const double apart = gap(k, l, n, r, cell);
    if (!(apart <= margin)) continue;
    const int w = weight(parts_[k], carried(parts_[l], n));
    if (w != 0) pairs.push_back({k, l, n, w, false, apart});
  }
  return pairs;
}

/// Of two bodies that are near, the pairs of each with particles within fibres at the ends of the other, and
/// of these; the part with the lower number comes first.
template <class Pairs>
void FibreParts::add_particles_within(std::uint32_t first, std::uint32_t second, const Image& n,
                                      Pairs& pairs) const {
  const auto for_particles_of = [this](const FibrePart& body, auto visit) {
    for (const ImageOf& end : {body.i, body.j})
      if (const std::uint32_t part = within_[end.particle]; part != none) visit(part, end.image);
  };
  const auto add = [&pairs](std::uint32_t k, std::uint32_t l, const Image& of_l) {
    if (l < k || (k == l && of_l < -of_l)) return pairs.emplace_back(l, k, -of_l), void();
    pairs.emplace_back(k, l, of_l);
  };
  const FibrePart &x = parts_[first], y = carried(parts_[second], n);
  for_particles_of(x, [&](std::uint32_t p, const Image& of_p) {
    add(second, p, of_p - n);
    for_particles_of(y, [&](std::uint32_t q, const Image& of_q) { add(p, q, of_q - of_p); });
  });
  for_particles_of(y, [&](std::uint32_t q, const Image& of_q) { add(first, q, of_q); });
}

double FibreParts::reach(const PerParticle<Vec3d>& r, const CellEdges& cell) const {
  double farthest = 0.0;
  for (const FibrePart& p : parts_)
    farthest = std::max(farthest, norm(between(r, cell, p.i.particle, p.j.particle, p.j.image)) + p.R);
  return 2.0 * farthest;
}

std::string FibreParts::name_of(std::uint32_t part) const {
  const FibrePart& p = parts_[part];
  if (!p.is_capsule()) return fmt::format("particle {}", p.i.particle.value);
  return fmt::format("bond {} (particles {}, {})", p.bond.value, p.i.particle.value, p.j.particle.value);
}

void merge(std::vector<FibreContact>& contacts) {
  const auto place = [](const FibreContact& c) { return std::tie(c.a.i, c.a.j, c.b.i, c.b.j, c.a.R, c.b.R); };
  const auto parts = [](const FibreContact& c) { return std::tuple(!c.body, c.first, c.second); };
  struct Sorted {
    std::uint64_t ends;  // of a, by which most differ: a.i is a particle itself
    const FibreContact* contact;
  };
  std::vector<Sorted> sorted;
  sorted.reserve(contacts.size());
  for (const FibreContact& c : contacts)
    sorted.push_back({std::uint64_t{c.a.i.particle.value} << 32 | c.a.j.particle.value, &c});
  std::sort(sorted.begin(), sorted.end(), [&](const Sorted& x, const Sorted& y) {
    if (x.ends != y.ends) return x.ends < y.ends;
    const auto order = place(*x.contact) <=> place(*y.contact);
    return order != 0 ? order < 0 : parts(*x.contact) < parts(*y.contact);  // those of bodies first
  });
  std::vector<FibreContact> merged;
  merged.reserve(contacts.size());
  for (std::size_t k = 0; k < sorted.size();) {
    FibreContact all = *sorted[k].contact;
    for (++k; k < sorted.size() && place(*sorted[k].contact) == place(all); ++k)
      all.weight += sorted[k].contact->weight;
    all.body = all.body && all.weight > 0;
    if (all.weight != 0) merged.push_back(all);
  }
  contacts = std::move(merged);
}

std::vector<FibreContact> fibre_contacts(const Model& model, const State& s) {
  std::vector<FibreContact> contacts;
  if (!any_capsules(model.contact, s.bonds)) return contacts;
  const FibreParts fibres(model, s.bonds);
  const auto at = [&s](const ImageOf& p) { return place_of(s.r, s.cell, p); };
  for (const FibrePair& pair : fibres.near_pairs(s.r, s.cell, 0.0))
    if (const auto c = contact_of(fibres.parts(), pair, at)) contacts.push_back(*c);
  merge(contacts);
  return contacts;
}

std::vector<FibreTouch> fibre_touches(const Model& model, const State& state) {
  using Places = std::tuple<ImageOf, ImageOf, ImageOf, ImageOf, double, double>;
  const auto key = [](const FibrePlace& a, const FibrePlace& b) {
    return Places{a.i, a.j, b.i, b.j, a.s, b.s};
  };
  std::map<Places, const PairHistory*> memories;
  for (const FibreMemory& m : state.fibre_history) {
    const auto [a, b] = places_of(m);
    memories[key(a, b)] = &m.history;
  }
  std::vector<FibreTouch> touches;
  for (const FibreContact& c : fibre_contacts(model, state)) {
    touches.push_back({c, touching_of(model, c, [&state](const ImageOf& p) { return point_of(state, p); })});
    const auto memory = memories.find(key(c.a, c.b));
    if (c.body && memory != memories.end()) touches.back().history = *memory->second;
  }
  return touches;
}

double fibre_energy(const Model& model, const State& state) {
  double U = 0.0;
  const TouchForms forms = fibre_forms(model.contact);
  for (const auto& [c, p, history] : fibre_touches(model, state))
    U +=
        c.weight * normal_energy(forms, touch_numbers(model, c.a.i.particle, c.b.i.particle), p.R, p.overlap);
  return U;
}

}  // namespace vbond
