#include "vbond/terms/pressure/detail/rest_pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "vbond/statics/detail/body.hpp"

namespace vbond {
namespace {

auto places(const PerParticle<Vec3d>& r) {
  return [&r](ParticleId p) { return r[p]; };
}

Eigen::Matrix3d cross_matrix(const Vec3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0;
  return m;
}

ParticleId corner(const PressedFacet& f, int b) {
  return b == 0 ? f.i : b == 1 ? f.j : f.k;
}
int corners_of(const PressedFacet& f) {
  return f.facet().is_strip() ? 2 : 3;
}

}  // namespace

bool RestPressure::is_there() const {
  return !body_.stage().pressures.empty();
}

void RestPressure::take_hold() {
  const std::vector<Pressure>& pressures = body_.stage().pressures;
  if (!belong_to(state_.pressed, pressures)) state_.pressed = facets_as_found(pressures, state_.r);
  surfaces_ = PressedSurfaces(pressures, state_.pressed);
}

double RestPressure::at(std::uint32_t pressure, double load_factor) const {
  const Pressure& p = surfaces_.pressure(pressure);
  return (p.constant ? 1.0 : load_factor) * p.pressure;
}

void RestPressure::add_applied(double load_factor, Loads& to) const {
  for (const PressedSurfaces::Share& s : surfaces_.shares())
    to.F[s.p] += at(s.pressure, load_factor) * surfaces_.force(s, places(state_.r));
}

void RestPressure::add_loads(LoadSum& to) const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const PressedSurfaces::Share& s : surfaces_.shares()) {
    const Vec3d F = at(s.pressure, body_.load_factor()) * surfaces_.force(s, places(state_.r));
    to.loads.F[s.p] += F;
    to.largest = larger(to.largest, norm(F));
    // areas are of differences of places, which are rounded
    const double place = eps * norm(state_.r[s.p]);
    to.rounding_of_force = larger(to.rounding_of_force, place * norm(F) / body_.unknowns().length());
    to.rounding_of_potential += place * norm(F);
  }
}

void RestPressure::add_load_rates(LoadSum& to) const {
  for (const PressedSurfaces::Share& s : surfaces_.shares())
    if (!surfaces_.pressure(s.pressure).constant)
      to.loads.F[s.p] += surfaces_.pressure(s.pressure).pressure * surfaces_.force(s, places(state_.r));
}

void RestPressure::add_pairs(std::vector<Assembly::Pair>& pairs) const {
  for (const PressedFacet& f : surfaces_.facets())
    if (surfaces_.pressure(f.pressure).kind == PressureKind::follower)
      for (int b = 0; b < corners_of(f); ++b)
        pairs.push_back({corner(f, b), corner(f, (b + 1) % corners_of(f))});
}

/// Visits what the force on corner a gives way with the place of corner b, -dF_a/dr_b, of followers, facet by
/// facet; a may be b.
template <class Visit>
void RestPressure::for_blocks(const Visit& visit) const {
  for (const PressedFacet& f : surfaces_.facets()) {
    const Pressure& pressure = surfaces_.pressure(f.pressure);
    const double p = at(f.pressure, body_.load_factor());
    if (pressure.kind != PressureKind::follower || p == 0.0) continue;
    for (int b = 0; b < corners_of(f); ++b) {
      const Eigen::Matrix3d K =
          -p * cross_matrix(turn_of_force(f.facet(), pressure.across, b, places(state_.r)));
      for (int a = 0; a < corners_of(f); ++a) visit(corner(f, a), corner(f, b), K);
    }
  }
}

/// A force on a particle that the motion of what is held brings.
void RestPressure::push(ParticleId p, const Vec3d& change, StiffnessSum& to) const {
  body_.unknowns().add_load(p, {change, {}}, to.load_direction);
}

void RestPressure::add_stiffness(StiffnessSum& to) const {
  const auto times = [](const Eigen::Matrix3d& K, const Vec3d& x) {
    const Eigen::Vector3d y = K * Eigen::Vector3d(x.x, x.y, x.z);
    return Vec3d{y[0], y[1], y[2]};
  };
  const auto add_own = [&](ParticleId p, const Eigen::Matrix3d& K) {
    Assembly::Block own = Assembly::Block::Zero();
    own.topLeftCorner<3, 3>() = K;
    own = to.assembly.in_axes(p, p, own);
    to.assembly.add_own(p, 0.5 * (own + own.transpose()));
    if (body_.flows()) to.full.add_own(p, own);
  };
  for_blocks([&](ParticleId a, ParticleId b, const Eigen::Matrix3d& K) {
    if (const Vec3d went = body_.held_rate(b).shift; went != Vec3d{}) push(a, -times(K, went), to);
    if (a == b) return add_own(a, K);
    Assembly::Block pair = Assembly::Block::Zero();
    pair.block<3, 3>(0, 6) = K;
    pair = to.assembly.in_axes(a, b, pair);
    to.assembly.add(a, b, 0.5 * (pair + pair.transpose()));
    if (body_.flows()) to.full.add(a, b, pair);
  });
  for (const PressedSurfaces::Share& s : surfaces_.shares()) {
    const Pressure& pressure = surfaces_.pressure(s.pressure);
    if (pressure.kind != PressureKind::central) continue;
    const Vec3d d = between(pressure.centre, state_.r[s.p]);
    const double distance = norm(d), k = at(s.pressure, body_.load_factor()) * s.towards / distance;
    const Eigen::Vector3d n(d.x / distance, d.y / distance, d.z / distance);
    const Eigen::Matrix3d K = k * (Eigen::Matrix3d::Identity() - n * n.transpose());
    if (const Vec3d went = body_.held_rate(s.p).shift; went != Vec3d{}) push(s.p, -times(K, went), to);
    add_own(s.p, K);
  }
}

