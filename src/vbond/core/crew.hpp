#pragma once
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace vbond {

/// Threads that wait for work together with their caller. A step hands out work twice within some 100 us, so
/// they look for it for a while before they sleep; not for long, as a thread that only looks keeps others
/// from the core, on a busy machine the very one that it waits for.
class Crew {
 public:
  /// Of this many, the caller among them; at least one.
  explicit Crew(std::size_t count);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  std::size_t count() const { return failures_.size(); }

  /// Calls work(k) for all k < count() at once, each in a thread, that of 0 in the caller's. If one throws,
  /// in whichever thread, it is thrown here once all have ended: of several the one of the lowest k.
  template <class Work>
  void for_each(Work work) {
    run([](void* w, std::size_t k) { (*static_cast<Work*>(w))(k); }, &work);
  }

 private:
  using Call = void (*)(void* work, std::size_t k);

  void run(Call call, void* work);
  void try_to_call(Call call, void* work, std::size_t k) noexcept;
  void hand_out(Call call, void* work);
  void serve(std::size_t k);

  std::vector<std::exception_ptr> failures_;  // of each
  Call call_ = nullptr;
  void* work_ = nullptr;
  std::atomic<unsigned> round_ = 0;  // of work handed out; wraps around
  std::atomic<unsigned> busy_ = 0;   // threads that have not finished their part of it
  std::vector<std::jthread> threads_;
};

}  // namespace vbond
