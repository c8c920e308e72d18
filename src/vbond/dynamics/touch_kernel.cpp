// The loop over pairs that touch, with all that physics/touch.hpp says; compiled as kernel.cpp is and by the
// same rules.
#include "vbond/dynamics/touch_kernel.hpp"

#include "vbond/dynamics/contact_kernel.hpp"
#include "vbond/dynamics/kernel_rows.hpp"
#include "vbond/physics/touch.hpp"
#include "vbond/physics/touch_mass.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

/// Pairs that are worked out together.
struct Together {
  std::uint32_t i[lanes], j[lanes];
  std::size_t pair[lanes], slot[lanes];
  std::size_t count = 0;
};

/// Four numbers of `lanes` rows, transposed: number k of row l in lane l of x[k].
template <class R, class Index>
VBOND_HD void load_quads(const R* rows, const Index* row, Half half, Halves& x) {
  const auto at = static_cast<std::size_t>(half);
  for (std::size_t k = 0; k < 4; ++k) {
#if VBOND_LANES == 8
    x[k].v = side_by_side(numbers(rows + row[k]) + at, numbers(rows + row[k + 4]) + at);
#else
    x[k] = Real::load(numbers(rows + row[k % lanes]) + at + k / lanes * lanes);
#endif
  }
  transpose_halves(x);
}

/// The reverse. Lanes that hold the same row write the same.
template <class R>
VBOND_HD void store_quads(Halves& x, R* rows, const std::size_t* row, Half half) {
  const auto at = static_cast<std::size_t>(half);
  transpose_halves(x);
  for (std::size_t k = 0; k < 4; ++k) {
#if VBOND_LANES == 8
    constexpr std::size_t quad = 4 * sizeof(double);
    std::memcpy(numbers(rows + row[k]) + at, &x[k].v, quad);
    std::memcpy(numbers(rows + row[k + 4]) + at, reinterpret_cast<const char*>(&x[k].v) + quad, quad);
#else
    x[k].store(numbers(rows + row[k % lanes]) + at + k / lanes * lanes);
#endif
  }
}

VBOND_HD Vec3<Real> vector(const Halves& x) {
  return {x[0], x[1], x[2]};
}

VBOND_HD TouchNumbers<Real> all_alike(const TouchNumbers<double>& n) {
  return {Real(n.stiffness),          Real(n.tangential), Real(n.damping), Real(n.viscous),
          Real(n.tangential_damping), Real(n.friction),   Real(n.rolling), Real(n.twisting),
          Real(n.rolling_stiffness),  Real(n.work)};
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
  take(&TouchNumbers<Real>::viscous, &TouchNumbers<double>::viscous);
  take(&TouchNumbers<Real>::tangential_damping, &TouchNumbers<double>::tangential_damping);
  take(&TouchNumbers<Real>::friction, &TouchNumbers<double>::friction);
  take(&TouchNumbers<Real>::rolling, &TouchNumbers<double>::rolling);
  take(&TouchNumbers<Real>::twisting, &TouchNumbers<double>::twisting);
  take(&TouchNumbers<Real>::rolling_stiffness, &TouchNumbers<double>::rolling_stiffness);
  take(&TouchNumbers<Real>::work, &TouchNumbers<double>::work);
  return to;
}

/// A sum over pairs in rows_at_once parts, every so many pairs in the same one: the bits do not depend on the
/// number of lanes, and no addition waits for the one before.
struct SumOfPairs {
  double part[rows_at_once] = {};

  /// Adds the first `count` lanes; `before` pairs, a multiple of the lanes, came before.
  VBOND_HD void add(const Real& x, std::size_t count, std::size_t before) {
    double* const at = part + before % rows_at_once;
    double of[lanes];
    (Real::load(at) + x).store(of);
    std::memcpy(at, of, count * sizeof(double));
  }
  VBOND_HD double sum() const {
    double all = 0.0;
    for (const double x : part) all += x;
    return all;
  }
};

/// TouchLosses of all pairs that touch.
struct LossesOfPairs {
  SumOfPairs damping, friction, rolling, adhesion;
  std::size_t pairs = 0;
};

