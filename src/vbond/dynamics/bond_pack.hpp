#pragma once
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "vbond/dynamics/rows.hpp"
#include "vbond/model/bond_law.hpp"
#include "vbond/model/losses.hpp"

namespace vbond {

/// Bonds that the vector unit takes at once.
inline constexpr std::size_t pack_bonds = 8;

/// What many bonds share: a law with these coefficients times a factor of the bond's own.
struct BondType {
  const BondLaw* law = nullptr;
  const BondRules* rules = &no_rules;
  bool damped = false, breakable = false;
  double a = 0;                 ///< of the bond that it was made from  [length]
  double R_i = 0, R_j = 0;      ///< [length]
  Coefficients coefficients{};  ///< in the order and units of the law's fields
};

/// Eight bonds of a type between particles that were not turned when they were bonded, so that one frame
/// serves both ends: 56 bytes a bond. Lanes past the last bond repeat it.
struct alignas(64) CompactPack {
  using Lanes = double[pack_bonds];
  std::uint32_t i[pack_bonds], j[pack_bonds];  ///< rows
  Lanes a;                                     ///< [length]
  Lanes scale;                                 ///< of all coefficients; as 1/a for a rod of one section
  Lanes frame[4];                              ///< w, x, y, z
};

/// Eight bonds of a law with all that is theirs: 192 bytes a bond, of which the loop reads the coefficients
/// that the law has.
struct alignas(64) FullPack {
  using Lanes = double[pack_bonds];
  std::uint32_t i[pack_bonds], j[pack_bonds];
  Lanes a, R_i, R_j;
  Lanes frame_i[4], frame_j[4];
  Lanes coefficients[most_coefficients];
};

/// What is to be known of a pack besides, of each lane a bit: which are unbroken bonds, and which of them add
/// their loads to their particles i and j. A thread adds to its own particles only.
struct PackLanes {
  std::uint8_t active = 0;
  std::uint8_t to_i = 0, to_j = 0;
  bool has(std::size_t lane) const { return (active >> lane & 1) != 0; }
  bool adds_to_i(std::size_t lane) const { return (to_i >> lane & 1) != 0; }
  bool adds_to_j(std::size_t lane) const { return (to_j >> lane & 1) != 0; }
  void remove(std::size_t lane) {
    const auto others = static_cast<std::uint8_t>(~(1u << lane));
    active &= others, to_i &= others, to_j &= others;
  }
};
inline constexpr std::uint8_t all_lanes = 0xff;

/// Rows that the step comes to after some bonds. Bonds wait for arithmetic, rows for memory: so the loop over
/// these bonds asks for those rows on its way.
struct RowsAhead {
  const PoseRow* pose = nullptr;
  const MotionRow* motion = nullptr;
  const LoadRow* load = nullptr;
  std::size_t count = 0;
};

/// Consecutive packs of one kind, as the kernel takes them.
template <class P>
struct PackRun {
  const P* packs;
  const PackLanes* lanes;
  std::size_t count;
  const BondType* type;       ///< of full packs without lengths and coefficients
  double* history = nullptr;  ///< of laws that remember: per pack and number, one per lane
  RowsAhead ahead{};
};

/// The power that damping of bonds takes, by cause.  [energy/time]
struct DampedPower {
  static constexpr Loss causes[] = {Loss::damping_axial, Loss::damping_shear, Loss::damping_bending,
                                    Loss::damping_torsion, Loss::bond_damping};
  alignas(64) double of[8]{};  ///< in this order; the rest is zero: a row as the kernel adds them
};

/// What the loop over bonds reads and writes besides the packs.
struct BondSweep {
  const PoseRow* pose;
  LoadRow* load;
  const MotionRow* rates = nullptr;  ///< of the half step; for laws that read rates, and of what breaks
  LoadRow* damping = nullptr;        ///< gets the loads of damping, for laws that damp; `load` does not
  double dt = 0;                     ///< for laws that remember: their history advances by it; 0: it stays
  double dissipated = 0;             ///< by what bonds remember, added to  [energy]
  double by_other_laws = 0;          ///< the part of it whose laws are not the library's
  DampedPower* damped = nullptr;     ///< at the rates, of bonds that damp: added to; or not asked for
  std::uint8_t* broken = nullptr;    ///< of each pack of the run: lanes that break, a bit each
};

}  // namespace vbond
