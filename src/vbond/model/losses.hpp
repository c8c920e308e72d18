#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace vbond {

/// What takes energy out for good.
enum class Loss : std::uint8_t {
  bond_damping,  ///< of laws that do not tell their channels
  yield_axial,
  yield_shear,
  yield_bending,
  yield_torsion,
  creep,
  softening,
  other_laws,  ///< what bonds of a program's own law dissipate by what they remember
  drag,        ///< viscous damping of all particles
  local_damping,
  contact_damping,
  friction,
  rolling,  ///< and twisting
  adhesion,
  bonding,  ///< energy of contacts that end because the pair is bonded
  damping_axial,
  damping_shear,
  damping_bending,
  damping_torsion,
};
inline constexpr std::size_t loss_count = static_cast<std::size_t>(Loss::damping_torsion) + 1;

/// Energy by what took it out.  [energy]
struct Losses {
  std::array<double, loss_count> of{};

  double& operator[](Loss cause) { return of[static_cast<std::size_t>(cause)]; }
  double operator[](Loss cause) const { return of[static_cast<std::size_t>(cause)]; }
  Losses& operator+=(const Losses& more) {
    for (std::size_t k = 0; k < loss_count; ++k) of[k] += more.of[k];
    return *this;
  }
  Losses& operator-=(const Losses& less) {
    for (std::size_t k = 0; k < loss_count; ++k) of[k] -= less.of[k];
    return *this;
  }
  double sum() const {
    double all = 0.0;
    for (const double x : of) all += x;
    return all;
  }
  friend bool operator==(const Losses&, const Losses&) = default;
};

}  // namespace vbond
