#pragma once
#include <chrono>
#include <cstdint>

namespace vbond {

/// Where the wall time of the steps goes, from one step in 128: looking at the clock in each would cost as
/// much as a small step. Of several threads the first is looked at.
struct StepTimes {
  double bonds = 0;  ///< [s], all three scaled up to all steps
  double contacts = 0;
  double integrate = 0;  ///< moving the particles: kicks, drift, supports, damping, applied loads
  /// Setting the loop up anew within a stage: particles spread anew over processes, images found anew, bodies
  /// that come or go.  [s], each time
  double anew = 0;
  int threads = 1;  ///< that share the work: fewer than asked for if there is too little for them to do

  static constexpr std::int64_t one_in = 128;

  /// Splits the time of a stretch of work, if it is one that is looked at.
  class Lap {
   public:
    explicit Lap(bool on) : on_(on) {
      if (on_) last_ = Clock::now();
    }
    /// What has passed since the last call was spent on `phase`.
    void add_to(double& phase) {
      if (!on_) return;
      const auto now = Clock::now();
      phase += static_cast<double>(one_in) * std::chrono::duration<double>(now - last_).count();
      last_ = now;
    }

   private:
    using Clock = std::chrono::steady_clock;
    bool on_;
    Clock::time_point last_;
  };
};

}  // namespace vbond
