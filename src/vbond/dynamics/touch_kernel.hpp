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
  double per_m = 0;      ///< [1/mass]
  double per_Theta = 0;  ///< [1/(mass*length^2)]
  double unused = 0;
};

/// What a pair does to its particles, in quadruples for the vector unit.
struct alignas(32) PairLoadRow {
  Vec3d F;         ///< on the first  [force]
  double l_i = 0;  ///< its lever  [length]
  Vec3d T;         ///< n x F  [force]
  double l_j = 0;  ///< lever of the second  [length]
  Vec3d M;         ///< against rolling and twisting, on the first  [force*length]
  double unused = 0;
};

/// Numbers of a TouchHistory, in quadruples.
struct alignas(32) HistoryRow {
  PairHistory x{};
};

/// What particles do that touch.
struct TouchRule {
  TouchForms forms;
  const TouchNumbers<double>* numbers;  ///< of each pair of materials, row by row
  std::uint32_t materials;
  const std::uint32_t* material;  ///< of each row; nullptr: there is one
  const TouchRow* row;
};

/// Near pairs, each once: those of row i, as its first, are pairs start[i], ... up to start[i + 1].
struct TouchTable {
  const std::size_t* start;
  const Row* second;
  HistoryRow* history;
  PairLoadRow* load;
  std::uint8_t* touching;  ///< whether the loads are of now
  double* kept;            ///< overlap that is not felt  [length]; nullptr: none
};

/// What a loop over pairs has found.
struct TouchSums {
  TouchLosses<double> lost;
  TouchLosses<double> parted;  ///< of pairs that have parted: summed by itself, in the order of pairs
  bool deep = false;           ///< two are nearer than deep_part of the sum of their radii
};

/// The loads of all pairs whose first is in these rows, from where their particles stand and how they moved
/// in the half step before. dt = 0: between steps, nothing is remembered of it.
using TouchLoop = TouchSums(const TouchRule&, const TouchTable&, RowRange, const PoseRow*, const MotionRow*,
                            double dt);

/// The touching of two rows as a law sees it.
Touching<double> touching_of(const TouchRow& i, const TouchRow& j, const Vec3d& r_ij, const MotionRow& of_i,
                             const MotionRow& of_j);
/// What is left of an overlap that is not felt: it goes as the particles part.  [length]
inline double still_kept(double kept, double overlap) {
  return overlap > 0.0 ? std::min(kept, overlap) : 0.0;
}
/// A history as numbers, and back.
TouchHistory<double> touch_history(const PairHistory& x);
PairHistory numbers_of(const TouchHistory<double>& h);
/// Whether two that touched before, and whose surfaces are now apart, still hold together.
bool holds_on(const TouchForms& forms, const TouchNumbers<double>& numbers, double R, double overlap);
/// What is lost as two part.
TouchLosses<double> lost_on_parting(const TouchForms& forms, const TouchNumbers<double>& numbers,
                                    const Touching<double>& p, double dt,
                                    const TouchHistory<double>& history);

}  // namespace vbond
