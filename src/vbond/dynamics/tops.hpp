#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/core/large_array.hpp"
#include "vbond/dynamics/order.hpp"
#include "vbond/dynamics/rows.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// The rotation of particles whose moments of inertia differ. Their angular momenta L are kept here; rows
/// hold the omega that follows, as those of all others. The kernels' kick and drag leave it alone (1/Theta is
/// 0 there), and their drift is overwritten.
///
/// A top that supports hold about all three axes turns as they say, by the kernels' drift; one that they hold
/// at rest about two axes turns about the third with the moment about that axis, which this does not change.
class Tops {
 public:
  /// Columns of the rows that it moves.
  struct Rows {
    LargeArray<PoseRow>& pose;
    LargeArray<MotionRow>& motion;
  };

  Tops(const Model& model, const Order& order);

  bool any() const { return !tops_.empty(); }
  bool has(std::size_t row) const { return !top_of_row_.empty() && top_of_row_[row] != 0; }
  /// L from a state, or from its omega where that is not the one that follows from L; and back, with its
  /// rows.
  void read(const State& state, const Order& order);
  void write(State& state, const Order& order) const;
  /// What supports hold of a particle, from now on, besides what they did.
  void hold(std::size_t row, const HeldDofs& held);
  void hold(const std::vector<Support>& supports, const Order& order);

  /// L += h M, and omega with it.
  void kick(RowRange rows, double h, const LargeArray<LoadRow>& load, const Rows& bodies);
  /// Drag b over h, solved exactly for each principal axis; returns the energy that goes.
  double slow_down(RowRange rows, double h, double b, const Rows& bodies);
  /// To be called before the kernels' drift, and put_turned after it: free tops turn for h without torque.
  void turn(RowRange rows, double h, const Rows& bodies);
  void put_turned(RowRange rows, const Rows& bodies) const;

  /// Tops that are held about two axes lose what they turn about these; L about the third stays.
  void turn_about_free_axes(RowRange rows, const Rows& bodies) const;

  /// Kinetic energy of the rotation of a top, if it turned with omega as it stands.
  double energy_with(std::size_t row, const PoseRow& pose, const Vec3d& omega) const;

  enum class Turns { freely, about_one_axis, as_held };
  /// Kinetic energy of the rotation of tops that are held at least so much.
  double energy(RowRange rows, Turns least, const LargeArray<PoseRow>& pose,
                const LargeArray<MotionRow>& motion) const;

 private:
  struct Top {
    std::size_t row;
    PrincipalInertia inertia;
    bool held[3] = {false, false, false};
    Vec3d L;      // of free ones
    Quatd q;      // after the drift under way
    Vec3d omega;  // likewise
    Turns turns() const {
      const int n = held[0] + held[1] + held[2];
      return n == 3 ? Turns::as_held : n == 2 ? Turns::about_one_axis : Turns::freely;
    }
    Vec3d free_axis() const { return {held[0] ? 0.0 : 1.0, held[1] ? 0.0 : 1.0, held[2] ? 0.0 : 1.0}; }
    Quatd principal(const Quatd& q_body) const { return q_body * inertia.axes; }
    Vec3d omega_at(const Quatd& q_body) const {
      return angular_velocity(inertia.moments, principal(q_body), L);
    }
  };

 public:
  static constexpr std::size_t bytes_each = sizeof(Top);  ///< [bytes]

 private:
  /// f(top) for those of `tops` in these rows.
  template <class SomeTops, class F>
  static void for_each(SomeTops& tops, RowRange rows, F f);

  std::vector<Top> tops_;                  // by rows
  bool any_in_body_ = false;               // or in another part of it
  std::vector<std::uint32_t> top_of_row_;  // in tops_, from 1; 0: none. Empty without tops
};

}  // namespace vbond
