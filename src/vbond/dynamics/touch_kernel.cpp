// The loop over pairs that touch, with all that physics/touch.hpp says; compiled as kernel.cpp is and by the
// same rules.
#include "vbond/dynamics/touch_kernel.hpp"

#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/kernel_rows.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

/// Pairs that are worked out together.
struct Together {
  std::uint32_t i[lanes], j[lanes];
  std::size_t pair[lanes];
  std::size_t count = 0;
};

/// Numbers from 4 q on of `lanes` rows of so many, transposed: number k of row l in lane l of x[k].
template <class R>
VBOND_HD void load_quads(const R* rows, const std::size_t* row, std::size_t q, Halves& x) {
  for (std::size_t k = 0; k < 4; ++k) {
#if VBOND_LANES == 8
    x[k].v = side_by_side(numbers(rows + row[k]) + 4 * q, numbers(rows + row[k + 4]) + 4 * q);
#else
    x[k] = Real::load(numbers(rows + row[k % lanes]) + 4 * q + k / lanes * lanes);
#endif
  }
  transpose_halves(x);
}

/// The reverse. Lanes that hold the same row write the same.
template <class R>
VBOND_HD void store_quads(Halves& x, R* rows, const std::size_t* row, std::size_t q) {
  transpose_halves(x);
  for (std::size_t k = 0; k < 4; ++k) {
#if VBOND_LANES == 8
    constexpr std::size_t quad = 4 * sizeof(double);
    std::memcpy(numbers(rows + row[k]) + 4 * q, &x[k].v, quad);
    std::memcpy(numbers(rows + row[k + 4]) + 4 * q, reinterpret_cast<const char*>(&x[k].v) + quad, quad);
#else
    x[k].store(numbers(rows + row[k % lanes]) + 4 * q + k / lanes * lanes);
#endif
  }
}

VBOND_HD Vec3<Real> vector(const Halves& x) {
  return {x[0], x[1], x[2]};
}

VBOND_HD TouchNumbers<Real> all_alike(const TouchNumbers<double>& n) {
  return {Real(n.stiffness),          Real(n.tangential),        Real(n.damping),
          Real(n.tangential_damping), Real(n.friction),          Real(n.rolling),
          Real(n.twisting),           Real(n.rolling_stiffness), Real(n.work)};
}

VBOND_HD TouchNumbers<Real> numbers_of_pairs(const TouchRule& rule, const Together& t) {
  if (rule.material == nullptr) return all_alike(*rule.numbers);
  TouchNumbers<double> of[lanes];
  for (std::size_t l = 0; l < lanes; ++l)
    of[l] = rule.numbers[rule.material[t.i[l]] * rule.materials + rule.material[t.j[l]]];
  TouchNumbers<Real> to;
  const auto take = [&](Real TouchNumbers<Real>::*to_number, double TouchNumbers<double>::*number) {
    double x[lanes];
    for (std::size_t l = 0; l < lanes; ++l) x[l] = of[l].*number;
    to.*to_number = Real::load(x);
  };
  take(&TouchNumbers<Real>::stiffness, &TouchNumbers<double>::stiffness);
  take(&TouchNumbers<Real>::tangential, &TouchNumbers<double>::tangential);
  take(&TouchNumbers<Real>::damping, &TouchNumbers<double>::damping);
  take(&TouchNumbers<Real>::tangential_damping, &TouchNumbers<double>::tangential_damping);
  take(&TouchNumbers<Real>::friction, &TouchNumbers<double>::friction);
  take(&TouchNumbers<Real>::rolling, &TouchNumbers<double>::rolling);
  take(&TouchNumbers<Real>::twisting, &TouchNumbers<double>::twisting);
  take(&TouchNumbers<Real>::rolling_stiffness, &TouchNumbers<double>::rolling_stiffness);
  take(&TouchNumbers<Real>::work, &TouchNumbers<double>::work);
  return to;
}

/// Adds the first lanes in their order.
VBOND_HD void add_first(const Real& x, std::size_t count, double& sum) {
  double of[lanes];
  x.store(of);
  for (std::size_t l = 0; l < count; ++l) sum += of[l];
}

