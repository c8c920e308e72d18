#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <string_view>

#include "vbond/physics/law.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond {

inline constexpr std::string_view name_with_offsets = "-with-offsets";

/// A law with rules or flow whose bonded points lie off the axis of the bond through the centre: rigid
/// offsets, which turn with their particles. P_i = r_i + R_i n_i1 + o_i2 n_i2 + o_i3 n_i3, the same of j.
/// Energy and loads are those of the inner law between points that stand at the ends of the offsets; on the
/// particle the force there has its moment about the centre. See docs/theory.md, "Offsets".
template <template <class> class CentredLaw>
struct WithOffsets {
  template <Scalar T>
  struct Law : CentredLaw<T> {
    using Centred = CentredLaw<T>;
    T o_i2, o_i3, o_j2, o_j3;  ///< along n_i2, n_i3, n_j2, n_j3  [length]

    static constexpr std::string_view name = joined_name<Centred::name, name_with_offsets>;
    static constexpr auto fields() {
      constexpr auto centred = Centred::fields();
      constexpr auto given = LawInput::given;
      constexpr LawDimension length{0, 1};
      std::array<LawField<Law>, offset_coefficients + centred.size()> all{};
      all[0] = {&Law::o_i2, {"o_i2", length, "offset of the bonded point of i along n_2", given}};
      all[1] = {&Law::o_i3, {"o_i3", length, "offset of the bonded point of i along n_3", given}};
      all[2] = {&Law::o_j2, {"o_j2", length, "offset of the bonded point of j along n_2", given}};
      all[3] = {&Law::o_j3, {"o_j3", length, "offset of the bonded point of j along n_3", given}};
      for (std::size_t k = 0; k < centred.size(); ++k)
        all[offset_coefficients + k] = {centred[k].at, centred[k].info};
      return all;
    }
    static constexpr Law from(const BondStiffness<T>& c, const T& a, const T& R_i, const T& R_j) {
      Law law{};
      static_cast<Centred&>(law) = Centred::from(c, a, R_i, R_j);
      law.o_i2 = law.o_i3 = law.o_j2 = law.o_j3 = T(0.0);
      return law;
    }

    /// The inner law; of one whose faces turn about a middle, with where that is.
    VBOND_HD constexpr decltype(auto) centred() const {
      if constexpr (requires(Centred c) { c.off_2; }) {
        Centred c = *this;
        c.off_2 = T(0.5) * (o_i2 + o_j2), c.off_3 = T(0.5) * (o_i3 + o_j3);
        return c;
      } else {
        return static_cast<const Centred&>(*this);
      }
    }
    VBOND_HD Vec3<T> offset_i(const BondPose<T>& b) const { return o_i2 * b.n_i[1] + o_i3 * b.n_i[2]; }
    VBOND_HD Vec3<T> offset_j(const BondPose<T>& b) const { return o_j2 * b.n_j[1] + o_j3 * b.n_j[2]; }
    /// The pose between the ends of the offsets, which stand for the centres there.
    VBOND_HD BondPose<T> at_offsets(const BondPose<T>& b) const {
      BondPose<T> there = b;
      there.r_ij = b.r_ij + offset_j(b) - offset_i(b);
      return there;
    }
    /// Loads at the ends of the offsets as the particles feel them, and the other way round.
    VBOND_HD BondLoads<T> at_centres(const BondPose<T>& b, const BondLoads<T>& l) const {
      return {l.F, l.M_ij + cross(offset_i(b), l.F), l.M_ji - cross(offset_j(b), l.F)};
    }
    VBOND_HD BondLoads<T> at_offsets(const BondPose<T>& b, const BondLoads<T>& l) const {
      return {l.F, l.M_ij - cross(offset_i(b), l.F), l.M_ji + cross(offset_j(b), l.F)};
    }
    VBOND_HD BondRates<T> at_offsets(const BondPose<T>& b, const BondRates<T>& rates) const {
      BondRates<T> there = rates;
      there.v_ij = rates.v_ij + cross(rates.w_j, offset_j(b)) - cross(rates.w_i, offset_i(b));
      return there;
    }
  };
};

