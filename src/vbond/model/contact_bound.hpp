#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// What contacts, present and to come, add to the largest squared frequency of a body, and which of them.
struct ContactBound {
  double lambda = 0.0;                           ///< [1/time^2]
  ParticleId p;                                  ///< the particle
  std::uint32_t first = 0, second = 0;           ///< materials
  bool damping = false;                          ///< most of it is from the damping of contacts
  std::optional<std::size_t> wall;               ///< the wall with a servo that it touches, if that counts
  std::string source(const Model& model) const;  ///< for reports
};

/// docs/contacts.md has the formulas. to_come: so many contacts a particle is taken to have at least.
/// supports: of the stage, for the masses by which contacts damp.
ContactBound contact_bound(const Model& model, const BodyPart& body, const std::vector<WallDrive>& drives,
                           const std::vector<BondingRule>& rules = {}, double to_come = 1.0,
                           const std::vector<Support>& supports = {});
/// Of a particle in a random heap of equal spheres, on average (isostatic: twice three).
inline constexpr double contacts_in_a_heap = 6.0;

/// Slopes of the forces of a contact: what a step bound goes by.
struct ContactSlopes {
  double normal = 0, tangential = 0;  ///< [force/length]
  double rolling = 0;                 ///< [force*length]
  double damping = 0;                 ///< along the normal  [force*time/length]
};
/// R, m: effective ones of the pair.
ContactSlopes contact_slopes(const TouchForms& forms, const TouchNumbers<double>& numbers, double R, double m,
                             double overlap);

}  // namespace vbond
