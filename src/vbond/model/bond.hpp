#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "vbond/core/boxed.hpp"
#include "vbond/core/cell.hpp"
#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/short_pointer.hpp"
#include "vbond/model/bond_law.hpp"
#include "vbond/physics/break_mode.hpp"
#include "vbond/physics/pose.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/section.hpp"

namespace vbond {

/// The coefficients of a bond, in less room: most laws have no more than the first four, or the others are
/// zero.
class KeptCoefficients {
 public:
  KeptCoefficients() = default;
  KeptCoefficients(const Coefficients& all) {
    std::copy_n(all.begin(), first_.size(), first_.begin());
    Others others;
    std::copy_n(all.begin() + first_.size(), others.size(), others.begin());
    if (others != Others{}) others_.set(others);
  }
  operator Coefficients() const {
    Coefficients all{};
    std::copy(first_.begin(), first_.end(), all.begin());
    if (others_) std::copy((*others_).begin(), (*others_).end(), all.begin() + first_.size());
    return all;
  }
  double operator[](std::size_t k) const {
    if (k < first_.size()) return first_[k];
    return others_ ? (*others_)[k - first_.size()] : 0.0;
  }
  void set(std::size_t k, double x) {
    Coefficients all = *this;
    all[k] = x;
    *this = all;
  }
  friend bool operator==(const KeptCoefficients&, const KeptCoefficients&) = default;

 private:
  static constexpr std::size_t at_hand = 4;
  using Others = std::array<double, most_coefficients - at_hand>;
  std::array<double, at_hand> first_{};
  Boxed<Others> others_;
};

/// How many sets the bonds of a body may be of: see Bond::set.
inline constexpr std::size_t most_bond_sets = 1 << 16;

/// In place of a frame in the body of j: it is that in the body of i.
inline constexpr Quatd no_other_frame{.w = 0, .x = 0, .y = 0, .z = 0};

/// What few bonds have, as they are made between particles that are turned to each other, touch as capsules,
/// or join images.
struct RareOfBond {
  Quatd frame_j = no_other_frame;  ///< the bond's frame in the body frame of j
  double capsule = 0;              ///< radius by which its axis is touched  [length]
  Image image_j{};                 ///< which image of j it joins with i itself

  friend bool operator==(const RareOfBond&, const RareOfBond&) = default;
};

/// One bond: its constants, and whether it is broken. What it remembers, if anything, is in State. There are
/// many: what few of them have is boxed, and what many share has a number.
struct Bond {
  ParticleId i, j;
  double a = 0, R_i = 0, R_j = 0;                 ///< length at rest, attachment distances  [length]
  KeptCoefficients coefficients{};                ///< of the law, in the order of its fields, in their units
  Quatd frame_i;                                  ///< the bond's frame in the body frame of i, see BondFrames
  Boxed<RareOfBond> rare{};                       ///< see frame_j(), capsule_of(), image_of_j()
  ShortPointer<BondLaw> law = &bond_law<VModel>;  ///< never null
  ShortPointer<BondRules> rules = &no_rules;      ///< never null; kept(), see model/rules.hpp
  std::uint16_t set = 0;                          ///< which bond set of the case made it
  bool broken = false;                            ///< keeps its id, and does nothing any more
  BreakMode mode = BreakMode::none;               ///< by what it broke