/// What it remembers, as the inner law sees it, and back.
template <class To, class From>
VBOND_HD LawHistory<To> history_as(const LawHistory<From>& h) {
  static_assert(history_of<To> == history_of<From>);
  LawHistory<To> same;
  for (std::size_t k = 0; k < history_of<To>; ++k) same.value[k] = h.value[k];
  return same;
}

/// What a law remembers, if it remembers anything.
template <class History, class Law>
concept MemoryOf = Remembering<Law> && std::same_as<History, LawHistory<Law>>;

template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD T stretch_energy(const Law& m, const T& D, const History&... h) {
  return stretch_energy(m.centred(), D, history_as<typename Law::Centred>(h)...);
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD T tension(const Law& m, const T& D, const History&... h) {
  return tension(m.centred(), D, history_as<typename Law::Centred>(h)...);
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD BondEnergy<T> bond_energy(const Law& m, const BondPose<T>& b, const History&... h) {
  return bond_energy(m.centred(), m.at_offsets(b), history_as<typename Law::Centred>(h)...);
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD BondLoads<T> bond_loads(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const History&... h) {
  return m.at_centres(
      b, bond_loads(m.centred(), m.at_offsets(b), axis, history_as<typename Law::Centred>(h)...));
}
template <OffsetLaw Law, Scalar T>
VBOND_HD BondLoads<T> bond_damping(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                   const BondRates<T>& rates) {
  return m.at_centres(b, bond_damping(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, rates)));
}
template <OffsetLaw Law, Scalar T>
VBOND_HD DampingPowers<T> damping_powers(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                         const BondRates<T>& rates) {
  return damping_powers(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, rates));
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD Failure<T> bond_failure(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                                 const BondLoads<T>& loads, const History&... h) {
  return bond_failure(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, loads),
                      history_as<typename Law::Centred>(h)...);
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law>... History>
VBOND_HD T utilisation(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis, const BondLoads<T>& loads,
                       const History&... h) {
  return utilisation(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, loads),
                     history_as<typename Law::Centred>(h)...);
}
template <OffsetLaw Law, Scalar T, MemoryOf<Law> History>
VBOND_HD History advance(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                         const BondRates<T>& rates, const T& dt, const History& h) {
  return history_as<Law>(advance(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, rates), dt,
                                 history_as<typename Law::Centred>(h)));
}
template <OffsetLaw Law, Scalar T>
requires Remembering<Law> VBOND_HD Advanced<Law> advance_with_loads(const Law& m, const BondPose<T>& b,
                                                                    const BondAxis<T>& axis,
                                                                    const BondRates<T>& rates, const T& dt,
                                                                    const LawHistory<Law>& h) {
  const auto [history, loads] = advance_with_loads(m.centred(), m.at_offsets(b), axis, m.at_offsets(b, rates),
                                                   dt, history_as<typename Law::Centred>(h));
  return {history_as<Law>(history), m.at_centres(b, loads)};
}
template <OffsetLaw Law, Scalar T>
requires requires(const typename Law::Centred& m) {
  m.intact();
}
VBOND_HD LawHistory<Law> crack(const Law& m, const BondPose<T>& b, const BondAxis<T>& axis,
                               const LawHistory<Law>& h) {
  return history_as<Law>(crack(m.centred(), m.at_offsets(b), axis, history_as<typename Law::Centred>(h)));
}
template <OffsetLaw Law, Scalar T>
VBOND_HD BondPose<T> elastic_pose(const Law& m, const BondPose<T>& b, const LawHistory<Law>& h) {
  return elastic_pose_with(m.centred(), m.at_offsets(b), history_as<typename Law::Centred>(h));
}

}  // namespace vbond
