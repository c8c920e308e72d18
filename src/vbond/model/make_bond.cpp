#include "vbond/model/make_bond.hpp"

#include <cmath>

namespace vbond {
namespace {

BondStiffness<double> stiffness_of(const TheoryParameters& t, double a) {
  switch (t.theory) {
    case BondTheory::bernoulli_euler: return bernoulli_euler(t.material, t.section, a);
    case BondTheory::timoshenko: return timoshenko(t.material, t.section, a, t.kappa);
    case BondTheory::short_cylinder: return short_cylinder(t.material, t.section, a);
  }
  return {};
}

/// A bond with its coefficients and lengths; ends and axes are still to be filled in.
Bond with_coefficients(const BondRecipe& recipe, double a, double R_i, double R_j) {
  Bond b{};
  b.law = recipe.law;
  b.set = recipe.set;
  b.a = a;
  b.R_i = R_i;
  b.R_j = R_j;
  if (const auto* given = std::get_if<GivenCoefficients>(&recipe.parameters))
    b.coefficients = given->values;
  else
    b.coefficients = recipe.law->from_stiffness(stiffness_of(recipe, a), recipe.reference_length.value_or(a),
                                                recipe.given);
  return b;
}

}  // namespace

BondStiffness<double> stiffness_of(const Bond& bond) {
  return bond.law->stiffness(bond);
}

BondStiffness<double> stiffness_of(const BondRecipe& recipe, double a) {
  const double a_ref = recipe.reference_length.value_or(a);
  if (const auto* c = std::get_if<BondStiffness<double>>(&recipe.parameters)) return *c;
  if (const auto* t = std::get_if<TheoryParameters>(&recipe.parameters)) return stiffness_of(*t, a_ref);
  return stiffness_of(with_coefficients(recipe, a, 0.0, 0.0));
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
  const Vec3d r_ij = j.r - i.r;
  const double distance = norm(r_ij);
  double R_i = recipe.R_i, R_j = recipe.R_j;
  if (recipe.attachment == Attachment::centres) R_i = R_j = 0.0;
  if (recipe.attachment == Attachment::surfaces) R_i = i.radius, R_j = j.radius;
  const double a = distance - R_i - R_j;
  if (!(a > 0.0)) return std::nullopt;

  const Vec3d e_ij = r_ij / distance;
  const Vec3d n_2 = bond_n_2(e_ij, recipe.n_2);
  Bond b = with_coefficients(recipe, a, R_i, R_j);
  b.i = i.id;
  b.j = j.id;
  const Quatd frame = rotation_to(e_ij, n_2);
  b.frame_i = conjugate(i.q) * frame;
  b.frame_j = conjugate(j.q) * frame;
  return b;
}

}  // namespace vbond
