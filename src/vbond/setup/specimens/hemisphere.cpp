#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vbond/core/near_pairs.hpp"
#include "vbond/core/random.hpp"
#include "vbond/setup/specimens/specimen.hpp"

namespace vbond {
namespace {

using Pairs = std::vector<std::array<std::size_t, 2>>;

/// Rim, then random places no closer than min_distance to any other. Units: spacing = 1.
std::vector<Vec3d> random_start(const HemisphereSpecimen& s, std::size_t rim, double R_c,
                                const SourcePlace& place) {
  std::vector<Vec3d> r;
  for (std::size_t k = 0; k < rim; ++k) {
    const double phi = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(rim);
    r.push_back({R_c * std::cos(phi), R_c * std::sin(phi), 0.0});
  }
  Random random(s.seed);
  const auto particles = static_cast<std::size_t>(s.particles);
  // at the paper's density one draw in two is refused; 10000 refusals in a row mean there is no room
  for (int refused = 0; r.size() < particles && refused < 10000;) {
    const Vec3d p = R_c * random.on_half_sphere();
    const bool free =
        std::none_of(r.begin(), r.end(), [&](const Vec3d& o) { return norm2(p - o) < sq(s.min_distance); });
    refused = free ? 0 : refused + 1;
    if (free) r.push_back(p);
  }
  if (r.size() < particles)
    throw CaseError(
        {place, fmt::format("only {} of {} particles found a place on the half-sphere", r.size(), particles),
         fmt::format("random places keep a distance of {} spacings", s.min_distance),
         "use fewer particles, a larger radius, or a smaller min_distance"});
  return r;
}

/// The moving particles' translation under the repulsion -f_0 / r^8 r_ij, with a list of near pairs that is
/// rebuilt before any pair outside it can have come within the cut-off.
class Relaxation {
 public:
  Relaxation(const HemisphereSpecimen& s, std::size_t rim, double R_c, std::vector<Vec3d> r)
      : s_(s), rim_(rim), R_c_(R_c), r_(std::move(r)), v_(r_.size()), F_(r_.size()) {}

  /// False if a position is no longer finite.
  bool step(double dt) {
    if (stale()) {
      if (!std::all_of(r_.begin(), r_.end(), is_finite)) return false;
      rebuild();
    }
    repel();
    for (std::size_t i = rim_; i < r_.size(); ++i) {
      // damping is taken at the end of the step: stable however strong it is
      Vec3d v = (v_[i] + dt * F_[i]) / (1.0 + s_.damping * dt);
      Vec3d e = normalised(r_[i]);
      v -= dot(v, e) * e;
      e = normalised(r_[i] + dt * v);
      v -= dot(v, e) * e;
      if (e.z < 0.0) e.z = -e.z, v.z = -v.z;  // particles would leak through the rim
      r_[i] = R_c_ * e;
      v_[i] = v;
    }
    return true;
  }

  const std::vector<Vec3d>& positions() const { return r_; }

 private:
  static constexpr double skin_ = 0.4;  // spacings; a rebuild costs about as much as ten steps

  bool stale() const {
    if (r_listed_.empty()) return true;
    for (std::size_t i = rim_; i < r_.size(); ++i)
      if (!(norm2(r_[i] - r_listed_[i]) <= sq(0.5 * skin_))) return true;  // also if not a number
    return false;
  }

  void rebuild() {
    near_.clear();
    for_near_pairs(r_, s_.cutoff + skin_, [this](std::size_t i, std::size_t j, double) {
      if (j >= rim_) near_.push_back({i, j});  // the rim does not move
    });
    r_listed_ = r_;
  }

  void repel() {
    std::fill(F_.begin(), F_.end(), Vec3d{});
    for (const auto& [i, j] : near_) {
      const Vec3d r_ij = between(r_[i], r_[j]);
      const double d2 = norm2(r_ij);
      if (d2 > sq(s_.cutoff)) continue;
      const Vec3d F = (-s_.strength / sq(sq(d2))) * r_ij;
      F_[i] += F;
      F_[j] -= F;
    }
  }

  const HemisphereSpecimen& s_;
  std::size_t rim_;
  double R_c_;
  std::vector<Vec3d> r_, v_, F_, r_listed_;
  Pairs near_;
};

void check(const HemisphereSpecimen& s, double rim, const SourcePlace& place) {
  const auto require = [&](bool holds, const std::string& what, const std::string& rule,
                           const std::string& way_out) {
    if (!holds) throw CaseError({place, what, rule, way_out});
  };
  require(s.radius > 0.0 && s.spacing > 0.0,
          fmt::format("a half-sphere of radius {} and spacing {}", s.radius, s.spacing),
          "both must be positive", "give radius and spacing in units of length");
  require(rim >= 3.0, fmt::format("a rim of {} particles", rim),
          "the rim has round(2 pi radius / spacing) >= 3", "use a larger radius or a smaller spacing");
  require(static_cast<double>(s.particles) > rim, fmt::format("{} particles", s.particles),
          fmt::format("the rim alone takes {}", rim),
          "use more particles, a smaller radius or a larger spacing");
}

}  // namespace

SpecimenPoints make_points(const HemisphereSpecimen& s, const SourcePlace& place) {
  const double R_c = s.radius / s.spacing;
  const double rim = std::round(2.0 * std::numbers::pi * R_c);
  check(s, rim, place);
  const auto on_rim = static_cast<std::size_t>(rim);
  Relaxation relaxation(s, on_rim, R_c, random_start(s, on_rim, R_c, place));
  const double T_0 = 2.0 * std::numbers::pi;  // the generator's own units: a = m = c_A = 1
  bool finite = true;
  for (std::int64_t k = 0; k < s.steps && finite; ++k) finite = relaxation.step(s.step * T_0);

  SpecimenPoints points;
  for (const Vec3d& r : relaxation.positions()) {
    finite = finite && is_finite(r);
    points.r.push_back(s.spacing * r);
  }
  if (!finite)
    throw CaseError({place, "the relaxation of the half-sphere did not stay finite",
                     fmt::format("its step is {} T0, its strength {}", s.step, s.strength),
                     "use a smaller step or strength, or a larger min_distance"});
  std::int64_t apex = 0;
  for (std::size_t i = 1; i < points.r.size(); ++i)
    if (points.r[i].z > points.r[static_cast<std::size_t>(apex)].z) apex = static_cast<std::int64_t>(i);
  std::vector<std::int64_t> rim_ids;
  for (std::size_t i = 0; i < on_rim; ++i) rim_ids.push_back(static_cast<std::int64_t>(i));
  points.parts = {{"rim", rim_ids}, {"apex", {apex}}};
  return points;
}

}  // namespace vbond
