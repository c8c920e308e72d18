// The loops of a step. This file is compiled once per instruction set, with its own namespace VBOND_KERNEL,
// the number of lanes VBOND_LANES, and VBOND_HD forcing the physics inline. It must define nothing but that
// namespace's table of functions: an inline function emitted here would be compiled for a machine on which
// the rest of the program may not be running.
#include "vbond/dynamics/kernel.hpp"

#include "vbond/core/pack.hpp"
#include "vbond/physics/evm.hpp"
#include "vbond/physics/range.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

constexpr std::size_t lanes = VBOND_LANES;
constexpr std::uint32_t one_after_another[rows_at_once] = {0, 1, 2, 3, 4, 5, 6, 7};
using Real = Pack<lanes>;

// ---- rows and lanes ---------------------------------------------------------------------------------

template <class R>
VBOND_HD const double* numbers(const R* row) {
  return reinterpret_cast<const double*>(row);
}
template <class R>
VBOND_HD double* numbers(R* row) {
  return reinterpret_cast<double*>(row);
}

/// Number k of row[l] in lane l of column[k].
template <class R>
VBOND_HD void load_columns(const R* rows, const std::uint32_t* row, Real (&column)[8]) {
  for (std::size_t part = 0; part < 8; part += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) column[part + l] = Real::load(numbers(rows + row[l]) + part);
    transpose(column + part);
  }
}

/// The other way about: afterwards row l is column[l], column[lanes + l] and so on.
VBOND_HD void make_rows(Real (&column)[8]) {
  for (std::size_t part = 0; part < 8; part += lanes) transpose(column + part);
}

VBOND_HD void add_row(const Real (&rows)[8], std::size_t l, double* to) {
  for (std::size_t part = 0; part < 8; part += lanes)
    (Real::load(to + part) + rows[part + l]).store(to + part);
}

/// This part of a row of eight that holds x four times, then y.
template <std::size_t W = lanes>
VBOND_HD Pack<W> halves(double x, double y, std::size_t part) {
  if constexpr (W == 8)
    return Pack<W>(__builtin_shufflevector(Pack<W>(x).v, Pack<W>(y).v, 0, 0, 0, 0, W, W, W, W));
  else
    return Pack<W>(part < 4 ? x : y);
}

