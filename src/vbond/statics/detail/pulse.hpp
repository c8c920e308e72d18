#pragma once
#include <chrono>
#include <string>
#include <utility>

#include "vbond/statics/statics.hpp"

namespace vbond {

/// Thrown out of a long piece of work where the stage is to end. No std::exception: it is not to be taken for
/// the failure of a solver.
struct Interrupted {};

/// While one lives, the stage that runs in this thread tells every few seconds what it is at, and can be
/// ended within an eigenvalue search. Linear algebra knows of no stage, so it finds the pulse by its thread.
class Pulse {
 public:
  Pulse(const StaticStage& stage, const StaticHooks& hooks,
        std::chrono::milliseconds between_lines = std::chrono::seconds(4));
  ~Pulse();
  Pulse(const Pulse&) = delete;
  Pulse& operator=(const Pulse&) = delete;

  /// What the thread is at as long as one lives, in words such as "linear estimates".
  class Work {
   public:
    explicit Work(const char* what) : before_(std::exchange(at_work(), what)) {}
    ~Work() { at_work() = before_; }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

   private:
    const char* before_;
  };

  // To be called often; without a stage in this thread they do nothing.
  static void factor();
  static void solution();
  static void place(double load_factor);
  /// Between pieces of work of a second at most: throws Interrupted if the stage is to end.
  static void may_end();

 private:
  using Clock = std::chrono::steady_clock;
  static Pulse*& present();
  static const char*& at_work();
  void tell_now_and_then();

  const StaticStage& stage_;
  const StaticHooks& hooks_;
  std::chrono::milliseconds between_lines_;
  Pulse* before_;
  Clock::time_point start_ = Clock::now(), told_ = start_;
  double load_factor_ = 0;
  long factors_ = 0, solutions_ = 0;
};

}  // namespace vbond
