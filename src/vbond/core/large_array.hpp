#pragma once
#include <cstddef>
#include <vector>

namespace vbond {

namespace detail {
/// Memory for an array: of many pages, if it is large, it begins at a large page and asks for such pages.
void* take_memory(std::size_t bytes, std::size_t alignment);  // std::bad_alloc if there is none
void give_memory(void* memory, std::size_t bytes, std::size_t alignment) noexcept;
}  // namespace detail

/// Of LargeArray.
template <class T>
struct LargePages {
  using value_type = T;

  LargePages() = default;
  template <class Other>
  LargePages(const LargePages<Other>&) {}

  T* allocate(std::size_t n) { return static_cast<T*>(detail::take_memory(n * sizeof(T), alignof(T))); }
  void deallocate(T* at, std::size_t n) noexcept { detail::give_memory(at, n * sizeof(T), alignof(T)); }
  friend bool operator==(const LargePages&, const LargePages&) { return true; }
};

/// What a step or a solution goes through as a whole, each time. An array of 4 MiB or more asks Linux for
/// pages of 2 MiB (madvise(2)), so that the processor looks up fewer addresses. Many systems give such pages
/// only to those who ask. Otherwise it is a std::vector.
template <class T>
using LargeArray = std::vector<T, LargePages<T>>;

}  // namespace vbond
