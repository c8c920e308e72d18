#include <cmath>
#include <numbers>

#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

using Particle = ParticleView;
using View = BondView;

constexpr double degrees = 180.0 / std::numbers::pi;

/// none: whole.
BreakMode mode_of(const Bond& b) {
  if (!has_failed(b)) return BreakMode::none;
  return b.mode == BreakMode::none ? BreakMode::other : b.mode;
}

// In the order of the arrays.
constexpr ParticleQuantity of_particles[] = {
    {"radius", unit::length, "of the particle; use it as the scale of sphere glyphs (diameter 2 x radius)",
     [](const Particle& p) { return p.model.radius[p.id]; }},
    {"velocity", unit::velocity, "of the centre; with `frames.wrap` that of the image that is shown",
     [](const Particle& p) {
       const Vec3d& v = p.state.v[p.id];
       return p.image.is_itself() ? v : v + image_velocity(p.state.cell, p.image);
     }},
    {"angular_velocity", unit::angular_velocity, "in the world frame",
     [](const Particle& p) { return p.state.omega[p.id]; }},
    {"rotation", unit::angle,
     "rotation vector since the start: direction is the axis, length the angle, 0 to pi; of a body that the "
     "case or a source has turned, with that turn",
     [](const Particle& p) { return rotation_vector(p.state.q[p.id]); }},
    {"displacement", unit::length,
     "position less position at the start, or as the particle came in from a source",
     [](const Particle& p) { return p.state.r[p.id] - first_place(p.model, p.state, p.id); }},
    {"id", unit::none, "number of the particle", [](const Particle& p) { return std::int64_t{p.id.value}; }},
    {"specimen", unit::none, "which `[[specimen]]` made it, from 0",
     [](const Particle& p) { return std::int64_t{p.model.specimen_of(p.id)}; }},
    {"fragment", unit::none, "number of its fragment: 0 is the heaviest, as in fragments.csv",
     [](const Particle& p) { return p.fragments ? p.fragments->number[p.id] : std::int64_t{0}; },
     Only::breaks},
    {"stress_normal", unit::stress,
     "xx, yy, zz of its stress, tension positive: the sum of x f over its bonds and contacts, walls among "
     "them, where f acts at x from its centre, over its volume as a sphere",
     [](const Particle& p) {
       return Vec3d{p.stress[0], p.stress[1], p.stress[2]};
     },
     Only::stress},
    {"stress_shear", unit::stress, "yz, zx, xy of its stress; the part that is symmetric",
     [](const Particle& p) {
       return Vec3d{p.stress[3], p.stress[4], p.stress[5]};
     },
     Only::stress},
    {"image", unit::none,
     "by how many edges a, b and c the particle is away from where it is shown; its own position is Points + "
     "image[0] a + image[1] b + image[2] c",
     [](const Particle& p) { return -p.image; }, Only::wrap},
};

