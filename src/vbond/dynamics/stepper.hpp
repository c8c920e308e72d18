#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

class Simulation;

/// What is asked of the whole body as it stands: the function of Simulation of that name (particles:
/// give_particles). All parts must call it at the same time, as each knows its share only.
struct Question {
  enum class What : std::int64_t {
    particles,
    survey,
    fastest_turn,
    reaction,
    reaction_before_breaks,
    mean_axial_force,
    deep_in_walls,
    grips
  } what;
  std::vector<ParticleId> particles = {};  ///< of reactions and axial forces
  double part = 0;                         ///< of deep_in_walls
};

/// Makes the steps of a Simulation in its place: by many processes, say, each of which steps a part of the
/// body by a Simulation of its own. The one that is stepped for then only shows the body to its observers.
class Stepper {
 public:
  /// The most steps until it comes back, as an interruption waits for that.
  static constexpr std::int64_t at_once = 256;
  virtual ~Stepper() = default;
  /// Takes over the body as a stage begins or goes on: of the state, particles and bonds are then sound in
  /// the process that has observers. Model and stage live as long as the stage. reach: particles that are
  /// nearer than this may touch or be bonded; 0: none; infinite: each part must know all.  [length]
  virtual void begin(const Model& model, const Stage& stage, State& state, double reach) = 0;
  /// The part of this process.
  virtual Simulation& part() = 0;
  /// Makes steps until the stage ends or observers must look, `most` of them unless others have been told of
  /// fewer, and brings up to date what the state says of the body as a whole; says what they have come to.
  /// Throws Diverged, with the state as it is then.
  virtual StopReason advance(std::int64_t most, State& state) = 0;
  /// By how many processes.
  virtual int parts() const = 0;
  /// Between leaps, of the process that has observers: all processes look at their parts at the same time,
  /// this one too, and do with it what each was given for that; the message is for them. Throws IoError with
  /// what the first says that failed.
  virtual void look_at_parts(const std::string& message) = 0;
  /// Between leaps, of the process that has observers: has all others answer, too. Returns the part of this
  /// process, which is then to be asked.
  virtual Simulation& ask(const Question& question) = 0;
  /// The stage has ended, and nothing more is asked of it: all processes get the whole state.
  virtual void end_stage(State& state) = 0;
};

}  // namespace vbond
