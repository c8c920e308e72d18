#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "campaigns/dice.hpp"
#include "campaigns/judge.hpp"
#include "slopes.hpp"
#include "vbond/fit/curve.hpp"
#include "vbond/statics/sensitivity.hpp"

/// Slopes of history columns from the tangents of balances, against differences of whole runs.
namespace vbond::slopes_test {
namespace {

using testing::Dice;
using testing::Tally;

// ---- bodies --------------------------------------------------------------------------------------------

/// A theory of bonds some 1 long with the keys that it may be varied by.
struct Theory {
  std::string text;
  std::vector<std::string> keys;
};

Theory some_theory(Dice& dice) {
  const double d = dice(0.3, 0.6), nu = dice(0.1, 0.3);
  const std::string circle = fmt::format("section = {{shape = \"circle\", diameter = {}}}\n", d),
                    material = fmt::format("E = {}\nnu = {}\n", dice(3, 20), nu);
  switch (dice.below(6)) {
    case 0: return {"theory = \"bernoulli-euler\"\n" + material + circle, {"E", "nu", "section.diameter"}};
    case 1:
      return {fmt::format("theory = \"timoshenko\"\nkappa = {}\n", dice(0.7, 0.95)) + material +
                  fmt::format("section = {{shape = \"annulus\", diameter = {}, inner_diameter = {}}}\n", d,
                              0.5 * d),
              {"E", "nu", "kappa", "section.diameter", "section.inner_diameter"}};
    case 2:
      return {"theory = \"short-cylinder\"\n" + material +
                  fmt::format("section = {{shape = \"square\", side = {}}}\n", d),
              {"E", "nu", "section.side"}};
    case 3:
      return {fmt::format("theory = \"parallel\"\nk_n = {}\nk_s = {}\ngrain_k_n = {}\n", dice(3, 20),
                          dice(2, 9), dice(20, 90)) +
                  circle,
              {"k_n", "k_s", "grain_k_n", "section.diameter"}};
    case 4:
      return {fmt::format("theory = \"parallel\"\nattach = \"neck\"\nE = {}\nstiffness_ratio = {}\n",
                          dice(3, 20), dice(1, 3)) +
                  fmt::format("section = {{shape = \"circle\", factor = {}}}\n", dice(0.5, 0.9)),
              {"E", "stiffness_ratio", "section.factor"}};
    default:
      return {
          fmt::format(
              "stiffness = {{c_A = {}, c_D = {}, c_B = {}, c_T = {}}}\nstiffness_factors = {{c_D = {}}}\n",
              dice(0.5, 2), dice(0.1, 0.5), dice(0.02, 0.1), dice(0.02, 0.1), dice(0.8, 1.2)),
          {"stiffness.c_A", "stiffness.c_D", "stiffness.c_B", "stiffness.c_T", "stiffness_factors.c_D"}};
  }
}

std::string vector_text(const Vec3d& v) {
  return fmt::format("[{}, {}, {}]", v.x, v.y, v.z);
}

/// A body clamped at one end, and loaded or moved at the other, in one or two stages; or a periodic one that
/// is strained along one axis and free to shrink along another.
Trial some_trial(Dice& dice, Tally& tally) {
  Trial t;
  const Theory theory = some_theory(dice);
  const int kind = dice.whole(0, 2);
  t.text = "[units]\nsystem = \"reduced\"\n[[specimen]]\nname = \"body\"\nradius = 0.49\nmass = 1.0\n";
  if (kind == 0)
    t.text += fmt::format("kind = \"rod\"\nparticles = {}\nspacing = 1.0\n", dice.whole(4, 9));
  else
    t.text += fmt::format("kind = \"block\"\nlattice = \"{}\"\ncells = [2, 2, 2]\nspacing = 1.0\n",
                          kind == 2 || dice.chance(0.5) ? "fcc" : "simple-cubic");
  if (kind == 2)
    t.text +=
        "[cell]\na = [2.8284271247461903, 0, 0]\nb = [0, 2.8284271247461903, 0]\nc = [0, 0, "
        "2.8284271247461903]\n";
  t.text += "[[bonds]]\nname = \"all\"\ndistance = 1.1\n" + theory.text;
  const bool cubic = dice.chance(0.2), prestrained = dice.chance(0.2), evm = dice.chance(0.3);
  if (evm) t.text += "law = \"evm\"\n";
  if (cubic) t.text += fmt::format("stretching = {{form = \"cubic\", k3 = {}, k4 = 0.5}}\n", dice(0.1, 0.5));
  if (prestrained) t.text += fmt::format("prestrain = {}\n", dice(0.001, 0.01));
  for (const std::string& key : theory.keys)
    if (dice.chance(0.6)) t.keys.push_back("bonds[all]." + key);
  if (t.keys.empty()) t.keys.push_back("bonds[all]." + theory.keys.front());
  if (cubic && dice.chance(0.5)) t.keys.push_back("bonds[0].stretching.k3");
  if (prestrained && dice.chance(0.5)) t.keys.push_back("bonds[0].prestrain");
  constexpr const char* tight = "newton = {tolerance = 1e-13}\n";
  if (kind == 2) {
    tally.add("periodic");
    t.text += fmt::format(
        "[[stage]]\nname = \"strain\"\nkind = \"equilibrium\"\nsteps = 2\n{}[stage.cell]\nzz = {{strain = "
        "{}}}\n"
        "xx = {{stress = {}}}\nxy = {{strain = {}}}\n",
        tight, dice(-0.02, 0.03), dice(-0.01, 0.01), dice(-0.01, 0.02));
    t.columns = {
        "load_factor",    "U_L",           "U_B", "cell_strain_xx", "cell_strain_zz", "cell_stress_zz",
        "cell_stress_yy", "cell_stress_xy"};
    t.text += "[output]\nhistory = {}\n";
    return t;
  }
  const std::string ends = kind == 0
                               ? "[groups]\nfoot = {indices = [0]}\nhead = {group = \"body.last\"}\n"
                               : "[groups]\nfoot = {half_space = {point = [0.1, 0, 0], normal = [1, 0, 0]}}\n"
                                 "head = {half_space = {point = [0.8, 0, 0], normal = [-1, 0, 0]}}\n";
  t.text += kind == 0 ? "[groups]\nfoot = {indices = [0]}\n" : ends;
  const std::string head = kind == 0 ? "last" : "head";
  const int stages = dice.whole(1, 2);
  for (int k = 0; k < stages; ++k) {
    t.text += fmt::format("[[stage]]\nname = \"s{}\"\nkind = \"equilibrium\"\nsteps = {}\n{}", k,
                          dice.whole(1, 3), tight);
    std::string supports = "{group = \"foot\", fix = [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"]}";
    const bool moved = dice.chance(0.4);
    if (moved) {
      tally.add("moved");
      supports += fmt::format(", {{group = \"{}\", fix = [\"x\", \"y\"], displacement = {}}}", head,
                              vector_text({dice(-0.03, 0.05), dice(-0.1, 0.1), 0}));
    }
    t.text += fmt::format("supports = [{}]\n", supports);
    std::vector<std::string> loads;
    if (!moved || dice.chance(0.5))
      loads.push_back(fmt::format("{{group = \"{}\", force = {}, constant = {}}}", head,
                                  vector_text(dice.vector(0.01)), dice.chance(0.3) ? "true" : "false"));
    if (dice.chance(0.3))
      loads.push_back(fmt::format("{{group = \"{}\", moment = {}}}", head, vector_text(dice.vector(0.005))));
    t.text += fmt::format("loads = [{}]\n", fmt::join(loads, ", "));
    if (dice.chance(0.3)) t.text += fmt::format("gravity = {}\n", vector_text(dice.vector(1e-3)));
  }
  if (stages == 2) tally.add("two stages");
  t.text += fmt::format(
      "[output]\nhistory = {{reactions = [\"foot\"], displacements = [\"{0}\"], axial_force = [\"all\"]}}\n",
      head);
  t.columns = {"load_factor",
               "U_L",
               "U_B",
               "U_T",
               "axial_force.all",
               "reaction.foot.fx",
               "reaction.foot.fy",
               "reaction.foot.fz",
               "reaction.foot.mx",
               "reaction.foot.my",
               "reaction.foot.mz"};
  for (const char axis : {'x', 'y', 'z'}) t.columns.push_back(fmt::format("displacement.{}.{}", head, axis));
  return t;
}

