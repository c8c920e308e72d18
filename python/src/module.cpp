#include "bindings.hpp"
#include "vbond/run/static_solver.hpp"

PYBIND11_MODULE(_vbond, m) {
  using namespace vbond::python;
  m.attr("__version__") = VBOND_VERSION;
  bind_errors(m);
  bind_cases(m);
  bind_state(m);
  bind_results(m);
  bind_run(m);
  bind_files(m);
#ifdef VBOND_HAS_STATICS
  bind_elastic(m);
#endif
  m.def("blas_kernel", &vbond::kernel_of_blas,
        "The kernel of OpenBLAS with which static stages compute in this process; empty without statics.");
  m.def("better_blas_kernel", &vbond::better_kernel_of_blas,
        "The kernel that uses what this processor has, if the one at hand uses less, for OPENBLAS_CORETYPE "
        "in the "
        "environment of Python; else empty.");
}
