#include "cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/mesh_inside.hpp"

namespace vbond::test {
namespace {

/// Particles 0 .. 9 at x = 0 .. 9 and groups of them.
Case with_groups(const std::string& groups, const std::string& more = "") {
  return parse_case("[[specimen]]\nkind = \"rod\"\nparticles = 10\nmass = 1\nradius = 0.4\n" + more +
                        "[[stage]]\nduration = 1\n[time]\nstep = 0.01\n[groups]\n" + groups,
                    "case.toml");
}

using Numbers = std::vector<std::size_t>;

Numbers members(const std::string& groups, const std::string& name, const std::string& more = "") {
  return numbers(build(with_groups(groups, more)).model, name);
}

void expect_refused(const std::string& groups, const std::vector<std::string>& parts) {
  const std::string text = text_of_error(with_groups(groups));
  for (const std::string& part : parts) EXPECT_TRUE(contains(text, part)) << part << " is not in:\n" << text;
}

TEST(Groups, OfACylinderIncludeItsEndsAndItsMantle) {
  EXPECT_EQ(members("g = { cylinder = { from = [2, 0, 0], to = [5, 0, 0], radius = 0.1 } }\n", "g"),
            (Numbers{2, 3, 4, 5}));
  EXPECT_EQ(members("g = { cylinder = { from = [4, 0, 7], to = [4, 0, -1], radius = 2 } }\n", "g"),
            (Numbers{2, 3, 4, 5, 6}));
  expect_refused("g = { cylinder = { from = [0, 0.2, 0], to = [9, 0.2, 0], radius = 0.1 } }\n",
                 {"group \"g\" has no particles"});
}

// The volume that a stress is divided by: given, of the particles as spheres, or of the box around them.
TEST(Groups, TakeUpTheVolumeThatTheCaseSays) {
  Case c = paper_rod();  // ten of radius 0.4, one apart
  const Built b = build(c);
  StressSpec s{{"case.toml", 70, 1}, {"all", {}}, 7.5};
  EXPECT_EQ(resolve_volume(s, b.model), 7.5);
  s.volume = StressVolume::spheres;
  EXPECT_NEAR(resolve_volume(s, b.model), 10 * 4.0 / 3.0 * std::numbers::pi * 0.064, 1e-12);
  s.volume = StressVolume::box;
  EXPECT_NEAR(resolve_volume(s, b.model), 9.8 * 0.8 * 0.8, 1e-12);
  c.specimens[0].radius = 0.0, c.specimens[0].inertia = 0.064;
  c.output.stresses = {s};
  EXPECT_TRUE(contains(text_of_error(c), "the box around its particles has no volume to divide by"));
}

TEST(Groups, OfAHalfSpaceLieWhereItsNormalDoesNotPoint) {
  EXPECT_EQ(members("g = { half_space = { point = [7, 0, 0], normal = [-2, 0, 0] } }\n", "g"),
            (Numbers{7, 8, 9}));
}

TEST(Groups, OfAMaterialFollowTheSpecimens) {
  const std::string more =
      "material = \"glass\"\n[[specimen]]\nname = \"ball\"\nkind = \"list\"\npositions = [[0, 5, 0]]\nmass = "
      "1\n"
      "radius = 0.4\n[[material]]\nname = \"steel\"\nE = 2\nnu = 0.3\n[[material]]\nname = \"glass\"\nE = 1\n"
      "nu = 0.2\n[contact]\nlaw = \"hertz\"\n";
  EXPECT_EQ(members("g = { material = \"steel\" }\n", "g", more), (Numbers{10}));
  EXPECT_EQ(members("g = { material = \"glass\" }\n", "g", more).size(), 10u);
  expect_refused("g = { material = \"glass\" }\n",
                 {"case.toml:11:7: there is no material \"glass\"", "the case has no [[material]]"});
}

TEST(Groups, AreMadeOfOthersThatMayComeLater) {
  const std::string groups =
      "rest = { difference = { of = \"all\", without = [\"both\", \"last\"] } }\n"
      "both = { union = [\"right\", \"left\"] }\n"
      "common = { intersection = [\"left\", \"right\"] }\n"
      "right = { box = { min = [3, -1, -1], max = [6, 1, 1] } }\n"
      "left = { indices = [4, 1, 0] }\n";
  const Model model = build(with_groups(groups)).model;
  EXPECT_EQ(numbers(model, "rest"), (Numbers{2, 7, 8}));
  EXPECT_EQ(numbers(model, "both"), (Numbers{0, 1, 3, 4, 5, 6}));
  EXPECT_EQ(numbers(model, "common"), (Numbers{4}));
}

TEST(Groups, ThatNeedThemselvesAreReportedOnce) {
  const std::string text = text_of_error(
      with_groups("a = { union = [\"ends\", \"b\"] }\nb = { intersection = [\"all\", \"c\"] }\n"
                  "c = { difference = { of = \"all\", without = [\"a\"] } }\nd = { union = [\"a\"] }\n"));
  EXPECT_EQ(text,
            "case.toml:13:45: group \"a\" needs itself: a -> b -> c -> a\n"
            "  union, intersection and difference take groups that can be found before\n"
            "  name another group here");
}

TEST(Groups, InAChainThatIsTooLongAreRefused) {
  std::string chain = "g0 = { union = [\"ends\"] }\n";
  for (int k = 1; k < 2500; ++k)
    chain += "g" + std::to_string(k) + " = { union = [\"g" + std::to_string(k - 1) + "\"] }\n";
  EXPECT_EQ(members(chain, "g2499"), (Numbers{0, 9})) << "each is found before the next asks for it";
  const std::string backwards = "end = { union = [\"g2499\"] }\n" + chain;
  expect_refused(backwards, {"case.toml:1513:20: group \"g1500\" is the end of a chain of 1001 groups",
                             "at most 1000 deep"});
}

TEST(Groups, WithoutParticlesAreRefusedByTheirKind) {
  expect_refused("a = { indices = [0] }\nb = { indices = [1] }\ng = { intersection = [\"a\", \"b\"] }\n",
                 {"case.toml:13:1: group \"g\" has no particles", "change the groups that it is made of"});
  expect_refused("g = { difference = { of = \"ends\", without = [\"all\"] } }\n",
                 {"group \"g\" has no particles"});
  expect_refused("g = { union = [\"eds\"] }\n",
                 {"case.toml:11:16: there is no group \"eds\"", "did you mean \"ends\"?"});
  expect_refused("g = { type = 2 }\n",
                 {"group \"g\": no particle is of type 2", "particles of LAMMPS data files have types"});
}

/// A box of two triangles for each face, some of them turned over.
const char* const cube_obj =
    "v 2 -1 -1\nv 5 -1 -1\nv 5 1 -1\nv 2 1 -1\nv 2 -1 1\nv 5 -1 1\nv 5 1 1\nv 2 1 1\n"
    "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 7 3 4 8\nf 2 3 7 6\n";

TEST(Groups, InsideAMeshAreThoseBetweenItsSurfaces) {
  const TemporaryFile file("cube.obj", std::string(cube_obj) + "f 1 4 8 5\n");
  const std::string mesh =
      "g = { mesh = { file = \"" + file.path().string() + "\", shift = [0.5, 0, 0] } }\n";
  EXPECT_EQ(members(mesh, "g"), (Numbers{3, 4, 5}));
  const TemporaryFile open("open.obj", cube_obj);
  expect_refused(
      "g = { mesh = { file = \"" + open.path().string() + "\" } }\n",
      {"case.toml:11:16: group \"g\": ", "has 4 open edges", "only closed surfaces have an inside"});
}

// Rays along z from these points meet edges and corners of the octahedron as well as faces.
TEST(InsideOfAMesh, DoesNotDependOnRaysThroughEdgesAndCorners) {
  TriangleMesh octahedron;
  octahedron.corners = {{4, 0, 0}, {-4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 4}, {0, 0, -4}};
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u}) octahedron.triangles.push_back({x, y, z});
  const MeshInside inside(octahedron);
  for (int i = -10; i <= 10; ++i)
    for (int j = -10; j <= 10; ++j)
      for (int k = -10; k <= 10; ++k) {
        const int sum = std::abs(i) + std::abs(j) + std::abs(k);
        if (sum == 8) continue;  // on the surface
        const Vec3d r{0.5 * i, 0.5 * j, 0.5 * k};
        ASSERT_EQ(inside(r), sum < 8) << r.x << ' ' << r.y << ' ' << r.z;
      }
}

