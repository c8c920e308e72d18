#include "bindings.hpp"

PYBIND11_MODULE(_vbond, m) {
  using namespace vbond::python;
  m.attr("__version__") = VBOND_VERSION;
  bind_errors(m);
  bind_cases(m);
  bind_state(m);
  bind_results(m);
  bind_run(m);
  bind_files(m);
}
