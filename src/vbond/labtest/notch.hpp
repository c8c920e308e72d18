#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vbond/labtest/test_body.hpp"

/// A sharp notch in a beam, and the toughness that it tells: docs/laboratory-tests.md.
namespace vbond::labtest {

/// The formula holds for this span over the height, and is taken for one that is no farther off than this
/// part.
inline constexpr double notched_span = 4.0, off_notched_span = 0.05;
/// Depths over the height for which it is taken.
inline constexpr double least_notch = 0.2, deepest_notch = 0.8;

/// k in K = s sqrt(W) k(a/W) of a beam of height W with an edge crack of depth a, in bending by three points
/// with a span of 4 W; s is the stress that the moment at the crack brings to the outer fibre of the whole
/// section. alpha = a/W, from 0 to 1. Srawley (1976), which ASTM E399 and ISO 12135 have: to 0.7 % of k from
/// 0.2 to 0.8.
double notched_beam_shape(double alpha);

/// What is left of a set of bonds, pair by pair.
struct ListedBonds {
  std::size_t set = 0;
  std::vector<std::array<std::int64_t, 2>> pairs;  ///< numbers of particles
};

/// A notch across a beam: the bonds that cross its plane down to a depth are left out.
struct Notch {
  double plane = 0;  ///< place along the axis  [length]
  /// From the stretched side: half of the way from the deepest bond that is left out to the next one that
  /// stays, where they cross the plane.  [length]
  double depth = 0;
  double height = 0, thickness = 0;     ///< of the beam  [length]
  std::size_t left_out = 0, stay = 0;   ///< bonds across the plane
  double toughness_per_force = 0;       ///< K over the force of the load  [1/length^1.5]
  std::vector<ListedBonds> bonds = {};  ///< of the sets that must be listed, so that no other bond is made
  double share() const { return depth / height; }
  double ligament() const { return thickness * (height - depth); }  ///< [length^2]
};

/// Where a beam is held and pushed, along its axis.  [length]
struct BeamPlaces {
  double left = 0, right = 0, load = 0;
};

/// The notch that the request asks for, in the middle of the span, at the side that the load stretches.
/// Throws CaseError if the body takes none.
Notch notch_of(const Body& body, const Request& request, const Section& section, const BeamPlaces& places);

/// The work of fracture is that of a test that ends with this part of the largest force or less.
inline constexpr double force_gone = 0.05;
/// Why there is none where so much is left.
std::string no_work_of_fracture(double left);

/// The case without the bonds of the notch.
void leave_out(const Notch& notch, Case& c);

}  // namespace vbond::labtest
