#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/grip.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/losses.hpp"
#include "vbond/model/model.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

/// A particle that a rigid support carries, and the number of the rigid body that it is of, from 1.
struct Carried {
  ParticleId particle;
  std::int64_t body = 0;
  friend bool operator==(const Carried&, const Carried&) = default;
};

/// Where the run is. Time is counted, never summed.
struct Clock {
  std::int64_t step = 0;        ///< steps since the start of the run
  std::int64_t stage_step = 0;  ///< steps since the start of this stage
  std::int32_t stage = 0;       ///< index of the stage
  double stage_start = 0;       ///< time at which this stage began  [time]
  double dt = 0;                ///< [time]
  double time() const { return stage_start + static_cast<double>(stage_step) * dt; }
  double stage_time() const { return static_cast<double>(stage_step) * dt; }
  friend bool operator==(const Clock&, const Clock&) = default;
};

/// The clock of a stage that has come to its end moves on to the next one. dt stays that of the last step
/// until the next stage begins: what is known of the middle of steps goes on from there.
inline void begin_next_stage(Clock& clock) {
  clock = {.step = clock.step,
           .stage_step = 0,
           .stage = clock.stage + 1,
           .stage_start = clock.time(),
           .dt = clock.dt};
}

/// Energy that has entered or left since the start of the run.  [energy]
struct EnergyBooks {
  double at_start = 0;    ///< kinetic + potential when the run began
  double dissipated = 0;  ///< by damping, flow, friction and adhesion, and of contacts whose pair is bonded
  double released = 0;    ///< energy of bonds at the time they broke, less that of contacts it switched on,
                          ///< and all that went with particles that were dropped
  double work_loads = 0;  ///< by point forces, moments and gravity
  double work_supports = 0;  ///< by supports, prescribed velocities, imposed strain, changes of temperature
  double inserted = 0;       ///< of bodies as they came in
  double removed = 0;        ///< that went with particles that were taken out
  double largest = 0;        ///< largest |at_start + work + inserted| so far: the scale of the balance error
  /// `dissipated` by cause. What bonds lose by flow their memory counts: here is, as a negative number, what
  /// they had lost when the books began. See losses_of().
  Losses lost{};

  void lose(Loss cause, double energy) { dissipated += energy, lost[cause] += energy; }
  /// All that has been brought in.
  double brought_in() const { return at_start + work_loads + work_supports + inserted; }
  friend bool operator==(const EnergyBooks&, const EnergyBooks&) = default;
};

/// What has come in with bodies of sources since the start of the run, and gone with particles that were
/// taken out where a stage says so.
struct MassBooks {
  std::int64_t particles_in = 0, particles_out = 0;
  double mass_in = 0, mass_out = 0;  ///< [mass]
  Vec3d momentum_in, momentum_out;   ///< [mass*length/time]
  friend bool operator==(const MassBooks&, const MassBooks&) = default;
};

/// How many bodies of a source are due by now, those that have come in among them. Where a rate brings them
/// it grows from visit to visit, not by whole numbers.
struct SourceRecord {
  double due = 0;
  friend bool operator==(const SourceRecord&, const SourceRecord&) = default;
};

/// The quantity watched for a peak (buckling): block averages and their maximum.
struct PeakRecord {
  double sum = 0;            ///< of the block under way
  std::int64_t samples = 0;  ///< in the block under way
  double last = 0;           ///< average of the last full block
  double peak = 0;           ///< largest block average so far
  double peak_time = 0;      ///< end of that block  [time]
  std::int64_t blocks = 0;   ///< full blocks so far in this stage
  friend bool operator==(const PeakRecord&, const PeakRecord&) = default;
};

/// How long the kinetic energy has been low, for the stop condition.
struct RestRecord {
  std::int64_t quiet_steps = 0;  ///< steps in a row below the bound
  friend bool operator==(const RestRecord&, const RestRecord&) = default;
};

/// A bond that grows with temperature, and its lengths where that is 0: see heat.hpp.
struct WarmBond {
  BondId bond;
  double expansion = 0;            ///< growth per temperature  [1/temperature]
  double a = 0, R_i = 0, R_j = 0;  ///< [length]
  friend bool operator==(const WarmBond&, const WarmBond&) = default;
};

