#pragma once
#include "campaigns/dice.hpp"
#include "vbond/physics/pose.hpp"

namespace vbond::testing {

/// Two particles with bond axes in body frames, in any position.
struct RandomPair {
  Vec3d r_i, r_j;
  Quatd q_i, q_j;
  Vec3d body_i[3], body_j[3];

  BondPose<double> pose() const {
    BondPose<double> b{r_j - r_i, {}, {}};
    for (int k = 0; k < 3; ++k) b.n_i[k] = rotate(q_i, body_i[k]), b.n_j[k] = rotate(q_j, body_j[k]);
    return b;
  }
};

class PoseSource : public Dice {
 public:
  using Dice::Dice;
  double uniform(double low, double high) { return (*this)(low, high); }
  /// A pair whose bond points anywhere, its ends then moved by up to `shift` and turned by up to `angle`.
  RandomPair pair(double distance, double shift, double angle) {
    const Quatd frame = rotation(3.14), q_i = rotation(3.14), q_j = rotation(3.14);
    const Vec3d e = rotate(frame, {1, 0, 0}), n2 = rotate(frame, {0, 1, 0}), n3 = rotate(frame, {0, 0, 1});
    RandomPair p;
    p.r_i = vector(2.0);
    p.r_j = p.r_i + distance * e + vector(shift);
    const Vec3d n_i[3] = {e, n2, n3}, n_j[3] = {-e, n2, n3};
    for (int k = 0; k < 3; ++k) {
      p.body_i[k] = rotate(conjugate(q_i), n_i[k]);
      p.body_j[k] = rotate(conjugate(q_j), n_j[k]);
    }
    p.q_i = rotation(angle) * q_i;
    p.q_j = rotation(angle) * q_j;
    return p;
  }
};

}  // namespace vbond::testing
