#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/time_function.hpp"

namespace vbond {

inline bool at_least_zero(double x) {
  return x >= 0.0 && std::isfinite(x);
}

inline bool above_zero(double x) {
  return x > 0.0 && std::isfinite(x);
}

/// To single precision.
inline bool is_unit(const Vec3d& e) {
  constexpr double tolerance = 1e-6;
  return std::abs(norm(e) - 1.0) <= tolerance;
}

inline std::string text(const Vec3d& x) {
  return fmt::format("({}, {}, {})", x.x, x.y, x.z);
}

/// Gathers mistakes.
class Mistakes {
 public:
  explicit Mistakes(const Model& model) : n_(model.particles()) {}
  std::vector<std::string> take() && { return std::move(list_); }

  void add(std::vector<std::string> mistakes) {
    for (std::string& m : mistakes) list_.push_back(std::move(m));
  }

  void require(bool holds, const std::string& mistake) {
    if (!holds) list_.push_back(mistake);
  }

  /// The first entry of a column for which the rule does not hold; `told(value)` is how it is shown.
  template <class T, class Rule, class Told>
  void require_all(const PerParticle<T>& column, const char* name, const char* rule, Rule holds, Told told) {
    const auto wrong = std::find_if_not(column.begin(), column.end(), holds);
    if (wrong != column.end())
      list_.push_back(fmt::format("{} of particle {} is {}: it must be {}", name, wrong - column.begin(),
                                  told(*wrong), rule));
  }

  void require_sizes(const std::string& whose, const char* rule,
                     std::initializer_list<std::pair<const char*, std::size_t>> columns) {
    for (const auto& [name, size] : columns)
      require(size == n_,
              fmt::format("{} has {} entries in {} for {} particles: {}", whose, size, name, n_, rule));
  }

  bool knows(ParticleId p) const { return p.value < n_; }

  void require_known(const IdList<ParticleId>& particles, const std::string& who,
                     const std::string& group = {}) {
    for (const ParticleId p : particles)
      if (!knows(p))
        return require(false, fmt::format("{} names particle {}{}, and there are {}, counted from 0", who,
                                          p.value, group.empty() ? "" : " (group \"" + group + "\")", n_));
  }

  /// Groups are looked up by bisection.
  void require_increasing(const IdList<ParticleId>& particles, const std::string& who) {
    require(std::adjacent_find(particles.begin(), particles.end(), std::greater_equal<>()) == particles.end(),
            who + " does not name its particles in increasing order, each once");
  }

  void require_finite(const Vec3d& x, const std::string& who, const char* what) {
    require(is_finite(x), fmt::format("{} of {} is {}: it must be finite", what, who, text(x)));
  }

  void require_factor(const TimeFunction& f, const std::string& who) {
    for (const TimeFunction::Point& p : f.points)
      if (!std::isfinite(p.t) || !std::isfinite(p.factor))
        return require(false, fmt::format("the factor of {} has the point ({}, {})", who, p.t, p.factor));
    const auto before = [](const auto& a, const auto& b) { return b.t < a.t; };  // equal times: a jump
    require(std::adjacent_find(f.points.begin(), f.points.end(), before) == f.points.end(),
            "the factor of " + who + " does not have its points in increasing time");
  }

  /// At rest there is no time.
  void refuse_factor(const TimeFunction& f, const std::string& who) {
    require(f.points.empty(), who + " has a factor over time: a stage at rest has none");
  }

 private:
  std::size_t n_;
  std::vector<std::string> list_;
};

}  // namespace vbond
