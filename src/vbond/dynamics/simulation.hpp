#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vbond/dynamics/bonding.hpp"
#include "vbond/dynamics/contacts.hpp"
#include "vbond/dynamics/damping.hpp"
#include "vbond/dynamics/evaluate.hpp"
#include "vbond/dynamics/observer.hpp"
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Why a stage ended.
enum class StopReason { running, duration, distance, peak, kinetic_energy, interrupted };

/// Total force and moment (about the origin of coordinates) that supports exert.
struct Reaction {
  Vec3d force;   ///< [force]
  Vec3d moment;  ///< [force*length]
};

/// One stage of a run: a const Model, a Stage, and the State that the step loop moves.
/// Observers see it read-only. Results do not depend on the number of threads.
class Simulation {
 public:
  /// Takes over the state. A state with stage_step = 0 begins the stage (supports take their given
  /// velocities); any other continues it, as after a checkpoint. stage.dt > 0.
  Simulation(const Model& model, Stage stage, State state, int threads = 1);

  void add_observer(std::shared_ptr<Observer> observer);

  /// One time step of stage().dt. Throws Diverged if a load is not finite or a bond has closed up.
  void step();

  /// Steps until a stop condition holds or `interrupted` returns true (asked after every step).
  StopReason run(bool (*interrupted)() = nullptr);

  const Model& model() const { return model_; }
  const Stage& stage() const { return stage_; }
  const State& state() const { return state_; }
  const Loads& loads() const { return loads_; }
  std::int64_t neighbour_rebuilds() const { return contacts_.rebuilds(); }

  /// Energies at the present positions and velocities; a sum over all bonds, so not for every step.
  Energies energies() const;
  /// Relative error of the energy balance for these energies: (kinetic + potential + dissipated
  /// - work - start) / largest energy seen. 0 while nothing has moved.
  double balance_error(const Energies& e) const;
  /// What the supports exert on these particles, along held degrees of freedom only.
  Reaction reaction(const std::vector<ParticleId>& particles) const;
  /// Mean over the bonds with both ends in the group of F.d, tension positive.  [force]
  double mean_axial_force(const std::vector<ParticleId>& particles) const;

 private:
  void begin_stage();
  void evaluate_loads();
  void apply_strain();
  void record_peak();
  StopReason stop_reason() const;

  const Model& model_;
  Stage stage_;
  State state_;
  Loads loads_;
  BondLoadsEvaluator bond_loads_;
  Contacts contacts_;
  Bonding bonding_;
  Damping damping_;
  std::vector<std::shared_ptr<Observer>> observers_;
  std::vector<BondId> peak_bonds_;
};

}  // namespace vbond
