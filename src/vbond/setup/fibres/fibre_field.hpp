#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "vbond/core/cell.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/random.hpp"
#include "vbond/core/vec3.hpp"

/// Rigid fibres in a vessel, and what keeps them apart. A fibre is a row of points with capsules around the
/// segments between them.
namespace vbond {

enum class Face : unsigned char {
  through,  ///< fibres go through and come in on the other side
  whole,    ///< fibres stay between the two faces as a whole
  middle    ///< only their middles do
};

struct FibreVessel {
  std::array<Vec3d, 3> edges{};  ///< a right-handed system  [length]
  Vec3d corner;                  ///< where they begin  [length]
  std::array<Face, 3> faces{};   ///< those that an edge joins; other than through: normal to all other edges

  double volume() const { return dot(edges[0], cross(edges[1], edges[2])); }
  Periodic periodic() const;
  CellEdges cell() const;  ///< none if nothing goes through
  /// Unit vector along an edge.
  Vec3d along(std::size_t edge) const { return normalised(edges[edge]); }
};

struct FibreField {
  FibreVessel vessel;
  double radius = 0;               ///< [length]
  double distance = 0;             ///< least of the axes of two fibres: their diameter and the gap  [length]
  std::vector<std::size_t> first;  ///< point of each fibre, and one past the last point
  std::vector<Vec3d> shape;        ///< of all points, about the middle of their fibre  [length]
  std::vector<Vec3d> middle;       ///< mean of its points, of each fibre  [length]
  std::vector<Quatd> turn;         ///< of its shape

  std::size_t size() const { return middle.size(); }
  std::size_t points_of(std::size_t fibre) const { return first[fibre + 1] - first[fibre]; }
  void add(const std::vector<Vec3d>& points_about_middle);
  std::vector<Vec3d> points() const;
};

/// The middles that a fibre of this shape may have in the vessel, in parts of each edge; none if it does not
/// fit.
std::optional<std::array<std::array<double, 2>, 3>> room_for(const FibreField& field,
                                                             const std::vector<Vec3d>& shape);
/// Whether a fibre of this shape meets its own image, wherever it is.
bool meets_its_image(const FibreField& field, const std::vector<Vec3d>& shape);

/// Puts the fibres at random places, those of `order` one after another: a place is taken if nothing is there
/// yet. Returns how many found none in a number of tries and lie across others.
std::size_t add_sequentially(FibreField& field, const std::vector<std::size_t>& order, Random& random);

/// How fibres may turn while they are pushed apart.
struct TurnsAllowed {
  int dimensions = 3;  ///< of their directions; 2: about the normal, 1: not at all
  Vec3d normal;
};
/// Moves and turns fibres until none is nearer to another one than it may be, nor outside. False if that does
/// not come about.
bool push_apart(FibreField& field, const TurnsAllowed& turns);

/// The least distance of two axes; infinite for a single fibre in an open vessel.  [length]
double least_distance(const FibreField& field);

}  // namespace vbond