constexpr BondQuantity of_bonds[] = {
    {"elongation", unit::length,
     "distance of the bonded points less the length at rest, which grows by `plastic_elongation` and `creep`",
     [](const View& b) { return b.shape.length - b.bond.a; }},
    {"length_at_rest", unit::length,
     "as it was made, at its temperature, without yielding and creep; elongation over it is the elastic "
     "strain",
     [](const View& b) { return b.bond.a; }},
    {"bend", unit::degrees, "angle between n_i1 and -n_j1, 0 to 180",
     [](const View& b) { return degrees * b.shape.bend; }},
    {"twist", unit::degrees, "about the line between the bonded points, -180 to 180",
     [](const View& b) { return degrees * b.shape.twist; }},
    {"U_L", unit::energy, "energy of stretching, as in history.csv", [](const View& b) { return b.U.U_L; }},
    {"U_B", unit::energy, "energy of bending and shear", [](const View& b) { return b.U.U_B; }},
    {"U_T", unit::energy, "energy of torsion", [](const View& b) { return b.U.U_T; }},
    {"axial_force", unit::force, "F.d, tension is positive", [](const View& b) { return b.axial_force; }},
    {"shear_force", unit::force, "size of F across d", [](const View& b) { return b.shear_force; }},
    {"moment_i", unit::moment, "size of the moment on particle i about its own centre",
     [](const View& b) { return b.moment_i; }},
    {"moment_j", unit::moment, "size of the moment on particle j about its own centre",
     [](const View& b) { return b.moment_j; }},
    {"range", unit::none, "0 good, 1 strained, 2 snapped",
     [](const View& b) { return static_cast<std::uint8_t>(bond_range(b.bond, b.shape)); }},
    {"id", unit::none, "number of the bond in order of creation",
     [](const View& b) { return std::int64_t{b.id.value}; }},
    {"set", unit::none, "which bond set of the case made it",
     [](const View& b) { return std::int64_t{b.bond.set}; }},
    {"bending_moment", unit::moment, "size of the bending moment at the middle, `M_b` of breaks.csv",
     [](const View& b) { return b.bending_moment; }, Only::breaks},
    {"torque", unit::moment, "positive if it turns particle i about d, `M_t` of breaks.csv",
     [](const View& b) { return b.torque; }, Only::breaks},
    {"utilisation", unit::none,
     "1 where it breaks; 0 if broken or without strength; by `elongation` below 0 in compression",
     [](const View& b) { return b.utilisation; }, Only::breaks},
    {"broken", unit::none,
     "0 whole; broken by 1 tension, 2 shear, 3 bending, 4 torsion, 5 compression, 6 what its law does not "
     "say",
     [](const View& b) { return static_cast<std::uint8_t>(mode_of(b.bond)); }, Only::breaks},
    {"capsule_radius", unit::length, "radius by which its axis is touched; 0: the bond touches nothing",
     [](const View& b) { return capsule_of(b.bond); }, Only::capsules},
    {"plastic_elongation", unit::length, "u_p: by what its length at rest has grown by yielding",
     [](const View& b) { return b.flowed[memory::stretch]; }, Only::flow},
    {"creep", unit::length, "by what its length at rest has grown by creep",
     [](const View& b) { return b.flowed[memory::crept]; }, Only::flow},
    {"plastic_bend", unit::degrees, "bending that has flowed, to and fro taken together: size of the angle",
     [](const View& b) { return degrees * std::hypot(b.flowed[memory::bent], b.flowed[memory::bent + 1]); },
     Only::flow},
    {"plastic_twist", unit::degrees, "twist that has flowed, to and fro taken together, with its sign",
     [](const View& b) { return degrees * b.flowed[memory::twisted]; }, Only::flow},
    {"axial_flow", unit::length, "alpha of the axial force: the sum of all amounts of its yielding",
     [](const View& b) { return b.flowed[memory::axial]; }, Only::flow},
    {"shear_flow", unit::length, "alpha of the shear force",
     [](const View& b) { return b.flowed[memory::shear]; }, Only::flow},
    {"bending_flow", unit::degrees, "alpha of the bending moment",
     [](const View& b) { return degrees * b.flowed[memory::bending]; }, Only::flow},
    {"torsion_flow", unit::degrees, "alpha of the torque",
     [](const View& b) { return degrees * b.flowed[memory::torsion]; }, Only::flow},
    {"damage", unit::none, "w of softening, 0 to 1", [](const View& b) { return b.flowed[memory::damage]; },
     Only::flow},
    {"image_j", unit::none,
     "by how many edges a, b and c the image of its second particle that it joins is away from that "
     "particle; "
     "with `frames.wrap` from where that is shown",
     [](const View& b) { return image_of_j(b.bond); }, Only::cell},
};

constexpr WallQuantity of_walls[] = {
    {"id", unit::none, "number of the wall in the order of the case, from 0",
     [](const WallView& w) { return static_cast<std::int64_t>(w.index); }},
    {"force", unit::force, "of particles on the wall", [](const WallView& w) { return w.now.force; }},
    {"moment", unit::moment, "of particles on the wall, about its centre",
     [](const WallView& w) { return w.now.moment; }},
    {"velocity", unit::velocity, "of its centre", [](const WallView& w) { return w.now.velocity; }},
    {"displacement", unit::length, "of its centre since the start",
     [](const WallView& w) { return w.now.displacement; }},
    {"rotation", unit::angle,
     "rotation vector since the start: direction is the axis, length the angle, 0 to pi; of a body that came "
     "in "
     "turned, with that turn",
     [](const WallView& w) { return rotation_vector(w.now.q); }},
    {"off", unit::none, "1: the stage has taken the wall away, nothing touches it; 0: it is there",
     [](const WallView& w) { return static_cast<std::int64_t>(w.now.off); }},
};

using Contact = ListedContact;
constexpr ContactQuantity of_contacts[] = {
    {"i", unit::none, "number of the particle; of a fibre, of the lower end of its bond",
     [](const Contact& c) { return c.i; }},
    {"j", unit::none, "of the other one, likewise; -1: it touches a wall",
     [](const Contact& c) { return c.j; }},
    {"wall", unit::none, "number of the wall in the order of the case, from 0; -1: it is between particles",
     [](const Contact& c) { return c.wall; }},
    {"overlap", unit::length, "that is felt; negative where adhesion holds on",
     [](const Contact& c) { return c.overlap; }},
    {"contact_radius", unit::length,
     "of the area that touches: sqrt(R* overlap), with adhesion by JKR that of JKR",
     [](const Contact& c) { return c.radius; }},
    {"normal_force", unit::force, "with damping; repulsion is positive",
     [](const Contact& c) { return c.normal_force; }},
    {"friction", unit::force, "size of the force across the normal, with damping",
     [](const Contact& c) { return c.friction; }},
    {"slip", unit::length, "taken up by the spring of friction: its force over its stiffness now",
     [](const Contact& c) { return c.slip; }},
    {"force", unit::force, "all of it, on particle i", [](const Contact& c) { return c.force; }},
};

}  // namespace

std::span<const ContactQuantity> contact_quantities() {
  return of_contacts;
}

std::span<const ParticleQuantity> particle_quantities() {
  return of_particles;
}

std::span<const BondQuantity> bond_quantities() {
  return of_bonds;
}

std::span<const WallQuantity> wall_quantities() {
  return of_walls;
}

}  // namespace vbond
