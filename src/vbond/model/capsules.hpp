#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/segments.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

// Bonds that touch as capsules: which touch, and where. Derivation: docs/contacts.md, "Fibres". In a periodic
// body what touches may be images: all ends of capsules are particles or images of them.
namespace vbond {

/// Where a fibre is touched: on the axis of a bond, at r_i + s (r_j - r_i), i before j; or at a particle,
/// i == j.
struct FibrePlace {
  ImageOf i, j;
  double s = 0;
  double R = 0;  ///< radius of the fibre there  [length]
};

/// What touches: the capsule of a bond, i before j in order of particles and images, or a particle, i == j.
struct FibrePart {
  ImageOf i, j;
  double R = 0;  ///< of a particle with capsules that of the thinnest  [length]
  BondId bond{};
  bool is_capsule() const { return i != j; }
  friend bool operator==(const FibrePart&, const FibrePart&) = default;
};
/// Its image n.
inline FibrePart carried(FibrePart part, const Image& n) {
  part.i = carried(part.i, n), part.j = carried(part.j, n);
  return part;
}

/// A part and an image of another, and how often their nearest points count, see docs/contacts.md: 1 for two
/// bodies (a capsule, or a particle without one), and for the particles within fibres what makes up for
/// counting them with each of their capsules.
struct FibrePair {
  std::uint32_t first, second;  ///< parts
  Image of_second;
  int weight;
  bool bodies;
  double gap;  ///< between the two as they were found; < 0: they overlap  [length]
};

/// A pair of nearest points, counted `weight` times. It has friction and damping if it is a `body` contact:
/// two bodies are nearest there, and nothing else makes up for it.
struct FibreContact {
  FibrePlace a, b;              ///< a before b, see in_order()
  std::uint32_t first, second;  ///< parts, bodies if it is one
  int weight;
  bool body;
};

/// The same contact with places in an order by which it is known again: a.i is a particle itself, and of the
/// two ways to have that the one whose ends come first.
FibreContact in_order(const FibreContact& contact);

/// Whether bonds touch as capsules at all.
bool any_capsules(const ContactModel& contact, const PerBond<Bond>& bonds);
/// Of each particle, whether a bond with a capsule was ever made there: it touches as part of a fibre, not as
/// other particles do. Empty if there is none.
std::vector<char> particles_of_fibres(std::size_t particles, const PerBond<Bond>& bonds);

/// Why this bond cannot have its capsule, and the way out; nothing if it can.
struct CapsuleMistake {
  std::string rule, way_out;
};
std::optional<CapsuleMistake> capsule_mistake(const ContactModel& contact, double capsule, double distance);
/// The same of a bond between particles where they stand.
std::optional<CapsuleMistake> capsule_mistake(const Model& model, const Bond& bond, double distance);

/// The parts of all fibres, and the other particles, which they may touch. First ends are particles
/// themselves.
class FibreParts {
 public:
  FibreParts() = default;
  FibreParts(const Model& model, const PerBond<Bond>& bonds);

  const std::vector<FibrePart>& parts() const { return parts_; }
  /// All pairs that are less than `margin` from touching, each once, in no special order, for finite
  /// positions.
  std::vector<FibrePair> near_pairs(const PerParticle<Vec3d>& r, const CellEdges& cell, double margin) const {
    return near_pairs(near_bodies(r, cell, margin), r, cell, margin);
  }
  /// Bodies that are so near, whether or not they may touch: they depend on parts and places alone.
  std::vector<FibrePair> near_bodies(const PerParticle<Vec3d>& r, const CellEdges& cell, double margin) const;
  /// All pairs, from the bodies that are so near.
  std::vector<FibrePair> near_pairs(const std::vector<FibrePair>& bodies, const PerParticle<Vec3d>& r,
                                    const CellEdges& cell, double margin) const;
  /// Two bodies; what is bonded to one end of the other does not touch it, so that a fibre may bend.
  bool may_touch(const FibrePart& x, const FibrePart& y) const;
  /// How far apart the first ends of two parts that touch may be.  [length]
  double reach(const PerParticle<Vec3d>& r, const CellEdges& cell) const;
  /// "bond 3 (particles 4, 5)" or "particle 7".
  std::string name_of(std::uint32_t part) const;

