#include "vbond/statics/detail/pulse.hpp"

#include <fmt/format.h>

namespace vbond {

Pulse::Pulse(const StaticStage& stage, const StaticHooks& hooks, std::chrono::milliseconds between_lines)
    : stage_(stage), hooks_(hooks), between_lines_(between_lines), before_(std::exchange(present(), this)) {}

Pulse::~Pulse() {
  present() = before_;
}

Pulse*& Pulse::present() {
  thread_local Pulse* pulse = nullptr;
  return pulse;
}

const char*& Pulse::at_work() {
  thread_local const char* what = "";
  return what;
}

void Pulse::factor() {
  if (Pulse* p = present()) ++p->factors_, p->tell_now_and_then();
}

void Pulse::solution() {
  if (Pulse* p = present()) ++p->solutions_, p->tell_now_and_then();
}

void Pulse::place(double load_factor) {
  if (Pulse* p = present()) p->load_factor_ = load_factor;
}

void Pulse::may_end() {
  Pulse* p = present();
  if (p == nullptr) return;
  p->tell_now_and_then();
  if (p->hooks_.interrupted && p->hooks_.interrupted()) throw Interrupted{};
}

void Pulse::tell_now_and_then() {
  if (!hooks_.progress) return;
  const Clock::time_point now = Clock::now();
  if (now - told_ < between_lines_) return;
  told_ = now;
  const char* what = at_work();
  hooks_.progress(fmt::format("stage \"{}\", {:.0f} s: load factor {:.6g}{}{}; {} factors, {} solutions",
                              stage_.name, std::chrono::duration<double>(now - start_).count(), load_factor_,
                              *what == '\0' ? "" : ", ", what, factors_, solutions_));
}

}  // namespace vbond
