#include "shells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "child.hpp"
#include "drawing.hpp"
#include "inertia.hpp"
#include "records.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::campaign {
namespace {

constexpr int longest_shell_run = 300, longest_witness = 900;  // seconds of the processor
constexpr double E = 1000.0, nu = 0.3;                         // of the material; radii are 1
constexpr double half_root_3 = 0.86602540378443865;

/// The axial load per length at which a long cylinder buckles, R = 1.
double classical_load(double h) {
  return E * h * h / std::sqrt(3.0 * (1.0 - nu * nu));
}

std::string fixed(bool clamped) {
  return clamped ? R"(["x","y","z","rx","ry","rz"])" : R"(["x","y","z"])";
}

/// Supports and loads of the end that is not at rest; `edge`: its length, `height` of the shell.
std::string driven_end(Dice& dice, const std::string& group, bool clamped, double edge, double h,
                       double height, bool may_turn, std::string& what) {
  const double force = edge * classical_load(h), way = 2.0 * classical_load(h) / (E * h) * height;
  switch (dice.whole(0, may_turn ? 3 : 2)) {
    case 0:
      what += ", end loaded";
      return fmt::format(
          "  {{group = \"{}\", fix = {}}},\n]\nloads = [{{group = \"{}\", total_force = [0, 0, {:.17g}]}}]\n",
          group, clamped ? R"(["x","y","rx","ry","rz"])" : R"(["x","y"])", group, -force);
    case 1:
      what += ", end moved";
      return fmt::format("  {{group = \"{}\", fix = {}, displacement = [0, 0, {:.17g}]}},\n]\n", group,
                         fixed(clamped), -way);
    case 2:
      what += ", grip moved";
      return fmt::format("  {{group = \"{}\", rigid = true, displacement = [0, 0, {:.17g}]}},\n]\n", group,
                         -way);
    default:
      what += ", grip turned";
      return fmt::format("  {{group = \"{}\", rigid = true, rotation = [0, 0, {:.17g}]}},\n]\n", group,
                         4.0 * way);
  }
}

std::string bonds_and_stage(double h, int count) {
  return fmt::format(
      "thickness = {0:.17g}\ndensity = 1.0\n[[bonds]]\nfrom_specimen = true\ntheory = \"shell\"\nE = {1}\n"
      "nu = {2}\nthickness = {0:.17g}\n[[stage]]\nkind = \"buckling\"\ncount = {3}\nsupports = [\n",
      h, E, nu, count);
}

ShellCase cylinder(Dice& dice, int count, bool panel) {
  ShellCase c;
  c.kind = panel ? "panel" : "cylinder";
  const double particles = dice.ratio(250, 5000), h = dice.ratio(0.005, 0.05);
  const double angle = panel ? dice(0.4, 2.5) : 2 * M_PI, slender = dice.ratio(0.4, 2.5);
  const double across = std::max(8.0, std::round(std::sqrt(particles / slender)));
  const double rows = std::max(6.0, std::round(particles / across));
  const double spacing = angle / (panel ? across - 1.0 : across), length = rows * half_root_3 * spacing;
  const bool clamped = dice.chance(0.5), sides_held = panel && dice.chance(0.5);
  c.text = fmt::format(
      "[[specimen]]\nkind = \"cylinder\"\ncylinder_radius = 1\nparticles_around = {}\n"
      "length = {:.17g}\n",
      across, length);
  if (panel) c.text += fmt::format("angle = {:.17g}\n", angle);
  c.what = fmt::format("{} x {} particles, R/h = {:.4g}, L/R = {:.3g}, {}{}", across, rows + 1, 1 / h, length,
                       clamped ? "clamped" : "hinged", sides_held ? ", sides hinged" : "");
  c.text += bonds_and_stage(h, count) + fmt::format("  {{group = \"first\", fix = {}}},\n", fixed(clamped));
  if (sides_held) c.text += "  {group = \"middle\", fix = [\"x\", \"y\"]},\n";
  c.text += driven_end(dice, "last", clamped, angle, h, length, !panel, c.what);
  if (sides_held)
    c.text += "[groups.middle]\ndifference = {of = \"sides\", without = [\"first\", \"last\"]}\n";
  return c;
}

ShellCase dome(Dice& dice, int count) {
  ShellCase c;
  c.kind = "dome of a shell";
  const double particles = dice.ratio(250, 5000), h = dice.ratio(0.005, 0.05);
  const double top = dice(0.1, 0.5), rim = top + dice(0.3, 0.9);
  // circles stand closer together towards the top, so that triangles stay equilateral
  const double way = std::log(std::tan(0.5 * rim) / std::tan(0.5 * top));
  const double spacing = std::sin(rim) * std::sqrt(2 * M_PI * way / (half_root_3 * particles));
  const bool clamped = dice.chance(0.5);
  c.text = fmt::format(
      "[[specimen]]\nkind = \"sphere\"\nsphere_radius = 1\nspacing = {:.17g}\npolar = [{:.17g}, {:.17g}]\n",
      spacing, top, rim);
  c.what = fmt::format("polar {:.3g} to {:.3g}, spacing {:.3g}, R/h = {:.4g}, rim {}", top, rim, spacing,
                       1 / h, clamped ? "clamped" : "hinged");
  c.text += bonds_and_stage(h, count) + fmt::format("  {{group = \"last\", fix = {}}},\n", fixed(clamped));
  c.text += driven_end(dice, "first", clamped, 2 * M_PI * std::sin(top), h, 1.0, true, c.what);
  return c;
}

struct Staged {
  Built built;
  StaticStage stage;
};

Staged staged(const ShellCase& c) {
  const Case parsed = parse_case(c.text, "shell.toml");
  Staged s{build(parsed), {}};
  s.stage = build_static_stage(parsed, s.built.model, 0, s.built.state);
  return s;
}

Witnessed witness_in_child(const ShellCase& c, const Answer& answer) {
  const ChildResult child = in_child(
      [&] {
        const Staged s = staged(c);
        const Witnessed w = witness_of(s.built.model, s.stage, s.built.state, answer, c.count);
        return nlohmann::json{{"verdict", w.judgement.verdict},
                              {"why", w.judgement.why},
                              {"balances", w.balances},
                              {"to", w.searched_to}}
            .dump();
      },
      longest_witness);
  if (!child.fate.empty()) return {{Verdict::no_reference, "witness: " + child.fate}, 0, 0.0};
  const auto j = nlohmann::json::parse(child.text);
  return {{j.at("verdict").get<Verdict>(), j.at("why")}, j.at("balances"), j.at("to")};
}

Answer ask_in_child(const ShellCase& c, StageKind kind, double first, double last) {
  return answer_in_child(
      [&] {
        Staged s = staged(c);
        s.stage.kind = kind;
        s.stage.frames_per_mode = 0;
        s.stage.path.first_step = 0.3 * first;
        s.stage.path.above = (1 + 1e-3) * last;
        s.stage.path.most_points = 300;
        // beyond a limit point, where buckling looks no farther, a shell snaps through a hundred more
        return answer_of_stage(s.built.model, s.built.state, s.stage, Until::first_limit_point);
      },
      longest_shell_run);
}

/// A load told with a gap is known to within three times that.
bool same_load(const ReferencePoint& a, const ReferencePoint& b) {
  const double off = std::max({1e-6, 3 * a.error, 3 * b.error});
  return a.kind == b.kind && std::abs(a.load_factor / b.load_factor - 1) <= off;
}

bool is_among(const ReferencePoint& p, const std::vector<ReferencePoint>& all) {
  return std::any_of(all.begin(), all.end(), [&p](const ReferencePoint& q) { return same_load(p, q); });
}

/// The special points of a path are the loads that were told, which may vanish together at one point of it.
/// Beyond the last of them nothing is known: the path comes to a limit point, or buckling was not asked more.
/// Where a path is stable again buckling tells of nothing.
Judgement judge_shell_path(const Answer& path, const Answer& buckling) {
  std::size_t known = 0;
  for (std::size_t k = 0; k < path.loads.size(); ++k)
    if (is_among(path.loads[k], buckling.loads)) known = k + 1;
  for (std::size_t k = 0; k < known; ++k)
    if (!path.loads[k].regained && !is_among(path.loads[k], buckling.loads))
      return {Verdict::wrong, fmt::format("{:.10g}, which buckling has not", path.loads[k].load_factor)};
  for (const ReferencePoint& told : buckling.loads) {
    if (is_among(told, path.loads)) continue;
    if (!path.failure.empty())
      return {path.failure == "gave up" ? Verdict::gave_up : Verdict::aborted, path.message};
    if (known < path.loads.size())
      return {Verdict::wrong, fmt::format("{:.10g} where buckling has {:.10g}", path.loads[known].load_factor,
                                          told.load_factor)};
    return {path.searched_to > told.load_factor ? Verdict::missed : Verdict::short_of,
            fmt::format("not told: {:.10g}; ended \"{}\" at {:.6g}", told.load_factor, path.ended,
                        path.searched_to)};
  }
  return {};
}

Judgement judge_shell(const ShellCase& c, const Answer& a, CaseRecord& r) {
  if (a.failure == "aborted") return {Verdict::aborted, a.message};
  const Witnessed w = witness_in_child(c, a);
  r.reference.nodes = w.balances, r.reference.searched_to = w.searched_to, r.reference.ended = "witness";
  if (w.judgement.verdict == Verdict::right) r.reference.points = a.loads;
  if (w.judgement.verdict != Verdict::right) return w.judgement;
  if (!a.failure.empty()) return {Verdict::gave_up, a.message};
  const bool enough = static_cast<int>(a.loads.size()) >= c.count;
  const bool may_end = a.ended == "limit point" || a.ended == "bond range";
  return enough || may_end ? w.judgement : Judgement{Verdict::short_of, "ended \"" + a.ended + "\""};
}

}  // namespace

