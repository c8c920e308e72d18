#include <pybind11/stl.h>

#include <new>

#include "bindings.hpp"
#include "vbond/core/error.hpp"

namespace vbond::python {
namespace {

/// The exceptions of the package, which live as long as the interpreter.
struct Errors {
  py::object error, case_error, diverged, no_equilibrium, io_error, run_warning;
};
Errors& errors() {
  static auto* all = new Errors;  // never destroyed: the interpreter may be gone by then
  return *all;
}

/// Raises an exception with attributes.
void raise(const py::object& type, const char* text, const py::dict& attributes) {
  const py::object error = type(text);
  for (const auto& [name, value] : attributes) py::setattr(error, name, value);
  PyErr_SetObject(type.ptr(), error.ptr());
}

py::list problems_of(const CaseError& e) {
  py::list problems;
  for (const Problem& p : e.problems()) {
    py::dict problem;
    const bool placed = p.place.line > 0;
    problem["file"] = p.place.file.empty() ? py::object(py::none()) : py::object(py::str(p.place.file));
    problem["line"] = placed ? py::object(py::int_(p.place.line)) : py::object(py::none());
    problem["column"] = placed ? py::object(py::int_(p.place.column)) : py::object(py::none());
    problem["what"] = p.what;
    problem["rule"] = p.rule;
    problem["way_out"] = p.way_out;
    problem["more"] = p.more;
    problems.append(problem);
  }
  return problems;
}

void translate(std::exception_ptr thrown) {
  using namespace py::literals;
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const CaseError& e) {
    raise(errors().case_error, e.what(), py::dict("problems"_a = problems_of(e)));
  } catch (const Diverged& e) {
    raise(errors().diverged, e.what(), py::dict("step"_a = e.step, "time"_a = e.time));
  } catch (const NoEquilibrium& e) {
    raise(errors().no_equilibrium, e.what(), {});
  } catch (const NoConvergence& e) {
    raise(errors().no_equilibrium, e.what(), {});
  } catch (const IoError& e) {
    raise(errors().io_error, e.what(), {});
  }
}

py::object made(py::module_& m, const char* name, const char* meaning, const py::tuple& bases) {
  using namespace py::literals;
  const py::object type =
      py::module_::import("builtins")
          .attr("type")(name, bases, py::dict("__doc__"_a = meaning, "__module__"_a = "vbond"));
  m.attr(name) = type;
  return type;
}

}  // namespace

void warn_of_run(const std::string& text) {
  if (PyErr_WarnEx(errors().run_warning.ptr(), text.c_str(), 1) != 0) throw py::error_already_set();
}

void bind_errors(py::module_& m) {
  const py::module_ builtins = py::module_::import("builtins");
  Errors& e = errors();
  e.error = made(m, "Error", "What vbond reports: the base of its other exceptions.",
                 py::make_tuple(builtins.attr("Exception")));
  e.case_error =
      made(m, "CaseError",
           "Mistakes in a case, all at once. `problems` is a list of dicts: file, line, column (None where "
           "there is no such place), what, rule, way_out.",
           py::make_tuple(e.error, builtins.attr("ValueError")));
  e.diverged = made(m, "Diverged", "The run went unphysical at `step` and `time`; it cannot go on.",
                    py::make_tuple(e.error));
  e.no_equilibrium = made(m, "NoEquilibrium", "A static stage found no equilibrium; the run cannot go on.",
                          py::make_tuple(e.error));
  e.io_error = made(m, "IoError", "A file or folder could not be read or written.",
                    py::make_tuple(e.error, builtins.attr("OSError")));
  e.run_warning =
      made(m, "RunWarning",
           "What a run reports and goes on: bonds bent out of the range of their law, deep overlaps.",
           py::make_tuple(builtins.attr("UserWarning")));
  py::register_exception_translator(&translate);
}

}  // namespace vbond::python
