#include "vbond/model/make_bond.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "vbond/model/joint_cells.hpp"
#include "vbond/model/rules.hpp"

namespace vbond {
namespace {

BondStiffness<double> parallel_of(const TheoryParameters& t, const Section& s, const BondRadii& R) {
  const PerArea& p = t.per_area;
  double k_n = p.k_n, k_s = p.k_s;
  if (p.of_modulus()) k_n = t.material.E / (R.i + R.j), k_s = k_n / p.ratio;
  if (p.grain_k_n > 0.0) k_n = between_grains(k_n, p.grain_k_n);
  if (p.grain_k_s > 0.0) k_s = between_grains(k_s, p.grain_k_s);
  return parallel_bond(k_n, k_s, s);
}

BondStiffness<double> stiffness_of(const TheoryParameters& t, const Section& s, double a,
                                   const BondRadii& R) {
  switch (t.theory) {
    case BondTheory::bernoulli_euler: return bernoulli_euler(t.material, s, a);
    case BondTheory::timoshenko: return timoshenko(t.material, s, a, t.kappa);
    case BondTheory::short_cylinder: return short_cylinder(t.material, s, a);
    case BondTheory::shell: return shell(t.material, t.thickness);
    case BondTheory::parallel: return parallel_of(t, s, R);
  }
  return {};
}

/// Of a whole bond, or of the cell of a flat joint.
Section section_of(const BondRecipe& recipe, const TheoryParameters& t, const BondRadii& R) {
  const Section whole = section_of(t, R);
  return recipe.cell ? section_of_cell(*recipe.cell, whole) : whole;
}

/// The radius of the section that a neck has; 0 if the recipe has no round section.
double neck_radius(const BondRecipe& recipe, const BondRadii& R) {
  const auto* theory = std::get_if<TheoryParameters>(&recipe.parameters);
  return theory ? section_of(*theory, R).r : 0.0;
}

/// Damping by ratio: reduced mass of stretching, inertia of bending and torsion, and for shear what the two
/// particles, turning about the middle of the bond, put up against it.
BondStiffness<double> reduced(const BondSite& i, const BondSite& j, const Bond& b) {
  const double mass = 1.0 / (1.0 / i.mass + 1.0 / j.mass),
               inertia = 1.0 / (1.0 / i.inertia + 1.0 / j.inertia);
  const double l_i = b.R_i + 0.5 * b.a, l_j = b.R_j + 0.5 * b.a;
  const double shear = 1.0 / (1.0 / mass + sq(l_i) / i.inertia + sq(l_j) / j.inertia);
  if (!b.law->has_offsets) return {mass, shear, inertia, inertia};
  const auto o = offsets_of(b);
  const double turns = (sq(o[0]) + sq(o[1])) / i.inertia + (sq(o[2]) + sq(o[3])) / j.inertia;
  return {1.0 / (1.0 / mass + turns), 1.0 / (1.0 / shear + 0.5 * turns), inertia, inertia};
}

std::array<double, 4> in_turn(const BondStiffness<double>& c) {
  return {c.c_A, c.c_D, c.c_B, c.c_T};
}

/// g_A, g_D, g_B, g_T of a bond.
std::array<double, 4> damping_of(const BondDamping& damping, const BondSite& i, const BondSite& j,
                                 const Bond& b) {
  std::array<double, 4> g = damping.values;
  const std::array<double, 4> c = in_turn(stiffness_of(b)), M = in_turn(reduced(i, j, b));
  for (std::size_t k = 0; k < g.size(); ++k) {
    if (damping.by == DampingBy::time) g[k] *= c[k];
    if (damping.by == DampingBy::ratio) g[k] *= 2.0 * std::sqrt(c[k] * M[k]);
  }
  return g;
}

/// The next state of SplitMix64 (Steele et al. 2014), which takes up one more number.
std::uint64_t mixed(std::uint64_t x, std::uint64_t more) {
  x += 0x9e3779b97f4a7c15 + more;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}
double from_0_to_1(std::uint64_t x) {
  return static_cast<double>(x >> 11) * 0x1p-53;
}

/// The same for the two particles of a pair, from whichever it is looked at; and for the image of the higher
/// one that it joins with the lower one itself, or of two images of one particle the one that is ahead.
std::uint64_t mixed(std::uint64_t x, ParticleId i, ParticleId j) {
  return mixed(mixed(x, std::min(i, j).value), std::max(i, j).value);
}
std::uint64_t mixed_with_image(std::uint64_t x, ParticleId i, ParticleId j, const Image& image_j) {
  const bool in_order = i < j || (i == j && image_j > -image_j);
  const Image n = in_order ? image_j : -image_j;
  for (const auto k : {n.a, n.b, n.c}) x = mixed(x, static_cast<std::uint64_t>(k));
  return x;
}

/// A number of [0, 1) that depends on the seed, the two particles and the image alone. Bonds through no face
/// have the same in an open body.
double variate(std::uint64_t seed, const Bond& b) {
  const std::uint64_t of_pair = mixed(seed, b.i, b.j);
  const Image image = image_of_j(b);
  return from_0_to_1(image.is_itself() ? of_pair : mixed_with_image(of_pair, b.i, b.j, image));
}

/// The rules of a bond whose stiffnesses have these factors: c_B/c_A then tells another round section than
/// its own, and what is known of it (Strength::own_section) is brought to the one that it has.
BondRules rules_without(const BondStiffness<double>& factors, BondRules rules) {
  const double told2 = factors.c_B / factors.c_A, told = std::sqrt(told2);  // radius told over its own
  rules.rubbing.reach /= told;
  Strength& s = rules.strength;
  if (!s.own_section) return rules;
  for (double* share : {&s.axial, &s.shear, &s.friction, &s.compression}) *share *= told2;
  for (double* share : {&s.bending, &s.torsion, &s.compression_bending}) *share *= told * told2;
  return rules;
}

/// What a bond of a law with rules has besides its stiffness.
void add_rules(const BondRecipe& recipe, const BondSite& i, const BondSite& j, Bond& b) {
  if (!b.law->has_rules) return;
  BondRules rules = recipe.cell ? rules_of_cell(*recipe.cell, recipe.rules) : recipe.rules;
  if (!std::holds_alternative<GivenCoefficients>(recipe.parameters))
    rules = rules_without(recipe.factors, std::move(rules));
  rules.damped = recipe.damping.by != DampingBy::none;
  b.rules = &kept(rules);
  if (rules.damped) {
    const std::array<double, 4> g = damping_of(recipe.damping, i, j, b);
    for (std::size_t k = 0; k < g.size(); ++k)
      b.coefficients.set(place_of(b, static_cast<RuleCoefficient>(k)), g[k]);
  }
  if (recipe.weibull.modulus > 0.0) {
    const double u = variate(recipe.weibull.seed, b);
    const auto* theory = std::get_if<TheoryParameters>(&recipe.parameters);
    const double A =
        theory && theory->of_radii.any() ? section_of(*theory, {i.radius, j.radius}).A : recipe.weibull.area;
    b.coefficients.set(place_of(b, RuleCoefficient::weakness),
                       1.0 / weibull_factor(recipe.weibull, u, A * b.a) - 1.0);
  }
}

/// Where the middle of the cell of a flat joint is: both sites have the same offset from their centres.
BondSite at_cell(const BondRecipe& recipe, BondSite site, const BondRadii& R, const Axes<double>& n) {
  const double r = section_of(std::get<TheoryParameters>(recipe.parameters), R).r;
  site.offset += r * (recipe.cell->y * n.y + recipe.cell->z * n.z);
  return site;
}

/// Lets the bonded points of a bond be where the sites say: offset from the axis through the centres of its
/// particles, which has these directions.
void offset_points(const BondRecipe& recipe, const BondSite& i, const BondSite& j, const Axes<double>& n,
                   Bond& b) {
  if (i.offset == Vec3d{} && j.offset == Vec3d{}) return;
  if (recipe.expansion != 0.0)
    throw std::invalid_argument("make_bond: bonds with offsets do not expand with temperature");
  const BondLaw* const ruled = with_rules(*b.law, no_rules);
  const BondLaw* const law = ruled ? with_offsets(*ruled) : nullptr;
  if (law == nullptr)
    throw std::invalid_argument("make_bond: law \"" + std::string(b.law->name) +
                                "\" has no form with offsets: only the library's laws do");
  Coefficients all = b.coefficients;
  std::copy_backward(all.begin(), all.end() - offset_coefficients, all.end());
  const Vec3d &o_i = i.offset, &o_j = j.offset;
  const std::array<double, offset_coefficients> o{dot(o_i, n.y), dot(o_i, n.z), dot(o_j, n.y), dot(o_j, n.z)};
  std::copy(o.begin(), o.end(), all.begin());
  b.coefficients = all;
  b.R_i += dot(o_i, n.x);
  b.R_j -= dot(o_j, n.x);
  b.law = law;
}

/// A bond with its coefficients and lengths; ends and axes are still to be filled in.
Bond with_coefficients(const BondRecipe& recipe, double a, double R_i, double R_j, const BondRadii& radii) {
  Bond b{};
  b.law = recipe.has_rules() ? with_rules(*recipe.law, recipe.rules) : recipe.law;
  if (b.law == nullptr)
    throw std::invalid_argument(
        "make_bond: law \"" + std::string(recipe.law->name) +
        "\" damps, breaks or remembers by itself, or has more than eight coefficients: "
        "it takes no rules, damping or weibull of a recipe");
  b.set = recipe.set;
  b.a = a;
  b.R_i = R_i;
  b.R_j = R_j;
  if (const auto* given = std::get_if<GivenCoefficients>(&recipe.parameters))
    b.coefficients = given->values;
  else
    b.coefficients = recipe.law->from_stiffness(stiffness_of(recipe, a, radii),
                                                recipe.reference_length.value_or(a), recipe.given);
  return b;
}

}  // namespace

BondStiffness<double> stiffness_of(const Bond& bond) {
  return bond.law->stiffness(bond);
}

BondStiffness<double> stiffness_of(const BondRecipe& recipe, double a, const BondRadii& radii) {
  const double a_ref = recipe.reference_length.value_or(a);
  const auto times_factors = [&f = recipe.factors](const BondStiffness<double>& c) {
    return BondStiffness<double>{f.c_A * c.c_A, f.c_D * c.c_D, f.c_B * c.c_B, f.c_T * c.c_T};
  };
  if (const auto* c = std::get_if<BondStiffness<double>>(&recipe.parameters)) return times_factors(*c);
  if (const auto* t = std::get_if<TheoryParameters>(&recipe.parameters))
    return times_factors(stiffness_of(*t, section_of(recipe, *t, radii), a_ref, radii));
  return stiffness_of(with_coefficients(recipe, a, 0.0, 0.0, radii));
}

BondLengths bond_lengths(const BondRecipe& recipe, double distance, const BondRadii& radii) {
  switch (recipe.attachment) {
    case Attachment::centres: return {distance, 0.0, 0.0};
    case Attachment::given: return {distance - recipe.R_i - recipe.R_j, recipe.R_i, recipe.R_j};
    case Attachment::surfaces: return {distance - radii.i - radii.j, radii.i, radii.j};
    case Attachment::neck: break;
  }
  const double gap = distance - radii.i - radii.j, r = neck_radius(recipe, radii);
  const double a = neck_length(gap, r, radii.i, radii.j), inwards = 0.5 * (gap - a);
  return {a, radii.i + inwards, radii.j + inwards};
}

double pair_variate(std::uint64_t seed, ParticleId i, ParticleId j, const Image& image_j) {
  constexpr std::uint64_t of_shares = 0x5348415245;
  return from_0_to_1(mixed_with_image(mixed(mixed(seed, of_shares), i, j), i, j, image_j));
}

double weibull_factor(const Weibull& weibull, double u, double V) {
  const double size = weibull.volume > 0.0 ? weibull.volume / V : 1.0;
  return std::pow(-size * std::log1p(-u), 1.0 / weibull.modulus);
}

Vec3d bond_n_2(const Vec3d& e, const std::optional<Vec3d>& wanted) {
  if (wanted) {
    const Vec3d n = across(normalised(*wanted), e);
    if (norm(n) > 1e-6) return normalised(n);
  }
  const double x = std::abs(e.x), y = std::abs(e.y), z = std::abs(e.z);
  const Vec3d axis = x <= y && x <= z ? Vec3d{1, 0, 0} : y <= z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  return normalised(across(axis, e));
}

std::optional<Bond> make_bond(const BondRecipe& recipe, const BondSite& i, const BondSite& j) {
  if (recipe.flat_joint.any() && !recipe.cell)
    throw std::invalid_argument("make_bond: a flat joint is several bonds: make one by each of recipes_of()");
  const Vec3d r_ij = between(i.r + i.offset, j.r + j.offset);
  const double distance = norm(r_ij);
  const BondRadii radii{i.radius, j.radius};
  const BondLengths lengths = bond_lengths(recipe, distance, radii);
  const double a = lengths.a / (1.0 + recipe.prestrain);
  if (!(a > 0.0)) return std::nullopt;

  const Vec3d e_ij = r_ij / distance;
  const Vec3d n_2 = bond_n_2(e_ij, recipe.n_2);
  Bond b = with_coefficients(recipe, a, lengths.R_i, lengths.R_j, radii);
  b.i = i.id;
  b.j = j.id;
  set_image_of_j(b, j.image - i.image);
  const Quatd frame = rotation_to(e_ij, n_2);
  set_frames(b, conjugate(i.q) * frame, conjugate(j.q) * frame);
  if (recipe.capsule)
    set_capsule(b, recipe.capsule_radius > 0.0 ? recipe.capsule_radius : std::min(i.radius, j.radius));
  const Axes<double> n = axes(frame);
  if (recipe.cell)
    offset_points(recipe, at_cell(recipe, i, radii, n), at_cell(recipe, j, radii, n), n, b);
  else
    offset_points(recipe, i, j, n, b);
  add_rules(recipe, i, j, b);
  return b;
}

bool breaks_as_made(const Bond& bond, const BondSite& i, const BondSite& j) {
  if (!can_break(bond)) return false;
  const BondPose<double> pose = bond_pose(bond, between(i.r, j.r), i.q, j.q);
  return bond.law->failure(bond, pose, first_history(bond, pose)).utilisation >= 1.0;
}

bool breaks_by_prestrain(const BondRecipe& recipe, const BondSite& i, const BondSite& j) {
  if (recipe.prestrain == 0.0) return false;
  BondRecipe mean = recipe;
  mean.weibull = {};
  const auto bond = make_bond(mean, i, j);
  return bond && breaks_as_made(*bond, i, j);
}

bool breaks_by_prestrain(const BondingRule& rule, const Model& model) {
  const auto smallest = [&model](const std::vector<char>& in) {
    double R = std::numeric_limits<double>::infinity();
    for (const ParticleId p : model.radius.ids())
      if (in[p.value]) R = std::min(R, model.radius[p]);
    return R;
  };
  const double R_i = smallest(rule.in_a), R_j = smallest(rule.in_b);
  const BondSite i{ParticleId{0}, {}, {}, R_i, 1.0, 1.0},
      j{ParticleId{1}, {rule.reach(R_i, R_j), 0, 0}, {}, R_j, 1.0, 1.0};
  return breaks_by_prestrain(rule.recipe, i, j);
}

}  // namespace vbond
