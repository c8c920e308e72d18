#pragma once
/// Which instruction sets this processor has, by the names that the library uses for its kernels. A program
/// that asks may hold objects compiled for all of them and call only those that it can run.
namespace vbond_bench {

inline bool has_avx2() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
inline bool has_avx512() {
  return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}

}  // namespace vbond_bench