/// Columns of one kind, whose sizes are compared together.
std::string kind_of(const std::string& column) {
  if (column.starts_with("U_")) return "energy";
  if (column.starts_with("cell_stress")) return "stress";
  if (column.starts_with("cell_strain")) return "strain";
  if (column.find(".m") != std::string::npos) return "moment";
  return column.substr(0, column.rfind('.'));
}

/// The rows at the load factors that a stage asks for, k/6 of 1: between them a stage chooses its own, which
/// differ from run to run.
std::vector<std::size_t> marks_of(const fit::Rows& rows) {
  std::vector<std::size_t> marks;
  for (std::size_t r = 0; r < rows.stage.size(); ++r)
    if (const double sixths = 6 * rows.columns[0][r]; std::abs(sixths - std::round(sixths)) < 1e-12)
      marks.push_back(r);
  return marks;
}

/// The largest difference of slopes from central ones of sixth order of whole runs, as a part of the largest
/// slope of columns of their kind, or of what such a column is over the value where that is more than ten
/// times larger.
double off_of(const fit::Task& task, const std::vector<std::string>& columns, const fit::Rows& rows,
              std::size_t j, double part) {
  const std::vector<double> at = starts_of(task);
  const double h = part * std::abs(at[j]);
  std::map<int, fit::Rows> beside;
  for (const int k : {-3, -2, -1, 1, 2, 3}) {
    std::vector<double> values = at;
    values[j] += k * h;
    beside.emplace(k, run(task, values, columns, false));
  }
  const std::vector<std::size_t> marks = marks_of(rows);
  std::map<int, std::vector<std::size_t>> marks_beside;
  for (const auto& [k, of] : beside) marks_beside.emplace(k, marks_of(of));
  std::map<std::string, double> size, apart;
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t n = 0; n < marks.size(); ++n) {
      const std::size_t r = marks[n];
      const auto y = [&](int k) { return beside.at(k).columns[c].at(marks_beside.at(k).at(n)); };
      const double difference = derivative_of_sixth_order(h, y), slope = rows.slopes[j].columns[c][r];
      double& s = size[kind_of(columns[c])];
      s = std::max({s, std::abs(difference), 0.1 * std::abs(rows.columns[c][r] / at[j])});
      double& a = apart[kind_of(columns[c])];
      a = std::max(a, std::abs(slope - difference));
    }
  double most = 0;
  for (const auto& [kind, a] : apart)
    if (a > 0) most = std::max(most, a / size[kind]);
  return most;
}

