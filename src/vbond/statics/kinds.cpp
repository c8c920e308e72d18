#include "vbond/statics/detail/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/statics/detail/rigid.hpp"

namespace vbond {

std::optional<BondUse> most_used_bond(const State& s, double load_factor) {
  std::vector<std::pair<BondId, double>> uses;
  double largest = -std::numeric_limits<double>::infinity();
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.broken || !can_break(b)) continue;
    const double u = b.law->failure(b, bond_pose(b, s), history_of_bond(s, k)).utilisation;
    uses.emplace_back(k, u);
    largest = larger(largest, u);
  }
  for (const auto& [k, u] : uses)
    if (u >= largest - same_use * std::abs(largest))
      return BondUse{k, s.bonds[k].i, s.bonds[k].j, largest, load_factor};
  return std::nullopt;
}

void refuse_nothing_free(const StaticBody& body) {
  const bool modes = body.stage().kind == StageKind::modes;  // turns that nothing turns are among them
  if (body.unknowns().size() > 0 || (modes && !body.unknowns().free_turns().empty())) return;
  throw NoEquilibrium(body.stage().name, "nothing is free to move",
                      "paths, critical loads and modes are of degrees of freedom that are free: hold fewer");
}

std::string free_motions_in_words(const StaticBody& body) {
  const RigidMotions free =
      free_rigid_motions(body.model(), body.state(), body.unknowns(), body.terms().holds(true));
  if (free.names.empty()) return {};
  std::string text = "parts of the body can move freely: ";
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, free.names.size()); ++k)
    text += (k > 0 ? ", " : "") + free.names[k];
  if (free.names.size() > named) text += fmt::format(" and {} more", free.names.size() - named);
  if (!body.model().walls.empty())
    text += "; walls have no friction here and hold only what they touch, along the normal";
  return text;
}

std::string loose_cell_in_words(const StaticBody& body) {
  std::string text;
  for (int k = 0; k < body.unknowns().size(); ++k)
    if (body.unknowns().is_of_cell(k) && body.tangent().col(k).norm() == 0.0)
      text += (text.empty() ? "; nothing resists " : ", ") + body.unknowns().name(k);
  return text;
}

void refuse_rigid_motions(const StaticBody& body) {
  const std::string text = free_motions_in_words(body);
  if (text.empty()) return;
  throw NoEquilibrium(
      body.stage().name, text,
      "a support may be missing; a motion that no load drives can be held on one particle, such "
      "as the spin of a rod along x by fix = [\"rx\"]; " +
          std::string(body.stage().kind == StageKind::modes
                          ? "modes of a body that is free are about where it stands, without loads and stress"
                          : "kind = \"modes\" takes free bodies that no load acts on"));
}

std::string first_of(const std::vector<std::string>& names) {
  std::string text;
  constexpr std::size_t named = 6;
  for (std::size_t k = 0; k < std::min(named, names.size()); ++k) text += (k > 0 ? ", " : "") + names[k];
  if (names.size() > named) text += fmt::format(" and {} more", names.size() - named);
  return text;
}

namespace {

constexpr const char* floating = "what floats";  // the group of supports that hold it

/// A part that floated at the start, and that others touch now, is held by what should carry nothing.
void refuse_touched(const StaticBody& body) {
  constexpr double nothing = 1e-6;  // of the largest force: balance goes farther
  if (body.is_relieved()) return;   // which these supports have a share of
  for (const Support& s : body.stage().supports)
    if (s.group == floating && body.share_held(s) > nothing)
      throw NoEquilibrium(
          body.stage().name,
          fmt::format("load factor {:.6g}: particle {} is of a part that nothing held, and that others touch "
                      "by now; it was held where it was",
                      body.load_factor(), s.particles.front().value),
          "end the stage before that: another one begins with what touches then, or bring the body to rest "
          "in "
          "a stage of dynamics");
}

}  // namespace

