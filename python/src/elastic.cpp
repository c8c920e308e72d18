#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "interpreter.hpp"
#include "vbond/statics/homogenise.hpp"

namespace vbond::python {
namespace {

py::array_t<double> matrix(const Constants& C) {
  py::array_t<double> a({6, 6});
  for (py::ssize_t i = 0; i < 6; ++i)
    for (py::ssize_t j = 0; j < 6; ++j)
      a.mutable_at(i, j) = C[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return a;
}
Constants constants(const py::array_t<double, py::array::c_style | py::array::forcecast>& a) {
  if (a.ndim() != 2 || a.shape(0) != 6 || a.shape(1) != 6)
    throw py::value_error("C must be an array of shape (6, 6)");
  Constants C;
  for (py::ssize_t i = 0; i < 6; ++i)
    for (py::ssize_t j = 0; j < 6; ++j)
      C[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = a.at(i, j);
  return C;
}
py::tuple directed(const Directed& d) {
  return py::make_tuple(d.value, py::make_tuple(d.along.x, d.along.y, d.along.z));
}

void bind_constants(py::module_& m) {
  using namespace py::literals;
  py::class_<IsotropicConstants>(m, "IsotropicConstants", "A material that is alike in all directions.")
      .def_readonly("K", &IsotropicConstants::K, "Bulk modulus")
      .def_readonly("G", &IsotropicConstants::G, "Shear modulus")
      .def_property_readonly("E", &IsotropicConstants::E, "Young's modulus")
      .def_property_readonly("nu", &IsotropicConstants::nu, "Poisson's ratio");
  py::class_<ElasticConstants>(
      m, "ElasticConstants",
      "What an elastic material does: C, (6, 6), in the order xx yy zz yz xz xy with engineering shear.")
      .def(py::init([](const py::array_t<double, py::array::c_style | py::array::forcecast>& C) {
             return ElasticConstants(constants(C));
           }),
           "C"_a)
      .def_property_readonly("C", [](const ElasticConstants& c) { return matrix(c.stiffness()); })
      .def_property_readonly(
          "S", [](const ElasticConstants& c) { return matrix(c.compliance()); }, "Its inverse")
      .def_property_readonly("voigt", &ElasticConstants::voigt, "Mean with equal strains; nearest to C")
      .def_property_readonly("reuss", &ElasticConstants::reuss, "Mean with equal stresses")
      .def_property_readonly("hill", &ElasticConstants::hill, "Mean of the two")
      .def_property_readonly("anisotropy", &ElasticConstants::anisotropy,
                             "5 G_V/G_R + K_V/K_R - 6; 0: isotropic")
      .def(
          "youngs_modulus",
          [](const ElasticConstants& c, const py::object& n) { return c.youngs_modulus(vector(n, "along")); },
          "along"_a)
      .def(
          "poissons_ratio",
          [](const ElasticConstants& c, const py::object& n, const py::object& across) {
            return c.poissons_ratio(vector(n, "along"), vector(across, "across"));
          },
          "along"_a, "across"_a)
      .def(
          "shear_modulus",
          [](const ElasticConstants& c, const py::object& a, const py::object& b) {
            return c.shear_modulus(vector(a, "a"), vector(b, "b"));
          },
          "a"_a, "b"_a)
      .def(
          "least_youngs_modulus",
          [](const ElasticConstants& c) { return directed(c.least_youngs_modulus()); },
          "(E, the direction of it)")
      .def(
          "largest_youngs_modulus",
          [](const ElasticConstants& c) { return directed(c.largest_youngs_modulus()); },
          "(E, the direction of it)")
      .def(
          "wave_speeds",
          [](const ElasticConstants& c, const py::object& n, double density) {
            std::vector<py::tuple> speeds;
            for (const Directed& d : c.wave_speeds(vector(n, "along"), density))
              speeds.push_back(directed(d));
            return speeds;
          },
          "along"_a, "density"_a, "Three of (speed, the direction in which particles move), slowest first");
}

}  // namespace

void bind_elastic(py::module_& m) {
  using namespace py::literals;
  bind_constants(m);
  py::class_<Homogenised>(m, "Homogenised", "The material that a periodic cell is a piece of.")
      .def_property_readonly(
          "C", [](const Homogenised& h) { return matrix(h.C); },
          "How stress changes with strain, (6, 6): xx yy zz yz xz xy, engineering shear [force/length^2]")
      .def_property_readonly(
          "constants", [](const Homogenised& h) { return ElasticConstants(h.C); },
          "What follows from C. ValueError if some strain has no stiffness, or C has no symmetry under "
          "stress")
      .def_readonly("stress", &Homogenised::stress, "xx yy zz yz xz xy, tension > 0 [force/length^2]")
      .def_readonly("volume", &Homogenised::volume)
      .def_readonly("density", &Homogenised::density)
      .def_readonly("particles", &Homogenised::particles)
      .def_readonly("bonds", &Homogenised::bonds)
      .def_readonly("floating", &Homogenised::floating, "Particles of parts that carry nothing")
      .def_readonly("moved", &Homogenised::moved, "Whether the body was not in balance as it was given")
      .def_readonly("solver", &Homogenised::solver, "'direct' or 'multigrid'")
      .def_property_readonly(
          "derivatives",
          [](const Homogenised& h) {
            py::dict sets;
            for (const ConstantsBySet& by : h.derivatives)
              sets[py::int_(by.set)] = py::dict("c_A"_a = matrix(by.c_A), "c_D"_a = matrix(by.c_D),
                                                "c_B"_a = matrix(by.c_B), "c_T"_a = matrix(by.c_T));
            return sets;
          },
          "By set of bonds and stiffness: what C changes by with the logarithm of that stiffness; {} unless "
          "asked for");
  m.def(
      "homogenise",
      [](const Snapshot& s, bool derivatives) {
        const WithoutLock others;
        return homogenise(*s.model, *s.state, {{}, derivatives});
      },
      "state"_a, "derivatives"_a);
}

}  // namespace vbond::python
