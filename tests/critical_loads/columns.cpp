// Straight rods.
#include <fmt/format.h>

#include <array>

#include "drawing.hpp"

namespace vbond::campaign {
namespace {

enum class Ends : std::uint8_t { pinned, clamped, cantilever, fixed_pinned };
constexpr std::array<const char*, 4> names{"pinned", "clamped", "cantilever", "fixed-pinned"};
enum class Push : std::uint8_t { force, displacement, weight, pull };
constexpr std::array<const char*, 4> pushes{"force", "displacement", "weight", "pull"};

/// Critical force of mode 1 of a straight chain between pins, R = 0: docs/theory.md.
double exact_force(double bonds, double a, const BondStiffness<double>& c) {
  const double S = std::sin(M_PI / (2 * bonds)), C = std::cos(M_PI / (2 * bonds));
  const double B3 = 0.5 * c.c_D * a * a, X = 4 * c.c_B * S * S * B3 / (2 * c.c_B * S * S + B3 * C * C);
  return 0.5 * c.c_A * (a - std::sqrt(a * a - 4 * X / c.c_A));
}

/// What the first particle's support holds, in space.
HeldDofs foot_of(Ends ends) {
  return ends == Ends::pinned ? HeldDofs{true, true, true, true, false, false} : testing::clamped;
}

/// What holds the last one but for its way along x.
HeldDofs head_of(Ends ends) {
  switch (ends) {
    case Ends::clamped: return {false, true, true, true, true, true};
    case Ends::cantilever: return {};
    case Ends::pinned:
    case Ends::fixed_pinned: break;
  }
  return {false, true, true, false, false, false};
}

void push(BodyPlan& plan, Push how, Ends ends, std::size_t N) {
  HeldDofs head = head_of(ends);
  const double sense = how == Push::pull ? 1.0 : -1.0;
  if (how == Push::displacement) head[0] = true;
  if (head != HeldDofs{}) hold(plan, {N}, head, how == Push::displacement ? Vec3d{-1, 0, 0} : Vec3d{});
  if (how == Push::force || how == Push::pull) load(plan, {N}, {sense, 0, 0});
  if (how == Push::weight) plan.gravity = {-1, 0, 0};
}

/// Force at the critical point as the closed form has it; nothing if there is none for this column.
std::optional<double> closed_form_of(const BodyPlan& plan, Push how, Ends ends, std::size_t N,
                                     double before) {
  const BondSet& set = plan.sets[0];
  if (set.law != &bond_law<VModel> || how == Push::weight || how == Push::pull) return {};
  if (ends == Ends::fixed_pinned || (how == Push::displacement && before != 0.0)) return {};
  const double n = static_cast<double>(N) * (ends == Ends::clamped      ? 0.5
                                             : ends == Ends::cantilever ? 2.0
                                                                        : 1.0);
  const double f = exact_force(n, 1.0 / static_cast<double>(N), set.stiffness);
  return how == Push::displacement ? f * static_cast<double>(N) / set.stiffness.c_A : f - before;
}

}  // namespace

BodyPlan column(Dice& dice) {
  BodyPlan plan;
  plan.kind = "column";
  const std::size_t N = dice.chance(0.03) ? dice.log_count(150, 350) : dice.log_count(5, 80);
  const Rod rod = random_rod(dice, 120, 1e7);
  for (std::size_t k = 0; k <= N; ++k)
    plan.r.push_back({static_cast<double>(k) / static_cast<double>(N), 0, 0});
  plan.radius = 0.1 / static_cast<double>(N);
  Ends ends = static_cast<Ends>(dice.whole(0, 3));
  const double p = dice(0.0, 1.0);
  const Push how = p < 0.45   ? Push::force
                   : p < 0.75 ? Push::displacement
                   : p < 0.9  ? Push::weight
                              : Push::pull;
  if (how == Push::displacement && ends == Ends::cantilever) ends = Ends::clamped;
  plan.sets = {chain_of(plan, everybody(plan), rod)};
  plan.sets[0].n_2 = Vec3d{0, 1, 0};
  if (dice.chance(0.4)) keep_in_plane(plan);
  hold(plan, {0}, foot_of(ends));
  plan.must_be_straight =
      ends == Ends::pinned && !plan.in_plane;  // a moment at the foot, which holds one turn
  push(plan, how, ends, N);
  double before = 0.0;
  if (dice.chance(0.15) && how != Push::displacement) {
    before = dice(-3.0, 0.5);
    plan.loads.push_back({{N}, {-before, 0, 0}, {}, true});
  }
  plan.closed_form = closed_form_of(plan, how, ends, N, before);
  if (ends == Ends::cantilever) plan.turning = plan.in_plane ? Turning::about_z : Turning::any;
  plan.what =
      fmt::format("{}, {}, {} bonds, EA L^2/EI = {:.3g}, {}{}{}", names[static_cast<std::size_t>(ends)],
                  pushes[static_cast<std::size_t>(how)], N, rod.EA, words(rod),
                  plan.in_plane ? ", in its plane" : "", before != 0 ? ", constant load" : "");
  return plan;
}

}  // namespace vbond::campaign