VBOND_HD void work_out(const TouchRule& rule, const TouchTable& table, Together& t, const PoseRow* pose,
                       const MotionRow* motion, double dt, LossesOfPairs& lost) {
  for (std::size_t l = t.count; l < lanes; ++l)
    t.i[l] = t.i[0], t.j[l] = t.j[0], t.pair[l] = t.pair[0], t.slot[l] = t.slot[0];
  Halves r_ij, v_i, v_j, w_i, w_j;
  load_between(pose, t.i, t.j, r_ij);
  load_halves(motion, t.i, Half::first, v_i);
  load_halves(motion, t.j, Half::first, v_j);
  for (std::size_t k = 0; k < 4; ++k) v_j[k] = v_j[k] - v_i[k];
  transpose_halves(v_j);
  load_columns(motion, t.i, Half::second, w_i);
  load_columns(motion, t.j, Half::second, w_j);
  Halves row_i, row_j;
  load_quads(rule.row, t.i, Half::first, row_i);
  load_quads(rule.row, t.j, Half::first, row_j);

  Touching<Real> p =
      round_bodies<Real>(vector(r_ij), {row_i[0], row_i[1], row_i[2]}, {row_j[0], row_j[1], row_j[2]},
                         vector(v_j), vector(w_i), vector(w_j));
  undamp_if_none_is_free(p);
  if (table.kept != nullptr) {
    double of[lanes];
    for (std::size_t l = 0; l < lanes; ++l) of[l] = table.kept[t.pair[l]];
    p.overlap = p.overlap - Real::load(of);
  }

  const bool rolls = rule.forms.rolling != RollingForm::none;
  const Real zero(0.0);
  Halves of_slip, of_damping, of_rolling = {zero, zero, zero, zero};
  load_quads(table.slip, t.pair, Half::first, of_slip);
  load_quads(table.slip, t.pair, Half::second, of_damping);
  if (rolls) load_quads(table.rolling, t.pair, Half::first, of_rolling);
  const TouchHistory<Real> before{vector(of_slip), of_slip[3],         vector(of_damping),
                                  of_damping[3],   vector(of_rolling), of_rolling[3]};

  const TouchLoads<Real> loads = touch(rule.forms, numbers_of_pairs(rule, t), p, Real(dt), before);
  const Vec3<Real> T = cross(p.n, loads.F);
  Halves of_F = {loads.F.x, loads.F.y, loads.F.z, p.l_i}, of_T = {T.x, T.y, T.z, p.l_j};
  store_quads(of_F, table.load, t.slot, Half::first);
  store_quads(of_T, table.load, t.slot, Half::second);
  for (std::size_t l = 0; l < t.count; ++l) table.touching[t.slot[l]] = 1;
  const TouchHistory<Real>& h = loads.history;
  Halves now_slip = {h.F_t.x, h.F_t.y, h.F_t.z, h.a}, now_damping = {h.F_d.x, h.F_d.y, h.F_d.z, h.k_r};
  store_quads(now_slip, table.slip, t.pair, Half::first);
  store_quads(now_damping, table.slip, t.pair, Half::second);
  if (rolls) {
    // the fourth is not used; where it was zero, g++ 12 stored the third in its place
    Halves of_M = {loads.M.x, loads.M.y, loads.M.z, h.M_t}, now_rolling = {h.M_r.x, h.M_r.y, h.M_r.z, h.M_t};
    store_quads(of_M, table.moment, t.slot, Half::first);
    store_quads(now_rolling, table.rolling, t.pair, Half::first);
  }
  if (dt > 0.0) {
    lost.damping.add(loads.lost.damping, t.count, lost.pairs);
    if (rule.forms.tangential != TangentialForm::none)
      lost.friction.add(loads.lost.friction, t.count, lost.pairs);
    if (rolls) lost.rolling.add(loads.lost.rolling, t.count, lost.pairs);
    if (rule.forms.adhesion != AdhesionForm::none)
      lost.adhesion.add(loads.lost.adhesion, t.count, lost.pairs);
    lost.pairs += lanes;
  }
}

/// What pairs remember is read as they come, and so many pairs ahead memory is asked for it.
constexpr std::size_t pairs_ahead = 24;

/// Two that do not touch: whether they hold on to each other. What they remember is lost if not.
bool still_touch(const TouchRule& rule, const TouchTable& table, std::size_t i, std::size_t k,
                 const PoseRow* pose, const MotionRow* motion, double dt, TouchLosses<double>& parted) {
  const std::size_t j = table.second[k].value;
  if (table.slip[k].a == 0.0) return false;
  const TouchNumbers<double>& numbers =
      rule.numbers[rule.material == nullptr ? 0 : rule.material[i] * rule.materials + rule.material[j]];
  const Touching<double> p =
      touching_of(rule.row[i], rule.row[j], between(pose[i], pose[j]), motion[i], motion[j]);
  if (holds_on(rule.forms, numbers, p.R, p.overlap)) return true;
  const bool rolls = rule.forms.rolling != RollingForm::none;
  if (dt > 0.0)
    parted += lost_on_parting(rule.forms, numbers, p, dt,
                              touch_history(table.slip[k], rolls ? table.rolling[k] : MomentRow{}));
  table.slip[k] = {};
  if (rolls) table.rolling[k] = {};
  return false;
}