TEST(Slopes, AreThoseOfWholeRunsBeside) {
  unsigned values = 0, numbers = 0;
  const Tally tally = testing::campaign("slopes of random bodies", 30, [&](unsigned seed, Tally& all) {
    Dice dice(seed);
    const Trial t = some_trial(dice, all);
    const fit::Task task = task_of(t);
    const fit::Rows rows = run(task, starts_of(task), t.columns, true);
    for (std::size_t j = 0; j < t.keys.size(); ++j) {
      ASSERT_EQ(rows.slopes[j].why_not, "") << t.keys[j] << "\n" << t.text;
      ASSERT_EQ(rows.slopes[j].columns.size(), t.columns.size());
      // h^6/140 of the seventh derivative where the body is near a critical load, and what balances are off
      // over h where its stress is low: the one wants a short step, the other a long one
      double off = off_of(task, t.columns, rows, j, 2e-3);
      if (off > 1e-6) off = std::min(off, off_of(task, t.columns, rows, j, 5e-4));
      all.below("off", off, 1e-6);
      if (off > 1e-6) ADD_FAILURE() << t.keys[j] << "\n" << t.text;
      ++values, numbers += static_cast<unsigned>(rows.stage.size() * t.columns.size());
    }
  });
  std::printf("%u values, %u numbers\n", values, numbers);
  if (tally.full) {
    EXPECT_GT(tally.sum("periodic"), 5);
    EXPECT_GT(tally.sum("moved"), 5);
    EXPECT_GT(tally.sum("two stages"), 5);
  }
}

