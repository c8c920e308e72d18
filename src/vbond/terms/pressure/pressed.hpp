#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/terms/pressure/pressure.hpp"

namespace vbond {

/// The vector area of a facet, where at(p) is the place of a particle.  [length^2]
template <class At>
Vec3d area_of(const Facet& f, const Vec3d& across, const At& at) {
  const Vec3d r_i = at(f.i), r_ij = between(r_i, at(f.j));
  return f.is_strip() ? cross(r_ij, across) : 0.5 * cross(r_ij, between(r_i, at(f.k)));
}

/// The facets of the pressures of a stage, with their areas as the particles stand.
std::vector<PressedFacet> facets_as_found(const std::vector<Pressure>& pressures,
                                          const PerParticle<Vec3d>& r);
/// Whether these are facets of those pressures: as many of each as it names, if it names any.
bool belong_to(const std::vector<PressedFacet>& facets, const std::vector<Pressure>& pressures);

/// Whether every edge of triangles has one on its other side that runs against it, and every end of a strip
/// is the start of another one.
bool is_closed(const std::vector<Facet>& facets);

/// What facets measure as particles stand.
struct SurfaceSize {
  double area = 0;    ///< [length^2]
  double volume = 0;  ///< enclosed by closed surfaces, < 0 where they face inwards  [length^3]
};
SurfaceSize size_of(const std::vector<Facet>& facets, const Vec3d& across, const PerParticle<Vec3d>& r);

/// What the pressures of a stage do to particles. Forces and work are those of a pressure of 1, and functions
/// of places: at(p) is that of a particle. Sums go over facets in their order.
class PressedSurfaces {
 public:
  /// What a pressure does to one of its particles.
  struct Share {
    ParticleId p;
    std::uint32_t pressure = 0;
    std::size_t first = 0, last = 0;  ///< of its facets, in facets_of_shares()
    Vec3d dead;                       ///< the force as the stage began  [length^2]
    double towards = 0;               ///< what of it pointed to the centre, of central pressures  [length^2]
  };

  PressedSurfaces() = default;
  /// Keeps a reference to the pressures. facets belong to them.
  PressedSurfaces(const std::vector<Pressure>& pressures, std::vector<PressedFacet> facets);
  PressedSurfaces(const std::vector<Pressure>&&, std::vector<PressedFacet>) = delete;

  bool any() const { return !shares_.empty(); }
  const Pressure& pressure(std::size_t k) const { return (*pressures_)[k]; }
  const std::vector<PressedFacet>& facets() const { return facets_; }
  /// In order of particles, and for each of pressures.
  const std::vector<Share>& shares() const { return shares_; }

  template <class At>
  Vec3d force(const Share& s, const At& at) const {
    const Pressure& pressure = (*pressures_)[s.pressure];
    if (pressure.kind == PressureKind::dead) return s.dead;
    if (pressure.kind == PressureKind::central) {
      const Vec3d to_centre = between(at(s.p), pressure.centre);
      return s.towards / norm(to_centre) * to_centre;
    }
    Vec3d sum;
    for (std::size_t k = s.first; k < s.last; ++k) {
      const Facet f = facets_[of_shares_[k]].facet();
      sum -= area_of(f, pressure.across, at) / f.corners();
    }
    return sum;
  }

  /// Work of each pressure where all particles go straight from one place to the other: exact, since areas
  /// are polynomials of the second degree in the way. Of closed surfaces what the volume shrinks by.
  /// [length^3]
  template <class At>
  std::vector<double> work(const At& from, const At& to) const {
    std::vector<double> work(pressures_ == nullptr ? 0 : pressures_->size(), 0.0);
    const auto half_way = [&](ParticleId p) { return 0.5 * (from(p) + to(p)); };
    for (const PressedFacet& f : facets_) {
      const Pressure& pressure = (*pressures_)[f.pressure];
      if (pressure.kind != PressureKind::follower) continue;
      const Facet facet = f.facet();
      const Vec3d area = (area_of(facet, pressure.across, from) + area_of(facet, pressure.across, to) +
                          4.0 * area_of(facet, pressure.across, half_way)) /
                         6.0;
      Vec3d way = between(from(f.i), to(f.i)) + between(from(f.j), to(f.j));
      if (!facet.is_strip()) way += between(from(f.k), to(f.k));
      work[f.pressure] -= dot(area, way) / facet.corners();
    }
    for (const Share& s : shares_) {
      const Pressure& pressure = (*pressures_)[s.pressure];
      if (pressure.kind == PressureKind::dead) work[s.pressure] += dot(s.dead, between(from(s.p), to(s.p)));
      if (pressure.kind == PressureKind::central)
        work[s.pressure] +=
            s.towards * (norm(between(from(s.p), pressure.centre)) - norm(between(to(s.p), pressure.centre)));
    }
    return work;
  }

 private:
  const std::vector<Pressure>* pressures_ = nullptr;
  std::vector<PressedFacet> facets_;
  std::vector<Share> shares_;
  std::vector<std::size_t> of_shares_;
};

/// The derivative of a facet's force on each of its corners, of a pressure of 1, with the place of corner b
/// (0: i, 1: j, 2: k) is the cross product of this with the shift of the corner.  [length]
template <class At>
Vec3d turn_of_force(const Facet& f, const Vec3d& across, int b, const At& at) {
  if (f.is_strip()) return (b == 0 ? -0.5 : 0.5) * across;
  const ParticleId corner[3] = {f.i, f.j, f.k};
  return -1.0 / 6.0 * between(at(corner[(b + 1) % 3]), at(corner[(b + 2) % 3]));
}

/// A bound of what the pressures add to the square of the highest angular frequency, at their largest factors
/// until `duration`: of rows of the matrix of their stiffness over the masses.  [1/time^2]
double lambda_of_pressures(const std::vector<Pressure>& pressures, const PerParticle<double>& mass,
                           const PerParticle<Vec3d>& r, double duration);

/// In words, as "48 strips of group \"ring\", closed: area 6.3, volume 3.1".
std::string in_words(const Pressure& pressure, const PerParticle<Vec3d>& r);

}  // namespace vbond