  friend bool operator==(const Bond&, const Bond&) = default;
};
static_assert(sizeof(Bond) == 120);

/// The radius by which the axis of a bond is touched; 0: it is not.  [length]
inline double capsule_of(const Bond& b) {
  return b.rare ? (*b.rare).capsule : 0.0;
}
inline void set_capsule(Bond& b, double radius) {
  if (b.rare || radius != 0.0) set_of_few(b.rare, &RareOfBond::capsule, radius);
}
/// Which image of its particle j a bond joins with i itself.
inline Image image_of_j(const Bond& b) {
  return b.rare ? (*b.rare).image_j : Image{};
}
inline void set_image_of_j(Bond& b, const Image& image) {
  if (b.rare || !image.is_itself()) set_of_few(b.rare, &RareOfBond::image_j, image);
}

/// Whether the bond's frames in the bodies of i and j differ; that in the body of j.
inline bool has_other_frame(const Bond& b) {
  return b.rare && (*b.rare).frame_j != no_other_frame;
}
inline const Quatd& frame_j(const Bond& b) {
  return has_other_frame(b) ? (*b.rare).frame_j : b.frame_i;
}
inline void set_frames(Bond& b, const Quatd& in_i, const Quatd& in_j) {
  b.frame_i = in_i;
  if (b.rare || in_j != in_i) set_of_few(b.rare, &RareOfBond::frame_j, in_j != in_i ? in_j : no_other_frame);
}

/// Whether a bond has cracked, and its faces still rub; and whether it has failed, so that it holds nothing
/// together: broken and gone, or cracked.
inline bool is_cracked(const Bond& b) {
  return !b.broken && b.mode != BreakMode::none;
}
inline bool has_failed(const Bond& b) {
  return b.broken || is_cracked(b);
}

/// Whether a bond adds loads of damping, and whether it may break.
inline bool is_damped(const Bond& b) {
  return b.law->damped && (!b.law->has_rules || b.rules->damped);
}
inline bool can_break(const Bond& b) {
  return b.law->breakable && (!b.law->has_rules || b.rules->can_break());
}
inline bool needs_rates(const Bond& b) {
  return is_damped(b) || b.law->remembers();
}

/// Whether it flows with time; and whether it flows, slips or is damaged by what is done to it, however fast.
inline bool creeps(const Bond& b) {
  return b.law->remembers() && b.law->has_rules && b.rules->creep.rate > 0.0;
}
inline bool yields_or_softens(const Bond& b) {
  return b.law->remembers() &&
         (!b.law->has_rules || b.rules->yield != Yield{} || b.rules->softening.any() || is_cracked(b));
}

/// The offsets o_i2, o_i3, o_j2, o_j3 of a bond, see with_offsets.hpp; zeros without.  [length]
inline std::array<double, offset_coefficients> offsets_of(const Bond& b) {
  if (!b.law->has_offsets) return {};
  return {b.coefficients[0], b.coefficients[1], b.coefficients[2], b.coefficients[3]};
}
/// What its bonded points are offset by from the lines through the centres along n_1, as it stands.
struct BondOffsets {
  Vec3d i, j;  ///< [length]
};
inline BondOffsets offsets_of(const Bond& b, const BondPose<double>& pose) {
  const std::array<double, offset_coefficients> o = offsets_of(b);
  return {o[0] * pose.n_i[1] + o[1] * pose.n_i[2], o[2] * pose.n_j[1] + o[3] * pose.n_j[2]};
}
/// The pose between the ends of its offsets, for what is written for bonds without.
inline BondPose<double> pose_at_offsets(const Bond& b, const BondPose<double>& pose) {
  if (!b.law->has_offsets) return pose;
  const BondOffsets o = offsets_of(b, pose);
  BondPose<double> there = pose;
  there.r_ij = pose.r_ij + o.j - o.i;
  return there;
}
/// From the centre of i to its bonded point.  [length]
inline Vec3d arm_of_i(const Bond& b, const BondPose<double>& pose) {
  const Vec3d along = b.R_i * pose.n_i[0];
  return b.law->has_offsets ? along + offsets_of(b, pose).i : along;
}
inline BondAxis<double> bond_axis(const Bond& b, const BondPose<double>& pose) {
  return bond_axis(pose_at_offsets(b, pose), b.R_i, b.R_j);
}
/// D_ij, from one bonded point to the other.  [length]
inline Vec3d bonded_points(const Bond& b, const BondPose<double>& pose) {
  return bonded_points(pose_at_offsets(b, pose), b.R_i, b.R_j);
}
inline BondShape bond_shape(const Bond& b, const BondPose<double>& pose) {
  return bond_shape(pose_at_offsets(b, pose), b.R_i, b.R_j);
}
/// What its section carries, given its loads.
inline SectionLoads<double> section_loads(const Bond& b, const BondPose<double>& pose,
                                          BondLoads<double> loads) {
  if (b.law->has_offsets) {
    const BondOffsets o = offsets_of(b, pose);
    loads.M_ij -= cross(o.i, loads.F);
    loads.M_ji += cross(o.j, loads.F);
  }
  return section_loads(section_moments(pose, b.R_i, b.R_j, loads), bond_axis(b, pose), loads);
}

/// Where a coefficient stands that rules give to a bond; its law has rules.
inline std::size_t place_of(const Bond& b, RuleCoefficient k) {
  return b.law->fields.size() - rule_coefficients + static_cast<std::size_t>(k);
}
inline double coefficient_of(const Bond& b, RuleCoefficient k) {
  return b.coefficients[place_of(b, k)];
}
/// 1 over the factor of the bond's own strength, less 1; 0 for laws that have none.
inline double weakness_of(const Bond& b) {
  return b.law->has_rules ? coefficient_of(b, RuleCoefficient::weakness) : 0.0;
}
/// The factor of the bond's own strength.
inline double strength_factor(const Bond& b) {
  return 1.0 / (1.0 + weakness_of(b));
}

/// Where a bond of this shape stands in the range of its law; a broken one has none to leave.
inline BondRange bond_range(const Bond& b, const BondShape& s) {
  return b.broken ? BondRange::good : b.law->range(b, s);
}

/// The sum of the coefficients that are energies, without signs: the energy of a bond near rest is a
/// difference of terms of this size.  [energy]
inline double angular_scale(const Bond& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < b.law->fields.size(); ++k)
    if (b.law->fields[k].dimension == force_times_length) sum += std::abs(b.coefficients[k]);
  return sum;
}

