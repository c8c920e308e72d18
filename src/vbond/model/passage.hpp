#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/bond_event.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

// What comes in and goes while a run goes on: sources let bodies in, and stages take particles out.
namespace vbond {

inline constexpr std::int64_t no_visit = std::numeric_limits<std::int64_t>::max();

/// The steps from one visit to the next.
std::int64_t steps_between(const Visits& visits, double dt);
/// The first step of the stage, not before this one, at which it is visited; no_visit: none. A sink is
/// visited until its `until`; a source once more if that lies between two visits, for what has become due
/// since the one before.
std::int64_t next_visit(const Sink& sink, double dt, std::int64_t stage_step);
std::int64_t next_visit(const Inflow& inflow, double dt, std::int64_t stage_step);
/// The same of all sources and sinks of the stage.
std::int64_t next_visit(const Stage& stage, std::int64_t stage_step);

/// What a visit has done.
struct Passage {
  bool changed = false;  ///< particles have come or gone
  std::vector<BondEvent>
      events;  ///< bonds that broke with particles that went, and those that bodies brought
  bool any_gone = false, any_come = false;
  bool lost = false;   ///< particles were dropped (model/drop.hpp): their energy is released, not removed
  double brought = 0;  ///< kinetic energy of what came in, and energy of its bonds  [energy]
  double flowed = 0;   ///< that the bonds that came in had dissipated by their prestrain  [energy]
};
/// The visit that is due at this step: first particles go, then bodies come in, each where it overlaps
/// nothing that is there: particles, walls, images. Which places are tried follows from the seed, the number
/// of the body and the step. Loads at the present positions are to be worked out anew, those of the new
/// particles alone where none has gone: these are not numbers then. Energies are for the caller to book
/// (Simulation::take_over).
Passage visit(const Model& model, const Stage& stage, State& state);

/// As a stage ends: bodies that have become due since the last visit count for the stages that follow.
void count_due_at_end(const Model& model, const Stage& stage, State& state);

/// How many bodies of a source have come in, and how many more are due.
std::size_t bodies_in(const Source& source, const State& state);
std::size_t bodies_due(const Model& model, std::size_t source, const State& state);

/// A bond of a body, by its recipe, between particles as they stand in the state; nothing if the recipe makes
/// none of this pair.
std::optional<Bond> bond_of_body(const Model& model, const State& state, const Source& source,
                                 std::size_t body, const SourceBond& bond);

/// The state with the bonds that the next body of each source will bring, between its particles as they wait:
/// for bounds of the time step.
State with_bonds_to_come(const Model& model, const State& state);

/// How a body stands and moves as it comes in.
struct Placing {
  std::vector<Vec3d> r;  ///< [length]
  Quatd turn;
  Vec3d centre;  ///< of mass  [length]
  Vec3d velocity, angular_velocity;
};
/// The place that a source draws for its body of this number at a try; nothing if none of a thousand draws
/// fits the region.
std::optional<Placing> place_of_try(const Model& model, const State& state, const Source& source,
                                    std::size_t body, std::int64_t step, std::int64_t attempt);

/// What cannot be of sources, and of particles that a state says wait.
std::vector<std::string> mistakes_in_sources(const Model& model);
std::optional<std::string> mistake_in_waiting(const Model& model, const State& state);

}  // namespace vbond