StaticStage with_floating_held(const Model& model, const StaticStage& stage, const State& state,
                               const StaticHooks& hooks) {
  constexpr double nothing = 1e-9;  // of the loads that drive a part: rounding
  StaticStage held = stage;
  const StaticBody body(model, stage, state);
  const RigidMotions free = free_rigid_motions(model, body.state(), body.unknowns());
  if (free.names.empty()) return held;
  for (const double factor : {0.0, 1.0}) {
    const Vector loads = body.applied(factor), along = free.basis.transpose() * loads;
    if (max_norm(along) > nothing * loads.norm())
      throw NoEquilibrium(stage.name, "loads drive parts that nothing holds: " + first_of(free.names),
                          "hold a particle, or let the loads of each part add up to nothing");
  }
  constexpr std::size_t translations = 3;  // of one part that goes on in all directions
  if (free.names.size() > translations)
    tell(stage, hooks,
         fmt::format("parts float, and are held where they are: {}; the cell does not carry them",
                     first_of(free.names)));
  for (const int unknown : holding_unknowns(free.basis)) {
    const auto [particle, dof] = body.unknowns().place(unknown);
    HeldPart part{particle, static_cast<std::uint8_t>(dof), HeldPart::Why::floats};
    if (const HeldAxes* axes = body.unknowns().axes(particle)) part.axes = *axes;
    held.supports.push_back(support_of(part));
  }
  return held;
}

Support support_of(const HeldPart& part) {
  Support hold{part.why == HeldPart::Why::floats ? floating : "", {part.particle}, {}, {}, {}};
  hold.held[part.dof] = true;
  hold.axes = part.axes;
  return hold;
}

StaticStage with_held(const StaticStage& stage, const std::vector<HeldPart>& parts) {
  StaticStage held = stage;
  for (const HeldPart& part : parts)
    if (part.why == HeldPart::Why::floats) held.supports.push_back(support_of(part));
  return held;
}

std::vector<HeldPart> floating_held(const StaticStage& stage) {
  std::vector<HeldPart> parts;
  for (const Support& s : stage.supports) {
    if (s.group != floating) continue;
    const auto dof = std::find(s.held.begin(), s.held.end(), true) - s.held.begin();
    parts.push_back(
        {s.particles.front(), static_cast<std::uint8_t>(dof), HeldPart::Why::floats, false, s.axes});
  }
  return parts;
}

StaticStage without_floating_held(StaticStage stage) {
  std::erase_if(stage.supports, [](const Support& s) { return s.group == floating; });
  return stage;
}

StaticStage stage_from(const Model& model, const StaticStage& stage, const Balanced& balanced) {
  StaticStage from = stage;
  from.grip_turns_at_start = balanced.grip_turns;
  if (stage.cell.any_stress()) {
    State still = balanced.state;
    still.v.assign(still.r.size(), {});
    for (CellEdge& e : still.cell) e = {.along = e.along};
    from.cell_stress_at_start = symmetric_part(cell_stress(model, still));
  }
  return from;
}

void refuse_not_finite(const StaticBody& body) {
  if (body.places_are_finite() && std::isfinite(body.residual()) && std::isfinite(body.energies().total()))
    return;
  throw NoEquilibrium(
      body.stage().name,
      fmt::format("at load factor {:.6g}: {}", body.load_factor(), body.first_not_finite()),
      "particles that are bonded must stand apart, and loads and stiffnesses be far from the largest number");
}

std::shared_ptr<Crew> crew_of(const StaticHooks& hooks) {
  constexpr int most = 8;  // a factor has about so many branches, and slabs become thin
  return std::make_shared<Crew>(static_cast<std::size_t>(std::clamp(hooks.threads, 1, most)));
}

void tell(const StaticStage& stage, const StaticHooks& hooks, const std::string& text) {
  if (hooks.tell) hooks.tell(fmt::format("stage \"{}\": {}", stage.name, text));
}

void tell_of_pressure(const StaticBody& body, const StaticHooks& hooks) {
  if (const auto pressed = body.terms().without_energy())
    tell(body.stage(), hooks,
         fmt::format(
             "load factor {:.6g}: {}; it is solved with the unsymmetric tangent, and flutter is not seen",
             body.load_factor(), *pressed));
}

void refuse_pressure_without_energy(const StaticBody& body) {
  const auto pressed = body.terms().without_energy();
  if (!pressed) return;
  const auto otherwise = [&] {
    switch (body.stage().kind) {
      case StageKind::buckling: return "follow the balance by kind = \"path\"";
      case StageKind::fracture: return "break bonds in a stage of dynamics";
      case StageKind::modes: return "let the body ring in a stage of dynamics";
      default: return "leave branch out";
    }
  };
  throw NoEquilibrium(
      body.stage().name, fmt::format("at load factor {:.6g} {}", body.load_factor(), *pressed),
      fmt::format("critical loads, breaks and natural modes are those of an energy: hold the edge, close the "
                  "surface, use kind = \"dead\" or \"central\", or {}",
                  otherwise()));
}