VBOND_HD void work_out(const TouchRule& rule, const TouchTable& table, Together& t, const PoseRow* pose,
                       const MotionRow* motion, double dt, TouchSums& sums) {
  for (std::size_t l = t.count; l < lanes; ++l) t.i[l] = t.i[0], t.j[l] = t.j[0], t.pair[l] = t.pair[0];
  Halves a, b, v_i, v_j, w_i, w_j;
  std::size_t of_i[lanes], of_j[lanes];
  for (std::size_t l = 0; l < lanes; ++l) of_i[l] = t.i[l], of_j[l] = t.j[l];
  load_halves(pose, t.i, Half::first, a);
  load_halves(pose, t.j, Half::first, b);
  load_halves(motion, t.i, Half::first, v_i);
  load_halves(motion, t.j, Half::first, v_j);
  for (std::size_t k = 0; k < 4; ++k) b[k] = b[k] - a[k], v_j[k] = v_j[k] - v_i[k];
  transpose_halves(b);
  transpose_halves(v_j);
  load_columns(motion, t.i, Half::second, w_i);
  load_columns(motion, t.j, Half::second, w_j);
  Halves row_i, row_j;
  load_quads(rule.row, of_i, 0, row_i);
  load_quads(rule.row, of_j, 0, row_j);

  Touching<Real> p =
      round_bodies<Real>(vector(b), {row_i[0], row_i[1], row_i[2]}, {row_j[0], row_j[1], row_j[2]},
                         vector(v_j), vector(w_i), vector(w_j));
  if (table.kept != nullptr) {
    double of[lanes];
    for (std::size_t l = 0; l < lanes; ++l) of[l] = table.kept[t.pair[l]];
    p.overlap = p.overlap - Real::load(of);
  }

  Halves q[3];
  const bool rolls = rule.forms.rolling != RollingForm::none;
  for (std::size_t k = 0; k < (rolls ? 3 : 2); ++k) load_quads(table.history, t.pair, k, q[k]);
  TouchHistory<Real> before;
  before.F_t = vector(q[0]), before.a = q[0][3];
  before.F_d = vector(q[1]), before.k_r = q[1][3];
  if (rolls)
    before.M_r = vector(q[2]), before.M_t = q[2][3];
  else
    before.M_r = {Real(0.0), Real(0.0), Real(0.0)}, before.M_t = Real(0.0);

  const TouchLoads<Real> loads = touch(rule.forms, numbers_of_pairs(rule, t), p, Real(dt), before);
  const Vec3<Real> T = cross(p.n, loads.F);
  Halves out[3] = {{loads.F.x, loads.F.y, loads.F.z, p.l_i},
                   {T.x, T.y, T.z, p.l_j},
                   {loads.M.x, loads.M.y, loads.M.z, Real(0.0)}};
  for (std::size_t k = 0; k < (rolls ? 3 : 2); ++k) store_quads(out[k], table.load, t.pair, k);
  for (std::size_t l = 0; l < t.count; ++l) table.touching[t.pair[l]] = 1;
  if (dt > 0.0) {
    add_first(loads.lost.damping, t.count, sums.lost.damping);
    if (rule.forms.tangential != TangentialForm::none)
      add_first(loads.lost.friction, t.count, sums.lost.friction);
    if (rolls) add_first(loads.lost.rolling, t.count, sums.lost.rolling);
    if (rule.forms.adhesion != AdhesionForm::none)
      add_first(loads.lost.adhesion, t.count, sums.lost.adhesion);
  }
  const TouchHistory<Real>& h = loads.history;
  Halves now[3] = {{h.F_t.x, h.F_t.y, h.F_t.z, h.a},
                   {h.F_d.x, h.F_d.y, h.F_d.z, h.k_r},
                   {h.M_r.x, h.M_r.y, h.M_r.z, h.M_t}};
  for (std::size_t k = 0; k < (rolls ? 3 : 2); ++k) store_quads(now[k], table.history, t.pair, k);
}

/// Two that do not touch: whether they hold on to each other. What they remember is lost if not.
bool still_touch(const TouchRule& rule, const TouchTable& table, std::size_t i, std::size_t k,
                 const PoseRow* pose, const MotionRow* motion, double dt, TouchSums& sums) {
  const std::size_t j = table.second[k].value;
  PairHistory& history = table.history[k].x;
  if (history[3] == 0.0) return false;
  const TouchNumbers<double>& numbers =
      rule.numbers[rule.material == nullptr ? 0 : rule.material[i] * rule.materials + rule.material[j]];
  const Touching<double> p =
      touching_of(rule.row[i], rule.row[j], pose[j].r - pose[i].r, motion[i], motion[j]);
  if (holds_on(rule.forms, numbers, p.R, p.overlap)) return true;
  if (dt > 0.0) sums.parted += lost_on_parting(rule.forms, numbers, p, dt, touch_history(history));
  for (double& x : history) x = 0.0;
  return false;
}

}  // namespace

TouchLoop touch_pairs;
TouchSums touch_pairs(const TouchRule& rule, const TouchTable& table, RowRange rows, const PoseRow* pose,
                      const MotionRow* motion, double dt) {
  TouchSums sums;
  Together together;
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    const Vec3d r_i = pose[i].r;
    const double R_i = rule.row[i].R;
    for (std::size_t k = table.start[i]; k < table.start[i + 1]; ++k) {
      const std::uint32_t j = table.second[k].value;
      const Vec3d r_ij = pose[j].r - r_i;
      const double distance2 = r_ij.x * r_ij.x + r_ij.y * r_ij.y + r_ij.z * r_ij.z,
                   reach = R_i + rule.row[j].R;
      table.touching[k] = 0;
      double felt = reach;
      if (table.kept != nullptr && table.kept[k] > 0.0)
        felt -= table.kept[k] = still_kept(table.kept[k], reach - std::sqrt(distance2));
      // a distance that is NaN counts as touching: the load check finds it
      if (distance2 >= felt * felt && !still_touch(rule, table, i, k, pose, motion, dt, sums)) continue;
      sums.deep |= distance2 < deep_part * reach * (deep_part * reach);
      together.i[together.count] = static_cast<std::uint32_t>(i);
      together.j[together.count] = j;
      together.pair[together.count] = k;
      if (++together.count < lanes) continue;
      work_out(rule, table, together, pose, motion, dt, sums);
      together.count = 0;
    }
  }
  if (together.count > 0) work_out(rule, table, together, pose, motion, dt, sums);
  sums.lost += sums.parted;
  return sums;
}

}  // namespace vbond::VBOND_KERNEL
