#include "vbond/build/mesh_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include "vbond/build/text_file.hpp"

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

/// Corners at the same place become one, in order of their first use.
void join_corners(TriangleMesh& mesh) {
  const auto key = [](const Vec3d& r) { return std::tuple(r.x, r.y, r.z); };
  std::vector<std::uint32_t> order(mesh.corners.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const auto a = key(mesh.corners[i]), b = key(mesh.corners[j]);
    return a != b ? a < b : i < j;
  });
  std::vector<std::uint32_t> same_as(order.size());
  for (std::size_t n = 0; n < order.size(); ++n) {
    const bool again = n > 0 && mesh.corners[order[n]] == mesh.corners[order[n - 1]];
    same_as[order[n]] = again ? same_as[order[n - 1]] : order[n];
  }
  constexpr std::uint32_t unused = 0xFFFFFFFFu;
  std::vector<std::uint32_t> number(order.size(), unused);
  std::vector<Vec3d> corners;
  for (Three& t : mesh.triangles)
    for (std::uint32_t& corner : t) {
      std::uint32_t& n = number[same_as[corner]];
      if (n == unused) {
        n = static_cast<std::uint32_t>(corners.size());
        corners.push_back(mesh.corners[corner]);
      }
      corner = n;
    }
  mesh.corners = std::move(corners);
}

void drop_degenerate(MeshFile& file) {
  const std::vector<Vec3d>& r = file.mesh.corners;
  file.degenerate += std::erase_if(file.mesh.triangles,
                                   [&](const Three& t) { return !has_area(r[t[0]], r[t[1]], r[t[2]]); });
}

/// Of triangles with the same corners the first stays, whichever way they turn: both sides of it are felt.
void drop_doubled(MeshFile& file) {
  std::vector<Three>& all = file.mesh.triangles;
  std::vector<std::pair<Three, std::size_t>> sorted;
  for (std::size_t k = 0; k < all.size(); ++k) {
    Three t = all[k];
    std::sort(t.begin(), t.end());
    sorted.emplace_back(t, k);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<char> doubled(all.size(), 0);
  for (std::size_t n = 1; n < sorted.size(); ++n)
    if (sorted[n].first == sorted[n - 1].first) doubled[sorted[n].second] = 1;
  std::size_t k = 0;
  file.doubled += std::erase_if(all, [&](const Three&) { return doubled[k++] != 0; });
}

std::size_t count_open_edges(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Three& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(std::minmax(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t n = 0; n < edges.size(); ++n)
    open += (n == 0 || edges[n] != edges[n - 1]) && (n + 1 == edges.size() || edges[n] != edges[n + 1]);
  return open;
}

}  // namespace

void clean(MeshFile& file) {
  drop_degenerate(file);
  join_corners(file.mesh);
  drop_doubled(file);
  file.open_edges = count_open_edges(file.mesh);
}

std::string MeshFile::text() const {
  std::vector<std::string> parts{
      fmt::format("{} triangles, {} corners", mesh.triangles.size(), mesh.corners.size())};
  const auto say = [&](std::size_t count, const char* what) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, what));
  };
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
    read = import_mesh(content, format);
  } catch (const std::runtime_error& e) {
    refuse(e.what(), "write the file anew with the program that made it");
  }
  for (Vec3d& r : read.mesh.corners) {
    r = scale * r + shift;
    constexpr double largest = 1e60;  // as of the numbers of a case
    if (!(std::abs(r.x) < largest && std::abs(r.y) < largest && std::abs(r.z) < largest))
      refuse(fmt::format("a corner is at ({}, {}, {})", r.x, r.y, r.z),
             "look at the file, and at scale and shift");
  }
  clean(read);
  if (read.mesh.triangles.empty()) refuse("it has no triangles with an area", "look at the file in a viewer");
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
