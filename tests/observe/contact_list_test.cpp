// The contacts of frames against the loads of the run: what all contacts of a particle, and of a wall, do to
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "specimen.hpp"
#include "vbond/case/read.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/observe/contact_list.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/physics/with_flow.hpp"
#include "vbond/setup/build.hpp"
#include "vtp_reader.hpp"

namespace vbond::contact_list_test {
namespace {

/// Spheres of radius 0.5, no two of them nearer than 0.85, in a box of edge 3 around which walls stand.
std::string spheres(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> in_box(0.45, 2.55);
  std::vector<Vec3d> r;
  for (int k = 0; k < 4000; ++k) {
    const Vec3d p{in_box(random), in_box(random), in_box(random)};
    bool apart = true;
    for (const Vec3d& q : r) apart = apart && norm(p - q) > 0.85;
    if (apart) r.push_back(p);
  }
  std::string text = "[[specimen]]\nkind = \"list\"\nradius = 0.5\nmass = 1\npositions = [";
  for (const Vec3d& p : r)
    text += "[" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + "],";
  return text +
         "]\n[[wall]]\nname = \"box\"\nshape = \"box\"\nmin = [0, 0, 0]\nmax = [3, 3, 3]\n"
         "[[wall]]\nname = \"ball\"\nshape = \"sphere\"\nside = \"inside\"\ncentre = [1.5, 1.5, 1.5]\nradius "
         "= 2.2\n"
         "[[velocities]]\nkind = \"gaussian\"\nmagnitude = 0.3\nseed = " +
         std::to_string(seed) +
         "\n[[velocities]]\nkind = \"rigid\"\nangular_velocity = [0.3, 0.2, 0.5]\n"
         "[[stage]]\nduration = 100\n";
}

/// Two layers of fibres that press on one another and slide.
std::string fibres() {
  return "[[specimen]]\nname = \"lower\"\nkind = \"rod\"\nparticles = 6\nradius = 0.2\nmass = 1\n"
         "array = [{count = 3, step = [0, 1.3, 0]}]\n"
         "[[specimen]]\nname = \"upper\"\nkind = \"rod\"\nparticles = 5\nspacing = 0.9\ndirection = [0.3, 1, "
         "0.02]\n"
         "origin = [1.3, -0.6, 0.36]\nradius = 0.2\nmass = 1\narray = [{count = 3, step = [0.95, 0, 0]}]\n"
         "[[bonds]]\nbetween = [\"lower\", \"lower\"]\ndistance = 1.05\ncapsule_radius = \"particles\"\n"
         "stiffness = {c_A = 50, c_D = 20, c_B = 2, c_T = 2}\n"
         "[[bonds]]\nbetween = [\"upper\", \"upper\"]\ndistance = 0.92\ncapsule_radius = \"particles\"\n"
         "stiffness = {c_A = 50, c_D = 20, c_B = 2, c_T = 2}\n"
         "[[velocities]]\ngroup = \"upper\"\nvelocity = [0.3, 0.1, -0.2]\n[[stage]]\nduration = 100\n";
}

/// Runs the case and compares, every few steps. Returns how many contacts there were in all, by kind.
struct Seen {
  int pairs = 0, on_walls = 0, sliding = 0, stretched = 0;
};
Seen compare(const std::string& text, int looks) {
  const Case c = parse_case(text, "case.toml");
  Built b = build(c);
  const Stage stage = build_stage(c, b.model, 0, b.state);
  Simulation run(b.model, stage, b.state);
  Seen seen;
  for (int look = 0; look < looks; ++look) {
    for (int k = 0; k < 25; ++k) run.step();
    const State& s = run.state();
    PerParticle<Vec3d> F(b.model.particles());
    std::vector<Vec3d> on_wall(b.model.walls.size());
    double largest = 1e-3;
    for (const BondId k : s.bonds.ids()) {
      const Vec3d f = bond_loads(s, k).F;
      F[s.bonds[k].i] += f, F[s.bonds[k].j] -= f;
      largest = std::max(largest, norm(f));
    }
    const bool fibre = !s.bonds.empty();
    for (const ListedContact& contact : list_contacts(b.model, s)) {
      largest = std::max(largest, norm(contact.force));
      const Vec3d n = normalised(contact.to - contact.from);
      EXPECT_NEAR(-dot(contact.force, n), contact.normal_force, 1e-12 * largest);
      EXPECT_NEAR(std::hypot(contact.normal_force, contact.friction), norm(contact.force), 1e-12 * largest);
      seen.sliding += contact.friction > 1e-6, seen.stretched += contact.overlap < 0.0;
      const ParticleId i{static_cast<std::size_t>(contact.i)};
      if (contact.wall >= 0) {
        ++seen.on_walls;
        EXPECT_EQ(contact.j, -1);
        F[i] += contact.force, on_wall[static_cast<std::size_t>(contact.wall)] -= contact.force;
        continue;
      }
      ++seen.pairs;
      const ParticleId j{static_cast<std::size_t>(contact.j)};
      if (!fibre) F[i] += contact.force, F[j] -= contact.force;
      if (fibre)  // a force on an axis is shared by both ends: only the sum over a fibre is compared
        F[ParticleId{0}] += contact.i < 18 ? contact.force : -contact.force;
    }
    const Loads loads = run.loads();
    Vec3d lower, expected_lower;
    for (const ParticleId p : F.ids()) {
      if (!fibre) {
        EXPECT_LT(norm(F[p] - loads.F[p]), 1e-11 * largest) << "particle " << p.value;
      }
      if (fibre && p.value < 18) lower += F[p], expected_lower += loads.F[p];
    }
    EXPECT_LT(norm(lower - expected_lower), 1e-11 * largest);
    for (std::size_t w = 0; w < on_wall.size(); ++w)
      EXPECT_LT(norm(on_wall[w] - run.walls()[w].force), 1e-11 * largest) << "wall " << w;
  }
  return seen;
}

const std::vector<std::string> contacts{
    "[contact]\nlaw = \"paper-hertz\"\nc_H = 20\n",
    "[contact]\nlaw = \"linear\"\nk = 20\nrestitution = 0.6\n",
    "[contact]\nlaw = \"linear\"\nk = 20\ntangential = \"linear\"\nk_t = 10\nfriction = 0.3\nrestitution = "
    "0.8\n",
    "[contact]\nlaw = \"hertz\"\nE = 40\nnu = 0.2\ntangential = \"mindlin\"\nfriction = 0.4\nrestitution = "
    "0.7\n"
    "rolling = \"spring\"\nrolling_friction = 0.2\n",
    "[contact]\nlaw = \"hertz\"\nE = 40\nnu = 0.2\nadhesion = \"dmt\"\nwork_of_adhesion = 0.1\n",
    "[contact]\nlaw = \"hertz\"\nE = 40\nnu = 0.2\nadhesion = \"jkr\"\nwork_of_adhesion = 0.3\ntangential = "
    "\"mindlin\"\n"
    "friction = 0.3\nrestitution = 0.9\n"};

TEST(ContactList, HoldsAllForcesOnParticlesAndWalls) {
  Seen seen;
  for (unsigned seed = 1; seed <= 4; ++seed)
    for (const std::string& contact : contacts) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + contact);
      const Seen now = compare(spheres(seed) + contact, 8);
      seen.pairs += now.pairs, seen.on_walls += now.on_walls, seen.sliding += now.sliding;
      seen.stretched += now.stretched;
    }
  EXPECT_GT(seen.pairs, 1000);
  EXPECT_GT(seen.on_walls, 1000);
  EXPECT_GT(seen.sliding, 500);
  EXPECT_GT(seen.stretched, 10) << "adhesion holds no pair beyond touching";
}

