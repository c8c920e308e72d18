#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vbond/dynamics/exchange.hpp"
#include "vbond/dynamics/simulation.hpp"
#include "vbond/dynamics/stepper.hpp"
#include "vbond/ranks/domains.hpp"

namespace vbond {

/// Rank 0 has ended: the others have nothing more to do.
struct Dismissed {};

/// The steps of a run by all ranks of MPI, which has begun. Each rank has a Run of the same case, and steps
/// its part of the body by a Simulation of its own. That of rank 0 alone has observers and decides how many
/// steps are made.
class Ranks : public Stepper, public Exchange {
 public:
  Ranks();
  /// Rank 0 dismisses the others.
  ~Ranks() override;

  int rank() const { return rank_; }
  int parts() const override { return size_; }
  /// How many of them share this machine, and whether rank 0 is among these.
  int on_this_machine() const { return here_; }
  bool first_is_here() const { return first_is_here_; }
  /// How many times a particle has gone to another rank so far, and how often they were spread anew.
  std::int64_t migrations() const { return migrations_; }
  std::int64_t redistributions() const { return redistributions_; }
  /// The longest time that a rank has worked, over the mean; waiting left out.
  double imbalance() const { return imbalance_; }
  /// To be called once by each rank when it is about to begin, or cannot (failure: why). Returns what stands
  /// in the way of the first rank that cannot begin, or nothing.
  std::string agree(const std::string& failure);
  bool has_agreed() const { return agreed_; }
  /// What this rank does with its part when rank 0 has all look at theirs; message: of rank 0.
  using Look = std::function<void(const Simulation& part, const std::string& message)>;
  void set_look(Look look) { look_ = std::move(look); }
  /// Of a rank that has no more to do itself: until rank 0 has ended. Throws Dismissed.
  void wait_for_end();

  void begin(const Model& model, const Stage& stage, State& state, double reach) override;
  Simulation& part() override;
  StopReason advance(std::int64_t most, State& state) override;
  Simulation& ask(const Question& question) override;
  void look_at_parts(const std::string& message) override;
  void end_stage(State& state) override;

  void halo(const HaloColumns& columns) override;
  void reverse_sum(std::span<LoadRow> load) override;
  void sum(std::span<double> numbers) const override;
  void max(std::span<double> numbers) const override;
  bool leads() const override { return rank_ == 0; }
  void gather_bytes(std::span<const std::byte> mine, bool everyone, const Room& room) const override;

 private:
  class Waiting;
  /// What rank 0 wants of the others; above zero, so many steps.
  enum Wish : std::int64_t { end = 0, start = -1, question = -2, look = -3, stage_over = -4 };
  std::int64_t follow(std::int64_t wish);
  Question share(Question question) const;
  std::string text_of_rank(int rank, std::string text) const;
  std::string first_failure(const std::string& mine) const;
  void look_here(const std::string& message);
  void bring_together(State& state);
  void take_part(State& state);
  StopReason step(std::int64_t steps, State& state);
  bool is_far();
  void redistribute(State& state);
  PerParticle<double> work_of(const State& state) const;
  double ghost_reach(const State& state) const;

  int rank_ = 0, size_ = 1, here_ = 1;
  bool first_is_here_ = true;
  std::int64_t migrations_ = 0, redistributions_ = 0;
  mutable double waited_ = 0;
  double worked_ = 0, imbalance_ = 1;
  bool agreed_ = false, dismissed_ = false;
  Look look_;
  const Model* model_ = nullptr;
  const Stage* stage_ = nullptr;
  Order order_;         // of the whole body
  double reach_ = 0;    // of what may touch or be bonded
  double room_ = 0;     // what may meet has been listed until a particle has gone so far
  double longest_ = 0;  // bond, as particles were spread
  double first_ghost_reach_ = 0;
  std::int64_t unchecked_ = 0;  // steps since ways were looked at
  std::unique_ptr<Domains> domains_;
  std::vector<ParticleId> own_;      // in increasing order
  std::vector<std::uint32_t> rows_;  // of the particles that domains_ names, in its order
  std::unique_ptr<Simulation> part_;
};

}  // namespace vbond
