#include "vbond/observe/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/observe/bond_look.hpp"

namespace vbond {
namespace {

std::string name_of(BondId k, ParticleId i, ParticleId j) {
  return fmt::format("bond {} (particles {}, {})", k.value, i.value, j.value);
}
std::string name_of(BondId k, const Bond& b) {
  return name_of(k, b.i, b.j);
}
std::string name_of(const SeenBond& b) {
  return name_of(b.bond, b.i, b.j);
}

bool is_finite(const Energies& e) {
  return std::isfinite(e.total());
}

bool is_finite(const State& s, ParticleId p) {
  const Quatd& q = s.q[p];
  return is_finite(s.r[p]) && is_finite(s.v[p]) && is_finite(s.omega[p]) &&
         std::isfinite(q.w + q.x + q.y + q.z);
}

double energy_of(BondId k, const State& s) {
  const BondEnergy<double> U = bond_energy(s, k);
  return U.U_L + U.U_B + U.U_T;
}

constexpr const char* smaller_step =
    "use a smaller time.step (or time.fraction); history and frames are sound as long as the balance error "
    "was small";

/// Angle between two vectors, sound at every angle.  [degrees]
double angle(const Vec3d& a, const Vec3d& b) {
  return 180.0 / std::numbers::pi * std::atan2(norm(cross(a, b)), dot(a, b));
}

SeenBond seen(BondId k, const BodyPart& body) {
  const State& s = body.state;
  const Bond& b = s.bonds[k];
  const BondPose<double> pose = elastic_pose(s, k);
  const BondShape shape = bond_shape(pose, 0.0, 0.0);
  const Vec3d& D = pose.r_ij;
  return {.bond = body.name(k),
          .i = b.i,
          .j = b.j,
          .a = b.a,
          .length = shape.length,
          .range = bond_range(b, shape),
          .strained_past = b.law->strained_past,
          .tilt_i = angle(D, pose.n_i[0]),
          .tilt_j = angle(-D, pose.n_j[0]),
          .twist = 180.0 / std::numbers::pi * shape.twist};
}

/// The angles that a bond is judged by, for a report.
std::string angles_of(const SeenBond& b) {
  return fmt::format("its ends are tilted by {:.1f} and {:.1f} degrees and twisted by {:.1f}", b.tilt_i,
                     b.tilt_j, b.twist);
}

/// Names the first thing that is not finite.
[[noreturn]] void blame_not_finite(const State& s) {
  const auto unsound = [&s](const std::string& subject, const std::string& finding) {
    return Diverged(s.clock.step, s.clock.time(), subject, finding, smaller_step);
  };
  for (const ParticleId p : s.r.ids())
    if (!is_finite(s, p))
      throw unsound(fmt::format("particle {}", p.value),
                    fmt::format("position ({}, {}, {}), velocity ({}, {}, {}): not finite", s.r[p].x,
                                s.r[p].y, s.r[p].z, s.v[p].x, s.v[p].y, s.v[p].z));
  for (const BondId k : s.bonds.ids())
    if (const double U = energy_of(k, s); !std::isfinite(U))
      throw unsound(name_of(k, s.bonds[k]), fmt::format("energy {}", U));
  throw unsound("all particles", "the energy is not finite although each particle and bond is: it overflows");
}

/// The bond with the largest energy, which is where an instability usually starts.
std::string most_loaded(const State& s) {
  std::string name = "all particles";
  double most = 0.0;
  for (const BondId k : s.bonds.ids()) {
    const double U = energy_of(k, s);
    if (U > most) most = U, name = "most loaded is " + name_of(k, s.bonds[k]);
  }
  return name;
}

}  // namespace

Watch::Watch(double energy_error, Tell tell, WatchRecord record)
    : energy_error_(energy_error), tell_(std::move(tell)), record_(std::move(record)) {}

void Watch::look(const Survey& survey, double balance_error, const CollectState& collect,
                 const std::function<std::string()>& suspect) {
  require_sound(survey, balance_error, collect, suspect);
  if (survey.deformed.empty()) return;
  const State& state = collect();
  for (const BondId k : survey.deformed) look_at_bond(seen(k, state), state.clock, time_of(state.clock));
}

std::string Watch::in_wall(const Model& model, const std::vector<DeepInWall>& deep) {
  const auto part = [&](const DeepInWall& d) { return d.overlap / model.radius[d.p]; };
  const auto worst = std::max_element(
      deep.begin(), deep.end(), [&](const DeepInWall& x, const DeepInWall& y) { return part(x) < part(y); });
  if (worst == deep.end()) return {};
  return fmt::format(
      "particle {} is on its way through wall \"{}\", which it overlaps by {:.3g} of its radius",
      worst->p.value, model.walls[worst->wall].name, part(*worst));
}

std::string Watch::time_of(const Clock& clock) {
  return fmt::format("t = {:.6g}", clock.time());
}

void Watch::require_sound(const Survey& survey, double balance_error, const CollectState& collect,
                          const std::function<std::string()>& suspect) const {
  const bool finite = is_finite(survey.energies), balanced = std::abs(balance_error) <= energy_error_;
  if (finite && balanced) return;
  const State& state = collect();  // the run ends here
  if (!finite) blame_not_finite(state);
  const std::string cause = suspect ? suspect() : "";
  throw Diverged(state.clock.step, state.clock.time(), cause.empty() ? most_loaded(state) : cause,
                 fmt::format("the energy balance is off by {:.3g} of the energy in the run, more than "
                             "watch.energy_error = {:g}",
                             balance_error, energy_error_),
                 cause.empty()
                     ? smaller_step + std::string("; raise watch.energy_error only if the jump is expected")
                     : "use a stiffer contact, lower velocities and loads, or a smaller time.step");
}

std::string Watch::when(const BodyView& body) {
  const BalancePoint* const at_rest = body.balance();
  return at_rest ? fmt::format("load factor {:.6g}", at_rest->load_factor) : time_of(body.clock());
}

void Watch::look(const BodyView& body, const std::function<std::string()>& suspect) {
  const Survey& survey = body.survey();
  require_sound(
      survey, body.balance_error(), [&body]() -> const State& { return body.state(); }, suspect);
  if (survey.any_deformed) {
    const BodyPart part = body.part();
    std::vector<SeenBond> news;
    for (const BondId k : survey.deformed)
      if (const SeenBond b = seen(k, part); is_news(b)) news.push_back(b);
    news = part.all.gather(news);
    std::sort(news.begin(), news.end(), [](const auto& x, const auto& y) { return x.bond < y.bond; });
    for (const SeenBond& b : news) look_at_bond(b, body.clock(), when(body));
  }
  look_at_handover(body);
}

/// Faces of flat joints that part leave spheres that may overlap far more than the faces were pressed. Told
/// once.
void Watch::look_at_handover(const BodyView& body) {
  constexpr double much = 0.05;  // of the energy in the body
  const double gained = -body.books().released;
  if (told_handover_ || !(gained > 0.0)) return;
  const double energy = body.energies().total();
  if (!(gained > much * energy)) return;
  const auto parted = [](const Bond& b) { return b.broken && b.law->crack != nullptr; };
  if (count_bonds(body.part(Show::bonds), parted) == 0) return;
  told_handover_ = true;
  if (tell_)
    tell_(fmt::format(
        "{}: breaking has brought in {:.4g} of energy, where there is {:.4g}: faces of flat joints have "
        "parted, and their spheres, which overlap, now push each other apart",
        time_of(body.clock()), gained, energy));
}

void Watch::look_at_servos(const Simulation& run) {
  constexpr double enough = 0.9;  // of the force: a wall that swings about it is there
  for (const WallDrive& d : run.stage().walls) {
    if (!d.servo || !tell_) continue;
    const WallState& wall = run.walls()[d.index];
    const double wanted = d.servo->factor(static_cast<double>(run.clock().stage_step) * run.clock().dt) *
                          d.servo->force,
                 is = 0.0 - dot(wall.force, d.servo->direction);
    if (!(is < enough * wanted)) continue;
    tell_(fmt::format(
        "{}: wall \"{}\" ends stage \"{}\" without its force: its servo presses with {:.4g}, not "
        "{:.4g}{}; since the start of the run it has gone {:.4g} along its direction",
        time_of(run.clock()), d.wall, run.stage().name, is, wanted,
        wall.force == Vec3d{} ? ", as it touches nothing" : "", dot(wall.displacement, d.servo->direction)));
  }
}

/// Whether look_at_bond() has something to say of it.
bool Watch::is_news(const SeenBond& b) const {
  const BondRecord before = b.bond.value < record_.bonds.size() ? record_.bonds[b.bond] : BondRecord{};
  return b.has_closed_up() || (b.is_stretched() && !record_.stretched.contains(b.bond)) ||
         (b.is_short() && !before.was_short) || b.range > before.worst;
}

void Watch::look_at_bond(const SeenBond& b, const Clock& clock, const std::string& when) {
  const BondId k = b.bond;
  if (b.has_closed_up())
    throw Diverged(clock.step, clock.time(), name_of(b),
                   fmt::format("its bonded points are {:.3g} apart, it has closed up (length at rest {:.6g})",
                               b.length, b.a),
                   "use smaller loads or velocities, a stiffer bond or a contact law; a smaller time.step "
                   "if the energy balance was already off");
  if (b.is_stretched() && record_.stretched.insert(k).second) {
    auto count = static_cast<std::int64_t>(record_.stretched.size()) - 1;
    report(count, untold_stretched_,
           fmt::format("{}: {} is longer than twice its length at rest: {:.4g} of {:.4g}", when, name_of(b),
                       b.length, b.a));
  }
  if (!b.is_short() && b.range == BondRange::good) return;
  if (record_.bonds.size() <= k.value) record_.bonds.resize(k.value + std::size_t{1});
  BondRecord& seen = record_.bonds[k];
  if (b.is_short() && !std::exchange(seen.was_short, true))
    report(record_.shortened, untold_shortened_,
           fmt::format("{}: {} is shorter than half its length at rest: {:.4g} of {:.4g}", when, name_of(b),
                       b.length, b.a));
  if (b.range <= seen.worst) return;
  seen.worst = b.range;
  const bool snapped = b.range == BondRange::snapped;
  report(snapped ? record_.snapped : record_.strained, snapped ? untold_snapped_ : untold_strained_,
         fmt::format("{}: {} {}: {}", when, name_of(b),
                     snapped ? "has snapped, past 90 degrees"
                             : fmt::format("is strained, past {} degrees", b.strained_past),
                     angles_of(b)));
}

void Watch::report(std::int64_t& count, std::int64_t& untold, const std::string& text) {
  if (++count > told_in_full)
    ++untold;
  else if (tell_)
    tell_(text);
}

void Watch::summarise() {
  const auto sum_up = [this](std::int64_t& untold, std::int64_t count, const char* what) {
    if (untold > 0 && tell_) tell_(fmt::format("{} more {}: {} in all so far", untold, what, count));
    untold = 0;
  };
  sum_up(untold_strained_, record_.strained, "bonds were strained");
  sum_up(untold_snapped_, record_.snapped, "bonds have snapped");
  sum_up(untold_shortened_, record_.shortened, "bonds were shorter than half their length at rest");
  sum_up(untold_stretched_, static_cast<std::int64_t>(record_.stretched.size()),
         "bonds were longer than twice their length at rest");
  sum_up(untold_overlapping_, static_cast<std::int64_t>(record_.overlapping.size()),
         "pairs of particles that are not bonded overlapped");
  sum_up(untold_in_walls_, static_cast<std::int64_t>(record_.in_walls.size()), "particles overlapped walls");
}

}  // namespace vbond
