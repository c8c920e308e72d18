#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "vbond/case/case.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/csv.hpp"

/// The extension _vbond, by subjects. What Python users see is the package `vbond` around it.
namespace vbond::python {

namespace py = pybind11;

void bind_errors(py::module_& m);
/// Warns as Python does; throws error_already_set if its filters make an error of it.
void warn_of_run(const std::string& text);
void bind_cases(py::module_& m);
void bind_state(py::module_& m);
void bind_results(py::module_& m);
void bind_run(py::module_& m);
void bind_files(py::module_& m);
void bind_elastic(py::module_& m);  ///< with statics

/// A case, shared by all that runs it.
using SharedCase = std::shared_ptr<const Case>;

/// A text that Python has made of a dict has lines that nobody has seen: its mistakes are told by keys alone.
CaseError without_places(const CaseError& e);

/// The body as it stood at one time: its arrays are views of this, which they keep alive.
struct Snapshot {
  std::shared_ptr<const Model> model;
  std::shared_ptr<const State> state;
};

/// n rows of so many doubles at this place, which `owner` keeps alive: no copy, not to be written to.
py::array view(const double* data, std::size_t rows, std::size_t columns, const py::object& owner);
/// Columns of vectors, quaternions or numbers as arrays: copies, which may be written to.
py::array copy(const std::vector<Vec3d>& values);
py::array copy(const std::vector<double>& values);
py::array copy(const std::vector<std::int64_t>& values);
py::array copy(const std::vector<std::uint8_t>& values);
py::array copy(const std::vector<Image>& values);

/// n vectors out of an array of shape (n, 3). Throws ValueError with the shape that is wanted and the one
/// that there is.
PerParticle<Vec3d> vectors(const py::object& array, std::size_t n, const char* name);
/// One vector, of three numbers.
Vec3d vector(const py::object& array, const char* name);

/// A column of history, filled row by row: whole numbers as int64, all else as float64, NaN where there is
/// none.
py::dict columns_of(const std::vector<std::string>& names, const std::vector<std::vector<Cell>>& rows);

}  // namespace vbond::python
