#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/labtest/request.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::labtest {

/// The body of a case, and how the test lies in it.
struct Body {
  const Case& c;
  const Model& model;
  const State& state;
  std::string file;        ///< of the case, for messages
  int axis = 2;            ///< along the specimen
  int across = 0;          ///< normal to it: along which shear, bend3 and brazilian load
  int third = 1;           ///< normal to both
  BoundingBox box;         ///< around the particles, as far as they reach  [length]
  double beyond = 0;       ///< by how much they reach farther than their radii  [length]
  double spacing = 0;      ///< mean distance of bonded centres  [length]
  double wave_speed = 0;   ///< about that of a lattice with this spacing and T_0  [length/time]
  bool can_break = false;  ///< some bond has a strength
  bool gives_way = false;  ///< some soften, or their stretching is no straight line
  bool creeps = false;     ///< some do

  /// From the centre of a particle to the surface of the body  [length].
  double reach(ParticleId p) const { return std::max(0.0, model.radius[p] + beyond); }
  double low(int direction) const { return component(box.low, direction); }
  double high(int direction) const { return component(box.high, direction); }
  double extent(int direction) const { return high(direction) - low(direction); }
  double middle(int direction) const { return 0.5 * (low(direction) + high(direction)); }
};

/// Measures the body that a case makes. Throws CaseError for what no test takes: periodic cells, bodies that
/// come in, bonds of stages, no bonds, parts that nothing joins.
Body body_of(const Case& c, const Built& built, const Request& request);

[[noreturn]] void refuse(const Body& body, const std::string& what, const std::string& rule,
                         const std::string& way_out);

enum class SectionShape : std::uint8_t { box, circle, given };

/// Normal to the axis, as far as particles reach.
struct Section {
  SectionShape shape = SectionShape::box;
  double area = 0;                 ///< [length^2]
  std::array<double, 2> extent{};  ///< across and along the third direction; of a circle its diameter twice
  std::vector<std::string> notes = {};  ///< what is to be known of it, a line each
  std::string text() const;             ///< "box 4 x 4"
};
/// Throws CaseError if it is neither a box nor a circle, not all along the body, or hollow, and no area is
/// given.
Section section_of(const Body& body, const Request& request);

/// Particles whose centres are behind a plane, at one side of the body.
struct Side {
  std::string group;
  int direction = 2;
  bool upper = false;
  double plane = 0;  ///< component of a point of it  [length]
  std::vector<ParticleId> particles;
  double mean = 0;   ///< of their centres along the direction  [length]
  double inner = 0;  ///< the same, of those within half a spacing of the innermost one  [length]
};
/// The particles that reach the face there, or those no deeper than the depth that is asked for.
Side side_of(const Body& body, const std::string& group, int direction, bool upper, const Request& request);

/// One degree of freedom of a particle: translation along a direction.
struct PointHold {
  ParticleId particle{0};
  int direction = 0;
};
/// Those of the candidates that, with what is held already, bar every rigid motion and nothing else; nothing
/// if the candidates cannot.
std::optional<std::vector<PointHold>> bar_rigid_motions(const Body& body, const std::vector<PointHold>& held,
                                                        const std::vector<ParticleId>& candidates);

/// A vector of this length along an axis.
inline Vec3d along(int direction, double length = 1.0) {
  Vec3d a{};
  component(a, direction) = length;
  return a;
}

inline const char* name_of_axis(int direction) {
  constexpr const char* names[] = {"x", "y", "z"};
  return names[direction];
}

}  // namespace vbond::labtest
