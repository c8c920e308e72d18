#include <array>
#include <cstring>
#include <limits>

#include "cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/mesh_file.hpp"

namespace vbond::test {
namespace {

struct Corner {
  float x, y, z;
};
using Triangle = std::array<Corner, 3>;

template <class T>
std::string bytes_of(const T& value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}

std::string binary_stl(const std::vector<Triangle>& triangles, std::uint32_t claimed) {
  std::string text = "solid is what some programs write into binary heads";
  text.resize(80, ' ');
  text += bytes_of(claimed);
  for (const Triangle& t : triangles) text += bytes_of(Corner{}) + bytes_of(t) + std::string(2, '\0');
  return text;
}
std::string binary_stl(const std::vector<Triangle>& triangles) {
  return binary_stl(triangles, static_cast<std::uint32_t>(triangles.size()));
}

std::string ascii_stl(const std::vector<Triangle>& triangles) {
  std::string text = "solid plate\n";
  for (const Triangle& t : triangles) {
    text += "facet normal 0 0 1\n outer loop\n";
    for (const Corner& c : t)
      text +=
          "  vertex " + std::to_string(c.x) + " " + std::to_string(c.y) + " " + std::to_string(c.z) + "\n";
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid plate\n";
}

/// A unit square.
const std::vector<Triangle> square{Triangle{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}},
                                   Triangle{{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}};

const char* const obj = "mtllib other.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const char* const ascii_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 "
    "3\n";

std::string binary_ply(std::string faces_claimed) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face " +
      faces_claimed + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Corner& c : {Corner{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) text += bytes_of(c);
  for (const std::array<int, 3>& f : {std::array{0, 1, 2}, {0, 2, 3}}) text += "\3" + bytes_of(f);
  return text;
}

MeshFile read(const std::string& name, const std::string& content) {
  const TemporaryFile file(name, content);
  return read_mesh_file(file.path(), 1.0, {}, {"case.toml", 7, 8});
}

std::string refusal(const std::string& name, const std::string& content) {
  try {
    read(name, content);
  } catch (const CaseError& e) {
    EXPECT_EQ(e.problems().at(0).place.line, 7u);
    return e.what();
  }
  return "accepted";
}

void expect_refused(const std::string& name, const std::string& content, const std::string& because) {
  const std::string text = refusal(name, content);
  EXPECT_TRUE(contains(text, because)) << name << " was met with: " << text;
}

TEST(MeshFiles, OfEveryFormatHoldTheSameSquare) {
  const std::pair<const char*, std::string> files[] = {{"binary.stl", binary_stl(square)},
                                                       {"ascii.STL", ascii_stl(square)},
                                                       {"square.obj", obj},
                                                       {"ascii.ply", ascii_ply},
                                                       {"binary.ply", binary_ply("2")}};
  for (const auto& [name, content] : files) {
    const MeshFile file = read(name, content);
    ASSERT_EQ(file.mesh.triangles.size(), 2u) << name;
    EXPECT_EQ(file.mesh.corners.size(), 4u) << name;
    EXPECT_EQ(file.open_edges, 4u) << name;
    EXPECT_EQ(file.degenerate + file.doubled + file.other, 0u) << name;
    double area = 0.0;
    for (const auto& [a, b, c] : file.mesh.triangles)
      area += 0.5 * norm(cross(file.mesh.corners[b] - file.mesh.corners[a],
                               file.mesh.corners[c] - file.mesh.corners[a]));
    EXPECT_EQ(area, 1.0) << name;
  }
}

TEST(MeshFiles, AreScaledThenShifted) {
  const TemporaryFile file("square.stl", binary_stl(square));
  const MeshFile read = read_mesh_file(file.path(), 0.5, {1, 2, 3}, {});
  const BoundingBox box = box_around(read.mesh.corners);
  EXPECT_EQ(box.low, (Vec3d{1, 2, 3}));
  EXPECT_EQ(box.high, (Vec3d{1.5, 2.5, 3}));
}

TEST(MeshFiles, WithDefectsAreCleanedAndTheDefectsCounted) {
  std::vector<Triangle> triangles = square;
  triangles.push_back({{{1, 1, 0}, {0, 0, 0}, {1, 0, 0}}});         // the first again, from another corner
  triangles.push_back({{{1, 0, 0}, {0, 0, 0}, {1, 1, 0}}});         // and turned over
  triangles.push_back({{{0, 0, 0}, {0.5F, 0.5F, 0}, {1, 1, 0}}});   // on a line
  triangles.push_back({{{0, 0, 0}, {0, 0, 0}, {1, 1, 0}}});         // two equal corners
  triangles.push_back({{{0, 0, -0.0F}, {1, 0, 0}, {0.5F, 0, 1}}});  // at right angles: an edge of three
  const MeshFile file = read("defects.stl", binary_stl(triangles));
  EXPECT_EQ(file.mesh.triangles.size(), 3u);
  EXPECT_EQ(file.mesh.corners.size(), 5u);
  EXPECT_EQ(file.degenerate, 2u);
  EXPECT_EQ(file.doubled, 2u);
  EXPECT_EQ(file.open_edges, 5u);
  EXPECT_EQ(file.text(),
            "3 triangles, 5 corners, 2 triangles without an area left out, 2 doubled triangles left out, 5 "
            "open edges");
}

TEST(MeshFiles, ThatAreNotWholeAreRefusedWithTheReason) {
  const std::string stl = binary_stl(square), ascii = ascii_stl(square);
  expect_refused("empty.stl", "", "it is empty");
  expect_refused("empty.obj", "", "it is empty");
  expect_refused("short.stl", stl.substr(0, 60), "it has no triangles");  // begins with "solid"
  expect_refused("short.stl", std::string(70, 'x'), "less than the head");
  expect_refused("none.stl", binary_stl({}), "it has no triangles");
  expect_refused("cut.stl", stl.substr(0, stl.size() - 1), "it has no triangles");
  std::string nameless = stl;
  nameless.replace(0, 5, "model");
  expect_refused("cut.stl", nameless.substr(0, nameless.size() - 1),
                 "it claims 2 triangles, which take 184 bytes");
  expect_refused("more.stl", nameless + "x", "which take 184 bytes, and has 185");
  expect_refused("cut_ascii.stl", ascii.substr(0, ascii.size() / 3), "it is not whole");
  expect_refused("cut_ascii.stl", ascii.substr(0, ascii.find("endsolid")), "there is no endsolid");
  expect_refused("none.obj", "v 0 0 0\nv 1 0 0\n", "cannot be used");
  expect_refused("cut.ply", std::string(ascii_ply).substr(0, std::string(ascii_ply).find("end_header")),
                 "there is no end_header");
  expect_refused("cut.ply", std::string(ascii_ply).substr(0, std::strlen(ascii_ply) - 4),
                 "row 1 of 1 of element face has 3 numbers on its line, which is too few: 5 belong there");
  expect_refused("cut.ply", std::string(ascii_ply).substr(0, std::string(ascii_ply).find("4 0 1 2")),
                 "it is cut off: row 1 of 1 is not there");
  const std::string ply = binary_ply("2");
  expect_refused("cut.ply", ply.substr(0, ply.size() - 1), "it is cut off: row 2 of 2");
  expect_refused("none.ply", binary_ply("0"), "it has no triangles");
  expect_refused("points.xyz", "0 0 0\n", ".stl, .obj or .ply");
}

// 2^31 triangles take 84 bytes modulo 2^32: Assimp 5.2 believes such a file.
TEST(MeshFiles, ThatClaimMoreThanTheyHoldAreRefusedBeforeMemoryIsAskedFor) {
  for (const std::uint32_t claimed : {0x80000000u, 0xFFFFFFFFu, 3u}) {
    std::string text = binary_stl({}, claimed);
    expect_refused("claims.stl", text,
                   claimed == 0x80000000u ? "it claims 2147483648" : "it has no triangles");
    text.replace(0, 5, "model");
    expect_refused("claims.stl", text, "it claims " + std::to_string(claimed) + " triangles");
  }
  for (const char* claimed : {"2147483648", "4294967296", "9223372036854775807", "100"})
    expect_refused("claims.ply", binary_ply(claimed), "it claims " + std::string(claimed) + " rows");
  expect_refused("claims.ply", binary_ply("99999999999999999999"), "it claims");
  expect_refused("claims.ply", binary_ply("-1"), "it claims");
}

TEST(MeshFiles, WithCoordinatesThatAreNotFiniteAreRefused) {
  std::vector<Triangle> triangles = square;
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    triangles[1][2].y = bad;
    expect_refused("bad.stl", binary_stl(triangles), "a corner is at");
  }
  expect_refused("indices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "cannot be used");
  std::string ply = binary_ply("2");
  ply.replace(ply.size() - 4, 4, bytes_of(4));
  expect_refused("indices.ply", ply, "cannot be used");
  EXPECT_TRUE(
      contains(refusal("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "no triangles with an area"));
}

TEST(MeshFiles, WithPolygonsHoldTheirTriangles) {
  const std::string corners = "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nv 1 1 0\n";
  const MeshFile pentagon = read("convex.obj", corners + "f 1 2 3 4 5\n");
  EXPECT_EQ(pentagon.mesh.triangles.size(), 3u);
  EXPECT_EQ(pentagon.open_edges, 5u);
  const MeshFile dented = read("dented.obj", corners + "f 1 2 3 4 5 6\n");
  EXPECT_EQ(dented.mesh.triangles.size(), 4u);
  EXPECT_EQ(dented.open_edges, 6u);
  expect_refused("crossed.obj", corners + "f 1 4 2 5\n", "a face of 4 corners crosses itself");
}

// Texture coordinates and normals that are not there, comments after faces, lines that go on.
TEST(MeshFiles, InObjAreReadByPlacesAlone) {
  const MeshFile square = read("square.obj",
                               "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nusemtl a\n"
                               "f 1/1/1 2/2/1 3/3/1 # f 1/2 2/3\nusemtl b\nf 1//7 \\\n 3/9 4\n");
  EXPECT_EQ(square.mesh.triangles.size(), 2u);
  EXPECT_EQ(square.open_edges, 4u);
}

// Assimp takes only the first numbers of a line, and takes the next line for the next row.
TEST(MeshFiles, InPlyWithRowsOfOtherLengthsAreRefused) {
  const std::string ply = ascii_ply;
  const auto with = [&](const std::string& row, const std::string& other) {
    std::string changed = ply;
    return changed.replace(changed.find(row), row.size(), other);
  };
  expect_refused("many.ply", with("1 0 0\n", "1 0 0 7\n"),
                 "row 2 of 4 of element vertex has 4 numbers on its line, which is too many: 3 belong there");
  expect_refused("many.ply", with("4 0 1 2 3", "4 0 1 2 3 0"),
                 "row 1 of 1 of element face has 6 numbers on its line, which is too many: 5 belong there");
  expect_refused("two.ply", with("0 0 0\n1 0 0", "0 0 0 1 0 0"), "which is too many");
  expect_refused("split.ply", with("0 0 0\n", "0 0\n0\n"), "which is too few");
}

// Their number, and that of objects in OBJ files, would cost a time that grows with its square in Assimp.
TEST(MeshFiles, AreHandedOnWithoutCommentsAndNames) {
  const std::string ply = ascii_ply;
  std::string commented = ply;
  commented.insert(ply.find("element"), "comment a\nobj_info b\ncomment\n");
  EXPECT_EQ(places_and_faces(commented, MeshFormat::ply), ply);
  EXPECT_EQ(places_and_faces("# a\no b\nv 0 0 0\ng c\nusemtl d\ns 1\nf 1 1/2 1\n", MeshFormat::obj),
            "v 0 0 0\nf 1 1 1\n");
  std::string many = ply;
  for (int k = 0; k < 1000; ++k) many.insert(ply.find("element face"), "property float a\n");
  expect_refused("many.ply", many, "its head has more than 1000 lines besides comments");
}

TEST(MeshFiles, AreJoinedInTheirOwnCoordinates) {
  std::vector<Triangle> triangles = square;
  triangles[1][0].z = 1e-7F, triangles[1][1].x = 1.0F + 1.2e-7F;
  const TemporaryFile file("seam.stl", binary_stl(triangles));
  for (const double scale : {1e-3, 1.0, 1e6})
    for (const double shift : {0.0, 3.0, 1e8}) {
      const MeshFile read = read_mesh_file(file.path(), scale, {shift, 0, shift}, {});
      EXPECT_EQ(read.mesh.corners.size(), 4u) << scale << ' ' << shift;
      EXPECT_EQ(read.joined.count, 2u);
      EXPECT_EQ(read.open_edges, 4u);
    }
}

TEST(MeshFiles, ThatAreMissingOrFoldersAreRefusedWhereTheCaseNamesThem) {
  const auto mesh_case = [](const std::string& file) {
    return parse_case(
        "[[specimen]]\nkind = \"list\"\npositions = [[0, 0, 1]]\nmass = 1\nradius = 0.4\n"
        "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.3\n[time]\nstep = 0.1\n"
        "[[stage]]\nduration = 1\n[[wall]]\nname = \"blade\"\nshape = \"mesh\"\nfile = \"" +
            file + "\"\nscale = 0.5\n",
        "case.toml");
  };
  const std::string missing = text_of_error(mesh_case("/no/such/blade.stl"));
  EXPECT_TRUE(contains(missing, "case.toml:17:1: \"/no/such/blade.stl\" cannot be read")) << missing;
  const TemporaryFile file("blade.stl", binary_stl(square));
  const Built b = build(mesh_case(file.path().string()));
  ASSERT_EQ(b.notes.size(), 1u);
  EXPECT_TRUE(contains(b.notes[0], "wall \"blade\": ")) << b.notes[0];
  EXPECT_TRUE(contains(b.notes[0], "2 triangles, 4 corners, 4 open edges")) << b.notes[0];
  EXPECT_EQ(b.model.walls.at(0).centre, (Vec3d{0.25, 0.25, 0}));
}

TEST(BoxMesh, IsClosed) {
  MeshFile box;
  box.mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  clean(box);
  EXPECT_EQ(box.open_edges, 0u);
  EXPECT_EQ(box.mesh.triangles.size(), 12u);
  double volume = 0.0;  // outward normals
  for (const auto& [a, b, c] : box.mesh.triangles)
    volume += dot(box.mesh.corners[a], cross(box.mesh.corners[b], box.mesh.corners[c])) / 6.0;
  EXPECT_NEAR(volume, 6.0, 1e-14);
}

}  // namespace
}  // namespace vbond::test
