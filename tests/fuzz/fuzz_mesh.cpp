#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/setup/mesh_file.hpp"
#include "vbond/terms/walls/mesh_surface.hpp"

/// The first byte chooses the format, the rest is the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbond;
  constexpr std::array names{"forged.stl", "forged.obj", "forged.ply"};
  if (size == 0) return 0;
  const auto file = fuzz::put(fuzz::folder() / names[data[0] % names.size()],
                              {reinterpret_cast<const char*>(data) + 1, size - 1});
  try {
    const MeshFile read = read_mesh_file(file, 2.0, {1, 0, 0}, {"fuzz.toml", 1, 1});
    for (const auto& triangle : read.mesh.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= read.mesh.corners.size()) std::abort();
    const MeshSurface surface(read.mesh);
    std::vector<std::uint32_t> near;
    std::vector<WallTouch> touches;
    surface.near({0.5, 0.5, 0.2}, 1.0, near);
    surface.touches_of(near, {0.5, 0.5, 0.2}, 1.0, touches);
    for (const WallTouch& t : touches)
      if (!(std::abs(norm(t.normal) - 1.0) < 1e-6 && t.distance >= 0.0 && t.distance < 1.0)) std::abort();
  } catch (const CaseError&) {
  }
  return 0;
}

namespace {

void append(std::string& text, const void* bytes, std::size_t count) {
  text.append(static_cast<const char*>(bytes), count);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using vbond::fuzz::add_seed;
  if (!vbond::fuzz::seeds()) return 0;
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::uint32_t two = 2;
  std::string stl(1, '\0');
  stl.append(80, 'x');
  append(stl, &two, 4);
  for (const int last : {2, 3}) {
    stl.append(12, '\0');
    append(stl, corners[0], 12);
    append(stl, corners[last - 1], 12);
    append(stl, corners[last], 12);
    stl.append(2, '\0');
  }
  add_seed("binary_stl", stl);
  add_seed("ascii_stl",
           std::string(1, '\0') +
               "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-1 0\n"
               "endloop\nendfacet\nendsolid s\n");
  add_seed(
      "obj",
      "\x01# square\nmtllib a.mtl\no s\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 1\nvt 0 0\nvn 0 0 1\ng a\ns off\n"
      "usemtl m\nf 1/1/1 2//1 3/1 4\nf -4 -3 -2\nl 1 2\np 1\n");
  const std::string tail =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n";
  add_seed("ascii_ply", "\x02ply\nformat ascii 1.0\ncomment c\n" + tail +
                            "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n");
  std::string ply = "\x02ply\nformat binary_little_endian 1.0\n" + tail;
  append(ply, corners, sizeof corners);
  for (const int last : {2, 3}) {
    const std::int32_t face[3] = {0, last - 1, last};
    ply += '\3';
    append(ply, face, sizeof face);
  }
  add_seed("binary_ply", ply);
  std::exit(0);
}
