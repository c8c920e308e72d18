#pragma once
#include <cstddef>

#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/model/pair_law.hpp"

namespace vbond {

/// What the loop over touching pairs reads and writes. A pair is worked out from both sides, and each side
/// keeps what the pair remembers: both do the same with the same numbers.
struct PairSweep {
  RowRange rows;  ///< whose loads are added to
  NearRows near;
  const PoseRow* pose;
  const MotionRow* rates;
  const ParticleId* particle;  ///< of each row
  const double *radius, *mass;
  LoadRow *load, *damping;
  PairHistory* history;  ///< of each place in the list; nullptr if pairs remember nothing
  double dt;             ///< by which histories advance; 0: they stay
};

/// The pair of two rows if they touch, i being the one with the lower number as a particle.
struct RowsOfPair {
  std::size_t i, j;
  bool touch;
  TouchingPair pair;
};
inline RowsOfPair rows_of_pair(const PairSweep& s, std::size_t a, std::size_t b) {
  const bool in_order = s.particle[a] < s.particle[b];
  const std::size_t i = in_order ? a : b, j = in_order ? b : a;
  const Vec3d r_ij = s.pose[j].r - s.pose[i].r;
  const double overlap = s.radius[i] + s.radius[j] - norm(r_ij);
  return {i,
          j,
          overlap > 0.0,
          {r_ij, s.radius[i], s.radius[j], overlap, s.mass[i], s.mass[j], s.rates[j].v - s.rates[i].v,
           s.rates[i].omega, s.rates[j].omega}};
}

inline void add_from(const PairLoads& l, bool as_i, LoadRow& row) {
  row.F += as_i ? l.F : -l.F;
  row.M += as_i ? l.M_i : l.M_j;
}

/// The loop over pairs for one law: a type with
///     static constexpr std::string_view name;  static constexpr std::array<std::string_view, n> history;
///     double energy(pair, history) const;            what the pair stores besides its repulsion
///     PairLoads loads(pair, history) const;          the loads of that
///     PairLoads damping(pair, history) const;        loads that never give energy
///     PairStep advance(pair, dt, history) const;     the new history, once per step and before the loads
///     PairSlopes slopes(pair) const;
/// A pair begins to touch with nothing remembered and nothing stored. When it no longer touches it forgets,
/// and what it stored is dissipated.
template <class Law>
double add_pair_loads(const void* object, const PairSweep& s) {
  const Law& law = *static_cast<const Law*>(object);
  double dissipated = 0.0;
  for (std::size_t a = s.rows.first; a < s.rows.last; ++a)
    for (std::size_t k = s.near.start[a]; k < s.near.end[a]; ++k) {
      const RowsOfPair p = rows_of_pair(s, a, s.near.rows[k].value);
      PairHistory history{};
      if (!p.touch) {
        if (s.history == nullptr || s.history[k] == history) continue;
        if (a == p.i) dissipated += law.energy(p.pair, s.history[k]);
        s.history[k] = history;
        continue;
      }
      if (s.history != nullptr) {
        history = s.history[k];
        if (s.dt > 0.0) {
          const PairStep step = law.advance(p.pair, s.dt, history);
          s.history[k] = history = step.history;
          if (a == p.i) dissipated += step.dissipated;
        }
      }
      add_from(law.loads(p.pair, history), a == p.i, s.load[a]);
      const PairLoads damping = law.damping(p.pair, history);
      add_from(damping, a == p.i, s.load[a]);
      add_from(damping, a == p.i, s.damping[a]);
    }
  return dissipated;
}

/// A law of touching pairs, to be pointed to by ContactModel::inelastic; keeps a reference to `law`.
template <class Law>
PairLaw pair_law(const Law& law) {
  static_assert(Law::history.size() <= std::tuple_size_v<PairHistory>);
  const auto of = [](const void* object) -> const Law& { return *static_cast<const Law*>(object); };
  return {.name = Law::name,
          .history = Law::history,
          .law = &law,
          .energy = [](const void* o, const TouchingPair& p,
                       const PairHistory& h) { return decltype(of){}(o).energy(p, h); },
          .loads = [](const void* o, const TouchingPair& p,
                      const PairHistory& h) { return decltype(of){}(o).loads(p, h); },
          .slopes = [](const void* o, const TouchingPair& p) { return decltype(of){}(o).slopes(p); },
          .add_loads = add_pair_loads<Law>};
}
template <class Law>
PairLaw pair_law(const Law&&) = delete;

}  // namespace vbond
