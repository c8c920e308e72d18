#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "vbond/dynamics/rows.hpp"
#include "vbond/model/contact.hpp"

namespace vbond {

/// What contacts ask of a particle.
struct alignas(32) TouchRow {
  double R = 0;          ///< [length]
  double per_m = 0;      ///< of ContactMasses  [1/mass]
  double per_Theta = 0;  ///< [1/(mass*length^2)]
  double unused = 0;
};

// What each pair has is read and written in every step, so that its size is its cost: a cache line, and what
// only rolling needs by itself.

/// What a pair does to its particles, in quadruples for the vector unit.
struct alignas(64) PairLoadRow {
  Vec3d F;         ///< on the first  [force]
  double l_i = 0;  ///< its lever  [length]
  Vec3d T;         ///< n x F  [force]
  double l_j = 0;  ///< lever of the second  [length]
};

/// A TouchHistory but for rolling, likewise.
struct alignas(64) SlipRow {
  Vec3d F_t;
  double a = 0;
  Vec3d F_d;
  double k_r = 0;
  friend bool operator==(const SlipRow&, const SlipRow&) = default;
};

/// Moments against rolling, and against twisting about the normal, on the first.  [force*length]
struct alignas(32) MomentRow {
  Vec3d M_r;
  double M_t = 0;
  friend bool operator==(const MomentRow&, const MomentRow&) = default;
};

/// What particles do that touch.
struct TouchRule {
  TouchForms forms;
  const TouchNumbers<double>* numbers;  ///< of each pair of materials, row by row
  std::uint32_t materials;
  const std::uint32_t* material;  ///< of each row; nullptr: there is one
  const TouchRow* row;
};

/// Near pairs, each once: those of row i, as its first, are pairs start[i], ... up to start[i + 1]. What is
/// needed only until both rows have added the loads of pair k is in slot k - first_pair + first_slot.
struct TouchTable {
  const std::size_t* start;
  const Row* second;
  SlipRow* slip;
  MomentRow* rolling;  ///< as remembered; unused without a form of rolling
  double* kept;        ///< overlap that is not felt  [length]; nullptr: none
  std::size_t first_pair, first_slot;
  // of each slot
  PairLoadRow* load;
  MomentRow* moment;       ///< M_r + M_t n; M_t is not used; nullptr without a form of rolling
  std::uint8_t* touching;  ///< whether the loads are of now
};

/// Slots of the pairs that rows are second of, in order of the first: those of row i are [start[i], start[i +
/// 1]).
struct TouchesAsSecond {
  const std::size_t* start;
  const std::size_t* slot;
};

/// What a loop over pairs has found.
struct TouchSums {
  TouchLosses<double> lost;
  bool deep = false;  ///< two are nearer than deep_part of the sum of their radii
};

/// The loads of all pairs whose first is in these rows, from where their particles stand and how they moved
/// in the half step before. dt = 0: between steps, nothing is remembered of it.
using TouchLoop = TouchSums(const TouchRule&, const TouchTable&, RowRange, const PoseRow*, const MotionRow*,
                            double dt);

/// Adds to these rows the loads of their pairs, in increasing order of the other row.
using AddTouches = void(const TouchTable&, const TouchesAsSecond&, RowRange, LoadRow*);

/// The touching of two rows as a law sees it.
Touching<double> touching_of(const TouchRow& i, const TouchRow& j, const Vec3d& r_ij, const MotionRow& of_i,
                             const MotionRow& of_j);
/// What is left of an overlap that is not felt: it goes as the particles part.  [length]
inline double still_kept(double kept, double overlap) {
  return overlap > 0.0 ? std::min(kept, overlap) : 0.0;
}
/// A history from its rows; and as numbers.
TouchHistory<double> touch_history(const SlipRow& slip, const MomentRow& rolling);
PairHistory numbers_of(const TouchHistory<double>& h);
/// Whether two that touched before, and whose surfaces are now apart, still hold together.
bool holds_on(const TouchForms& forms, const TouchNumbers<double>& numbers, double R, double overlap);
/// What is lost as two part.
TouchLosses<double> lost_on_parting(const TouchForms& forms, const TouchNumbers<double>& numbers,
                                    const Touching<double>& p, double dt,
                                    const TouchHistory<double>& history);

}  // namespace vbond
