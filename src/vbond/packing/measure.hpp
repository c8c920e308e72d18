#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "vbond/packing/vessel.hpp"

namespace vbond::packing {

/// Radical cells of grains: the part of the vessel that is nearest to each.
struct MeasuredCells {
  double least = 0, mean = 0, largest = 0;  ///< volumes  [length^3]
  /// 1 - volume of a grain / volume of its cell; overlaps and places behind walls make it a little too small.
  double least_porosity = 0, mean_porosity = 0, largest_porosity = 0;
  /// Mean number of faces of more than least_face times the square of the distance of the two grains.
  double faces = 0;
  static constexpr double least_face = 0.01;
};

/// What a packing is like.
struct Measured {
  double volume = 0;         ///< of the vessel  [length^3]
  double porosity = 0;       ///< 1 - volume of the grains / volume of the vessel
  double core_porosity = 0;  ///< of what is deeper than a mean radius below walls, by counting points, to
                             ///< about 1e-3; without walls the same; -1 if nothing is so deep
  double mean_radius = 0, least_radius = 0, largest_radius = 0;  ///< [length]
  double contacts = 0;  ///< mean number of contacts of a grain, walls among them
  /// Twice the contacts between grains that are held, and of these with walls, over their number: 6 - 6 /
  /// number if there are as many contacts as it takes to hold them in a cell.
  double backbone_contacts = 0;
  std::size_t rattlers = 0;         ///< grains with fewer than four contacts, those with rattlers not counted
  std::size_t loners = 0;           ///< grains without a neighbour within a gap of 1.05
  double largest_overlap = 0;       ///< over the smaller radius
  double largest_wall_overlap = 0;  ///< over the radius
  /// Mean number of neighbours whose distance is below this factor of the sum of radii.
  static constexpr std::array<double, 6> gaps{1.01, 1.02, 1.05, 1.1, 1.15, 1.2};
  std::array<double, 6> neighbours{};
  /// Radial distribution: of places around a grain, over the mean, in shells of rdf_step mean diameters;
  /// empty if no grain is as deep below the walls as it reaches.
  static constexpr double rdf_step = 0.02, rdf_reach = 3.0;
  std::vector<double> rdf;
  std::optional<MeasuredCells> cells;  ///< by measure_cells()
};

/// touching: grains with gaps up to this count as contacts.  [length]
Measured measure(const Vessel& vessel, double volume, const std::vector<Vec3d>& r,
                 const std::vector<double>& radius, double touching = 0.0);

/// Nothing where planes do not stand for the walls: space_of() in voronoi.hpp.
std::optional<MeasuredCells> measure_cells(const Vessel& vessel, const std::vector<Vec3d>& r,
                                           const std::vector<double>& radius, int threads);

/// Of spheres, overlaps counted twice.  [length^3]
double volume_of(const std::vector<double>& radius);

/// How many neighbours each has within that factor of the sum of radii.
std::vector<int> count_neighbours(const Vessel& vessel, const std::vector<Vec3d>& r,
                                  const std::vector<double>& radius, double gap);

}  // namespace vbond::packing
