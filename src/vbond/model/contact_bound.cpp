#include "vbond/model/contact_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vbond/core/bounding_box.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/contact_masses.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/physics/bond_step.hpp"
#include "vbond/terms/walls/wall_touch.hpp"

namespace vbond {
namespace {

constexpr double part_of_overlap = 0.1;  // of the sum of two radii, which contacts to come may reach

/// A wall as the step bound sees it.
struct BoundWall {
  WallSurface surface;
  std::uint32_t material;
  bool off = false;
  double touches = 0;   ///< now
  double per_mass = 0;  ///< of a servo's, for one of its touches  [1/mass]
};

/// Of each particle. Of two that touch, both count the overlap, so that neither of them takes the stiffness
/// of their contact for less than it is.
struct PresentContacts {
  PerParticle<double> number, overlap;  ///< overlap: the largest  [length]
};

PresentContacts present_contacts(const Model& model, const BodyPart& body, const RigidBodies& bodies,
                                 std::vector<BoundWall>& walls) {
  const State& state = body.state;
  PresentContacts found{PerParticle<double>(model.particles(), 0.0),
                        PerParticle<double>(model.particles(), 0.0)};
  const auto add = [&found](ParticleId p, double overlap) {
    found.number[p] += 1.0;
    found.overlap[p] = std::max(found.overlap[p], overlap);
  };
  for_touching_pairs(model, body, bodies, [&](ParticleId i, ParticleId j, const Image&, double overlap) {
    add(i, overlap), add(j, overlap);
  });
  if (body.shares_pairs()) {
    body.all.sum({found.number.data(), found.number.size()});
    body.all.max({found.overlap.data(), found.overlap.size()});
  }
  for (const auto& [c, touching, history] : fibre_touches(model, state)) {
    if (!c.body) continue;
    const double overlap = touching.overlap;
    for (const FibrePlace& place : {c.a, c.b})
      for_shares(place, [&](const ImageOf& p, double) { add(p.particle, overlap); });
  }
  std::vector<WallTouch> touches;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (walls[w].off) continue;
    for (const ParticleId p : model.radius.ids()) {
      if (is_absent(state, p)) continue;
      const double R = model.radius[p];
      Vec3d r = state.r[p];
      if (w < state.walls.size()) r = at_start(model.walls[w], state.walls[w], r);
      if (!walls[w].surface.may_touch(r, R)) continue;
      touches.clear();
      walls[w].surface.touches(r, R, touches);
      for (const WallTouch& t : touches) add(p, R - t.distance);
      walls[w].touches += static_cast<double>(touches.size());
    }
  }
  return found;
}

/// The radii by which particles are touched: their own, or that of a capsule that is thicker, present or to
/// come.
PerParticle<double> touched_radii(const Model& model, const State& state,
                                  const std::vector<BondingRule>& rules) {
  PerParticle<double> R = model.radius;
  if (!particles_touch(model.contact)) return R;
  for (const Bond& b : state.bonds)
    for (const ParticleId p : {b.i, b.j})
      if (!b.broken) R[p] = std::max(R[p], capsule_of(b));
  for (const BondingRule& rule : rules)
    for (const ParticleId p : R.ids())
      if (rule.recipe.capsule && (rule.in_a[p.value] || rule.in_b[p.value]))
        R[p] = std::max(R[p], rule.recipe.capsule_radius);
  return R;
}

/// Particles that may touch a wall at once as it comes along a direction: one layer of them, closely packed
/// in squares over the shadow of the body.
double particles_of_a_layer(const Model& model, const State& state, const Vec3d& direction) {
  const double n = static_cast<double>(model.particles());
  const double R = std::accumulate(model.radius.begin(), model.radius.end(), 0.0) / n;
  BoundingBox box;
  for (const ParticleId p : state.r.ids())
    if (!is_absent(state, p)) box.add(state.r[p], R);
  if (present(state) == 0) box.add({}, R);
  const Vec3d size = box.high - box.low;
  const double shadow = std::abs(direction.x) * size.y * size.z + std::abs(direction.y) * size.z * size.x +
                        std::abs(direction.z) * size.x * size.y;
  return std::clamp(shadow / (4.0 * R * R), 1.0, n);
}

std::vector<BoundWall> bound_walls(const Model& model, const std::vector<WallDrive>& drives) {
  std::vector<BoundWall> walls;
  for (const Wall& w : model.walls) walls.push_back({WallSurface(w.shape), w.material});
  for (const WallDrive& d : drives) walls[d.index].off = d.off;
  return walls;
}

void share_masses(const Model& model, const State& state, const std::vector<WallDrive>& drives,
                  std::vector<BoundWall>& walls) {
  for (const WallDrive& d : drives)
    if (d.servo)
      walls[d.index].per_mass =
          std::max(walls[d.index].touches, particles_of_a_layer(model, state, d.servo->direction)) /
          d.servo->mass;
}

/// The radius R* of a particle that touches a wall, the stiffest there is: hollow walls are larger than flat
/// ones.
double radius_at_wall(const WallShape& shape, double R) {
  double curvature_1 = 0.0, curvature_2 = 0.0;
  if (const auto* cylinder = std::get_if<CylinderWall>(&shape);
      cylinder && (cylinder->side == WallSide::inside || std::isfinite(cylinder->length)))
    curvature_1 = -1.0 / cylinder->radius;
  if (const auto* sphere = std::get_if<SphereWall>(&shape); sphere && sphere->side == WallSide::inside)
    curvature_1 = curvature_2 = -1.0 / sphere->radius;
  const WallTouch hollow{{}, 0.0, curvature_1, curvature_2};
  return R * curvature_1 > -1.0 ? effective_radius(R, hollow) : R;  // larger particles stay outside
}

/// One kind of touch that a particle of the first material may have.
struct PossibleTouch {
  std::uint32_t first, second;
  TouchNumbers<double> numbers;
  std::optional<std::size_t> wall;
};

std::vector<PossibleTouch> possible_touches(const Model& model, const std::vector<BoundWall>& walls) {
  const auto materials = static_cast<std::uint32_t>(std::max<std::size_t>(1, model.materials.size()));
  std::vector<char> of_particles(materials, 0);
  for (const ParticleId p : model.mass.ids()) of_particles[model.material_of(p)] = 1;
  std::vector<PossibleTouch> all;
  const auto add = [&](std::uint32_t first, std::uint32_t second, std::optional<std::size_t> wall) {
    all.push_back({first, second, touch_numbers(model.contact, model.materials, first, second), wall});
  };
  for (std::uint32_t first = 0; first < materials; ++first) {
    if (of_particles[first] == 0) continue;
    for (std::uint32_t second = 0; second < materials; ++second)
      if (particles_touch(model.contact) && model.particles() > 1 && of_particles[second] != 0)
        add(first, second, std::nullopt);
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (!walls[w].off) add(first, walls[w].material, w);
  }
  return all;
}

}  // namespace

