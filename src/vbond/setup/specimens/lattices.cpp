#include <cmath>
#include <numbers>

#include "vbond/setup/specimens/random_surface.hpp"
#include "vbond/setup/specimens/surface.hpp"

namespace vbond {
namespace {

/// A rectangular cell and where its particles sit, all in units of the nearest-neighbour distance.
struct UnitCell {
  Vec3d size;
  std::vector<Vec3d> sites;
};

UnitCell unit_cell(Lattice lattice) {
  const double s2 = std::numbers::sqrt2, s3 = std::numbers::sqrt3;
  switch (lattice) {
    case Lattice::simple_cubic: return {{1, 1, 1}, {{0, 0, 0}}};
    case Lattice::fcc:
      return {{s2, s2, s2}, {{0, 0, 0}, {0, s2 / 2, s2 / 2}, {s2 / 2, 0, s2 / 2}, {s2 / 2, s2 / 2, 0}}};
    case Lattice::bcc: {
      const double edge = 2.0 / s3;  // of the cube: neighbours stand along its diagonals
      return {{edge, edge, edge}, {{0, 0, 0}, {0.5 * edge, 0.5 * edge, 0.5 * edge}}};
    }
    case Lattice::hcp: {
      const double h = std::sqrt(2.0 / 3.0);  // distance of close-packed planes
      return {{1, s3, 2 * h}, {{0, 0, 0}, {0.5, s3 / 2, 0}, {0.5, s3 / 6, h}, {0, 2 * s3 / 3, h}}};
    }
  }
  return {};
}

void require_counts(std::initializer_list<std::int64_t> counts, const SourcePlace& place) {
  for (const std::int64_t n : counts)
    if (n < 1)
      throw CaseError({place, "a count of " + std::to_string(n) + " along one direction",
                       "every direction holds at least one", "use counts of 1 or more"});
}

}  // namespace

SpecimenPoints make_points(const BlockSpecimen& s, const SourcePlace& place) {
  require_counts({s.cells[0], s.cells[1], s.cells[2]}, place);
  const UnitCell cell = unit_cell(s.lattice);
  SpecimenPoints points;
  for (std::int64_t z = 0; z < s.cells[2]; ++z)
    for (std::int64_t y = 0; y < s.cells[1]; ++y)
      for (std::int64_t x = 0; x < s.cells[0]; ++x)
        for (const Vec3d& site : cell.sites) {
          const Vec3d corner{static_cast<double>(x) * cell.size.x, static_cast<double>(y) * cell.size.y,
                             static_cast<double>(z) * cell.size.z};
          points.r.push_back(s.origin + s.spacing * (corner + site));
        }
  return points;
}

SpecimenPoints make_points(const SheetSpecimen& s, const SourcePlace& place) {
  if (s.lattice == SheetLattice::random) return random_sheet(s, place);
  require_counts({s.particles[0], s.particles[1]}, place);
  const bool triangular = s.lattice == SheetLattice::triangular;
  const double row_distance = triangular ? std::numbers::sqrt3 / 2 : 1.0;
  SpecimenPoints points;
  for (std::int64_t y = 0; y < s.particles[1]; ++y)
    for (std::int64_t x = 0; x < s.particles[0]; ++x) {
      const double shift = triangular && y % 2 == 1 ? 0.5 : 0.0;
      points.r.push_back(s.origin + s.spacing * Vec3d{static_cast<double>(x) + shift,
                                                      static_cast<double>(y) * row_distance, 0.0});
    }
  add_shares(s, points);
  return points;
}

}  // namespace vbond
