#pragma once
#include "vbond/setup/specimens/specimen.hpp"

/// Surfaces with particles at random places and even distances, about a spacing apart: random, then pushed
/// apart until they are evenly spread, the borders first, in even steps. Bonds are the edges of Delaunay's
/// triangles: flat for sheets and cylinders (which are rolled up after that), the convex hull for spheres.
namespace vbond {

SpecimenPoints random_sheet(const SheetSpecimen& s, const SourcePlace& place);
SpecimenPoints random_cylinder(const CylinderSpecimen& s, const SourcePlace& place);
SpecimenPoints random_sphere(const SphereSpecimen& s, const SourcePlace& place);

}  // namespace vbond
