#include "vbond/core/crew.hpp"

#include <algorithm>

namespace vbond {
namespace {

void wait_for_change(const std::atomic<unsigned>& value, unsigned from) {
  constexpr int looks = 2000;  // 10 to 50 us
  for (int k = 0; k < looks; ++k) {
    if (value.load(std::memory_order_acquire) != from) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(from, std::memory_order_acquire);
}

}  // namespace

Crew::Crew(std::size_t count) : failures_(std::max<std::size_t>(count, 1)) {
  try {
    for (std::size_t k = 1; k < count; ++k) threads_.emplace_back([this, k] { serve(k); });
  } catch (...) {  // no more threads to be had
    hand_out(nullptr, nullptr);
    throw;
  }
}

Crew::~Crew() {
  hand_out(nullptr, nullptr);
}

void Crew::run(Call call, void* work) {
  hand_out(call, work);
  try_to_call(call, work, 0);
  for (unsigned busy; (busy = busy_.load(std::memory_order_acquire)) != 0;) wait_for_change(busy_, busy);
  for (std::exception_ptr& failure : failures_)
    if (failure) {
      const std::exception_ptr first = failure;
      std::fill(failures_.begin(), failures_.end(), nullptr);
      std::rethrow_exception(first);
    }
}

void Crew::try_to_call(Call call, void* work, std::size_t k) noexcept {
  try {
    call(work, k);
  } catch (...) {
    failures_[k] = std::current_exception();
  }
}

/// Work without a call ends the threads.
void Crew::hand_out(Call call, void* work) {
  call_ = call;
  work_ = work;
  busy_.store(static_cast<unsigned>(threads_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
}

void Crew::serve(std::size_t k) {
  for (unsigned seen = 0;;) {
    wait_for_change(round_, seen);
    if (round_.load(std::memory_order_acquire) == seen) continue;
    ++seen;
    if (call_ == nullptr) return;
    try_to_call(call_, work_, k);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

}  // namespace vbond
