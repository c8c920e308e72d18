#include "vbond/model/agreement.hpp"

#include <algorithm>
#include <array>

namespace vbond {
namespace {

const Vec3d& translation(const Support& s) {
  return s.velocity;
}
const Vec3d& translation(const StaticSupport& s) {
  return s.displacement;
}
const Vec3d& rotation(const Support& s) {
  return s.angular_velocity;
}
const Vec3d& rotation(const StaticSupport& s) {
  return s.rotation;
}

bool same_times(const Support& a, const Support& b) {
  const auto same = [](const auto& x, const auto& y) { return x.t == y.t && x.factor == y.factor; };
  return std::equal(a.factor.points.begin(), a.factor.points.end(), b.factor.points.begin(),
                    b.factor.points.end(), same);
}
bool same_times(const StaticSupport&, const StaticSupport&) {
  return true;
}

template <class AnySupport>
bool same_axis(const AnySupport& a, const AnySupport& b) {
  if (!a.pivot || !b.pivot) return !a.pivot && !b.pivot && a.particles == b.particles;
  constexpr double rounding = 1e-12;
  const Vec3d& w = rotation(a);
  return norm(cross(w, *a.pivot - *b.pivot)) <= rounding * norm(w) * std::max(norm(*a.pivot), norm(*b.pivot));
}

template <class AnySupport>
bool moves_alike(const AnySupport& a, const AnySupport& b, std::size_t dof) {
  const auto turns = [](const AnySupport& s) { return s.rigid && rotation(s) != Vec3d{}; };
  if (dof < 3 && (turns(a) || turns(b)))
    return a.rigid && b.rigid && translation(a) == translation(b) && rotation(a) == rotation(b) &&
           same_times(a, b) && same_axis(a, b);
  const auto rate = [dof](const AnySupport& s) {
    return component(dof < 3 ? translation(s) : rotation(s), static_cast<int>(dof % 3));
  };
  return rate(a) == rate(b) && (rate(a) == 0.0 || same_times(a, b));
}

template <class AnySupport>
std::vector<Disagreement> disagreements_of(const std::vector<AnySupport>& supports, std::size_t particles) {
  constexpr std::size_t nobody = static_cast<std::size_t>(-1);
  std::vector<std::array<std::size_t, 6>> holder(particles, {nobody, nobody, nobody, nobody, nobody, nobody});
  std::vector<Disagreement> found;
  for (std::size_t k = 0; k < supports.size(); ++k) {
    bool told = false;
    for (const ParticleId p : supports[k].particles)
      for (std::size_t dof = 0; dof < 6 && p.value < particles; ++dof) {
        if (!supports[k].held[dof]) continue;
        std::size_t& by = holder[p.value][dof];
        if (by == nobody) by = k;
        if (told || by == k || moves_alike(supports[by], supports[k], dof)) continue;
        told = true;
        found.push_back({p, dof, by, k});
      }
  }
  return found;
}

}  // namespace

std::vector<Disagreement> disagreements(const std::vector<Support>& supports, std::size_t particles) {
  return disagreements_of(supports, particles);
}
std::vector<Disagreement> disagreements(const std::vector<StaticSupport>& supports, std::size_t particles) {
  return disagreements_of(supports, particles);
}

const char* name_of_dof(std::size_t dof) {
  static constexpr const char* names[6] = {
      "x", "y", "z", "the turn about x", "the turn about y", "the turn about z"};
  return names[dof];
}

}  // namespace vbond
