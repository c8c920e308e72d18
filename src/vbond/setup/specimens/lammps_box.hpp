#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {

/// The box of a LAMMPS data file, as far as the file gives it: by its ends along x, y and z, tilted or not,
/// or, as a general triclinic one, by three vectors.
struct LammpsBox {
  std::optional<std::array<double, 2>> ends[3];  ///< low and high along x, y, z  [length]
  std::optional<std::array<double, 3>> tilt;     ///< xy, xz, yz  [length]
  std::optional<Vec3d> vectors[3];               ///< avec, bvec, cvec  [length]
  std::optional<Vec3d> origin;                   ///< where they begin  [length]

  /// How a line of the header that tells of the box must look; nullptr for other lines.
  static const char* form_of(const std::vector<std::string_view>& words);
  /// Reads it; false if it does not look so.
  bool read(const std::vector<std::string_view>& words);

  /// What is wrong with these lines together; empty if nothing is.
  std::string mistake() const;

  /// Edge a, b or c, which an image flag counts; nothing if the file does not give it.
  std::optional<Vec3d> edge(std::size_t k) const;
  /// The line that would give it.
  const char* line_of_edge(std::size_t k) const;

  /// All of it; nothing if an edge is missing or there is no volume.
  std::optional<FileBox> whole() const;

  /// The shortest of the vectors that lead from one particle to the images of another, as far as the box has
  /// edges of some length; else d itself.
  Vec3d nearest_image(const Vec3d& d) const;

 private:
  bool is_general() const { return vectors[0] || vectors[1] || vectors[2] || origin; }
};

/// Marks bonds that are meant to go through the boundary of the box: through it they are shorter than they
/// stand, and as long as is usual, half to twice the median. If none of them is longer than 2.5 times the
/// median, the body may merely be as small as its box: then they are taken as they stand, with a note.
void find_bonds_across(const LammpsBox& box, const std::string& file, SpecimenPoints& points);

}  // namespace vbond