TEST(ContactList, HoldsTheForcesBetweenFibres) {
  const Seen seen = compare(fibres() + contacts[3].substr(0, contacts[3].find("rolling")), 12);
  EXPECT_GT(seen.pairs, 50);
  EXPECT_GT(seen.sliding, 20);
}

// Two equal spheres: a = sqrt(R* d), F = 4/3 E* a d, and a slip that is F_t/(8 G* a).
TEST(ContactList, HasRadiusAndSlipByTheirFormulas) {
  const Case c = parse_case(
      "[[specimen]]\nkind = \"list\"\nradius = 1\nmass = 1\npositions = [[0, 0, 0], [1.99, 0, 0]]\n"
      "[contact]\nlaw = \"hertz\"\nE = 100\nnu = 0.25\ntangential = \"mindlin\"\nfriction = 0.5\n"
      "[[stage]]\nduration = 1\n",
      "case.toml");
  Built b = build(c);
  b.state.contact_history = {{ParticleId{0}, ParticleId{1}, {0, 0.01, 0, std::sqrt(0.5 * 0.01)}, 0.0}};
  const std::vector<ListedContact> all = list_contacts(b.model, b.state);
  ASSERT_EQ(all.size(), 1u);
  const double a = std::sqrt(0.5 * 0.01), E = 100 / (2 * (1 - 0.25 * 0.25)), G = 100 / 2.5 / (2 * (2 - 0.25));
  EXPECT_NEAR(all[0].radius, a, 1e-12);
  EXPECT_NEAR(all[0].overlap, 0.01, 1e-12);
  EXPECT_NEAR(all[0].normal_force, 4.0 / 3.0 * E * a * 0.01, 1e-12);
  EXPECT_NEAR(all[0].friction, 0.01, 1e-15);
  EXPECT_NEAR(all[0].slip, 0.01 / (8 * G * a), 1e-12);
  EXPECT_NEAR(all[0].force.x, -all[0].normal_force, 1e-12);
}

