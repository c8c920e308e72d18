#include "vbond/model/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "vbond/model/holds.hpp"

namespace vbond {
namespace {

bool same_times(const Support& a, const Support& b) {
  const auto same = [](const auto& x, const auto& y) { return x.t == y.t && x.factor == y.factor; };
  return std::equal(a.factor.points.begin(), a.factor.points.end(), b.factor.points.begin(),
                    b.factor.points.end(), same);
}

bool same_axis(const Support& a, const Support& b) {
  if (!a.pivot || !b.pivot) return !a.pivot && !b.pivot && a.particles == b.particles;
  constexpr double rounding = 1e-12;
  const Vec3d& w = a.angular_velocity;
  return norm(cross(w, *a.pivot - *b.pivot)) <= rounding * norm(w) * std::max(norm(*a.pivot), norm(*b.pivot));
}

bool moves_alike(const Support& a, const Support& b, std::size_t dof, const Vec3d& axis) {
  if (is_free_grip(a) || is_free_grip(b)) return false;
  const auto turns = [](const Support& s) { return s.rigid && s.angular_velocity != Vec3d{}; };
  if (dof < 3 && (turns(a) || turns(b)))
    return a.rigid && b.rigid && a.velocity == b.velocity && a.angular_velocity == b.angular_velocity &&
           same_times(a, b) && same_axis(a, b);
  const auto rate = [&](const Support& s) { return dot(dof < 3 ? s.velocity : s.angular_velocity, axis); };
  return rate(a) == rate(b) && (rate(a) == 0.0 || same_times(a, b));
}

std::string name_of(std::size_t dof, const HeldAxes* axes) {
  static constexpr const char* names[3] = {"x", "y", "z"};
  const Vec3d& a = axis_of(axes, dof);
  std::string name = fmt::format("({:.4g}, {:.4g}, {:.4g})", a.x, a.y, a.z);
  for (std::size_t k = 0; k < 3; ++k)
    if (a == world_axes[k]) name = names[k];
  return dof < 3 ? name : "the turn about " + name;
}

constexpr std::uint32_t nobody = static_cast<std::uint32_t>(-1);

}  // namespace

std::vector<Disagreement> disagreements(const std::vector<Support>& supports, std::size_t particles) {
  if (supports.empty()) return {};
  const ParticleAxes axes(supports);
  std::vector<std::array<std::uint32_t, 6>> holder(particles,
                                                   {nobody, nobody, nobody, nobody, nobody, nobody});
  std::vector<Disagreement> found;
  for (std::uint32_t k = 0; k < supports.size(); ++k) {
    bool told = false;
    const auto tell = [&](ParticleId p, std::string what, std::uint32_t by, bool oblique) {
      if (!std::exchange(told, true)) found.push_back({p, std::move(what), by, k, oblique});
    };
    for (const ParticleId p : supports[k].particles) {
      if (p.value >= particles) continue;
      const auto of_p = axes.of(p);
      const HeldDofs held = axes.held(supports[k], p);
      std::uint32_t other = k;  // that holds it along other axes
      for (std::size_t dof = 0; dof < 6; ++dof) {
        std::uint32_t& by = holder[p.value][dof];
        if (by != nobody && by != k) other = by;
        if (!held[dof] && !supports[k].rigid) continue;
        if (by == nobody) by = k;
        if (by != k && !moves_alike(supports[by], supports[k], dof, axis_of(of_p.get(), dof)))
          tell(p, name_of(dof, of_p.get()), by, false);
      }
      if (!axes.fits(supports[k], p)) tell(p, "the direction", other, true);
    }
  }
  return found;
}

}  // namespace vbond