/// From particle i of a bond to its particle j, or that image of it, which stand at these places.  [length]
inline Vec3d between(const PerParticle<Vec3d>& r, const CellEdges& cell, const Bond& b) {
  return between(r, cell, b.i, b.j, image_of_j(b));
}

/// The pose of a bond, its axes turned into the world frame.
inline BondPose<double> bond_pose(const Bond& b, const Vec3d& r_ij, const Quatd& q_i, const Quatd& q_j) {
  return bond_pose(BondFrames<double>{b.frame_i, frame_j(b)}, r_ij, q_i, q_j);
}

/// All coefficients of the law as given, in the order of its fields.
struct GivenCoefficients {
  Coefficients values{};
};

enum class BondTheory : std::uint8_t { bernoulli_euler, timoshenko, short_cylinder, shell, parallel };

/// A full circle for each pair: its radius is this factor times the smaller radius of the two particles, or
/// their mean.
struct SectionOfRadii {
  double factor = 0;  ///< > 0; 0: all bonds have one section
  bool of_mean = false;
  bool any() const { return factor > 0.0; }
};

/// Stiffnesses per area of bonds of theory `parallel`.
struct PerArea {
  double k_n = 0, k_s = 0;              ///< [force/length^3]; both 0: k_n = E/(R_i + R_j), k_s = k_n/ratio
  double ratio = 0;                     ///< k_n/k_s, > 0
  double grain_k_n = 0, grain_k_s = 0;  ///< of each grain, in series; 0: grains are rigid  [force/length^3]
  bool of_modulus() const { return ratio > 0.0; }
};

/// Elastic constants and section; kappa is used by Timoshenko only. A shell has a thickness and no section.
struct TheoryParameters {
  BondTheory theory = BondTheory::bernoulli_euler;
  Material material{};
  Section section{};
  double kappa = 0;              ///< shear coefficient, > 0
  double thickness = 0;          ///< of the wall, > 0; shell only  [length]
  SectionOfRadii of_radii = {};  ///< if any, in place of the section
  PerArea per_area = {};         ///< parallel only
};

/// Radii of the two particles of a bond, 0 where a particle has none.  [length]
struct BondRadii {
  double i = 0, j = 0;
};

/// The section of a bond between particles of these radii.
constexpr Section section_of(const TheoryParameters& t, const BondRadii& R) {
  if (!(t.of_radii.factor > 0.0)) return t.section;
  return circle(2.0 * t.of_radii.factor * (t.of_radii.of_mean ? 0.5 * (R.i + R.j) : R.i < R.j ? R.i : R.j));
}