ShellCase random_shell(unsigned seed, int number) {
  Dice dice(seed * 1000003u + static_cast<unsigned>(number));
  const double kind = dice(0.0, 1.0);
  const int count = dice.whole(1, 4);
  ShellCase c = kind < 0.45   ? cylinder(dice, count, false)
                : kind < 0.75 ? cylinder(dice, count, true)
                              : dome(dice, count);
  if (dice.chance(
          0.5)) {  // as the torsion of bonds depends on n_2 a closed shell is else not quite symmetric
    const std::string bonds = "from_specimen = true\n";
    c.text.insert(c.text.find(bonds) + bonds.size(), "n_2 = [0, 0, 1]\n");
    c.what += ", n_2 along the axis";
  }
  c.number = number, c.count = count;
  c.what += fmt::format(", {} wanted", count);
  return c;
}

CaseRecord run_shell(const ShellCase& c) {
  CaseRecord r;
  r.number = c.number, r.kind = c.kind, r.what = c.what;
  r.buckling = ask_in_child(c, StageKind::buckling, 0.0, 0.0);
  const auto start = std::chrono::steady_clock::now();
  r.of_buckling = judge_shell(c, r.buckling, r);
  r.reference_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (r.buckling.loads.empty()) return r;
  const auto [low, high] = std::minmax_element(
      r.buckling.loads.begin(), r.buckling.loads.end(),
      [](const ReferencePoint& a, const ReferencePoint& b) { return a.load_factor < b.load_factor; });
  r.path = ask_in_child(c, StageKind::path, low->load_factor, high->load_factor);
  r.of_path = judge_shell_path(r.path, r.buckling);
  return r;
}

}  // namespace vbond::campaign
