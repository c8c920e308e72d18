#include "vbond/dynamics/team.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <numeric>
#include <thread>

namespace vbond {

/// Threads that wait for work together with their caller. A step hands out work twice within some 100 us, so
/// they look for it for a while before they sleep; not for long, as a thread that only looks keeps others
/// from the core, on a busy machine the very one that it waits for.
class Crew {
 public:
  explicit Crew(const std::vector<Part>& parts) : parts_(parts), failures_(parts.size()) {
    try {
      for (std::size_t p = 1; p < parts.size(); ++p) threads_.emplace_back([this, p] { serve(p); });
    } catch (...) {  // no more threads to be had
      hand_out(nullptr, nullptr);
      throw;
    }
  }
  ~Crew() { hand_out(nullptr, nullptr); }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// If the call throws, in whichever thread, it is thrown here once all have ended: of several the one of
  /// the lowest part.
  void run(void (*call)(void* work, const Part&), void* work) {
    hand_out(call, work);
    try_to_call(call, work, parts_.front());
    for (unsigned busy; (busy = busy_.load(std::memory_order_acquire)) != 0;) wait_for_change(busy_, busy);
    for (std::exception_ptr& failure : failures_)
      if (failure) {
        const std::exception_ptr first = failure;
        std::fill(failures_.begin(), failures_.end(), nullptr);
        std::rethrow_exception(first);
      }
  }

 private:
  static void wait_for_change(const std::atomic<unsigned>& value, unsigned from) {
    constexpr int looks = 2000;  // 10 to 50 us
    for (int k = 0; k < looks; ++k) {
      if (value.load(std::memory_order_acquire) != from) return;
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }
    value.wait(from, std::memory_order_acquire);
  }

  void try_to_call(void (*call)(void* work, const Part&), void* work, const Part& part) noexcept {
    try {
      call(work, part);
    } catch (...) {
      failures_[part.index] = std::current_exception();
    }
  }

  /// Work without a call ends the threads.
  void hand_out(void (*call)(void* work, const Part&), void* work) {
    call_ = call;
    work_ = work;
    busy_.store(static_cast<unsigned>(threads_.size()), std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  }

  void serve(std::size_t part) {
    for (unsigned seen = 0;;) {
      wait_for_change(round_, seen);
      if (round_.load(std::memory_order_acquire) == seen) continue;
      ++seen;
      if (call_ == nullptr) return;
      try_to_call(call_, work_, parts_[part]);
      if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
    }
  }

  const std::vector<Part>& parts_;
  std::vector<std::exception_ptr> failures_;  // of each part
  void (*call_)(void* work, const Part&) = nullptr;
  void* work_ = nullptr;
  std::atomic<unsigned> round_ = 0;  // of work handed out; wraps around
  std::atomic<unsigned> busy_ = 0;   // threads that have not finished their part of it
  std::vector<std::jthread> threads_;
};

Team::Team(std::size_t rows, const std::vector<std::size_t>& work, int threads)
    : rows_(filled_up(rows)), blocks_(work.size()) {
  const std::size_t all = std::accumulate(work.begin(), work.end(), std::size_t{0});
  const std::size_t parts =
      std::clamp<std::size_t>(all / least_part, 1, static_cast<std::size_t>(std::max(1, threads)));
  std::size_t block = 0, done = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    Part part{p, block, block, {}};
    const std::size_t goal = all * (p + 1) / parts;
    while (block < blocks_ && (p + 1 == parts || done + work[block] / 2 < goal)) done += work[block++];
    part.last_block = block;
    part.rows = {std::min(rows_, part.first_block * block_rows), std::min(rows_, block * block_rows)};
    parts_.push_back(part);
  }
  if (parts_.size() > 1) crew_ = std::make_unique<Crew>(parts_);
}

Team::~Team() = default;

void Team::run(void (*call)(void* work, const Part&), void* work) const {
  crew_->run(call, work);
}

const Part& Team::part_of_row(std::size_t row) const {
  for (const Part& p : parts_)
    if (p.rows.contains(row)) return p;
  return parts_.back();
}

}  // namespace vbond
