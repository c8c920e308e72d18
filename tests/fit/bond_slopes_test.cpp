#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "slopes.hpp"
#include "vbond/case/read.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/statics/sensitivity.hpp"

/// How coefficients of bonds change with the keys that make them, against complex steps; and what has no
/// slopes.
namespace vbond::slopes_test {
namespace {

using Complex = std::complex<double>;

/// Written out once more, from docs/theory.md, for numbers that carry a step.
struct Formulas {
  struct Section {
    Complex A, J, J_p;
  };
  static Complex pow4(Complex x) { return x * x * x * x; }
  static Section circle(Complex d) {
    return {M_PI * d * d / 4.0, M_PI * pow4(d) / 64.0, M_PI * pow4(d) / 32.0};
  }
  static std::array<Complex, 4> rod(Complex E, Complex nu, const Section& s, Complex shear_over_bending,
                                    double a) {
    return {E * s.A / a, shear_over_bending * E * s.J / (a * a * a), E * s.J / a,
            E / (2.0 * (1.0 + nu)) * s.J_p / a};
  }
  /// B1 to B4 of the V-model.
  static std::array<Complex, 4> v_model(const std::array<Complex, 4>& c, double a) {
    const Complex B3 = 0.5 * c[1] * a * a;
    return {c[0], c[2] - 0.5 * B3, B3, c[3]};
  }
};

/// A bond of two particles of radius 0.49, 1 apart: its text, its values by key, and its coefficients by
/// them.
struct Offered {
  std::string text;
  std::map<std::string, double> values;
  std::function<std::array<Complex, 4>(std::map<std::string, Complex>)> coefficients;
};

std::vector<Offered> all_offered() {
  using F = Formulas;
  using V = std::map<std::string, Complex>;
  const std::string circle = "section = {shape = \"circle\", diameter = 0.3}\n",
                    material = "E = 7.0\nnu = 0.23\n";
  std::vector<Offered> all;
  all.push_back(
      {"theory = \"bernoulli-euler\"\n" + material + circle,
       {{"E", 7}, {"nu", 0.23}, {"section.diameter", 0.3}},
       [](V v) { return F::v_model(F::rod(v["E"], v["nu"], F::circle(v["section.diameter"]), 12, 1), 1); }});
  all.push_back({"theory = \"bernoulli-euler\"\n" + material +
                     "section = {shape = \"annulus\", diameter = 0.3, inner_diameter = 0.1}\n",
                 {{"section.diameter", 0.3}, {"section.inner_diameter", 0.1}},
                 [](V v) {
                   const auto o = F::circle(v["section.diameter"]),
                              i = F::circle(v["section.inner_diameter"]);
                   return F::v_model(F::rod(7, 0.23, {o.A - i.A, o.J - i.J, o.J_p - i.J_p}, 12, 1), 1);
                 }});
  all.push_back({"theory = \"bernoulli-euler\"\n" + material + "section = {shape = \"square\", side = 0.3}\n",
                 {{"section.side", 0.3}},
                 [](V v) {
                   const Complex h = v["section.side"];
                   return F::v_model(
                       F::rod(7, 0.23, {h * h, F::pow4(h) / 12.0, 0.140577014955157 * F::pow4(h)}, 12, 1), 1);
                 }});
  all.push_back(
      {"theory = \"bernoulli-euler\"\n" + material +
           "section = {shape = \"given\", A = 0.08, J = 5e-4, J_p = 9e-4}\n",
       {{"section.A", 0.08}, {"section.J", 5e-4}, {"section.J_p", 9e-4}},
       [](V v) {
         return F::v_model(F::rod(7, 0.23, {v["section.A"], v["section.J"], v["section.J_p"]}, 12, 1), 1);
       }});
  const auto timoshenko = [](Complex E, Complex nu, const F::Section& s, Complex kappa) {
    const Complex kA = kappa * s.A;
    return F::v_model(F::rod(E, nu, s, 12.0 * kA / (kA + 24.0 * s.J * (1.0 + nu)), 1), 1);
  };
  all.push_back(
      {"theory = \"timoshenko\"\nkappa = 0.87\n" + material + circle,
       {{"E", 7}, {"nu", 0.23}, {"kappa", 0.87}, {"section.diameter", 0.3}},
       [=](V v) { return timoshenko(v["E"], v["nu"], F::circle(v["section.diameter"]), v["kappa"]); }});
  all.push_back({"theory = \"timoshenko\"\n" + material + circle, {{"nu", 0.23}}, [=](V v) {  // of Hutchinson
                   const Complex nu = v["nu"];
                   return timoshenko(7, nu, F::circle(0.3),
                                     6.0 * (1.0 + nu) * (1.0 + nu) / (7.0 + 12.0 * nu + 4.0 * nu * nu));
                 }});
  all.push_back({"theory = \"short-cylinder\"\nE = 7.0\nnu = 0.45\n" + circle,
                 {{"E", 7}, {"nu", 0.45}, {"section.diameter", 0.3}},
                 [](V v) {
                   const Complex nu = v["nu"], M = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) * v["E"],
                                 G = v["E"] / (2.0 * (1.0 + nu));
                   const auto s = F::circle(v["section.diameter"]);
                   return F::v_model({M * s.A, G * s.A, M * s.J, G * s.J_p}, 1);
                 }});
  all.push_back({"theory = \"shell\"\n" + material + "thickness = 0.2\n",
                 {{"E", 7}, {"nu", 0.23}, {"thickness", 0.2}},
                 [](V v) {
                   const Complex nu = v["nu"], h = v["thickness"],
                                 c_A = v["E"] * h / (std::sqrt(3.0) * (1.0 - nu)), c_B = c_A * h * h / 12.0,
                                 across = (1.0 - 3.0 * nu) / (1.0 + nu);
                   return F::v_model({c_A, across * c_A, c_B, across * c_B}, 1);
                 }});
  all.push_back({"theory = \"parallel\"\nk_n = 8.0\nk_s = 3.0\ngrain_k_n = 40.0\ngrain_k_s = 20.0\n" + circle,
                 {{"k_n", 8}, {"k_s", 3}, {"grain_k_n", 40}, {"grain_k_s", 20}, {"section.diameter", 0.3}},
                 [](V v) {
                   const Complex k_n = 1.0 / (1.0 / v["k_n"] + 2.0 / v["grain_k_n"]),
                                 k_s = 1.0 / (1.0 / v["k_s"] + 2.0 / v["grain_k_s"]);
                   const auto s = F::circle(v["section.diameter"]);
                   return F::v_model({s.A * k_n, s.A * k_s, s.J * k_n, s.J_p * k_s}, 1);
                 }});
  all.push_back(
      {"theory = \"parallel\"\nE = 8.0\nstiffness_ratio = 2.5\nsection = {shape = \"circle\", factor = "
       "0.8}\n",
       {{"E", 8}, {"stiffness_ratio", 2.5}, {"section.factor", 0.8}},
       [](V v) {
         const Complex k_n = v["E"] / 0.98, k_s = k_n / v["stiffness_ratio"];
         const auto s = F::circle(2.0 * 0.49 * v["section.factor"]);
         return F::v_model({s.A * k_n, s.A * k_s, s.J * k_n, s.J_p * k_s}, 1);
       }});
  all.push_back(
      {"stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.05, c_T = 0.04}\nstiffness_factors = {c_A = 1.1, c_D = "
       "0.9, c_B = 1.2, c_T = 0.8}\n",
       {{"stiffness.c_A", 1},
        {"stiffness.c_D", 0.3},
        {"stiffness.c_B", 0.05},
        {"stiffness.c_T", 0.04},
        {"stiffness_factors.c_A", 1.1},
        {"stiffness_factors.c_D", 0.9},
        {"stiffness_factors.c_B", 1.2},
        {"stiffness_factors.c_T", 0.8}},
       [](V v) {
         std::array<Complex, 4> c;
         const char* names[]{"c_A", "c_D", "c_B", "c_T"};
         for (std::size_t k = 0; k < 4; ++k)
           c[k] = v[std::string("stiffness.") + names[k]] * v[std::string("stiffness_factors.") + names[k]];
         return F::v_model(c, 1);
       }});
  all.push_back({"coefficients = {B1 = 1.0, B2 = -0.02, B3 = 0.2, B4 = 0.05}\n",
                 {{"coefficients.B1", 1},
                  {"coefficients.B2", -0.02},
                  {"coefficients.B3", 0.2},
                  {"coefficients.B4", 0.05}},
                 [](V v) {
                   return std::array<Complex, 4>{v["coefficients.B1"], v["coefficients.B2"],
                                                 v["coefficients.B3"], v["coefficients.B4"]};
                 }});
  return all;
}

TEST(Slopes, OfCoefficientsAreThoseOfComplexSteps) {
  int keys = 0;
  double largest = 0;
  for (const Offered& offered : all_offered()) {
    Trial t{
        "[units]\nsystem = \"reduced\"\n[[specimen]]\nkind = \"rod\"\nparticles = 2\nspacing = 1.0\nradius = "
        "0.49\nmass = 1.0\n"
        "[[bonds]]\ndistance = 1.1\n" +
            offered.text +
            "[[stage]]\nkind = \"equilibrium\"\nsupports = [{group = \"first\", fix = [\"x\", \"y\", \"z\", "
            "\"rx\", \"ry\", \"rz\"]}]\n"
            "[output]\nhistory = {}\n",
        {},
        {}};
    for (const auto& [key, value] : offered.values) t.keys.push_back("bonds[0]." + key);
    const fit::Task task = task_of(t);
    const std::vector<fit::Nudge> nudges = nudges_of(task, starts_of(task));
    std::size_t j = 0;
    for (const auto& [key, value] : offered.values) {
      const fit::Nudge& nudge = nudges[j++];
      const auto coefficients = [&](int k) {
        const Case c = parse_case(t.text, "t.toml", nudge.changes[static_cast<std::size_t>(k + 3)]);
        const BondSite i{ParticleId{0}, {}, {}, 0.49, 1, 1}, other{ParticleId{1}, {1, 0, 0}, {}, 0.49, 1, 1};
        const auto bond = make_bond(c.bonds[0].recipe, i, other);
        return Eigen::Vector4d(bond->coefficients[0], bond->coefficients[1], bond->coefficients[2],
                               bond->coefficients[3]);
      };
      const Eigen::Vector4d slope = derivative_of_sixth_order(nudge.step, coefficients);
      std::map<std::string, Complex> at(offered.values.begin(), offered.values.end());
      constexpr double tiny = 1e-30;
      at[key] += Complex(0, tiny);
      const auto exact = offered.coefficients(at);
      double size = 0;
      for (const Complex& c : exact) size = std::max(size, std::abs(c.imag() / tiny));
      for (std::size_t k = 0; k < 4; ++k) {
        const auto index = static_cast<Eigen::Index>(k);
        EXPECT_NEAR(coefficients(0)[index], exact[k].real(), 1e-13 * std::abs(exact[0].real())) << key;
        const double off = std::abs(slope[index] - exact[k].imag() / tiny) / size;
        EXPECT_LT(off, 1e-10) << key << " of\n" << offered.text;
        largest = std::max(largest, off);
      }
      ++keys;
    }
  }
  std::printf("%d keys, largest difference %.1e\n", keys, largest);
}

// ---- what is not followed, and fits ----------------------------------------------------------------------

std::string cantilever(const std::string& bonds, const std::string& stage, const std::string& support = "",
                       const std::string& load = "force = [0, 1e-4, 0]") {
  return "[units]\nsystem = \"reduced\"\n[[specimen]]\nkind = \"rod\"\nparticles = 5\nspacing = 1.0\nradius "
         "= 0.45\nmass = 1.0\n"
         "[[bonds]]\nname = \"b\"\n" +
         bonds + "[[stage]]\nname = \"s\"\n" + stage +
         "supports = [{group = \"first\", fix = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]}" + support +
         "]\nloads = [{group = \"last\", " + load +
         "}]\n[output]\nhistory = {displacements = "
         "[\"last\"]}\n";
}

TEST(Slopes, SayWhyTheyAreNotThere) {
  const std::string stiff = "stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.05, c_T = 0.04}\n",
                    near = "distance = 1.1\n", still = "kind = \"equilibrium\"\n";
  const auto why = [](const std::string& text, const std::string& key) {
    const fit::Task task = task_of({text, {key}, {}});
    return run(task, starts_of(task), {"load_factor", "displacement.last.y"}, true).slopes[0].why_not;
  };
  EXPECT_EQ(why(cantilever(near + stiff, still), "bonds[b].stiffness.c_A"), "");
  EXPECT_EQ(why(cantilever(near + stiff, still), "specimen[0].mass"), "it is no key of bonds");
  EXPECT_EQ(why(cantilever(near + stiff, still), "bonds[b].distance"), "it changes no bond that is there");
  EXPECT_EQ(why(cantilever(near + stiff + "yield = {axial_force = 1.0}\n", still), "bonds[b].stiffness.c_A"),
            "stage \"s\": its bonds remember their past");
  const fit::Task moving =
      task_of({cantilever(near + stiff, "duration = 1.0\n"), {"bonds[b].stiffness.c_A"}, {}});
  EXPECT_EQ(run(moving, starts_of(moving), {"time", "displacement.last.y"}, true).slopes[0].why_not,
            "stage \"s\" is one of motion");
  // a value beside which there is none
  EXPECT_EQ(why(cantilever(near + "theory = \"bernoulli-euler\"\nE = 9.0\nnu = 0.5\nsection = {shape = "
                                  "\"circle\", diameter = 0.3}\n",
                           still),
                "bonds[b].nu"),
            "the case refuses values next to it");
}

const std::string stiff_bonds =
    "distance = 1.1\nstiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.05, c_T = 0.04}\n";

std::string why_no_slope(const std::string& text, const std::vector<std::string>& columns) {
  const fit::Task task = task_of({text, {"bonds[b].stiffness.c_A"}, {}});
  return run(task, starts_of(task), columns, true).slopes[0].why_not;
}

// Slopes of forces on walls came out as 0.
TEST(Slopes, HaveNoNumbersOfWalls) {
  const std::string wall =
      "[contact]\nlaw = \"linear\"\nk = 0.05\n[[wall]]\nname = \"w\"\nshape = \"plane\"\npoint = [0, "
      "0.5, 0]\nnormal = [0, -1, 0]\n";
  const std::string text = wall + cantilever(stiff_bonds, "kind = \"equilibrium\"\n");
  EXPECT_EQ(why_no_slope(text, {"load_factor", "displacement.last.y"}), "");
  const std::string why = "wall.w.Fy is a number of a wall, which balances do not give";
  EXPECT_EQ(why_no_slope(text, {"load_factor", "wall.w.Fy"}), why);
  EXPECT_EQ(why_no_slope(text, {"wall.w.Fy", "displacement.last.y"}), why);
}

// Turns about two axes do not commute: where they lead depends on the way.
TEST(Slopes, HaveNoSupportsThatHoldOneTurn) {
  const std::string still = "kind = \"equilibrium\"\n",
                    load = "force = [0, 1e-3, 1e-3], moment = [1e-3, 0, 1e-3]",
                    part =
                        "stage \"s\": a support holds or turns a part of a rotation, so that balances "
                        "depend on the way to them";
  const std::vector<std::string> columns{"load_factor", "displacement.last.y"};
  const auto held = [&](const std::string& support) {
    return why_no_slope(cantilever(stiff_bonds, still, ", {group = \"last\", " + support + "}", load),
                        columns);
  };
  for (const char* one : {"rx", "ry", "rz"}) EXPECT_EQ(held(fmt::format("fix = [\"{}\"]", one)), part);
  EXPECT_EQ(held("fix = [\"rx\", \"ry\"]"), "");
  EXPECT_EQ(held("fix = [\"rx\", \"ry\"], rotation = [0.1, 0, 0]"), part);
  EXPECT_EQ(held("fix = [\"rx\", \"ry\", \"rz\"], rotation = [0.1, 0, 0]"), "");
}

// A stage that lets a particle turn about one axis carries what it holds of earlier turns with it. In a plane
// it holds none.
TEST(Slopes, HaveNoTurnsThatASupportHoldsAndTurns) {
  const auto why = [](const std::string& load) {
    const std::string clamp = "{group = \"first\", fix = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]}",
                      first = fmt::format(
                          "kind = \"equilibrium\"\nsupports = [{}]\nloads = [{{group = \"last\", {}}}]\n"
                          "[[stage]]\nname = \"t\"\nkind = \"equilibrium\"\n",
                          clamp, load);
    return why_no_slope(cantilever(stiff_bonds, first, ", {group = \"last\", fix = [\"rx\", \"ry\"]}",
                                   "moment = [0, 0, 1e-3]"),
                        {"load_factor", "displacement.last.y"});
  };
  EXPECT_EQ(why("force = [0, 1e-3, 0]"), "");
  EXPECT_EQ(
      why("force = [0, 1e-3, 1e-3]"),
      "stage \"t\", load factor 0: a support holds a part of a rotation that an earlier stage has changed");
}

/// A ball at the side of a post, whose bond is under stress, and above a trough. Forces that fade hold both,
/// until the ball is let go without them and comes to lie in the trough.
std::string ball_beside_a_post(const std::string& tolerance) {
  const auto wall = [](const std::string& name, const std::string& normal) {
    return "[[wall]]\nname = \"" + name + "\"\nshape = \"plane\"\npoint = [2, 0, 0]\nnormal = " + normal +
           "\n";
  };
  return "[units]\nsystem = \"reduced\"\n[[specimen]]\nkind = \"list\"\nradius = 0.5\nmass = 1.0\n"
         "positions = [[0, 0, 2], [0, 0, 3], [0.28961, 0, 3.93623]]\n"
         "[[bonds]]\nname = \"b\"\ndistance = 1.01\nbetween = [\"post\", \"post\"]\nprestrain = 0.003\n"
         "stiffness = {c_A = 2.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}\n"
         "[contact]\nlaw = \"linear\"\nk = 1.0\n" +
         wall("left", "[0.2, 0, 1]") + wall("right", "[-0.2, 0, 1]") +
         "[groups]\npost = {indices = [0, 1]}\nfoot = {indices = [0]}\nball = {indices = [2]}\n"
         "[[stage]]\nname = \"s\"\nkind = \"equilibrium\"\nsteps = 5\nnewton = {tolerance = " +
         tolerance +
         "}\ngravity = [0, 0, -1e-3]\nconstant_gravity = true\n"
         "supports = [{group = \"foot\", fix = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]}, "
         "{group = \"ball\", fix = [\"y\"]}]\n[output]\nhistory = {displacements = [\"ball\"]}\n";
}

// Then they are no part of the balance, and the post bears its upper particle alone: U_L = W^2/(2 c_A). Such
// points were refused, as if the balance depended on the way to it, or had slopes with what had faded.
TEST(Slopes, GoOnWhereForcesThatFadeHaveBeenDropped) {
  const double W = 1e-3, c_A = 2.0;
  for (const char* tolerance : {"1e-13", "1e-9"}) {
    SCOPED_TRACE(tolerance);
    const fit::Task task = task_of({ball_beside_a_post(tolerance), {"bonds[b].stiffness.c_A"}, {}});
    const fit::Rows rows = run(task, starts_of(task), {"load_factor", "displacement.ball.z", "U_L"}, true);
    ASSERT_EQ(rows.slopes[0].why_not, "");
    int dropped = 0;
    for (std::size_t r = 0; r < rows.stage.size(); ++r) {
      if (rows.columns[1][r] > -2.0 || rows.columns[0][r] == 1.0) continue;
      ++dropped;
      EXPECT_NEAR(rows.slopes[0].columns[1][r], 0.0, 1e-9) << rows.columns[0][r];
      // 1e-5: the balance is off by 1e-9 of 6e-3, the force of the prestrain, in N = 1e-3
      EXPECT_NEAR(rows.slopes[0].columns[2][r] / (-W * W / (2 * c_A * c_A)), 1.0, 1e-5) << rows.columns[0][r];
    }
    EXPECT_GE(dropped, 3);
  }
}

}  // namespace
}  // namespace vbond::slopes_test
