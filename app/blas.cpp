#include "blas.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string>

#include "vbond/run/static_solver.hpp"

namespace vbond::app {

void choose_blas_kernel(char** arguments) {
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (std::getenv(variable) != nullptr) return;
  const std::string better = better_kernel_of_blas();
  if (better.empty() || setenv(variable, better.c_str(), 1) != 0) return;
  execv("/proc/self/exe", arguments);
  unsetenv(variable);  // it could not be started: the kernel at hand is slower, and as right
}

}  // namespace vbond::app
