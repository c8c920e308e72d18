#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "vbond/model/held_axes.hpp"
#include "vbond/model/state.hpp"
#include "vbond/statics/results.hpp"

/// What a stage of fracture knows beside State while it is under way: with both it goes on as if it had never
/// stopped, to the last bit. Plain data, without the solvers' types.
namespace vbond {

/// One degree of freedom that the stage holds, or gives to a grip, because nothing else does.
struct HeldPart {
  enum class Why : std::uint8_t {
    floats,   ///< a part of a periodic body that nothing held as the stage began
    came_off  ///< a part that came off
  };
  ParticleId particle;
  std::uint8_t dof = 0;
  Why why = Why::came_off;
  bool grip = false;                  ///< of the free grip whose first particle this is
  std::optional<HeldAxes> axes = {};  ///< absent: the world's
  friend bool operator==(const HeldPart&, const HeldPart&) = default;
};

/// The kept factor of the tangent, as it can be made again: where the body stood when it was made, and all
/// that has happened to it since.
struct KeptFactorUnderWay {
  /// By how much the tangent changed among these unknowns, row by row.
  struct Change {
    std::vector<std::int32_t> unknowns;
    std::vector<double> numbers;
    double least_part = 0;  ///< of the largest of its parts: what is less was left out
    friend bool operator==(const Change&, const Change&) = default;
  };
  struct Place {
    PerParticle<Vec3d> r;
    PerParticle<Quatd> q;
    CellEdges cell;
    double load_factor = 0;
    std::int64_t breaks = 0;  ///< since parts were held last
    /// Pairs of nodes that the tangent had room for.
    std::vector<std::pair<ParticleId, ParticleId>> pattern;
    friend bool operator==(const Place&, const Place&) = default;
  };
  std::shared_ptr<const Place>
      made_at;  ///< null: none is kept, and of the rest there are random numbers only
  std::vector<Change> changes;
  std::mt19937_64 random_as_made, random;
  std::int64_t proofs = 0;
  double spent = 0, in_cycle = 0, slow = 0, wasted = 0, recent = 0;
};

struct FractureUnderWay {
  // ---- the loop
  /// Single numbers.
  struct Numbers {
    double load_factor = 0;
    double dissipated_before = 0, largest_reaction = 0;
    double avalanche_factor = 0;
    std::int64_t in_avalanche = 0;
    bool has_before = false;  ///< a balance before this one, in the same way
    double before_factor = 0, before_use = 0;
    bool on_way = false;  ///< of the load factor
    double way_to = 0, way_limit = 0;
    bool breaking = false;  ///< the load goes down after a break
    double worst_from = 0, worst_to = 0, worst_energy = 0;
    bool peak_pushes = false;  ///< the largest load so far was negative
    bool stable = false;       ///< known to be, or left open
    bool open = false;         ///< left open, by moments without a potential or by friction
    bool flows = false;
    double held_at = 0;       ///< load factor at which parts were held last
    std::int64_t breaks = 0;  ///< since then
    std::int64_t unknowns = 0;
    std::array<double, 6> cell_stress_at_start{};
    friend bool operator==(const Numbers&, const Numbers&) = default;
  } numbers;
  StaticResult found;        ///< so far
  std::vector<double> rate;  ///< of the unknowns per load factor; empty: not known
  // ---- the body
  std::vector<HeldPart> held;  ///< in this order
  /// Orientations, as the stage began, of particles that it holds about one axis.
  std::vector<Quatd> turned_at_start;
  std::vector<Quatd> turns_of_grips;  ///< in the stage, as parts were held last
  /// As parts were held last, or as the stage began from its constant loads.
  std::shared_ptr<const State> begun;
  /// Pairs of nodes that the tangent has room for.
  std::shared_ptr<const std::vector<std::pair<ParticleId, ParticleId>>> pattern;
  PerBond<BondHistory> remembered_before;  ///< at the balance before, of bodies that flow
  /// What the tangent at hand was summed up with instead; empty: nothing else.
  PerBond<BondHistory> remembered_of_tangent;
  KeptFactorUnderWay factor;
};

}  // namespace vbond