/// The sum of a row's numbers, always in this order.
VBOND_HD double sum_of_row(const Real (&row)[8 / lanes]) {
  double x[8];
  for (std::size_t part = 0; part < 8; part += lanes) row[part / lanes].store(x + part);
  return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

// ---- bonds ------------------------------------------------------------------------------------------

VBOND_HD Quat<Real> quat(const double (&q)[4][pack_bonds], std::size_t l) {
  return {Real::load(q[0] + l), Real::load(q[1] + l), Real::load(q[2] + l), Real::load(q[3] + l)};
}

template <template <class> class Law>
VBOND_HD Law<Real> law_of(const CompactPack& p, const BondType& t, std::size_t l) {
  const Real scale = Real::load(p.scale + l);
  return {Real::load(p.a + l), Real(t.R_i),        Real(t.R_j),       scale * Real(t.B1),
          scale * Real(t.B2),  scale * Real(t.B3), scale * Real(t.B4)};
}
template <template <class> class Law>
VBOND_HD Law<Real> law_of(const FullPack& p, const BondType&, std::size_t l) {
  return {Real::load(p.a + l),  Real::load(p.R_i + l), Real::load(p.R_j + l), Real::load(p.B1 + l),
          Real::load(p.B2 + l), Real::load(p.B3 + l),  Real::load(p.B4 + l)};
}

VBOND_HD BondFrames<Real> frames_of(const CompactPack& p, std::size_t l) {
  const Quat<Real> frame = quat(p.frame, l);
  return {frame, frame};
}
VBOND_HD BondFrames<Real> frames_of(const FullPack& p, std::size_t l) {
  return {quat(p.frame_i, l), quat(p.frame_j, l)};
}

/// The bonds in lanes l, l + 1 .. of a pack as their particles stand.
template <class P>
VBOND_HD BondPose<Real> pose_of(const P& p, const PoseRow* pose, std::size_t l) {
  Real i[8], j[8];
  load_columns(pose, p.i + l, i);
  load_columns(pose, p.j + l, j);
  return bond_pose(frames_of(p, l), {i[0], i[1], i[2]}, {i[4], i[5], i[6], i[7]}, {j[0], j[1], j[2]},
                   {j[4], j[5], j[6], j[7]});
}

template <template <class> class Law, class P>
VBOND_HD void add_pack(const P& p, const BondType& type, PackLanes in_use, RowRange own, const PoseRow* pose,
                       LoadRow* load) {
  for (std::size_t first = 0; first < pack_bonds; first += lanes) {
    const BondLoads<Real> b = bond_loads(law_of<Law>(p, type, first), pose_of(p, pose, first));
    const Real zero(0.0);
    Real on_i[8] = {b.F.x, b.F.y, b.F.z, zero, b.M_ij.x, b.M_ij.y, b.M_ij.z, zero};
    Real on_j[8] = {-b.F.x, -b.F.y, -b.F.z, zero, b.M_ji.x, b.M_ji.y, b.M_ji.z, zero};
    make_rows(on_i);
    make_rows(on_j);
    if (in_use.count == pack_bonds && !in_use.crossing) {
      for (std::size_t l = 0; l < lanes; ++l) {  // bond after bond: two of them may share a particle
        add_row(on_i, l, numbers(load + p.i[first + l]));
        add_row(on_j, l, numbers(load + p.j[first + l]));
      }
      continue;
    }
    for (std::size_t l = 0; l < lanes && first + l < in_use.count; ++l) {
      if (own.contains(p.i[first + l])) add_row(on_i, l, numbers(load + p.i[first + l]));
      if (own.contains(p.j[first + l])) add_row(on_j, l, numbers(load + p.j[first + l]));
    }
  }
}

template <class P>
void add_loads(const PackRun<P>& run, RowRange own, const PoseRow* pose, LoadRow* load) {
  switch (run.type.law) {
    case BondLaw::v_model:
      for (std::size_t k = 0; k < run.count; ++k)
        add_pack<VModel>(run.packs[k], run.type, run.lanes[k], own, pose, load);
      break;
    case BondLaw::evm:
      for (std::size_t k = 0; k < run.count; ++k)
        add_pack<Evm>(run.packs[k], run.type, run.lanes[k], own, pose, load);
      break;
  }
}

template <template <class> class Law, class P>
VBOND_HD std::uint8_t survey_pack(const P& p, const BondType& type, PackLanes in_use, const PoseRow* pose,
                                  BondEnergies& sum) {
  unsigned look = 0;
  for (std::size_t first = 0; first < in_use.count; first += lanes) {
    const BondPose<Real> b = pose_of(p, pose, first);
    const Law<Real> law = law_of<Law>(p, type, first);
    const BondEnergy<Real> U = bond_energy(law, b);
    const BondTilt<Real> tilt = bond_tilt(b, law.R_i, law.R_j);
    for (std::size_t l = 0; l < lanes && first + l < in_use.count; ++l) {
      sum.U_L += U.U_L.v[l];
      sum.U_B += U.U_B.v[l];
      sum.U_T += U.U_T.v[l];
      const BondTilt<double> t{tilt.length.v[l], tilt.c_i.v[l], tilt.c_j.v[l], tilt.cos_twist.v[l],
                               tilt.sin_twist.v[l]};
      if (needs_look(t, p.a[first + l])) look |= 1u << (first + l);
    }
  }
  return static_cast<std::uint8_t>(look);
}

template <class P>
void survey(const PackRun<P>& run, const PoseRow* pose, BondEnergies& sum, std::uint8_t* look) {
  switch (run.type.law) {
    case BondLaw::v_model:
      for (std::size_t k = 0; k < run.count; ++k)
        look[k] = survey_pack<VModel>(run.packs[k], run.type, run.lanes[k], pose, sum);
      break;
    case BondLaw::evm:
      for (std::size_t k = 0; k < run.count; ++k)
        look[k] = survey_pack<Evm>(run.packs[k], run.type, run.lanes[k], pose, sum);
      break;
  }
}

// ---- particles --------------------------------------------------------------------------------------

double kick(RowRange rows, double h, const InverseInertia* inverse, const LoadRow* load, MotionRow* motion) {
  Real poison[8 / lanes];  // 0 * x is 0 for every finite x and NaN for any other
  for (Real& p : poison) p = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (std::size_t part = 0; part < 8; part += lanes) {
      const Real F = Real::load(numbers(load + k) + part);
      double* v = numbers(motion + k) + part;
      (Real::load(v) + halves(h * inverse[k].per_m, h * inverse[k].per_Theta, part) * F).store(v);
      poison[part / lanes] = poison[part / lanes] + Real(0.0) * F;
    }
  return sum_of_row(poison);
}

/// The largest square of each component of v and omega in these rows. A NaN counts as a small number: it
/// stays one whatever is done with it.
VBOND_HD MotionRow largest_squares(RowRange rows, const MotionRow* motion) {
  Real largest[8 / lanes];  // square of each number of a row
  for (Real& x : largest) x = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; k += 2)  // two at once: a shorter chain of waiting
    for (std::size_t part = 0; part < 8; part += lanes) {
      const Real first = Real::load(numbers(motion + k) + part),
                 second = Real::load(numbers(motion + k + 1) + part);
      Real& most = largest[part / lanes];
      most = max(most, max(first * first, second * second));
    }
  MotionRow squares;
  for (std::size_t part = 0; part < 8; part += lanes) largest[part / lanes].store(numbers(&squares) + part);
  return squares;
}