/// Everything that changes, and exactly what a checkpoint holds: state_table.hpp declares each of its fields.
/// Those of the terms are declared in their folders.
struct State : Terms::OfState {
  Clock clock;
  PerParticle<Vec3d> r;      ///< positions of the centres  [length]
  PerParticle<Vec3d> v;      ///< velocities  [length/time]
  PerParticle<Quatd> q;      ///< orientations, body to world
  PerParticle<Vec3d> omega;  ///< angular velocities, world frame  [rad/time]
  /// Angular momenta of the rotation of tops, world frame, others zero: omega follows from them, and would
  /// give them back with a rounding error at each step. Empty, or where omega was changed: they follow from
  /// omega.
  PerParticle<Vec3d> spin;            ///< [mass*length^2/time]
  PerBond<Bond> bonds;                ///< in order of creation
  PerBond<BondHistory> bond_history;  ///< empty where no bond remembers anything
  PerParticle<double> temperature;    ///< of particles  [temperature]; empty: 0 everywhere
  std::vector<WarmBond> warm_bonds;   ///< in order of bonds, which have the lengths of now
  /// Forces and moments at the present positions, where they do not follow from these: with bonds that damp,
  /// remember or break, with walls, with local damping, and with contacts that are not elastic or of
  /// capsules. Else empty. Those of a particle that are not numbers are worked out anew.
  Loads loads;
  std::vector<PairMemory> contact_history;  ///< of touching pairs that remember something, in order of (i, j)
  std::vector<FibreMemory> fibre_history;   ///< of the contacts of capsules, in order of their places
  CellEdges cell;                           ///< its edges, and how they change; empty: nothing is periodic
  std::vector<GripState> grips;             ///< of the stage under way, in the order of its supports
  std::vector<GrippedPose> gripped;         ///< their particles, grip by grip
  std::vector<Carried> carried;  ///< of the stage under way, or the last one; in the order of particles
  Loads damping;                 ///< the part of these that damps; empty if no bond does
  Loads local_damping;  ///< the part of these that is local damping, where bonds damp as well; else empty
  EnergyBooks books;
  PeakRecord peak;
  RestRecord rest;
  std::int64_t breaks = 0;  ///< bonds that have broken in this stage
  /// Particles that were taken out of the computation (model/drop.hpp), in increasing order: they stay where
  /// they were, at rest, without bonds, and touch nothing.
  std::vector<ParticleId> dropped;
  std::vector<ParticleId> taken;  ///< those of them that sinks took out, in increasing order
  /// Particles of bodies that have not come in yet, in increasing order: at rest, where the first body of
  /// their source stands as it waits, without bonds; they touch nothing.
  std::vector<ParticleId> waiting;
  std::vector<SourceRecord> sources;  ///< of each of Model::sources; empty: none has been visited yet
  PerParticle<Vec3d> came_at;  ///< where particles stood as they came in, r_0 of others  [length]; empty:
                               ///< nobody has come in
  MassBooks mass;

  friend bool operator==(const State&, const State&) = default;
};

inline bool is_dropped(const State& s, ParticleId p) {
  return std::binary_search(s.dropped.begin(), s.dropped.end(), p);
}

inline bool is_waiting(const State& s, ParticleId p) {
  return std::binary_search(s.waiting.begin(), s.waiting.end(), p);
}
/// Whether the particle takes no part in the computation.
inline bool is_absent(const State& s, ParticleId p) {
  return is_dropped(s, p) || is_waiting(s, p);
}
inline bool any_absent(const State& s) {
  return !s.dropped.empty() || !s.waiting.empty();
}
/// Those particles, in increasing order.
inline std::vector<ParticleId> absent(const State& s) {
  std::vector<ParticleId> all;
  std::merge(s.dropped.begin(), s.dropped.end(), s.waiting.begin(), s.waiting.end(), std::back_inserter(all));
  return all;
}
/// What means, fragments and frames leave out: particles that wait, and those that sinks took out. Others
/// that were dropped count, where they stopped.
inline std::vector<ParticleId> left_out(const std::vector<ParticleId>& taken,
                                        const std::vector<ParticleId>& waiting) {
  std::vector<ParticleId> all;
  std::merge(taken.begin(), taken.end(), waiting.begin(), waiting.end(), std::back_inserter(all));
  return all;
}
inline std::vector<ParticleId> left_out(const State& s) {
  return left_out(s.taken, s.waiting);
}
/// Where displacements count from: the place of a particle as the run began, or as it came in.  [length]
inline const Vec3d& first_place(const Model& model, const State& s, ParticleId p) {
  return s.came_at.empty() ? model.r_0[p] : s.came_at[p];
}
/// How many particles take part in the computation.
inline std::size_t present(const State& s) {
  return s.r.size() - s.dropped.size() - s.waiting.size();
}

