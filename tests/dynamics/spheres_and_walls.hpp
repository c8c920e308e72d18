#pragma once
#include <string>
#include <vector>

#include "rods.hpp"

/// A sphere, walls and contacts for tests.
namespace vbond::testing {

inline Wall floor_at(double z) {
  return {"floor", PlaneWall{{0, 0, z}, {0, 0, 1}}, 0, {}};
}
inline Specimen sphere(const Vec3d& r, double radius, double mass, const ContactModel& contact,
                       const std::vector<Wall>& walls) {
  Specimen s{equal_particles({r}, mass, 0.4 * mass * sq(radius), radius), {}};
  s.model.contact = contact;
  s.model.walls = walls;
  s.state = at_rest(s.model);
  return s;
}
inline WallDrive drive(const std::string& wall, std::size_t index) {
  WallDrive d;
  d.wall = wall, d.index = index;
  return d;
}
inline ContactModel linear(double k, double mu, double e = 1.0) {
  ContactModel c{.law = ContactLaw::linear, .pairs = ContactPairs::all};
  c.k = k, c.k_t = 2.0 / 7.0 * k, c.tangential = TangentialForm::linear;
  c.surface = {.friction = mu, .restitution = e};
  return c;
}

}  // namespace vbond::testing
