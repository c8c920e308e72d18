#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "campaigns/plain_bodies.hpp"
#include "statics/bodies.hpp"

/// Elastic bodies at rest by plain means: Newton's method with differences of plain loads, a dense matrix,
/// and bisection of the load factor until a bond comes to its strength. For tests.
namespace vbond::testing {

/// What a stage does to such a body in proportion to the load factor. The first particle is clamped.
struct PlainPull {
  Vec3d displacement, force;  ///< of the last particle: one of the two is zero
  double heating = 0;         ///< of all particles
  bool moves() const { return !(displacement == Vec3d{}); }
};

/// Loads on particles, and the most used bond.
struct PlainBalance {
  std::vector<std::array<double, 6>> loads;  ///< forces and moments on each particle
  double largest = 0;                        ///< load of a bond
  std::vector<double> used;
};

/// Those of bonds between particles that stand so.
inline PlainBalance loads_at(const std::vector<PlainBond>& bonds, const std::vector<Vec3d>& r,
                             const std::vector<Quatd>& q) {
  PlainBalance all{std::vector<std::array<double, 6>>(r.size()), 0, {}};
  for (const PlainBond& b : bonds) {
    all.used.push_back(0.0);
    if (b.broken) continue;
    const PlainPose p = pose_of(b, r[b.i], q[b.i], r[b.j], q[b.j]);
    const PlainLoads l = loads_of(b, p);
    all.used.back() = utilisation_of(b, p, l);
    all.largest = std::max({all.largest, norm(l.F), norm(l.M_i), norm(l.M_j)});
    const Vec3d M_i = l.M_i + cross(p.arm_i, l.F), M_j = l.M_j - cross(p.arm_j, l.F);
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      all.loads[b.i][at] += component(l.F, k), all.loads[b.j][at] -= component(l.F, k);
      all.loads[b.i][at + 3] += component(M_i, k), all.loads[b.j][at + 3] += component(M_j, k);
    }
  }
  return all;
}

/// Solves A x = b by elimination, the largest pivot first. False: singular.
inline bool eliminate(std::vector<std::vector<double>> A, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t k = c; k < n; ++k)
      if (std::abs(A[k][c]) > std::abs(A[pivot][c])) pivot = k;
    if (!(std::abs(A[pivot][c]) > 1e-13)) return false;
    std::swap(A[c], A[pivot]), std::swap(b[c], b[pivot]);
    for (std::size_t k = c + 1; k < n; ++k) {
      const double f = A[k][c] / A[c][c];
      if (f == 0.0) continue;
      for (std::size_t m = c; m < n; ++m) A[k][m] -= f * A[c][m];
      b[k] -= f * b[c];
    }
  }
  for (std::size_t c = n; c-- > 0;) {
    for (std::size_t m = c + 1; m < n; ++m) b[c] -= A[c][m] * b[m];
    b[c] /= A[c][c];
  }
  return true;
}

class PlainRest {
 public:
  PlainRest(const Body& body, const PlainPull& pull)
      : bonds(body.bonds),
        r(body.specimen.state.r.values()),
        q(body.specimen.state.q.values()),
        pull_(pull),
        first_(body.specimen.state) {
    hold();
  }
  std::vector<PlainBond> bonds;
  std::vector<Vec3d> r;
  std::vector<Quatd> q;
  double f = 0;  ///< load factor

  struct Stand {
    std::vector<Vec3d> r;
    std::vector<Quatd> q;
    double f;
  };
  Stand here() const { return {r, q, f}; }
  void restore(const Stand& s) {
    r = s.r, q = s.q;
    at(s.f);
  }

  /// The largest part of its strength that a bond has used.
  double most_used() const { return loads_at(bonds, r, q).used[most_used_bond()]; }
  std::size_t most_used_bond() const {
    const std::vector<double> used = loads_at(bonds, r, q).used;
    return static_cast<std::size_t>(std::max_element(used.begin(), used.end()) - used.begin());
  }
  void break_bond(std::size_t k) {
    bonds[k].broken = true;
    hold();
  }