/// A row of loads gets sign F, lever T, and sign times the moment of a pair.
VBOND_HD void add_pair(const TouchTable& table, std::size_t slot, double sign, double lever,
                       Real (&row)[8 / lanes]) {
  constexpr double used[8] = {1, 1, 1, 0, 1, 1, 1, 0};  // not the levers, which stand beside F and T
  const double* const load = numbers(table.load + slot);
  for (std::size_t at = 0; at < 8; at += lanes)
    row[at / lanes] =
        row[at / lanes] + halves_of(sign, lever, at) * Real::load(used + at) * Real::load(load + at);
  if (table.moment == nullptr) return;
  double moment[8] = {};
  std::memcpy(moment + 4, table.moment + slot, sizeof(Vec3d));  // the fourth number of a row stays 0
  for (std::size_t at = 0; at < 8; at += lanes)
    row[at / lanes] = row[at / lanes] + Real(sign) * Real::load(moment + at);
}

}  // namespace

AddTouches add_touches;
void add_touches(const TouchTable& table, const TouchesAsSecond& second, RowRange rows, LoadRow* load) {
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    Real row[8 / lanes];
    for (std::size_t at = 0; at < 8; at += lanes) row[at / lanes] = Real::load(numbers(load + i) + at);
    for (std::size_t e = second.start[i]; e < second.start[i + 1]; ++e)
      if (const std::size_t s = second.slot[e]; table.touching[s] != 0)
        add_pair(table, s, -1.0, table.load[s].l_j, row);
    const std::size_t to_slot = table.first_slot - table.first_pair;
    for (std::size_t s = table.start[i] + to_slot; s < table.start[i + 1] + to_slot; ++s)
      if (table.touching[s] != 0) add_pair(table, s, 1.0, table.load[s].l_i, row);
    for (std::size_t at = 0; at < 8; at += lanes) row[at / lanes].store(numbers(load + i) + at);
  }
}

TouchLoop touch_pairs;
TouchSums touch_pairs(const TouchRule& rule, const TouchTable& table, RowRange rows, const PoseRow* pose,
                      const MotionRow* motion, double dt) {
  TouchSums sums;
  LossesOfPairs lost;
  TouchLosses<double> parted;
  Together together;
  const std::size_t last = table.start[rows.last];
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    const Vec3d r_i = pose[i].r;
    const double R_i = rule.row[i].R;
    for (std::size_t k = table.start[i]; k < table.start[i + 1]; ++k) {
      __builtin_prefetch(table.slip + (k + pairs_ahead < last ? k + pairs_ahead : last), 1);
      const std::uint32_t j = table.second[k].value;
      const Vec3d r_ij = between(r_i, pose[j].r);
      const double distance2 = r_ij.x * r_ij.x + r_ij.y * r_ij.y + r_ij.z * r_ij.z,
                   reach = R_i + rule.row[j].R;
      const std::size_t slot = k - table.first_pair + table.first_slot;
      table.touching[slot] = 0;
      double felt = reach;
      if (table.kept != nullptr && table.kept[k] > 0.0)
        felt -= table.kept[k] = still_kept(table.kept[k], reach - std::sqrt(distance2));
      // a distance that is NaN counts as touching: the load check finds it
      if (distance2 >= felt * felt && !still_touch(rule, table, i, k, pose, motion, dt, parted)) continue;
      sums.deep |= distance2 < deep_part * reach * (deep_part * reach);
      together.i[together.count] = static_cast<std::uint32_t>(i);
      together.j[together.count] = j;
      together.pair[together.count] = k;
      together.slot[together.count] = slot;
      if (++together.count < lanes) continue;
      work_out(rule, table, together, pose, motion, dt, lost);
      together.count = 0;
    }
  }
  if (together.count > 0) work_out(rule, table, together, pose, motion, dt, lost);
  sums.lost = {lost.damping.sum(), lost.friction.sum(), lost.rolling.sum(), lost.adhesion.sum()};
  sums.lost += parted;
  return sums;
}

}  // namespace vbond::VBOND_KERNEL
