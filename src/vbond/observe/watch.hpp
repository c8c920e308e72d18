#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "vbond/core/column.hpp"
#include "vbond/dynamics/encounters.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/model/state.hpp"
#include "vbond/physics/range.hpp"

namespace vbond {

/// What the watch has seen of one bond so far.
struct BondRecord {
  BondRange worst = BondRange::good;
  bool was_short = false;  ///< |D| has been below a/2
  friend bool operator==(const BondRecord&, const BondRecord&) = default;
};

/// A bond as it stands, for those who judge it.
struct SeenBond {
  BondId bond;
  ParticleId i, j;
  double a = 0, length = 0;  ///< at rest and now  [length]
  BondRange range = BondRange::good;
  double strained_past = 0;                  ///< of its law  [degrees]
  double tilt_i = 0, tilt_j = 0, twist = 0;  ///< of its ends  [degrees]

  /// |D| is less than a millionth of a, so that d = D / |D| has lost its meaning; or not a number.
  bool has_closed_up() const { return !(length >= 1e-6 * a); }
  bool is_stretched() const { return length > 2.0 * a; }
  bool is_short() const { return length < 0.5 * a; }
};

/// Where two particles, i < j, came deep in one another, and the last step at which they still were.
struct DeepPair {
  ParticleId i, j;
  Vec3d entered;       ///< along r_j - r_i
  double nearest = 0;  ///< distance of their centres since  [length]
  std::int64_t last_step = 0;
  friend bool operator==(const DeepPair&, const DeepPair&) = default;
};
inline std::pair<ParticleId, ParticleId> place_of(const DeepPair& d) {
  return {d.i, d.j};
}

/// What the watch has seen so far; kept in checkpoints so that a resumed run reports nothing twice.
struct WatchRecord {
  PerBond<BondRecord> bonds;  ///< up to the last one that there was something to say about
  std::int64_t strained = 0;  ///< bonds reported or counted as strained
  std::int64_t snapped = 0;
  std::int64_t shortened = 0;
  std::set<BondId> stretched;  ///< bonds reported or counted as longer than twice their length at rest
  std::set<std::pair<ParticleId, ParticleId>> overlapping;     ///< pairs that were reported or counted, i < j
  std::map<std::pair<ParticleId, ParticleId>, DeepPair> deep;  ///< pairs as of the last step that had any
  double fastest = 0.5;      ///< way in a step over FastParticle::limit, as last reported; 0.5: not yet
  double farthest_turn = 0;  ///< of a particle in a step, as last reported; 0: not yet  [rad]
  std::set<std::pair<ParticleId, std::uint32_t>> in_walls;  ///< particles and walls, reported or counted
  friend bool operator==(const WatchRecord&, const WatchRecord&) = default;
};

/// Looks after the run: reports bonds that leave the range of their law, each worsening once, and
/// stops a run that has become unphysical. Thresholds are those of physics/range.hpp.
class Watch {
 public:
  using Tell = std::function<void(const std::string&)>;
  using CollectState = std::function<const State&()>;

  /// Reports of one kind (strained, snapped, shortened, stretched, overlapping, in walls) given in full;
  /// later ones are only counted.
  static constexpr std::int64_t told_in_full = 10;

  /// energy_error: relative error of the energy balance that stops the run, > 0.
  /// tell: takes one report, without a line end; may be empty.
  Watch(double energy_error, Tell tell, WatchRecord record = {});

  /// Throws Diverged if an energy is not finite, the balance is off by more than energy_error, or a
  /// bond has closed up (|D| < 1e-6 a); then reports bonds that are worse than ever before.
  /// state: gives the state surveyed; called only if a bond is deformed or something is wrong.
  /// suspect: asked if the balance is off, for what may be the cause (in_wall); empty: nothing is known.
  void look(const Survey& survey, double balance_error, const CollectState& state,
            const std::function<std::string()>& suspect = {});
  /// The same of a body; reports of a balance say which load factor, not when. Of a body that several
  /// processes share, each looks at its own bonds, and all are told what is new.
  void look(const BodyView& body, const std::function<std::string()>& suspect = {});
  /// The particle that is deepest in a wall, in words; empty if there is none.
  static std::string in_wall(const Model& model, const std::vector<DeepInWall>& deep);

  /// Reports pairs that are not bonded and overlap by more than `part` of the smaller radius beyond what they
  /// overlapped by at model.r_0, each pair once. part > 0; particles without radius overlap nothing. For
  /// looks now and then: it sorts all particles into cells.
  void look_at_overlaps(const Model& model, const State& state, double part) {
    look_at_overlaps(model, BodyPart(state), part, time_of(state.clock));
  }
  void look_at_overlaps(const BodyView& body, double part);
  /// The same of capsules.
  void look_at_capsules(const std::vector<DeepCapsules>& deep, const Clock& clock);

  /// Throws ParticlesLost for pairs that have passed through: whose line of centres has turned by more than a
  /// right angle while it was deep in one another. Reports the others as overlaps, as look_at_overlaps does.
  /// Asks for the state only if there is something to tell. To be called after every step with encounters.
  void look_at_encounters(const Model& model, const std::vector<Encounter>& encounters, const Clock& clock,
                          double part, const CollectState& state);

  /// Reports a particle that is too fast for its contacts to be seen, again when it is twice as fast.
  void look_at_speed(const FastParticle& fastest, const Clock& clock);

  /// Throws ParticlesLost for a particle that turns by more than half a turn in a step, unless the stage
  /// insists on it; reports it if it turns less, again when it turns twice as far.
  void look_at_turns(const FastTurn& fastest, const Clock& clock, bool insist);

  /// Reports particles that are deep in walls, each once.
  void look_at_walls(const Model& model, const std::vector<DeepInWall>& deep, const Clock& clock);

  /// Reports servos that do not press with their force as the stage ends.
  void look_at_servos(const Simulation& run);

  /// Sums up the reports that were not given in full since the last summary.
  void summarise();

  const WatchRecord& record() const { return record_; }

 private:
  void look_at_handover(const BodyView& body);
  void require_sound(const Survey& survey, double balance_error, const CollectState& state,
                     const std::function<std::string()>& suspect) const;
  bool is_news(const SeenBond& bond) const;
  void look_at_bond(const SeenBond& bond, const Clock& clock, const std::string& when);
  void look_at_overlaps(const Model& model, const BodyPart& body, double part, const std::string& when);
  void report_overlap(const Model& model, ParticleId i, ParticleId j, double depth, const std::string& when);
  /// How reports begin: with the time, and of a balance with its load factor.
  static std::string time_of(const Clock& clock);
  static std::string when(const BodyView& body);
  void report(std::int64_t& count, std::int64_t& untold, const std::string& text);

  double energy_error_;
  Tell tell_;
  WatchRecord record_;
  bool told_handover_ = false;
  std::int64_t untold_strained_ = 0, untold_snapped_ = 0, untold_shortened_ = 0;
  std::int64_t untold_stretched_ = 0, untold_overlapping_ = 0, untold_in_walls_ = 0;
};

}  // namespace vbond
