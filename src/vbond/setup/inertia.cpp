#include "vbond/setup/inertia.hpp"

#include "vbond/core/scalar.hpp"

namespace vbond {
namespace {

Vec3d vector(const std::array<double, 3>& a) {
  return {a[0], a[1], a[2]};
}

Vec3d moments_of(const EllipsoidSolid& s, double mass) {
  return moments_of_ellipsoid(mass, vector(s.semi_axes));
}
Vec3d moments_of(const BoxSolid& s, double mass) {
  return moments_of_box(mass, vector(s.edges));
}
Vec3d moments_of(const CylinderSolid& s, double mass) {
  return moments_of_cylinder(mass, s.size[0], s.size[1]);
}

PrincipalInertia equal(double moment) {
  return {{moment, moment, moment}, {}};
}

PrincipalInertia given(const SpecimenSpec& spec, const SpecimenPoints& points, std::size_t i, double mass,
                       double radius) {
  if (!points.moments.empty()) return {points.moments[i], {}};
  if (!points.inertia.empty()) return equal(points.inertia[i]);
  if (spec.principal_inertia) return {vector(*spec.principal_inertia), {}};
  if (spec.inertia_tensor) {
    const auto& I = *spec.inertia_tensor;
    return principal_inertia({I[0], I[1], I[2], I[3], I[4], I[5]}).value_or(equal(0.0));
  }
  if (spec.solid)
    return {std::visit([mass](const auto& shape) { return moments_of(shape, mass); }, spec.solid->shape), {}};
  return equal(spec.inertia.value_or(0.4 * mass * sq(radius)));
}

}  // namespace

PrincipalInertia inertia_of(const SpecimenSpec& spec, const SpecimenPoints& points, std::size_t i,
                            double mass, double radius) {
  const PrincipalInertia inertia = given(spec, points, i, mass, radius);
  constexpr double rounding = 1e-14;  // of a tensor that was turned into its principal axes
  const double least = least_of(inertia.moments);
  return largest_of(inertia.moments) - least <= rounding * least ? equal(least) : inertia;
}

int times_inertia_is_given(const SpecimenSpec& spec, const SpecimenPoints& points) {
  return spec.inertia.has_value() + spec.principal_inertia.has_value() + spec.inertia_tensor.has_value() +
         spec.solid.has_value() + !points.inertia.empty() + !points.moments.empty();
}

}  // namespace vbond
