#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "bindings.hpp"

namespace vbond::python {
namespace {

static_assert(sizeof(Vec3d) == 3 * sizeof(double) && sizeof(Quatd) == 4 * sizeof(double));

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_of(const py::array& a) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < a.ndim(); ++k) text += (k > 0 ? ", " : "") + std::to_string(a.shape(k));
  return text + (a.ndim() == 1 ? ",)" : ")");
}

/// The array as doubles. Text, complex numbers and objects are no numbers here.
Doubles doubles(const py::object& object, const char* name) {
  if (py::hasattr(object, "mask"))
    throw py::type_error(std::string(name) + ": a masked array has places without numbers; fill them first");
  const py::array a = py::array::ensure(object);
  if (!a) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": an array of numbers is wanted, not " +
                         std::string(py::str(py::type::of(object).attr("__name__"))));
  }
  if (const char kind = a.dtype().kind(); kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(std::string(name) + ": an array of numbers is wanted, not of dtype " +
                         std::string(py::str(a.dtype())));
  return Doubles(a);
}

void require_finite(const Doubles& a, const char* name) {
  if (!std::all_of(a.data(), a.data() + a.size(), [](double x) { return std::isfinite(x); }))
    throw py::value_error(std::string(name) + ": all numbers must be finite");
}

template <class T>
py::array copied(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

double number_of(const Cell& cell) {
  if (const auto* x = std::get_if<double>(&cell)) return *x;
  if (const auto* n = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*n);
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

py::array view(const double* data, std::size_t rows, std::size_t columns, const py::object& owner) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  if (columns > 1) shape.push_back(static_cast<py::ssize_t>(columns));
  py::array_t<double> a(shape, data, owner);
  py::detail::array_proxy(a.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return a;
}

py::array copy(const std::vector<Vec3d>& values) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size()), 3};
  return py::array_t<double>(shape, values.empty() ? nullptr : &values[0].x);
}
py::array copy(const std::vector<double>& values) {
  return copied(values);
}
py::array copy(const std::vector<std::int64_t>& values) {
  return copied(values);
}
py::array copy(const std::vector<std::uint8_t>& values) {
  return copied(values);
}
py::array copy(const std::vector<Image>& values) {
  static_assert(sizeof(Image) == 3 * sizeof(std::int32_t));
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size()), 3};
  return py::array_t<std::int32_t>(shape, values.empty() ? nullptr : &values[0].a);
}

PerParticle<Vec3d> vectors(const py::object& array, std::size_t n, const char* name) {
  const Doubles a = doubles(array, name);
  if (a.ndim() != 2 || a.shape(0) != static_cast<py::ssize_t>(n) || a.shape(1) != 3)
    throw py::value_error(std::string(name) + ": shape (" + std::to_string(n) + ", 3) is wanted, not " +
                          shape_of(a));
  require_finite(a, name);
  PerParticle<Vec3d> values(n);
  for (const ParticleId p : values.ids()) values[p] = {a.at(p.value, 0), a.at(p.value, 1), a.at(p.value, 2)};
  return values;
}

Vec3d vector(const py::object& array, const char* name) {
  const Doubles a = doubles(array, name);
  if (a.ndim() != 1 || a.shape(0) != 3)
    throw py::value_error(std::string(name) + ": three numbers are wanted, not shape " + shape_of(a));
  require_finite(a, name);
  return {a.at(0), a.at(1), a.at(2)};
}

py::dict columns_of(const std::vector<std::string>& names, const std::vector<std::vector<Cell>>& rows) {
  py::dict columns;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool whole = !rows.empty() && std::all_of(rows.begin(), rows.end(), [c](const auto& row) {
      return std::holds_alternative<std::int64_t>(row[c]);
    });
    if (whole) {
      std::vector<std::int64_t> values;
      for (const auto& row : rows) values.push_back(std::get<std::int64_t>(row[c]));
      columns[py::str(names[c])] = copy(values);
    } else {
      std::vector<double> values;
      for (const auto& row : rows) values.push_back(number_of(row[c]));
      columns[py::str(names[c])] = copy(values);
    }
  }
  return columns;
}

}  // namespace vbond::python
