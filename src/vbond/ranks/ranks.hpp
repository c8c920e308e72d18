#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vbond/dynamics/stepper.hpp"
#include "vbond/ranks/domains.hpp"
#include "vbond/ranks/share.hpp"

namespace vbond {

/// Rank 0 has ended: the others have nothing more to do.
struct Dismissed {};

/// The steps of a run by all ranks of MPI, which has begun. Each rank has a Run of the same case; that of
/// rank 0 alone has observers and decides how many steps are made.
class Ranks : public Stepper {
 public:
  Ranks();
  /// Rank 0 dismisses the others.
  ~Ranks() override;

  bool leads() const { return rank_ == 0; }
  int size() const { return size_; }
  /// How many times a particle has gone to another rank so far.
  std::int64_t migrations() const { return migrations_; }
  /// To be called once by each rank when it is about to begin, or cannot (failure: why). Returns what stands
  /// in the way of the first rank that cannot begin, or nothing.
  std::string agree(const std::string& failure);
  bool has_agreed() const { return agreed_; }
  /// Of a rank that has no more to do itself: until rank 0 has ended. Throws Dismissed.
  void wait_for_end();

  void begin(const Model& model, const Stage& stage, const State& state) override;
  std::vector<BondId> advance(std::int64_t most, bool all_look, State& state) override;

 private:
  static constexpr std::int64_t end = 0, start = -1;
  std::int64_t follow(std::int64_t order);
  void share_out();
  void evaluate(bool in_step);
  void evaluate_between_steps(std::int64_t stage_step);
  bool any_breaks() const;
  bool step_chunk(std::int64_t steps, State& state);
  std::vector<BondId> take_out_broken(std::int64_t stage_step);
  void look_for_failure(const std::vector<StepSums>& sums, std::int64_t first_bad, const State& state) const;
  void redistribute_if_due(State& state);
  void count_migrations(std::vector<ParticleId> before);
  void collect(bool everyone, State& state) const;

  int rank_ = 0, size_ = 1;
  std::int64_t migrations_ = 0;
  bool agreed_ = false, dismissed_ = false;
  bool breakable_ = false;    // some bond is
  double first_longest_ = 0;  // bond, as the stage began
  const Model* model_ = nullptr;
  const Stage* stage_ = nullptr;
  PerBond<Bond> bonds_;
  std::unique_ptr<Domains> domains_;
  std::unique_ptr<Share> share_;
  ParticleId failed_;  // of own particles, in the first step in which one failed
};

}  // namespace vbond