// Through both limit points, where the load factor cannot be held: along the curve of force over
// displacement, to what straight lines between rows are off.
TEST(Slopes, OfAPathPassLimitPoints) {
  const Trial t{R"(
[units]
system = "reduced"
[[specimen]]
kind = "list"
positions = [[0, 0, 0], [1, 0.05, 0], [2, 0.1, 0], [3, 0.15, 0], [4, 0.2, 0], [5, 0.15, 0], [6, 0.1, 0],
             [7, 0.05, 0], [8, 0, 0]]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.01, c_B = 1e-3, c_T = 1e-3}
[groups]
feet = {indices = [0, 8]}
crown = {indices = [4]}
[[stage]]
name = "push"
kind = "path"
supports = [{group = "feet", fix = ["x", "y"]}, {group = "all", fix = ["z", "rx", "ry"]},
            {group = "crown", fix = ["x", "rz"]}]
loads = [{group = "crown", force = [0.0, -1e-4, 0.0]}]
largest_step = 0.001
stop = {distance = {groups = ["crown", "feet"], below = 0.0}}
[output]
history = {displacements = ["crown"]}
)",
                {"bonds[0].stiffness.c_A", "bonds[0].stiffness.c_B"},
                {"displacement.crown.y", "load_factor"}};
  Trial trial = t;
  const std::string stop = "stop = {distance = {groups = [\"crown\", \"feet\"], below = 0.0}}\n";
  trial.text.replace(trial.text.find(stop), stop.size(), "most_points = 700\n");
  const fit::Task task = task_of(trial);
  const fit::Rows rows = run(task, starts_of(task), trial.columns, true);
  EXPECT_TRUE(fit::goes_back({rows.columns[1], rows.columns[0]})) << "there is no limit point";
  const auto at_points = [&](const fit::Rows& of) {
    std::vector<double> y;
    for (const double x : {-0.02, -0.05, -0.09, -0.13, -0.2}) {
      const auto at = fit::at({of.columns[0], of.columns[1]}, x);
      y.push_back(at ? at->y : NAN);
    }
    return y;
  };
  for (std::size_t j = 0; j < 2; ++j) {
    ASSERT_EQ(rows.slopes[j].why_not, "");
    std::vector<double> above = starts_of(task), below = above;
    const double h = 1e-3 * above[j];
    above[j] += h, below[j] -= h;
    const std::vector<double> up = at_points(run(task, above, trial.columns, false)),
                              down = at_points(run(task, below, trial.columns, false));
    const double xs[]{-0.02, -0.05, -0.09, -0.13, -0.2};
    double size = 0;
    for (std::size_t k = 0; k < up.size(); ++k) size = std::max(size, std::abs(up[k] - down[k]) / (2 * h));
    ASSERT_GT(size, 0);
    for (std::size_t k = 0; k < up.size(); ++k) {
      const double slope = fit::rate_at({rows.columns[0], rows.columns[1]},
                                        {rows.slopes[j].columns[0], rows.slopes[j].columns[1]}, xs[k]);
      EXPECT_NEAR(slope, (up[k] - down[k]) / (2 * h), 5e-3 * size) << trial.keys[j] << " at " << xs[k];
    }
  }
}

}  // namespace
}  // namespace vbond::slopes_test