// A ball of many triangles beside one large one, a tetrahedron: some strips along y hold many, some few.
TEST(InsideOfAMesh, IsFoundAmongSmallAndLargeTriangles) {
  TriangleMesh mesh;
  constexpr std::uint32_t n = 60;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double theta = std::numbers::pi * i / n, phi = 2.0 * std::numbers::pi * j / n;
      const double rho = i == n ? 0.0 : std::sin(theta);  // the pole is one point, and the mesh closed
      mesh.corners.push_back({rho * std::cos(phi), rho * std::sin(phi), std::cos(theta)});
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * n + j, b = i * n + (j + 1) % n;
      mesh.triangles.push_back({a, b, b + n});
      mesh.triangles.push_back({a, b + n, a + n});
    }
  const auto first = static_cast<std::uint32_t>(mesh.corners.size());
  for (const Vec3d& corner : {Vec3d{2, -9, -9}, {2, 9, -9}, {2, 0, 9}, {9, 0, 0}})
    mesh.corners.push_back(corner);
  for (const std::array<std::uint32_t, 3>& t :
       {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  const MeshInside inside(mesh);
  int counted = 0;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k = -5; k <= 5; ++k) {
        const Vec3d r{0.23 * i, 0.23 * j, 0.23 * k};
        // the polyhedron reaches into the unit ball by less than 1 - cos(pi/n)
        if (norm(r) > 0.995 && norm(r) < 1.0) continue;
        ASSERT_EQ(inside(r), norm(r) < 1.0) << r.x << ' ' << r.y << ' ' << r.z;
        ++counted;
      }
  EXPECT_GT(counted, 1300);
  EXPECT_TRUE(inside({2.5, 0, 0}));
  EXPECT_TRUE(inside({2.1, 7, -8}));
  EXPECT_FALSE(inside({8.9, 1, 0}));
  EXPECT_FALSE(inside({1.9, 0, 0}));
}

}  // namespace
}  // namespace vbond::test