 private:
  struct Entry {
    ImageOf other;          // of the particle itself
    std::uint32_t capsule;  // its part, or none
    Image of_part;          // that ends there
  };
  static constexpr std::uint32_t none = 0xffffffff;

  template <class Visit>
  void for_capsules_of(const ImageOf& p, Visit visit) const;
  bool bonded(const ImageOf& p, const ImageOf& o) const;
  bool is_body(const FibrePart& part) const { return part.is_capsule() || capsules_[part.i.particle] == 0; }
  bool is_of_fibre(const FibrePart& part) const { return of_fibre_[part.i.particle.value] != 0; }
  int weight(const FibrePart& x, const FibrePart& y) const;
  double gap(std::uint32_t first, std::uint32_t second, const Image& n, const PerParticle<Vec3d>& r,
             const CellEdges& cell) const;
  int weight_of_line(const FibrePart& body, const ImageOf& p) const;
  template <class Pairs>
  void add_particles_within(std::uint32_t first, std::uint32_t second, const Image& n, Pairs& pairs) const;

  Periodic periodic_{};
  bool bonded_balls_touch_ = false;
  std::vector<FibrePart> parts_;
  PerParticle<std::uint32_t> capsules_;  // how many there are now
  PerParticle<std::uint32_t> within_;    // the part of a particle within fibres; else none
  std::vector<char> of_fibre_;
  std::vector<std::size_t> start_;  // of each particle, in entries_
  std::vector<Entry> entries_;      // its bonds
};

/// The two parts of a pair, and the ends of their axes where they stand.
struct PlacedPair {
  FibrePart x, y;
  Vec3d x_i, x_j, y_i, y_j;
  NearestOnSegments nearest() const { return nearest_on_segments(x_i, x_j, y_i, y_j); }
};
/// r(p) is the position of a particle or image.
template <class PositionOf>
PlacedPair placed(const std::vector<FibrePart>& parts, const FibrePair& pair, PositionOf r) {
  const FibrePart &x = parts[pair.first], y = carried(parts[pair.second], pair.of_second);
  return {x, y, r(x.i), r(x.j), r(y.i), r(y.j)};
}
/// The contact where two parts are nearest, if they overlap there.
inline std::optional<FibreContact> contact_at(const FibrePair& pair, const PlacedPair& of,
                                              const NearestOnSegments& at) {
  if (at.distance2 >= sq(of.x.R + of.y.R)) return std::nullopt;  // NaN goes on: the load check finds it
  const auto place = [](const FibrePart& part, double s) {
    if (s == 0.0 || !part.is_capsule()) return FibrePlace{part.i, part.i, 0.0, part.R};
    return s == 1.0 ? FibrePlace{part.j, part.j, 0.0, part.R} : FibrePlace{part.i, part.j, s, part.R};
  };
  return in_order({place(of.x, at.s), place(of.y, at.t), pair.first, pair.second, pair.weight, pair.bodies});
}
template <class PositionOf>
std::optional<FibreContact> contact_of(const std::vector<FibrePart>& parts, const FibrePair& pair,
                                       PositionOf r) {
  const PlacedPair of = placed(parts, pair, r);
  return contact_at(pair, of, of.nearest());
}

/// The places that a memory is of, and back.
inline std::pair<FibrePlace, FibrePlace> places_of(const FibreMemory& m) {
  return {{{m.a_i, {}}, {m.a_j, m.image_a_j}, m.s, m.R_a},
          {{m.b_i, m.image_b_i}, {m.b_j, m.image_b_j}, m.t, m.R_b}};
}
inline FibreMemory memory_at(const FibrePlace& a, const FibrePlace& b) {
  FibreMemory m;
  m.a_i = a.i.particle, m.a_j = a.j.particle, m.b_i = b.i.particle, m.b_j = b.j.particle;
  m.image_a_j = a.j.image, m.image_b_i = b.i.image, m.image_b_j = b.j.image;
  m.s = a.s, m.t = b.s, m.R_a = a.R, m.R_b = b.R;
  return m;
}

/// Puts contacts at the same places together and in order; those whose weights cancel are left out.
void merge(std::vector<FibreContact>& contacts);

/// A particle as a contact sees it.
struct MovingPoint {
  Vec3d r, v, omega;
};

/// Calls visit(particle or image, share) for the one or two of a place: position, velocity, angular velocity
/// and loads are shared linearly.
template <class Visit>
void for_shares(const FibrePlace& p, Visit visit) {
  if (p.i == p.j) return visit(p.i, 1.0);
  visit(p.i, 1.0 - p.s);
  visit(p.j, p.s);
}

/// The touching at a contact; at(p) is a MovingPoint. m* is that of the shares: 1/m* = sum of share^2/m,
/// where an image has its share with its particle.
template <class PointOf>
Touching<double> touching_of(const Model& model, const FibreContact& c, PointOf at) {
  MovingPoint of[2];
  double per_m[2] = {}, per_Theta[2] = {};
  for (const int k : {0, 1}) {
    const FibrePlace& p = k == 0 ? c.a : c.b;
    for_shares(p, [&](const ImageOf& q, double share) {
      const MovingPoint m = at(q);
      of[k].v += share * m.v, of[k].omega += share * m.omega;
      per_m[k] += share * share / model.mass[q.particle];
      per_Theta[k] += share * share / model.inertia[q.particle];
    });
    if (p.i.particle == p.j.particle)  // itself, or between it and its image
      per_m[k] = 1.0 / model.mass[p.i.particle], per_Theta[k] = 1.0 / model.inertia[p.i.particle];
    of[k].r = on_segment(at(p.i).r, at(p.j).r, p.s);
  }
  return round_bodies<double>(between(of[0].r, of[1].r), {c.a.R, per_m[0], per_Theta[0]},
                              {c.b.R, per_m[1], per_Theta[1]}, of[1].v - of[0].v, of[0].omega, of[1].omega);
}

/// Calls add(particle or image, force, moment) for what the force F on a does to all particles.
template <class Add>
void share_loads(const FibreContact& c, const Touching<double>& p, const Vec3d& F, Add add) {
  const Vec3d T = cross(p.n, F);
  for_shares(c.a, [&](const ImageOf& q, double share) { add(q, share * F, (share * p.l_i) * T); });
  for_shares(c.b, [&](const ImageOf& q, double share) { add(q, -share * F, (share * p.l_j) * T); });
}

/// The forms of contacts of fibres: without resistance to rolling.
inline TouchForms fibre_forms(const ContactModel& contact) {
  TouchForms forms = touch_forms(contact);
  forms.rolling = RollingForm::none;
  return forms;
}

/// A particle, or an image of one, as it stands in a state and moves.
inline MovingPoint point_of(const State& s, const ImageOf& p) {
  return {place_of(s.r, s.cell, p), s.v[p.particle] + image_velocity(s.cell, p.image), s.omega[p.particle]};
}
/// The contacts of fibres as particles stand. For looks now and then, not for a time loop.
std::vector<FibreContact> fibre_contacts(const Model& model, const State& state);
/// One of them, as it touches, and what its last step has left in the memory; nothing without a memory.
struct FibreTouch {
  FibreContact contact;
  Touching<double> touching;
  PairHistory history{};
};
std::vector<FibreTouch> fibre_touches(const Model& model, const State& state);
/// What they store, friction left out.  [energy]
double fibre_energy(const Model& model, const State& state);

}  // namespace vbond
