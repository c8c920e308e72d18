#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/core/triangle_mesh.hpp"
#include "vbond/setup/mesh_corners.hpp"

namespace vbond {

enum class MeshFormat : std::uint8_t { stl, obj, ply };

/// What a file of triangles holds, made fit for walls, and what was done to it.
struct MeshFile {
  TriangleMesh mesh;
  JoinedCorners joined;
  std::size_t degenerate = 0;  ///< triangles without an area, left out
  std::size_t doubled = 0;     ///< triangles that had the corners of another one, left out
  /// The surface of solids: each triangle once, if that is closed. Else it lacks the faces in which two
  /// solids meet, which are there as often in the one sense as in the other; or, where two overlap, has faces
  /// twice.
  std::vector<std::array<std::uint32_t, 3>> solid;
  std::size_t other = 0;       ///< points and lines, left out
  std::size_t open_edges = 0;  ///< with a triangle on one side only: holes and outlines
  /// Edges of `solid` with an odd number of triangles: 0 if it is closed. What has no area counts here where
  /// it fills gaps of width zero.
  std::size_t unpaired_edges = 0;
  /// `solid` with its corners.
  TriangleMesh surface() const;
  /// In one line, for the user.
  std::string text() const;
};

/// Reads an STL (binary or ASCII), OBJ or PLY file, told by its extension; polygons become triangles. Corners
/// at the same place to rounding are one (join_corners), wherever scale and shift then take them. Coordinates
/// have the precision of 32 bits. `file`: as seen from the current folder. Throws CaseError at `place`, where
/// the case names it, also for a file that is cut off or claims more than it holds: sizes are compared before
/// memory is asked for.
MeshFile read_mesh_file(const std::filesystem::path& file, double scale, const Vec3d& shift,
                        const SourcePlace& place);

/// Why this content cannot be a file of the format, as far as its size tells; empty if nothing is wrong.
std::string mistake_in_size(std::string_view content, MeshFormat format);

/// The file without texture coordinates, normals, names, materials and comments, as far as they disturb.
std::string places_and_faces(std::string content, MeshFormat format);

/// The triangles of a file of this format, corners as they stand in it. Throws std::runtime_error with the
/// reason.
MeshFile import_mesh(std::string_view content, MeshFormat format);

/// Joins corners, leaves out what is no triangle or there already, counts open edges. Coordinates are finite.
void clean(MeshFile& file);

/// The twelve triangles of a box along the axes.
TriangleMesh box_mesh(const Vec3d& min, const Vec3d& max);

}  // namespace vbond
