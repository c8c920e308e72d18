#include "vbond/statics/blas_kernel.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

extern "C" char* openblas_get_corename();
extern "C" char* openblas_get_config();

namespace vbond {
namespace {

struct Kernel {
  const char* name;
  VectorSet uses;
};

/// OpenBLAS's names (its driver/others/dynamic.c) and the instructions that the kernels are written in.
constexpr std::array kernels{
    Kernel{"katmai", VectorSet::sse},        Kernel{"coppermine", VectorSet::sse},
    Kernel{"northwood", VectorSet::sse},     Kernel{"prescott", VectorSet::sse},
    Kernel{"banias", VectorSet::sse},        Kernel{"atom", VectorSet::sse},
    Kernel{"core2", VectorSet::sse},         Kernel{"penryn", VectorSet::sse},
    Kernel{"dunnington", VectorSet::sse},    Kernel{"nehalem", VectorSet::sse},
    Kernel{"athlon", VectorSet::sse},        Kernel{"opteron", VectorSet::sse},
    Kernel{"opteron_sse3", VectorSet::sse},  Kernel{"barcelona", VectorSet::sse},
    Kernel{"nano", VectorSet::sse},          Kernel{"bobcat", VectorSet::sse},
    Kernel{"sandybridge", VectorSet::avx},   Kernel{"bulldozer", VectorSet::avx},
    Kernel{"piledriver", VectorSet::avx},    Kernel{"steamroller", VectorSet::avx},
    Kernel{"excavator", VectorSet::avx},     Kernel{"haswell", VectorSet::avx2},
    Kernel{"zen", VectorSet::avx2},          Kernel{"skylakex", VectorSet::avx512},
    Kernel{"cooperlake", VectorSet::avx512}, Kernel{"sapphirerapids", VectorSet::avx512},
};

std::optional<VectorSet> used_by(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Kernel& k : kernels)
    if (name == k.name) return k.uses;
  return std::nullopt;
}

#if defined(__x86_64__)
std::optional<VectorSet> of_this_processor() {
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
  if (avx512) return VectorSet::avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return VectorSet::avx2;
  if (__builtin_cpu_supports("avx")) return VectorSet::avx;
  return VectorSet::sse;
}
#else
std::optional<VectorSet> of_this_processor() {
  return std::nullopt;
}
#endif

}  // namespace

std::string blas_kernel() {
  return openblas_get_corename();
}

std::string better_blas_kernel(const std::string& own, VectorSet processor) {
  const std::optional<VectorSet> used = used_by(own);
  if (!used || *used >= processor) return {};
  switch (processor) {
    case VectorSet::sse: return {};
    case VectorSet::avx: return "Sandybridge";
    case VectorSet::avx2: return "Haswell";
    case VectorSet::avx512:
      return "SkylakeX";  // those that came after it differ in other numbers than doubles
  }
  return {};
}

std::string better_blas_kernel() {
  const std::string built = openblas_get_config();
  const std::optional<VectorSet> processor = of_this_processor();
  if (!processor || built.find("DYNAMIC_ARCH") == std::string::npos) return {};
  return better_blas_kernel(blas_kernel(), *processor);
}

}  // namespace vbond
