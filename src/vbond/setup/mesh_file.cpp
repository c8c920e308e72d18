#include "vbond/setup/mesh_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

using Three = std::array<std::uint32_t, 3>;

MeshFormat format_of(const std::filesystem::path& file, const SourcePlace& place) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".ply") return MeshFormat::ply;
  throw CaseError({place, fmt::format("\"{}\" is no file of triangles that is known", file.string()),
                   "the extension tells the format: .stl, .obj or .ply", "convert the file to one of them"});
}

/// Takes the triangles without an area out of the mesh.
std::vector<Three> take_slivers(TriangleMesh& mesh) {
  const std::vector<Vec3d>& r = mesh.corners;
  std::vector<Three> slivers;
  std::erase_if(mesh.triangles, [&](const Three& t) {
    if (has_area(r[t[0]], r[t[1]], r[t[2]])) return false;
    slivers.push_back(t);
    return true;
  });
  return slivers;
}

/// A triangle with its corners in increasing order, and whether that turns it over.
struct Sorted {
  Three corners;
  std::size_t index;
  bool turned;
};

Sorted sorted(const Three& t, std::size_t index) {
  Sorted s{t, index, false};
  const auto order = [&](std::size_t i, std::size_t j) {
    if (s.corners[i] > s.corners[j]) std::swap(s.corners[i], s.corners[j]), s.turned = !s.turned;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return s;
}

/// Of triangles with the same corners the first stays, whichever way they turn: both sides of it are felt.
void drop_doubled(MeshFile& file) {
  std::vector<Three>& all = file.mesh.triangles;
  std::vector<Sorted> in_order;
  for (std::size_t k = 0; k < all.size(); ++k) in_order.push_back(sorted(all[k], k));
  std::sort(in_order.begin(), in_order.end(), [](const Sorted& a, const Sorted& b) {
    return std::tie(a.corners, a.index) < std::tie(b.corners, b.index);
  });
  std::vector<char> doubled(all.size(), 0);
  for (std::size_t n = 0; n < in_order.size();) {
    const std::size_t first = n;
    int sense = 0;
    for (; n < in_order.size() && in_order[n].corners == in_order[first].corners; ++n) {
      sense += in_order[n].turned ? -1 : 1;
      doubled[in_order[n].index] = n > first;
    }
    if (sense != 0) file.solid.push_back(all[in_order[first].index]);
  }
  std::size_t k = 0;
  file.doubled += std::erase_if(all, [&](const Three&) { return doubled[k++] != 0; });
}

struct EdgeCounts {
  std::size_t single = 0, odd = 0;  ///< edges with one triangle, with an odd number of them
};

EdgeCounts count_edges(const std::vector<Three>& triangles) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Three& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(std::minmax(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (std::size_t n = 0; n < edges.size();) {
    const std::size_t first = n;
    while (n < edges.size() && edges[n] == edges[first]) ++n;
    counts.single += n - first == 1;
    counts.odd += (n - first) % 2;
  }
  return counts;
}

}  // namespace

void clean(MeshFile& file) {
  std::vector<Three>& all = file.mesh.triangles;
  file.joined = join_corners(file.mesh);
  file.degenerate +=
      std::erase_if(all, [](const Three& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  const std::vector<Three> slivers = take_slivers(file.mesh);
  file.degenerate += slivers.size();
  const std::vector<Three> with_doubled = all;
  drop_doubled(file);
  const auto unpaired = [&](std::vector<Three> surface) {
    const std::size_t without = count_edges(surface).odd;
    surface.insert(surface.end(), slivers.begin(), slivers.end());
    return std::min(without, count_edges(surface).odd);
  };
  // what is there twice may be a fault of the file, a face in which two solids meet, or two that overlap
  // there
  const std::vector<Three> apart = std::exchange(file.solid, all);
  file.unpaired_edges = unpaired(file.solid);
  for (const auto& other : {apart, with_doubled})
    if (file.unpaired_edges > 0 && unpaired(other) == 0) file.solid = other, file.unpaired_edges = 0;
  file.open_edges = count_edges(all).single;
  const auto number = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), file.solid.begin(), file.solid.end());  // which has the same corners
  take_corners(std::vector<Vec3d>(file.mesh.corners), file.mesh);
  file.solid.assign(all.begin() + number, all.end());
  all.resize(static_cast<std::size_t>(number));
}

TriangleMesh MeshFile::surface() const {
  return {mesh.corners, solid};
}

std::string MeshFile::text() const {
  std::vector<std::string> parts{
      fmt::format("{} triangles, {} corners", mesh.triangles.size(), mesh.corners.size())};
  const auto say = [&](std::size_t count, const char* what) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, what));
  };
  if (joined.count > 0)
    parts.push_back(fmt::format("{} corners joined with others, at most {:.1g} of its size away",
                                joined.count, joined.farthest));
  say(degenerate, "triangles without an area left out");
  say(doubled, "doubled triangles left out");
  say(other, "points or lines left out");
  say(open_edges, "open edges");
  return fmt::format("{}", fmt::join(parts, ", "));
}

MeshFile read_mesh_file(const std::filesystem::path& file, double scale, const Vec3d& shift,
                        const SourcePlace& place) {
  const auto refuse = [&](const std::string& reason, const char* way_out) {
    throw CaseError({place, fmt::format("\"{}\" cannot be used: {}", file.string(), reason),
                     "a wall needs triangles: an STL, OBJ or PLY file that is whole, with finite coordinates",
                     way_out});
  };
  const MeshFormat format = format_of(file, place);
  const std::string content = read_bytes(file, place);
  if (const std::string reason = mistake_in_size(content, format); !reason.empty())
    refuse(reason, "write the file anew with the program that made it");
  MeshFile read;
  try {
    read = import_mesh(places_and_faces(content, format), format);
  } catch (const std::runtime_error& e) {
    refuse(e.what(), "write the file anew with the program that made it");
  }
  std::vector<Vec3d>& corners = read.mesh.corners;
  const auto check = [&](const Vec3d& r) {
    constexpr double largest = 1e60;  // as of the numbers of a case
    if (!(std::abs(r.x) < largest && std::abs(r.y) < largest && std::abs(r.z) < largest))
      refuse(fmt::format("a corner is at ({}, {}, {})", r.x, r.y, r.z),
             "look at the file, and at scale and shift");
  };
  for (const Vec3d& r : corners) check(r), check(scale * r + shift);
  clean(read);
  if (read.mesh.triangles.empty()) refuse("it has no triangles with an area", "look at the file in a viewer");
  for (Vec3d& r : corners) r = scale * r + shift;
  for (const auto& [a, b, c] : read.mesh.triangles)
    if (!has_area(corners[a], corners[b], corners[c]))
      refuse("shift takes it so far away that its corners cannot be told apart", "use a smaller shift");
  return read;
}

TriangleMesh box_mesh(const Vec3d& min, const Vec3d& max) {
  TriangleMesh mesh;
  for (std::uint32_t k = 0; k < 8; ++k)
    mesh.corners.push_back({k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z});
  mesh.triangles = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 7, 3}, {2, 6, 7}, {0, 6, 2}, {0, 4, 6}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace vbond
