#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "vbond/dynamics/kernel.hpp"

namespace vbond {

namespace baseline {
extern const StepKernel kernel;
}
#if defined(VBOND_VECTOR_KERNELS)
namespace avx2 {
extern const StepKernel kernel;
}
namespace avx512 {
extern const StepKernel kernel;
}
namespace avx512_pairs {
extern const StepKernel kernel;
}
#endif

std::vector<const StepKernel*> available_kernels() {
  std::vector<const StepKernel*> kernels{&baseline::kernel};
#if defined(VBOND_VECTOR_KERNELS)  // each set asks for what CMakeLists.txt compiles it with
  if (__builtin_cpu_supports("avx2")) kernels.push_back(&avx2::kernel);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    kernels.insert(kernels.end(), {&avx512::kernel, &avx512_pairs::kernel});
    if (!__builtin_cpu_is("intel")) std::swap(kernels.back(), kernels.rbegin()[1]);
  }
#endif
  return kernels;
}

namespace {

const StepKernel& chosen_kernel() {
  const std::vector<const StepKernel*> kernels = available_kernels();
  const char* wanted = std::getenv("VBOND_SIMD");
  if (wanted == nullptr) return *kernels.back();
  std::string names;
  for (auto k = kernels.rbegin(); k != kernels.rend(); ++k) {
    if ((*k)->name == std::string(wanted)) return **k;
    if (names.find((*k)->name) == std::string::npos)
      names.insert(0, (*k)->name + std::string(names.empty() ? "" : ", "));
  }
  throw std::invalid_argument("VBOND_SIMD = " + std::string(wanted) + ": this machine can execute " + names +
                              "; without VBOND_SIMD the best of them is used");
}

}  // namespace

const StepKernel& step_kernel() {
  static const StepKernel& kernel = chosen_kernel();
  return kernel;
}

const char* instruction_set() {
  return step_kernel().name;
}

const BondLoops& bond_loops(const BondLaw& law, const StepKernel& kernel) {
  const auto laws = bond_laws();
  const auto at = std::find(laws.begin(), laws.end(), &law);
  if (at != laws.end()) return kernel.bonds[at - laws.begin()];
  if (law.loops != nullptr)
    if (const BondLoops* loops = law.loops(kernel.name)) return *loops;
  throw std::invalid_argument("the bond law \"" + std::string(law.name) +
                              "\" has no loops for the instruction set " + kernel.name +
                              ": see CONTRIBUTING.md on laws of a program's own");
}

void drift_by_any_angle(RowRange rows, double h, const MotionRow* motion, PoseRow* pose) {
  for (std::size_t k = rows.first; k < rows.last; ++k) {
    pose[k].r += h * motion[k].v;
    pose[k].q = renormalised(rotation_of(h * motion[k].omega) * pose[k].q);
  }
}

}  // namespace vbond
