#pragma once
#include <array>
#include <cstddef>

#include "vbond/model/state.hpp"
#include "vbond/statics/detail/bond_lanes.hpp"

namespace vbond {

/// Bonds that wait until there are enough of one law to be worked out together.
class WaitingBonds {
 public:
  std::size_t number() const { return number_; }
  BondId bond(std::size_t l) const { return bonds_[l]; }
  void empty() { number_ = 0; }
  void add(const State& s, BondId k) {
    const Bond& b = s.bonds[k];
    const std::size_t l = number_++;
    bonds_[l] = k;
    lanes_.a[l] = b.a, lanes_.R_i[l] = b.R_i, lanes_.R_j[l] = b.R_j;
    for (std::size_t c = 0; c < 4; ++c) lanes_.coefficients[c][l] = b.coefficients[c];
    put(b.frame_i, lanes_.frame_i, l), put(frame_j(b), lanes_.frame_j, l);
    put(s.q[b.i], lanes_.q_i, l), put(s.q[b.j], lanes_.q_j, l);
    const Vec3d r_ij = between(s, b);
    lanes_.r_ij[0][l] = r_ij.x, lanes_.r_ij[1][l] = r_ij.y, lanes_.r_ij[2][l] = r_ij.z;
  }
  /// With numbers in all lanes, those of the first bond where none waits.
  BondLanes& filled(const State& s) {
    const std::size_t number = number_;
    while (number_ < bonds_together) add(s, bonds_[0]);
    number_ = number;
    return lanes_;
  }

 private:
  static void put(const Quatd& q, BondLanes::Lane (&to)[4], std::size_t l) {
    to[0][l] = q.w, to[1][l] = q.x, to[2][l] = q.y, to[3][l] = q.z;
  }
  std::array<BondId, bonds_together> bonds_{};
  std::size_t number_ = 0;
  BondLanes lanes_;
};

/// Those of these bonds that hold, in their order. Those that may go together, as may(k) says and their law
/// allows: work(loops, lanes) for some of them, then each(k, lanes, lane); alone(k) for others.
template <class Bonds, class May, class Work, class Each, class Alone>
void for_bonds_in_lanes(const State& s, const Bonds& bonds, May&& may, Work&& work, Each&& each,
                        Alone&& alone) {
  const BondLaneKernel& kernel = bond_lane_kernel();
  WaitingBonds waiting;
  const BondLaneLoops* loops = nullptr;
  const auto work_out = [&] {
    if (waiting.number() == 0) return;
    BondLanes& lanes = waiting.filled(s);
    work(*loops, lanes);
    for (std::size_t l = 0; l < waiting.number(); ++l) each(waiting.bond(l), lanes, l);
    waiting.empty();
  };
  for (const BondId k : bonds) {
    const Bond& b = s.bonds[k];
    if (b.broken) continue;
    const BondLaneLoops* own = may(k) ? lane_loops(kernel, *b.law, *b.rules) : nullptr;
    if (own != loops || own == nullptr) work_out();
    loops = own;
    if (own == nullptr) {
      alone(k);
      continue;
    }
    waiting.add(s, k);
    if (waiting.number() == bonds_together) work_out();
  }
  work_out();
}

}  // namespace vbond
