#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// The box of a LAMMPS data file, as far as the file gives it.
struct LammpsBox {
  std::optional<double>
      period[3];                 ///< edges along x, y, z; of a tilted box: the diagonal of its cell's matrix
  std::array<double, 3> tilt{};  ///< xy, xz, yz

  static constexpr const char* lines[3] = {"low high xlo xhi", "low high ylo yhi", "low high zlo zhi"};

  bool is_tilted() const { return tilt != std::array<double, 3>{}; }

  /// How a line of the header that tells of the box must look; nullptr for other lines.
  static const char* form_of(const std::vector<std::string_view>& words);
  /// Reads it; false if it does not look so.
  bool read(const std::vector<std::string_view>& words);

  /// The shortest of the vectors that lead from one particle to the images of another, if the box has edges
  /// of some length; else d itself. Exact for boxes with right angles, good enough for tilted ones.
  Vec3d nearest_image(Vec3d d) const;
};

/// Marks bonds that are meant to go through the boundary of the box: through it they are shorter than they
/// stand, and as long as is usual, half to twice the median. If none of them is longer than 2.5 times the
/// median, the body may merely be as small as its box: then they are taken as they stand, with a note.
void find_bonds_across(const LammpsBox& box, const std::string& file, SpecimenPoints& points);

}  // namespace vbond
