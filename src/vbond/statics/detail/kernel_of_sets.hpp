#pragma once

namespace vbond {

/// A kernel as it is compiled for several instruction sets; null: it is not.
template <class Kernel>
struct KernelOfSets {
  const Kernel* baseline;
  const Kernel* avx2 = nullptr;
  const Kernel* avx512 = nullptr;

  /// That of the set of this number, from 0; null: this machine can execute no more. Each set asks for what
  /// CMakeLists.txt compiles it with.
  const Kernel* of(int number) const {
    if (number == 0) return baseline;
#if defined(VBOND_VECTOR_KERNELS)
    if (number == 1 && __builtin_cpu_supports("avx2")) return avx2;
    if (number == 2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
      return avx512;
#endif
    return nullptr;
  }
  const Kernel& best() const {
    int number = 0;
    while (of(number + 1) != nullptr) ++number;
    return *of(number);
  }
};

}  // namespace vbond
