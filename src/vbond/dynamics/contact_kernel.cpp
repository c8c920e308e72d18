// The loop over contacts, compiled as kernel.cpp is and by the same rules.
#include "vbond/dynamics/contact_kernel.hpp"

#include "vbond/core/simd.hpp"

namespace vbond::VBOND_KERNEL {
namespace {

/// At most four: with eight too many lanes stay empty, since lists are short (docs/decisions/data-layout.md).
constexpr std::size_t lanes = VBOND_LANES < 4 ? VBOND_LANES : 4;
using Real = Pack<lanes>;
using Mask = decltype(Real::Native{} < Real::Native{});  // -1 or 0 in each lane

VBOND_HD bool any(const Mask& mask) {
  std::int64_t found = 0;
  for (std::size_t l = 0; l < lanes; ++l) found |= mask[l];
  return found != 0;
}

/// x where the mask is set, else 0.
VBOND_HD Real only(const Mask& mask, const Real& x) {
  return Real(mask ? x.v : typename Real::Native{});
}

/// The first lanes, so many of them.
VBOND_HD Mask first_lanes(std::size_t count) {
  constexpr std::int64_t indices[4] = {0, 1, 2, 3};
  Mask index;
  std::memcpy(&index, indices, sizeof index);
  return index < static_cast<std::int64_t>(count);
}

// ---- rows and lanes ---------------------------------------------------------------------------------

/// r or F of one row, and the number behind it, which is not used.
struct HalfRow {
  Real part[4 / lanes];
};

VBOND_HD HalfRow half_row(const Vec3d& r) {
  HalfRow h;
  for (std::size_t k = 0; k < 4; k += lanes) h.part[k / lanes] = Real::load(&r.x + k);
  return h;
}

/// F -= s r_ij
VBOND_HD void subtract(HalfRow& F, double s, const HalfRow& r_j, const HalfRow& r_i) {
  for (std::size_t k = 0; k < 4 / lanes; ++k)
    F.part[k] = F.part[k] - Real(s) * between(r_i.part[k], r_j.part[k]);
}

/// Where these rows are, one in each lane.
VBOND_HD Vec3<Real> places(const PoseRow* pose, const Row* row) {
  Real r[4];
  for (std::size_t k = 0; k < 4; ++k) r[k] = Real::load(&pose[row[k % lanes].value].r.x + k / lanes * lanes);
  transpose_halves(r);
  return {r[0], r[1], r[2]};
}

VBOND_HD Real radii(const double* radius, const Row* row) {
  Real R;
  for (std::size_t l = 0; l < lanes; ++l) R.v[l] = radius[row[l].value];
  return R;
}

// ---- contacts ---------------------------------------------------------------------------------------

template <ContactRule::Kind kind>
bool add_contacts(const ContactRule& rule, const NearRows& near, RowRange rows, const PoseRow* pose,
                  LoadRow* load) {
  Real deepest(0.0);
  for (std::size_t i = rows.first; i < rows.last; ++i) {
    const std::size_t begin = near.start[i], end = near.end[i];
    if (begin == end) continue;
    const Vec3d place = pose[i].r;
    const Vec3<Real> r_i{Real(place.x), Real(place.y), Real(place.z)};
    const HalfRow half_i = half_row(pose[i].r);
    const Real R_i(rule.radius[i]);
    HalfRow F = half_row(load[i].F);
    for (std::size_t k = begin; k < end; k += lanes) {
      const Row* const j = near.rows + k;
      const Real R_j = kind == ContactRule::Kind::alike ? R_i : radii(rule.radius, j);
      const Real reach = R_i + R_j, distance2 = norm2(between(r_i, places(pose, j)));
      const Mask touch = first_lanes(end - k) & ~(distance2.v >= sq(reach).v);  // a distance that is NaN, too
      if (!any(touch)) continue;
      const Real distance = sqrt(distance2);
      deepest = larger(only(touch, Real(deep_part) * reach - distance), deepest);
      HertzContact<Real> law{Real(rule.law.k)};
      if constexpr (kind == ContactRule::Kind::by_radii) law = hertz(rule.E_star, R_i, R_j);
      double scale[lanes];
      only(touch, contact_force(law, reach - distance) / distance).store(scale);
      for (std::size_t l = 0; l < lanes; ++l)  // one after the other; what does not touch adds 0
        subtract(F, scale[l], half_row(pose[j[l].value].r), half_i);
    }
    for (std::size_t k = 0; k < 4; k += lanes) F.part[k / lanes].store(&load[i].F.x + k);
  }
  return any(deepest.v > Real(0.0).v);
}

}  // namespace

ContactLoop add_contact_loads;
bool add_contact_loads(const ContactRule& rule, const NearRows& near, RowRange rows, const PoseRow* pose,
                       LoadRow* load) {
  switch (rule.kind) {
    case ContactRule::Kind::alike:
      return add_contacts<ContactRule::Kind::alike>(rule, near, rows, pose, load);
    case ContactRule::Kind::same_law:
      return add_contacts<ContactRule::Kind::same_law>(rule, near, rows, pose, load);
    case ContactRule::Kind::by_radii: break;
  }
  return add_contacts<ContactRule::Kind::by_radii>(rule, near, rows, pose, load);
}

}  // namespace vbond::VBOND_KERNEL