/// From particle i to particle j, or to an image of it, as they stand now.  [length]
inline Vec3d between(const State& s, ParticleId i, ParticleId j, const Image& of_j = {}) {
  return between(s.r, s.cell, i, j, of_j);
}
/// From particle i of a bond to its particle j, or that image of it, as they stand now.  [length]
inline Vec3d between(const State& s, const Bond& b) {
  return between(s.r, s.cell, b);
}
/// The pose of a bond as its particles stand now.
inline BondPose<double> bond_pose(const Bond& b, const State& s) {
  return bond_pose(b, between(s, b), s.q[b.i], s.q[b.j]);
}

/// The particles of a model at their first positions: unturned, at rest, without bonds.
inline State at_rest(const Model& model) {
  State s;
  s.r = model.r_0;
  s.cell = cell_at_start(model);
  s.v.assign(model.particles(), {});
  s.q.assign(model.particles(), {});
  s.omega.assign(model.particles(), {});
  return s;
}

/// What two touching particles remember, or i and an image of j; null: nothing.
inline const PairMemory* memory_of(const State& s, ParticleId i, ParticleId j, const Image& of_j = {}) {
  const bool in_order = i < j || (i == j && of_j > Image{});
  const std::tuple<ParticleId, ParticleId, Image> pair(std::min(i, j), std::max(i, j),
                                                       in_order ? of_j : -of_j);
  const auto at = std::lower_bound(s.contact_history.begin(), s.contact_history.end(), pair,
                                   [](const PairMemory& m, const auto& p) { return place_of(m) < p; });
  return at != s.contact_history.end() && place_of(*at) == pair ? &*at : nullptr;
}

/// Whether i and this image of j are of one rigid body: then they do not touch (model/rigid_bodies.hpp).
inline bool are_one_body(const State& s, ParticleId i, ParticleId j, const Image& of_j = {}) {
  if (s.carried.empty() || i == j || !of_j.is_itself()) return false;
  const auto body = [&s](ParticleId p) {
    const auto at = std::lower_bound(s.carried.begin(), s.carried.end(), p,
                                     [](const Carried& c, ParticleId q) { return c.particle < q; });
    return at != s.carried.end() && at->particle == p ? at->body : 0;
  };
  const std::int64_t of_i = body(i);
  return of_i != 0 && of_i == body(j);
}

/// The part of their overlap that two particles do not feel.  [length]
inline double kept_overlap(const State& s, ParticleId i, ParticleId j, const Image& of_j = {}) {
  const PairMemory* memory = memory_of(s, i, j, of_j);
  return memory != nullptr ? memory->kept : 0.0;
}

/// Energy of the repulsion of two particles, bonded or not; 0 if they do not touch, or are of one rigid body.
/// [energy]
inline double contact_pair_energy(const Model& model, const State& s, ParticleId i, ParticleId j,
                                  const Image& of_j = {}) {
  if (!particles_touch(model.contact) || are_one_body(s, i, j, of_j)) return 0.0;
  const double R_i = model.radius[i], R_j = model.radius[j];
  const double overlap = R_i + R_j - norm(between(s, i, j, of_j)) - kept_overlap(s, i, j, of_j);
  if (!(overlap > 0.0)) return 0.0;
  return normal_energy(touch_forms(model.contact), touch_numbers(model, i, j), reduced_radius(R_i, R_j),
                       overlap);
}