double RestPressure::work(const Placement& from, const Placement& to, double load_factor) const {
  const std::vector<double> work = surfaces_.work(places(from.r), places(to.r));
  double sum = 0.0;
  for (std::uint32_t k = 0; k < work.size(); ++k) sum += at(k, load_factor) * work[k];
  return sum;
}

const RestPressure::Skew& RestPressure::skew() const {
  if (std::exchange(skew_.placement, body_.placement_number()) == body_.placement_number()) return skew_;
  skew_.entries.clear();
  const Unknowns& unknowns = body_.unknowns();
  double largest = 0.0;
  const auto add = [&](ParticleId row, ParticleId column,
                       const Eigen::Ref<const Eigen::Matrix<double, 6, 6>>& K) {
    const ParticleId c = unknowns.carrier(row), d = unknowns.carrier(column);
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b) {
        const int of_row = unknowns.of(c, a), of_column = unknowns.of(d, b);
        if (K(a, b) == 0.0 || of_row == Unknowns::held || of_column == Unknowns::held) continue;
        skew_.entries.push_back({of_row, of_column, 0.5 * K(a, b), 0.5 * std::abs(K(a, b))});
        skew_.entries.push_back({of_column, of_row, -0.5 * K(a, b), 0.5 * std::abs(K(a, b))});
      }
  };
  for_blocks([&](ParticleId a, ParticleId b, const Eigen::Matrix3d& K) {
    largest = larger(largest, K.cwiseAbs().maxCoeff());
    Assembly::Block pair = Assembly::Block::Zero();
    pair.block<3, 3>(0, a == b ? 0 : 6) = K;
    pair = body_.in_axes(a, b, pair);
    if (a == b)
      add(a, a, pair.topLeftCorner<6, 6>());
    else
      add(a, b, pair.topRightCorner<6, 6>());
  });
  std::stable_sort(skew_.entries.begin(), skew_.entries.end(), [](const Entry& x, const Entry& y) {
    return std::pair(x.row, x.column) < std::pair(y.row, y.column);
  });
  std::vector<Entry> sums;
  for (const Entry& e : skew_.entries) {
    if (sums.empty() || sums.back().row != e.row || sums.back().column != e.column)
      sums.push_back({e.row, e.column, 0.0, 0.0});
    sums.back().K += e.K, sums.back().size += e.size;
  }
  // of the largest of all: along slanted axes entries may be nothing but what the turn leaves of others
  for (const Entry& e : sums) largest = larger(largest, e.size);
  const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * largest;
  std::erase_if(sums, [&](const Entry& e) { return std::abs(e.K) <= rounding; });
  skew_.entries = std::move(sums);
  skew_.largest = 0.0;
  double row = 0.0;
  for (std::size_t k = 0; k < skew_.entries.size(); ++k) {
    if (k == 0 || skew_.entries[k].row != skew_.entries[k - 1].row) row = 0.0;
    row += std::abs(skew_.entries[k].K);
    skew_.largest = larger(skew_.largest, row);
  }
  return skew_;
}

void RestPressure::for_skew(const SkewEntry& entry) const {
  for (const Entry& e : skew().entries) entry(e.row, e.column, e.K);
}

std::optional<std::string> RestPressure::without_energy() const {
  if (!is_there() || skew().entries.empty()) return std::nullopt;
  return fmt::format("the pressure has no energy: the surface that it follows has a free edge at particle {}",
                     body_.unknowns().place(skew().entries.front().row).particle.value);
}

void PressureTerm::begin_at_rest(const StaticStage& stage, State& state) {
  state.pressed = facets_as_found(stage.pressures, state.r);
  if (!belong_to(state.pressed, stage.pressures))
    throw std::invalid_argument("run_static_stage: a pressure does not say on which facets it acts");
}

std::unique_ptr<RestTerm> PressureTerm::at_rest(const StaticBody& body, State& state) {
  return std::make_unique<RestPressure>(body, state);
}

}  // namespace vbond