namespace {

/// A balance beyond the strength of a bond must not pass for one that a real body could have. Modes are those
/// under all loads of their stage.
void watch_strength(const StaticBody& body, const StaticHooks& hooks, StaticResult& result) {
  const double load_factor = body.stage().kind == StageKind::modes ? 1.0 : body.load_factor();
  const std::optional<BondUse> here = most_used_bond(body.state(), load_factor);
  if (!here || (result.most_used && here->utilisation <= result.most_used->utilisation)) return;
  if (here->utilisation >= 1.0 && !(result.most_used && result.most_used->utilisation >= 1.0))
    tell(body.stage(), hooks,
         fmt::format("load factor {:.6g}: bond {} (particles {}, {}) is past its strength, at {:.4g} of it, "
                     "and does not break here; kind = \"fracture\" breaks bonds",
                     here->load_factor, here->bond.value, here->i.value, here->j.value, here->utilisation));
  result.most_used = here;
}

}  // namespace

void note_free_turns(const StaticBody& body, const StaticHooks& hooks, StaticResult& result) {
  const int before = result.free_turns;
  result.free_turns = static_cast<int>(body.unknowns().free_turns().size());
  if (before > 0 || result.free_turns == 0) return;
  tell(body.stage(), hooks,
       fmt::format("nothing turns {}: {} turns meet no stiffness, and stay as they are",
                   body.unknowns().names_of_free_turns(), result.free_turns));
}

void report_point(StaticBody& body, PointKind kind, std::optional<int> unstable, const StaticHooks& hooks,
                  StaticResult& result) {
  refuse_not_finite(body);
  refuse_touched(body);
  if (const auto fault = body.fault_of_terms())
    throw NoEquilibrium(body.stage().name, fmt::format("load factor {:.6g}: {}", body.load_factor(), *fault),
                        "use more steps, a stiffer contact, or a wider wall");
  body.accept();
  ++body.clock().step;
  ++body.clock().stage_step;
  ++result.points;
  result.load_factor = body.load_factor();
  note_free_turns(body, hooks, result);
  if (body.stage().kind != StageKind::fracture) watch_strength(body, hooks, result);
  if (hooks.point) hooks.point(point_at(body, kind, unstable, result));
}

StaticPoint point_at(StaticBody& body, PointKind kind, std::optional<int> unstable,
                     const StaticResult& result) {
  return {body.state(),
          body.load_factor(),
          kind,
          unstable,
          body.energies(),
          [&body](const std::vector<ParticleId>& particles) { return body.reaction(particles); },
          body.grips(),
          result.fracture.books.released,
          body.is_relieved()};
}

StaticOutcome interrupted_outcome(StaticResult result, State state) {
  result.ended = "interrupted";
  state.v.assign(state.r.size(), {});
  state.omega.assign(state.r.size(), {});
  state.spin = {};
  return {std::move(result), std::move(state)};
}

NoEquilibrium current_failure(const StaticStage& stage) {
  constexpr const char* way_out_of_memory =
      "fewer particles help; where it is the factor that does not fit, also newton = {solver = "
      "\"multigrid\"} of "
      "vbond-petsc";
  try {
    throw;
  } catch (const NoEquilibrium& e) {
    return e;
  } catch (const NoConvergence& e) {
    return {stage.name, e.what(),
            "the tangent may be nearly singular, or its modes too close together: a smaller count, "
            "or other supports, help"};
  } catch (const std::length_error& e) {
    return {stage.name, e.what(), way_out_of_memory};
  } catch (const std::bad_alloc&) {
    return {stage.name, "memory ran out", way_out_of_memory};
  }
}

StaticOutcome run_from_constant_loads(const Model& model, const StaticStage& stage, State state,
                                      const StaticHooks& hooks, const RunFromBalance& run) {
  StaticResult result;
  try {
    std::optional<Balanced> balanced = balance_of_constant_loads(model, stage, state, hooks, result);
    if (!balanced) return interrupted_outcome(std::move(result), std::move(state));
    const StaticStage from = stage_from(model, stage, *balanced);
    State end = run(from, std::move(balanced->state), result);
    return {std::move(result), std::move(end)};
  } catch (...) {
    throw StaticStageFailed(current_failure(stage), std::move(result));
  }
}

StaticOutcome run_from_balance(const StaticStage& stage, State balanced, StaticResult found,
                               const RunFromBalance& run) {
  try {
    State end = run(stage, std::move(balanced), found);
    return {std::move(found), std::move(end)};
  } catch (...) {
    throw StaticStageFailed(current_failure(stage), std::move(found));
  }
}

}  // namespace vbond
