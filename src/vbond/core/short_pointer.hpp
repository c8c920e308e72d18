#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <stdexcept>

namespace vbond {

/// A pointer in two bytes, to one of few objects that last as long as the program: what very many objects
/// share. Used as a pointer is. Making one from a pointer looks for the object among all that there were, up
/// to 65,535; following it costs one more read than with a pointer.
template <class T>
class ShortPointer {
 public:
  constexpr ShortPointer() = default;
  ShortPointer(const T* object) : number_(number_of(object)) {}

  operator const T*() const { return all().objects[number_].load(std::memory_order_relaxed); }
  const T* operator->() const { return *this; }

 private:
  static constexpr std::size_t most = 1 << 16;
  struct All {
    std::array<std::atomic<const T*>, most> objects{};  // the first is nullptr
    std::atomic<std::size_t> count = 1;
    std::mutex mutex;
  };
  static All& all() {
    static constinit All objects;
    return objects;
  }
  static std::uint16_t number_of(const T* object) {
    All& known = all();
    std::size_t k = 0;
    const auto is_found = [&](std::size_t count) {
      while (k < count && known.objects[k].load(std::memory_order_relaxed) != object) ++k;
      return k < count;
    };
    if (is_found(known.count.load(std::memory_order_acquire))) return static_cast<std::uint16_t>(k);
    const std::lock_guard lock(known.mutex);
    if (!is_found(known.count.load(std::memory_order_relaxed))) {
      if (k == most)
        throw std::length_error("more than 65,535 objects that are to have numbers of two bytes");
      known.objects[k].store(object, std::memory_order_relaxed);
      known.count.store(k + 1, std::memory_order_release);
    }
    return static_cast<std::uint16_t>(k);
  }

  std::uint16_t number_ = 0;
};

}  // namespace vbond