/// What a bond remembers of its prestrain as it is made in this pose: beyond its limits it has flowed, or is
/// damaged.
inline BondHistory first_history(const Bond& b, const BondPose<double>& pose) {
  return b.law->has_rules ? b.law->advance(b, pose, {}, 0.0, no_history) : no_history;
}

/// By what part of its lengths at temperature 0 a bond with this expansion has grown.
inline double growth_of(const State& s, const Bond& b, double expansion) {
  if (s.temperature.empty()) return 0.0;
  return expansion * 0.5 * (s.temperature[b.i] + s.temperature[b.j]);
}

/// What books have of a bond as it is made. If bonded pairs do not touch, the energy of the pair's repulsion
/// is given up and booked as dissipated; the energy of a prestrain, with what has flowed of it, is booked as
/// work of imposed strain.  [energy]
struct EnergyOfNewBond {
  double repulsion = 0, prestrain = 0, flowed = 0;
  bool any() const { return repulsion != 0.0 || prestrain != 0.0 || flowed != 0.0; }
};
inline void book(const EnergyOfNewBond& of, EnergyBooks& books) {
  books.lose(Loss::bonding, of.repulsion);
  books.work_supports += of.prestrain;
  books.work_supports += of.flowed;
  books.dissipated += of.flowed;
}

/// Takes up a new bond, made by this recipe; one that expands is at rest at the temperature of now. Books
/// nothing.
inline EnergyOfNewBond take_up_bond(const Model& model, const Bond& bond, const BondRecipe& recipe,
                                    State& s) {
  EnergyOfNewBond energy;
  s.bonds.push_back(bond);
  if (!s.bond_history.empty()) s.bond_history.resize(s.bonds.size());
  if (recipe.expansion != 0.0) {
    const double factor = 1.0 + growth_of(s, bond, recipe.expansion);
    s.warm_bonds.push_back({BondId{s.bonds.size() - 1}, recipe.expansion, bond.a / factor, bond.R_i / factor,
                            bond.R_j / factor});
  }
  if (model.contact.pairs == ContactPairs::unbonded)
    energy.repulsion = contact_pair_energy(model, s, bond.i, bond.j, image_of_j(bond));
  if (recipe.prestrain == 0.0) return energy;
  const BondPose<double> pose = bond_pose(bond, s);
  const BondHistory history = first_history(bond, pose);
  const BondEnergy<double> U = bond.law->energy(bond, pose, history);
  energy.prestrain = U.U_L + U.U_B + U.U_T;
  if (history == no_history) return energy;
  s.bond_history.resize(s.bonds.size());
  s.bond_history[BondId{s.bonds.size() - 1}] = history;
  energy.flowed = history[memory::dissipated];
  return energy;
}
/// The same, and books it.
inline void add_bond(const Model& model, const Bond& bond, const BondRecipe& recipe, State& s) {
  book(take_up_bond(model, bond, recipe, s), s.books);
}

/// What a bond remembers.
inline const BondHistory& history_of_bond(const State& s, BondId k) {
  return k.value < s.bond_history.size() ? s.bond_history[k] : no_history;
}

/// The elastic shape of a bond as its particles stand now: what has flowed is left out.
inline BondPose<double> elastic_pose(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  return b.law->elastic_pose(b, bond_pose(b, s), history_of_bond(s, k));
}
inline BondShape bond_shape(const State& s, BondId k) {
  return bond_shape(elastic_pose(s, k), 0.0, 0.0);
}

/// Whether the faces of a bond that has cracked do not touch.
inline bool stands_open(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  return is_cracked(b) && !(b.law->energy(b, bond_pose(b, s), history_of_bond(s, k)).U_L > 0.0);
}

/// Energy and loads of a bond as its particles stand now, damping left out; nothing if it is broken.
inline BondEnergy<double> bond_energy(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  return b.broken ? BondEnergy<double>{} : b.law->energy(b, bond_pose(b, s), history_of_bond(s, k));
}
inline BondLoads<double> bond_loads(const State& s, BondId k) {
  const Bond& b = s.bonds[k];
  return b.broken ? BondLoads<double>{} : b.law->loads(b, bond_pose(b, s), history_of_bond(s, k));
}

}  // namespace vbond