VBOND_HD double sum_of(const Vec3d& x) {
  return x.x + x.y + x.z;
}

double drift(RowRange rows, double h, const MotionRow* motion, PoseRow* pose) {
  const MotionRow most = largest_squares(rows, motion);
  const double way2 = h * h * sum_of(most.v);
  if (!(h * h * sum_of(most.omega) < small_rotation_limit2)) {  // too much for small_rotation, or nearly so
    drift_by_any_angle(rows, h, motion, pose);
    return way2;
  }
  const Real step(h);
  for (std::size_t k = rows.first; k < rows.last; k += lanes) {
    Real p[8], m[8];
    load_columns(pose + k, one_after_another, p);
    load_columns(motion + k, one_after_another, m);
    const Quat<Real> turn = small_rotation(step * Vec3<Real>{m[4], m[5], m[6]});
    const Quat<Real> q = renormalised(turn * Quat<Real>{p[4], p[5], p[6], p[7]});
    Real moved[8] = {p[0] + step * m[0], p[1] + step * m[1], p[2] + step * m[2], p[3], q.w, q.x, q.y, q.z};
    make_rows(moved);
    for (std::size_t l = 0; l < lanes; ++l)
      for (std::size_t part = 0; part < 8; part += lanes) moved[part + l].store(numbers(pose + k + l) + part);
  }
  return way2;
}

double slow_down(RowRange rows, const Decay* decay, MotionRow* motion) {
  Real lost[8 / lanes];
  for (Real& e : lost) e = Real(0.0);
  for (std::size_t k = rows.first; k < rows.last; ++k)
    for (std::size_t part = 0; part < 8; part += lanes) {
      double* v = numbers(motion + k) + part;
      const Real rate = Real::load(v);
      lost[part / lanes] =
          lost[part / lanes] + halves(decay[k].of_v, decay[k].of_omega, part) * (rate * rate);
      (halves(decay[k].v, decay[k].omega, part) * rate).store(v);
    }
  return sum_of_row(lost);
}

}  // namespace

ContactLoop add_contact_loads;  // contact_kernel.cpp

extern const StepKernel kernel;
const StepKernel kernel{VBOND_KERNEL_NAME,
                        {add_loads<CompactPack>, survey<CompactPack>},
                        {add_loads<FullPack>, survey<FullPack>},
                        kick,
                        drift,
                        slow_down,
                        add_contact_loads};

}  // namespace vbond::VBOND_KERNEL
