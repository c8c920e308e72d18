#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/physics/hertz.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond {

enum class ContactLaw : std::uint8_t { none, paper_hertz, hertz, linear };
/// Which particles touch: all, those that are not bonded, or none: walls alone are touched.
enum class ContactPairs : std::uint8_t { all, unbonded, none };

/// What two surfaces do when they touch, besides repelling each other. Absent: see ContactModel.
struct Surface {
  std::optional<double> friction{};           ///< mu >= 0
  std::optional<double> restitution{};        ///< e of a head-on impact, 0 < e <= 1
  std::optional<double> rolling_friction{};   ///< mu_r >= 0
  std::optional<double> twisting_friction{};  ///< mu_t >= 0
  std::optional<double> work_of_adhesion{};   ///< w >= 0  [energy/area]
};

/// What a particle or a wall is made of, as far as contacts ask.
struct ContactMaterial {
  std::string name;
  double E = 0;   ///< [force/area]
  double nu = 0;  ///< -1 < nu <= 0.5
  Surface surface{};
};

/// What holds for one pair of materials, in place of what follows from the two.
struct ContactPair {
  std::array<std::uint32_t, 2> materials{};  ///< in Model::materials
  Surface surface{};
};

/// What particles and walls do that overlap. E, nu, c_H and k are those of all, unless Model::materials says
/// more.
struct ContactModel {
  ContactLaw law = ContactLaw::none;
  ContactPairs pairs = ContactPairs::unbonded;
  double c_H = 0;       ///< paper_hertz: [force/length]
  double length = 1.0;  ///< paper_hertz: the length scale a  [length]
  double E = 0;         ///< hertz: [force/area]
  double nu = 0;        ///< hertz
  double k = 0;         ///< linear: [force/length]
  double k_t = 0;       ///< tangential = linear: [force/length]
  TangentialForm tangential = TangentialForm::none;
  RollingForm rolling = RollingForm::none;
  AdhesionForm adhesion = AdhesionForm::none;  ///< hertz only
  bool attraction = false;                     ///< TouchForms::attraction
  /// Pairs that are not bonded touch, and the bond of two breaks that overlap: they feel what their overlap
  /// grows beyond that, until they have parted. Else they feel all of it from then on.
  bool keeps_overlap = false;
  double damping = 0;  ///< c_n along the contact, beside what a restitution asks for  [force*time/length]
  double tangential_damping = 1;       ///< c_t / c_n
  double rolling_stiffness = 0;        ///< [force*length]; 0: k_t R_r^2
  Surface surface{};                   ///< absent numbers: friction 0, restitution 1, no adhesion
  std::vector<ContactPair> between{};  ///< exceptions
};

/// The repulsion of two particles with these radii, if it is that of all materials and Hertz's; stiffness 0
/// for `none`.
inline HertzContact<double> contact_law(const ContactModel& c, double R_i, double R_j) {
  switch (c.law) {
    case ContactLaw::none:
    case ContactLaw::linear: break;
    case ContactLaw::paper_hertz: return paper_hertz(c.c_H, std::sqrt(c.length));
    case ContactLaw::hertz: return hertz(c.E, c.nu, R_i, R_j);
  }
  return {0.0};
}

/// Whether particles touch each other.
constexpr bool particles_touch(const ContactModel& c) {
  return c.law != ContactLaw::none && c.pairs != ContactPairs::none;
}

constexpr TouchForms touch_forms(const ContactModel& c) {
  NormalForm normal = NormalForm::hertz;
  if (c.law == ContactLaw::linear) normal = NormalForm::linear;
  if (c.law == ContactLaw::paper_hertz) normal = NormalForm::one_hertz;
  return {normal, c.adhesion, c.tangential, c.rolling, c.attraction};
}

/// What the pair of two materials does: an exception of ContactModel::between, else the geometric mean of
/// what the two materials say, else what the model says for all.
TouchNumbers<double> touch_numbers(const ContactModel& contact, const std::vector<ContactMaterial>& materials,
                                   std::uint32_t first, std::uint32_t second);

/// The key of what contacts do besides repelling along the normal, the first of several, e.g.
/// "contact.tangential". Empty: nothing.
std::string key_beyond_repulsion(const ContactModel& contact, const std::vector<ContactMaterial>& materials);
/// The key of what they do along the normal that has no balance of its own; empty: nothing. Friction,
/// resistance to rolling and damping are none: at rest they are left out.
std::string key_without_balance(const ContactModel& contact);
/// Whether contacts resist sliding, rolling or twisting.
inline bool has_friction(const ContactModel& c) {
  return c.law != ContactLaw::none &&
         (c.tangential != TangentialForm::none || c.rolling != RollingForm::none);
}
/// Whether they are no more than one elastic repulsion of the centres, which has loops of its own.
bool is_elastic(const ContactModel& contact, const std::vector<ContactMaterial>& materials);

/// What two bodies remember of their contact: numbers of a TouchHistory, see physics/touch.hpp, as i feels
/// it.
using PairHistory = std::array<double, 12>;
inline TouchHistory<double> touch_history(const PairHistory& x) {
  return {{x[0], x[1], x[2]}, x[3], {x[4], x[5], x[6]}, x[7], {x[8], x[9], x[10]}, x[11]};
}

/// The same as the other of the two feels it.
inline PairHistory seen_from_the_other(PairHistory h) {
  for (const std::size_t k : {0, 1, 2, 4, 5, 6, 8, 9, 10}) h[k] = -h[k];  // the vectors
  return h;
}

/// What the pair of two particles, i < j, remembers; or of i and an image of j, i <= j, of i itself one > 0.
struct PairMemory {
  ParticleId i, j;
  PairHistory history{};
  double kept = 0;  ///< the part of the overlap that is not felt  [length]
  Image image_j{};  ///< which image of j
  friend bool operator==(const PairMemory&, const PairMemory&) = default;
};
/// By which memories are in order.
inline std::tuple<ParticleId, ParticleId, Image> place_of(const PairMemory& m) {
  return {m.i, m.j, m.image_j};
}

/// What a contact of fibres remembers, of the places a and b, a before b, as in FibreContact: on the axis of
/// the bond of two particles, or at one of them (a_i == a_j, and both images the same). a_i is a particle
/// itself.
struct FibreMemory {
  ParticleId a_i, a_j, b_i, b_j;
  double s = 0, t = 0;      ///< where on the axes
  double R_a = 0, R_b = 0;  ///< [length]
  Vec3d normal;             ///< unit vector from a to b
  PairHistory history{};
  Image image_a_j{}, image_b_i{}, image_b_j{};  ///< which images of the others
  friend bool operator==(const FibreMemory&, const FibreMemory&) = default;
};

}  // namespace vbond
