#include "vbond/core/large_array.hpp"

#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace vbond::detail {
namespace {

constexpr std::size_t large_page = std::size_t{1} << 21;  // of x86-64, and of ARM with pages of 4 KiB

/// Of less, alignment would leave as many addresses unused as the array has.
bool is_large(std::size_t bytes) {
  return bytes >= 2 * large_page;
}
std::align_val_t alignment_of(std::size_t bytes, std::size_t alignment) {
  return std::align_val_t{is_large(bytes) ? large_page : alignment};
}

}  // namespace

void* take_memory(std::size_t bytes, std::size_t alignment) {
  void* memory = ::operator new(bytes, alignment_of(bytes, alignment));
#ifdef MADV_HUGEPAGE
  // A request: where it is refused, pages are as small as those of others.
  if (is_large(bytes)) static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));
#endif
  return memory;
}

void give_memory(void* memory, std::size_t bytes, std::size_t alignment) noexcept {
  ::operator delete(memory, alignment_of(bytes, alignment));
}

}  // namespace vbond::detail
