#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vbond/dynamics/borders.hpp"
#include "vbond/dynamics/partition.hpp"
#include "vbond/ranks/domains.hpp"
#include "vbond/ranks/halo.hpp"

namespace vbond {

/// The ranks of MPI, which has begun, as the processes that step a body. Each of them makes the same Run,
/// with all particles, and steps its part of it (Run::spread_over). All ranks call these functions at
/// the same time; each may call alone those that say so.
class Ranks : public Partition {
 public:
  Ranks();

  /// These may be called by one rank alone.
  int rank() const override { return rank_; }
  int ranks() const override { return size_; }
  /// How many of them share this machine. May be called by one rank alone.
  int on_this_machine() const { return here_; }
  /// How many times a particle has gone to another rank so far, and how often they were spread anew. May be
  /// called by one rank alone.
  std::int64_t migrations() const { return migrations_; }
  std::int64_t redistributions() const { return redistributions_; }
  /// The longest time that a rank has worked since particles were spread first, over the mean; waiting left
  /// out, and what is done together.
  double imbalance() const;
  /// Of the failures that ranks have, that of the lowest rank; empty if there is none.
  std::string first_failure(const std::string& mine) const;
  /// The text of rank 0.
  std::string text_of_leader(std::string text) const { return text_of_rank(0, std::move(text)); }
  /// Whether something that was done together has failed: all ranks know. May be called by one rank alone.
  bool has_failed_together() const { return has_failed_together_; }

  std::vector<ParticleId> spread_first(const Model& model, const State& state,
                                       const PerParticle<std::uint32_t>& bonds, double longest) override;
  Share spread(const Model& model, const State& state, double reach, bool knows_all) override;
  Share spread_anew(const Model& model, const State& state) override;
  Share migrate(Model& model, State& state, PartHandedOver part) override;

  void begin_halo(const HaloColumns& columns) override;
  void end_halo(const HaloColumns& columns) override;
  void reverse_sum(std::span<LoadRow> load) override;
  void sum(std::span<double> numbers) const override;
  void max(std::span<double> numbers) const override;
  std::vector<std::size_t> swap_bytes(std::span<const std::byte> mine, const std::vector<std::size_t>& sizes,
                                      const Room& room) const override;
  void gather_bytes(std::span<const std::byte> mine, const Room& room) const override;
  void send_bytes_to_leader(std::span<const std::byte> mine, const Room& room) const override;
  void together(const std::function<void()>& work) const override;

 private:
  class Waiting;
  struct Counts;
  Counts counts(std::size_t mine) const;
  std::string text_of_rank(int rank, std::string text) const;
  std::vector<ParticleId> redistribute(const Model& model, const State& state);
  std::vector<int> owners_among(std::vector<PlacedParticle> across, const std::vector<ParticleId>& others,
                                std::size_t particles) const;
  Share share_of(const Model& model, const State& state);
  std::vector<BoundingBox> boxes_of_others(const State& state) const;
  Share share_with(std::vector<ImageOf> ghosts, std::vector<int> owners, const Model& model,
                   const State& state);
  void make_domains(const Model& model, const State& state, const PerParticle<double>& work, double longest);
  double ghost_reach() const;
  bool are_spread_anew(const Model& model) const;
  double size_of_domains(const State& state, double longest) const;

  int rank_ = 0, size_ = 1, here_ = 1;
  std::int64_t migrations_ = 0, redistributions_ = 0;
  mutable double waited_ = 0;
  mutable bool waits_ = false, has_failed_together_ = false;
  double begun_ = -1;       // seconds of work then; < 0: not yet
  double reach_ = 0;        // of what may touch or be bonded
  bool knows_all_ = false;  // each rank knows all particles
  double lost_beyond_ = 0;
  bool domains_fit_ = false;  // those of spread_first
  std::unique_ptr<Domains> domains_;
  std::vector<ParticleId> own_;  // in increasing order
  Halo halo_;
};

}  // namespace vbond