/// Where a bond is fastened: at the centres, at the surfaces, or at given distances from the centres. neck:
/// with its middle between the surfaces, as long as the cement in its section; see neck_length.
enum class Attachment : std::uint8_t { centres, surfaces, given, neck };

/// What is given of a bond's damping, for stretching, shear, bending and torsion in turn.
enum class DampingBy : std::uint8_t {
  none,
  coefficients,  ///< g itself  [stiffness * time]
  time,          ///< g = time * stiffness: Rayleigh's beta K; a mode has zeta = beta omega / 2
  ratio,         ///< g = 2 ratio sqrt(stiffness * reduced mass or inertia of the two particles)
};
struct BondDamping {
  DampingBy by = DampingBy::none;
  std::array<double, 4> values{};
};

/// A flat joint: the section of a bond in `radial` rings of equal thickness, each in `around` equal parts.
/// Each part is a bond of its own, a cell.
struct FlatJoint {
  int radial = 0;  ///< > 0; 0: bonds are whole
  int around = 0;  ///< 1, or 3 and more

  bool any() const { return radial > 0; }
};
/// A cell of a flat joint whose section has the radius 1.
struct JointCell {
  double area = 0;        ///< as a part of that of the section
  double y = 0, z = 0;    ///< of its centroid, along n_2 and n_3
  double own_moment = 0;  ///< second moment of area about the centroid, the mean of all axes, over its area
};

/// Weibull's distribution of strength: a bond of volume V = A a has the factor (V_0/V)^(1/m)
/// (-ln(1-u))^(1/m), with u drawn from the seed and the two particles.
struct Weibull {
  double modulus = 0;  ///< m, > 0; 0: all bonds have the same strength
  double volume = 0;   ///< V_0; 0: that of each bond, which leaves size out
  double area = 0;     ///< A, with volume
  std::uint64_t seed = 1;
};

/// How to make a bond between any two particles: everything but the particles.
struct BondRecipe {
  const BondLaw* law = &bond_law<VModel>;  ///< never null
  std::variant<GivenCoefficients, BondStiffness<double>, TheoryParameters> parameters;
  BondStiffness<double> factors{1.0, 1.0, 1.0, 1.0};  ///< on what stiffnesses or theory say, > 0
  BondRules rules;  ///< for a law that has rules; whether it is damped follows from `damping`
  BondDamping damping;
  FlatJoint flat_joint;           ///< of theory `parallel` with a circle, only
  std::optional<JointCell> cell;  ///< of it, that this recipe makes: see recipes_of
  Weibull weibull;
  Coefficients given{};  ///< besides stiffnesses or theory: coefficients that do not follow from them
  Attachment attachment = Attachment::centres;
  double R_i = 0, R_j = 0;  ///< only with Attachment::given  [length]
  /// The bond is longer than its length at rest by this part of it when it is made, > -1: (D - a)/a.
  double prestrain = 0;
  double expansion = 0;  ///< by what part its bonds grow per temperature: see heat.hpp  [1/temperature]
  /// If set, coefficients are worked out once at this length and are the same for all bonds of the set
  /// (the paper's shell); if not, at each bond's own length.  [length]
  std::optional<double> reference_length;
  /// n_2 is this direction made normal to the bond. Without it, or if it is within 1e-6 rad of the
  /// bond: the coordinate axis least aligned with the bond, the first of equals.
  std::optional<Vec3d> n_2;
  std::uint16_t set = 0;
  bool capsule = false;       ///< its bonds touch as capsules
  double capsule_radius = 0;  ///< of these; 0: the smaller radius of each bond's particles  [length]

  /// Whether its bonds follow the radii of their particles, which then must have some.
  bool needs_radii() const {
    const auto* theory = std::get_if<TheoryParameters>(&parameters);
    return attachment == Attachment::surfaces || attachment == Attachment::neck ||
           (theory && (theory->of_radii.any() || theory->per_area.of_modulus()));
  }
  /// Whether its bonds need the law with rules.
  bool has_rules() const {
    return rules != no_rules || damping.by != DampingBy::none || weibull.modulus > 0.0;
  }
};

}  // namespace vbond