TEST(ContactFrames, AreLinesBetweenCentresAndToWalls) {
  const Case c = parse_case(
      "[[specimen]]\nkind = \"list\"\nradius = 1\nmass = 1\npositions = [[0, 0, 0.9], [1.9, 0, 3]]\n"
      "[[specimen]]\nname = \"other\"\nkind = \"list\"\nradius = 1\nmass = 1\npositions = [[0.1, 0, 2.8]]\n"
      "[[wall]]\nshape = \"plane\"\nnormal = [0, 0, 1]\n"
      "[contact]\nlaw = \"linear\"\nk = 10\n[[stage]]\nduration = 1\n",
      "case.toml");
  const Built b = build(c);
  const test::Folder folder;
  write_contacts_vtp(folder / "contacts.vtp", b.model, b.state);
  const test::VtpReader f(test::content_of(folder / "contacts.vtp"));
  EXPECT_EQ(f.arrays.at("i").integers(), (std::vector<std::int64_t>{0, 1, 0}));
  EXPECT_EQ(f.arrays.at("j").integers(), (std::vector<std::int64_t>{2, 2, -1}));
  EXPECT_EQ(f.arrays.at("wall").integers(), (std::vector<std::int64_t>{-1, -1, 0}));
  const auto points = f.arrays.at("Points").as<double>();
  ASSERT_EQ(points.size(), 18u);
  EXPECT_EQ(points[12], 0.0);
  EXPECT_EQ(points[14], 0.9);
  EXPECT_NEAR(points[17], 0.0, 1e-15);
  const auto force = f.arrays.at("normal_force").as<double>();
  EXPECT_NEAR(force[2], 10 * 0.1, 1e-14);
}

TEST(ContactFrames, AreListedAndGoOnWithTheOthers) {
  const test::Folder folder;
  test::Chain chain;  // its particles do not touch: files of no contacts
  const auto frames = [&] {
    const std::string list = test::content_of(folder / "contacts.pvd");
    int n = 0;
    for (std::size_t at = 0; (at = list.find("<DataSet", at)) != std::string::npos; ++at) ++n;
    return n;
  };
  const auto write = [&](FrameWriter& writer, std::int64_t step) {
    chain.at_step(step);
    writer.write(chain.model, chain.state);
  };
  {
    FrameWriter writer(folder.path(), false, {}, {.contacts = true});
    for (const std::int64_t step : {0, 10, 20}) write(writer, step);
  }
  EXPECT_EQ(frames(), 3);
  FrameWriter writer(folder.path(), false, 10, {.contacts = true});
  EXPECT_EQ(frames(), 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/contacts_000000000020.vtp"));
  write(writer, 20);
  EXPECT_EQ(frames(), 3);
  EXPECT_EQ(test::VtpReader(test::content_of(folder / "frames/contacts_000000000020.vtp")).lines, 0u);
}

// A prestrain beyond the limit has flowed as the bond is made: u_p is the elongation less N_y/c_A.
TEST(BondFrame, ShowsWhatHasBecomeOfABondThatFlows) {
  const auto frame_of = [](const std::string& rules) {
    const Built b =
        build(parse_case("[[specimen]]\nkind = \"rod\"\nparticles = 2\nmass = 1\ninertia = 0.1\n[[bonds]]\n"
                         "distance = 1\nstiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}\n" +
                             rules + "[[stage]]\nduration = 1\n",
                         "case.toml"));
    State state = b.state;
    if (!state.bond_history.empty()) {  // and some bending and twist, as if it had flowed
      BondHistory& h = state.bond_history[BondId{0}];
      h[memory::bent] = 0.03, h[memory::bent + 1] = -0.04, h[memory::twisted] = -0.1,
      h[memory::torsion] = 0.5;
    }
    const test::Folder folder;
    write_bonds_vtp(folder / "b.vtp", state, UnitSystem::reduced, {}, {.flow = true});
    return test::VtpReader(test::content_of(folder / "b.vtp"));
  };
  const test::VtpReader flowed = frame_of("prestrain = 0.25\nyield = {axial_force = 0.05}\n");
  const auto value = [&](const char* name) { return flowed.arrays.at(name).as<double>().at(0); };
  EXPECT_NEAR(value("plastic_elongation"), 0.2 - 0.05, 1e-14);  // from 0.8 to 1
  EXPECT_NEAR(value("axial_flow"), 0.15, 1e-14);
  EXPECT_NEAR(value("axial_force"), 0.05, 1e-14);
  EXPECT_EQ(value("creep"), 0.0);
  EXPECT_NEAR(value("length_at_rest"), 0.8, 1e-14);  // as it was made
  EXPECT_NEAR(value("elongation"), 1.0 - (0.8 + value("plastic_elongation")), 1e-14);
  EXPECT_NEAR(value("plastic_bend"), 0.05 * 180 / M_PI, 1e-13);
  EXPECT_NEAR(value("plastic_twist"), -0.1 * 180 / M_PI, 1e-13);
  EXPECT_NEAR(value("torsion_flow"), 0.5 * 180 / M_PI, 1e-13);
  EXPECT_EQ(value("bending_flow"), 0.0);
  EXPECT_EQ(value("shear_flow"), 0.0);
  EXPECT_EQ(value("damage"), 0.0);
  const test::VtpReader elastic = frame_of("");
  EXPECT_EQ(elastic.arrays.at("plastic_elongation").as<double>(), std::vector<double>{0.0});
  test::Chain chain;
  const test::Folder folder;
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced);
  EXPECT_EQ(test::VtpReader(test::content_of(folder / "b.vtp")).arrays.count("damage"), 0u);
}

}  // namespace
}  // namespace vbond::contact_list_test
