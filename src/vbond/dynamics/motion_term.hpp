#pragma once
#include <cstddef>
#include <string>

#include "vbond/dynamics/bodies.hpp"
#include "vbond/dynamics/bond_packs.hpp"
#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/team.hpp"
#include "vbond/model/drop.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/touch.hpp"

namespace vbond {

/// What may help where particles pass through what should keep them out.
inline constexpr const char* gentler_contact =
    "use a stiffer contact, lower velocities and loads, or a smaller time.step";

/// What terms may do to the simulation that calls them.
class MotionHost {
 public:
  virtual ~MotionHost() = default;
  /// Particles of this block have lost so much to what they touch.
  virtual void lose(std::size_t block, const TouchLosses<double>& to_touches) = 0;
  /// The potential energy of what is worked out here.
  virtual double potential_energy() const = 0;
  /// What bonds that are worked out here have dissipated by flow, as the state remembers.  [energy]
  virtual double flowed() const = 0;
  /// All loads, anew and between steps: rates are those of now, and nothing is remembered of them.
  virtual void evaluate_loads() = 0;
  /// Leaves in the rows what loads of the stage do as the step begins, and nothing else.
  virtual void apply_loads_alone() = 0;
  /// Particles are elsewhere at once: all loads anew.
  virtual void particles_jumped() = 0;
  /// Bonds have other lengths, so that energies known before are old.
  virtual void lengths_have_changed() = 0;
  /// The order of bonds in packs, and what they remember, anew from the state.
  virtual void arrange_bonds() = 0;
  /// The run ends: "<who>: <what>", and a way out. Of parts the first of all that failed is told.
  virtual void diverge(std::size_t first_particle, const std::string& who, const std::string& what,
                       const std::string& way_out) const = 0;
  /// A particle that the stage drops after this step; a stage that drops none ends instead.
  virtual void lose_particle(const LostParticle& lost) = 0;
};

/// A body in motion as its terms see it. References, which outlive the terms.
struct BodyInMotion {
  const Model& model;
  const Stage& stage;
  State& state;  ///< positions, velocities and memories in it are old: those of now are in bodies and bonds
  Bodies& bodies;
  BondPacks& bonds;
  const Team& team;
  const Exchange& exchange;
  EnergyBooks& books;  ///< of parts the share of this one
  MotionHost& host;
};

/// Something that acts on a body in motion besides bonds, contacts, supports and loads: walls, temperatures,
/// an imposed strain. A step calls what is there, in the order of terms/terms.hpp, and each function
/// in the order below. Those that stay as they are do nothing.
class MotionTerm {
 public:
  virtual ~MotionTerm() = default;
  /// Whether the stage has it; if not, nothing else is called.
  virtual bool is_there() const = 0;
  /// Whether particles touch it: then all of them move before any of its loads are added, it takes energy
  /// out, and states keep the loads, which do not follow from places alone.
  virtual bool touches() const { return false; }
  /// Whether it adds loads, of which a particle's need to know its own place and motion alone where particles
  /// do not touch it.
  virtual bool adds_loads() const { return touches(); }

  // ---- between steps ----
  /// Takes over what a state says of it, and gives it back. A state with stage_step = 0 is one in which the
  /// stage begins; any other is read again once its loads are worked out, as these may have been remembered.
  virtual void read(const State&) {}
  virtual void write(State&) const {}
  /// As a stage begins, before its loads are worked out for the first time, and once its energy is known.
  virtual void before_stage(bool /*run_begins*/) {}
  virtual void begin_stage() {}

  // ---- a step of dt, or 0: the loads of now, of which nothing is remembered ----
  /// No step of the particles has been made; terms before this one in the list may have changed the body.
  virtual void begin_step() {}
  /// Only of those that particles touch: all particles are where they come to, and none has gone farther than
  /// this since the last call.  [length]
  virtual void particles_moved(double /*dt*/, double /*way*/) {}
  /// Only of those that do: adds its loads to the rows of a block, from places and the motion of the half
  /// step before.
  virtual void add_loads(const Block&, double /*dt*/) {}
  /// All loads are complete, and particles have their velocities.
  virtual void end_step(double /*dt*/) {}
  /// The energy that the body's blocks have got in the step has been booked.
  virtual void books_closed() {}

  /// What it stores, which counts as energy of contacts; of parts the share of this one.  [energy]
  virtual double energy() const { return 0.0; }
};

}  // namespace vbond