ContactSlopes contact_slopes(const TouchForms& forms, const TouchNumbers<double>& numbers, double R, double m,
                             double overlap) {
  TouchForms repulsion = forms;
  repulsion.adhesion = AdhesionForm::none;
  const NormalForce<double> n = normal_force(repulsion, numbers, R, overlap);
  ContactSlopes to;
  to.normal = (forms.normal == NormalForm::linear ? 1.0 : 1.5) * n.secant;
  if (forms.tangential != TangentialForm::none) to.tangential = tangential_stiffness(forms, numbers, n.a);
  if (forms.rolling == RollingForm::spring)
    to.rolling = numbers.rolling_stiffness > 0.0 ? numbers.rolling_stiffness : to.tangential * sq(R);
  to.damping = numbers.viscous + numbers.damping * std::sqrt(m * n.secant);
  return to;
}

std::string ContactBound::source(const Model& model) const {
  std::string of =
      (damping ? "the damping of contacts of particle " : "contacts of particle ") + std::to_string(p.value);
  if (wall) of += " and others with wall \"" + model.walls[*wall].name + "\", by the mass of its servo";
  if (model.materials.empty()) return of;
  return of + ", " + model.materials[first].name + " with " + model.materials[second].name;
}

ContactBound contact_bound(const Model& model, const BodyPart& body, const std::vector<WallDrive>& drives,
                           const std::vector<BondingRule>& rules, double to_come,
                           const std::vector<Support>& supports) {
  if (model.contact.law == ContactLaw::none || model.particles() == 0) return {};
  const State& state = body.state;
  const PerParticle<double> radius = touched_radii(model, state, rules);
  const double R_max = *std::max_element(radius.begin(), radius.end());
  if (!(R_max > 0.0)) return {};
  std::vector<BoundWall> walls = bound_walls(model, drives);
  const std::vector<PossibleTouch> touches = possible_touches(model, walls);
  if (touches.empty()) return {};
  const PresentContacts present =
      present_contacts(model, body, RigidBodies(model.particles(), carried_by(supports)), walls);
  share_masses(model, state, drives, walls);

  const TouchForms forms = touch_forms(model.contact);
  const ContactMasses masses(model, supports);
  ContactBound largest;
  const auto look_at = [&](ParticleId p, const PossibleTouch& t, double n, double overlap) {
    const double R = radius[p], m = model.mass[p], per_m = 2.0 / m, per_Theta = 2.0 / model.inertia[p];
    const double R_pair = t.wall ? radius_at_wall(model.walls[*t.wall].shape, R) : R * R_max / (R + R_max);
    // against what moves as prescribed it is the other one's damping that counts
    const double damps = std::isinf(masses.of(p)) ? m : masses.of(p);
    const ContactSlopes s = contact_slopes(forms, t.numbers, R_pair, damps, overlap);
    const auto lambda = [&](double share_of_wall, bool damped) {  // of each of the particle's n contacts
      const double along = n * per_m + share_of_wall, across = along + n * sq(R) * per_Theta;
      const double c_t = s.tangential > 0.0 ? t.numbers.tangential_damping : 0.0;
      return damped_bound(std::max(s.normal * along, s.tangential * across + s.rolling * n * per_Theta),
                          damped ? s.damping * std::max(along, c_t * across) : 0.0);
    };
    const double share = t.wall ? walls[*t.wall].per_mass : 0.0, of_this = lambda(share, true);
    if (!(of_this > largest.lambda)) return;
    largest = {of_this, p, t.first, t.second, of_this > 2.0 * lambda(share, false), {}};
    if (of_this > 2.0 * lambda(0.0, true)) largest.wall = t.wall;
  };
  for (const ParticleId p : model.mass.ids())
    for (const PossibleTouch& t : touches) {
      if (t.first != model.material_of(p)) continue;
      look_at(p, t, to_come, part_of_overlap * (radius[p] + R_max));
      if (present.number[p] > 0.0) look_at(p, t, present.number[p], present.overlap[p]);
    }
  return largest;
}

}  // namespace vbond