  /// Largest load out of balance, as a part of the largest of a bond.
  double unbalanced() const {
    const PlainBalance b = loads_at(bonds, r, q);
    double most = 0.0;
    for (const double x : free_loads(b)) most = std::max(most, std::abs(x));
    return most / std::max(b.largest, 1e-12);
  }
  /// To balance at this load factor from where it stands. False: not found.
  bool settle(double load_factor) {
    at(load_factor);
    for (int k = 0; k < 60; ++k) {
      const PlainBalance b = loads_at(bonds, r, q);
      std::vector<double> x = free_loads(b);
      double most = 0.0;
      for (const double u : x) most = std::max(most, std::abs(u));
      if (!(most < 1e6)) return false;
      if (most <= 1e-12 * b.largest + 1e-16) return true;
      if (!eliminate(stiffness(), x)) return false;
      double farthest = 0.0;
      for (const double u : x) farthest = std::max(farthest, std::abs(u));
      move(x, std::min(1.0, 0.2 / farthest));
    }
    return unbalanced() < 1e-10;
  }
  /// Whether every small movement meets resistance: elimination of the symmetric part without exchanges.
  bool is_stable() const {
    std::vector<std::vector<double>> K = stiffness();
    const std::size_t n = K.size();
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b) K[a][b] = K[b][a] = 0.5 * (K[a][b] + K[b][a]);
    for (std::size_t c = 0; c < n; ++c) {
      if (!(K[c][c] > 1e-9)) return false;
      for (std::size_t k = c + 1; k < n; ++k)
        for (std::size_t m = n; m-- > c;) K[k][m] -= K[k][c] / K[c][c] * K[c][m];
    }
    return true;
  }

  /// Along the load factor to `to` or to where a bond comes to its strength; `up`: from below it, else from
  /// above. False: no stable balance was found close by, and it stands at the last one.
  bool go_on(double to, bool up) {
    constexpr double longest = 1.0 / 40;
    double step = longest;
    const auto past = [&] { return up ? most_used() >= 1.0 - 1e-9 : most_used() <= 1.0 + 1e-9; };
    while (f != to && !past()) {
      const Stand from = here();
      const double next = std::abs(to - f) <= step ? to : f + (to > f ? step : -step);
      if (!settle(next) || !is_stable() || farthest(from) > 0.2) {
        restore(from);
        step *= 0.5;
        if (step < 1e-6 * longest) return false;
        continue;
      }
      if (past() && !stop_at_strength(from)) return false;
      step = std::min(longest, 2 * step);
    }
    return true;
  }
  /// Whether no way along bonds leads from the first particle to the last any more.
  bool is_parted() const { return parts().back() != 0; }
  /// The largest movement or turn from there.
  double farthest(const Stand& s) const {
    double most = 0.0;
    for (std::size_t p = 0; p < r.size(); ++p)
      most = std::max({most, norm(r[p] - s.r[p]), norm(rotation_vector(q[p] * conjugate(s.q[p])))});
    return most;
  }

 private:
  PlainPull pull_;
  State first_;                                            // at load factor 0
  std::vector<std::pair<std::size_t, std::size_t>> free_;  // particle and degree of freedom

  /// Bisection between a balance and this one, on the side of it where the bond has come to its strength.
  bool stop_at_strength(const Stand& from) {
    double before = from.f, after = f;
    restore(from);
    const bool below = most_used() < 1.0;
    for (int k = 0; k < 60 && std::abs(after - before) > 1e-13; ++k) {
      const double middle = 0.5 * (before + after);
      if (!settle(middle)) return false;
      ((most_used() < 1.0) == below ? before : after) = middle;
    }
    return settle(after);
  }

  void at(double load_factor) {
    f = load_factor;
    const std::size_t last = r.size() - 1;
    if (pull_.moves()) r[last] = first_.r[ParticleId{last}] + f * pull_.displacement;
    warm_up(bonds, first_, std::vector<double>(r.size(), f * pull_.heating));
  }
  /// By the first particle of each.
  std::vector<std::size_t> parts() const {
    std::vector<std::size_t> part(r.size());
    for (std::size_t p = 0; p < r.size(); ++p) part[p] = p;
    for (std::size_t sweep = 0; sweep < r.size(); ++sweep)
      for (const PlainBond& b : bonds)
        if (!b.broken) part[b.i] = part[b.j] = std::min(part[b.i], part[b.j]);
    return part;
  }
  /// The clamp, the support that moves, and parts that nothing holds: all of a particle of each, and the
  /// turns about the support that moves.
  void hold() {
    const std::size_t n = r.size();
    const std::vector<std::size_t> part = parts();
    free_.clear();
    for (std::size_t p = 1; p < n; ++p)
      for (std::size_t dof = 0; dof < 6; ++dof) {
        const bool moved = pull_.moves() && p + 1 == n, loose = part[p] != 0;
        const bool with_moved = pull_.moves() && part[p] == part[n - 1];
        if (moved && (dof < 3 || loose)) continue;
        if (loose && !with_moved && part[p] == p) continue;
        free_.push_back({p, dof});
      }
  }
  std::vector<double> free_loads(const PlainBalance& b) const {
    std::vector<double> x;
    for (const auto& [p, dof] : free_) {
      const bool pulled = !pull_.moves() && p + 1 == r.size() && dof < 3;
      x.push_back(b.loads[p][dof] + (pulled ? f * component(pull_.force, static_cast<int>(dof)) : 0.0));
    }
    return x;
  }
  void move(const std::vector<double>& x, double by) {
    std::vector<Vec3d> turns(r.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto [p, dof] = free_[k];
      Vec3d& to = dof < 3 ? r[p] : turns[p];
      component(to, static_cast<int>(dof % 3)) += by * x[k];
    }
    for (std::size_t p = 0; p < r.size(); ++p) q[p] = normalised(rotation_of(turns[p]) * q[p]);
  }
  /// Minus the derivative of the free loads: central differences, bond by bond.
  std::vector<std::vector<double>> stiffness() const {
    constexpr double h = 1e-6;
    std::vector<std::array<std::size_t, 6>> of(r.size());
    for (auto& o : of) o.fill(free_.size());
    for (std::size_t k = 0; k < free_.size(); ++k) of[free_[k].first][free_[k].second] = k;
    std::vector<std::vector<double>> K(free_.size(), std::vector<double>(free_.size()));
    for (const PlainBond& b : bonds) {
      if (b.broken) continue;
      PlainBond alone = b;
      alone.i = 0, alone.j = 1;
      for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t dof = 0; dof < 6; ++dof) {
          const std::size_t column = of[side == 0 ? b.i : b.j][dof];
          if (column == free_.size()) continue;
          const auto moved = [&](double x) {
            std::vector<Vec3d> r_of{r[b.i], r[b.j]};
            std::vector<Quatd> q_of{q[b.i], q[b.j]};
            Vec3d turn;
            component(dof < 3 ? r_of[side] : turn, static_cast<int>(dof % 3)) += x;
            q_of[side] = normalised(rotation_of(turn) * q_of[side]);
            return loads_at({alone}, r_of, q_of).loads;
          };
          const auto after = moved(h), before = moved(-h);
          for (std::size_t end = 0; end < 2; ++end)
            for (std::size_t k = 0; k < 6; ++k)
              if (const std::size_t row = of[end == 0 ? b.i : b.j][k]; row < free_.size())
                K[row][column] -= (after[end][k] - before[end][k]) / (2 * h);
        }
    }
    return K;
  }
};

}  // namespace vbond::testing
