#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "interpreter.hpp"
#include "vbond/statics/homogenise.hpp"
#include "vbond/statics/homogenise_body.hpp"
#include "vbond/statics/homogenise_sheet.hpp"

namespace vbond::python {
namespace {

py::array_t<double> matrix(const Constants& C) {
  py::array_t<double> a({6, 6});
  for (py::ssize_t i = 0; i < 6; ++i)
    for (py::ssize_t j = 0; j < 6; ++j)
      a.mutable_at(i, j) = C[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return a;
}
py::array_t<double> matrix(const SheetConstants& C) {
  py::array_t<double> a({3, 3});
  for (py::ssize_t i = 0; i < 3; ++i)
    for (py::ssize_t j = 0; j < 3; ++j)
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
py::tuple extremes(const Extremes& e) {
  return py::make_tuple(directed(e.least), directed(e.largest));
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
          "shear_moduli",
          [](const ElasticConstants& c, const py::object& n) {
            return extremes(c.shear_moduli(vector(n, "along")));
          },
          "along"_a, "((least G, m), (largest G, m)): of all directions m across")
      .def(
          "poissons_ratios",
          [](const ElasticConstants& c, const py::object& n) {
            return extremes(c.poissons_ratios(vector(n, "along")));
          },
          "along"_a, "((least nu, m), (largest nu, m)): of all directions m across")
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

void bind_sheets(py::module_& m) {
  using namespace py::literals;
  py::class_<HomogenisedSheet>(m, "HomogenisedSheet",
                               "The plate that a sheet is: per width, N = A e + B k and M = B^T e + D k.")
      .def_property_readonly(
          "A", [](const HomogenisedSheet& h) { return matrix(h.A); },
          "Membrane forces by strain, (3, 3): 11 22 12, engineering shear [force/length]")
      .def_property_readonly(
          "B", [](const HomogenisedSheet& h) { return matrix(h.B); },
          "Membrane forces by curvature, (3, 3): rows are of strains [force]")
      .def_property_readonly(
          "D", [](const HomogenisedSheet& h) { return matrix(h.D); },
          "Moments by curvature -(w_11, w_22, 2 w_12), (3, 3) [force*length]")
      .def_property_readonly(
          "axes",
          [](const HomogenisedSheet& h) {
            std::vector<std::array<double, 3>> axes;
            for (const Vec3d& a : h.axes) axes.push_back({a.x, a.y, a.z});
            return axes;
          },
          "Axes of the world along 1, 2 and the normal")
      .def_readonly("plane", &HomogenisedSheet::plane, "Where the plane cuts the normal's axis [length]")
      .def_readonly("area", &HomogenisedSheet::area, "Of the cell [length^2]")
      .def_readonly("density", &HomogenisedSheet::density, "Mass per area")
      .def_readonly("particles", &HomogenisedSheet::particles)
      .def_readonly("bonds", &HomogenisedSheet::bonds)
      .def_readonly("floating", &HomogenisedSheet::floating, "Particles of parts that carry nothing")
      .def_readonly("parts", &HomogenisedSheet::parts,
                    "Parts that carry, and do not hang together with each other")
      .def_readonly("solver", &HomogenisedSheet::solver, "'direct' or 'multigrid'");
  m.def(
      "homogenise_sheet",
      [](const Snapshot& s) {
        const WithoutLock others;
        return homogenise_sheet(*s.model, *s.state);
      },
      "state"_a);
}

void bind_bodies(py::module_& m) {
  using namespace py::literals;
  py::class_<HomogenisedBody>(m, "HomogenisedBody", "Elastic constants of a body without a cell.")
      .def_property_readonly(
          "by_displacement", [](const HomogenisedBody& h) { return ElasticConstants(h.by_displacement); },
          "Its surface moves with the strain and does not turn")
      .def_property_readonly(
          "by_traction", [](const HomogenisedBody& h) { return ElasticConstants(h.by_traction); },
          "Its surface bears a uniform stress: never stiffer")
      .def_readonly("volume", &HomogenisedBody::volume)
      .def_readonly("density", &HomogenisedBody::density)
      .def_readonly("particles", &HomogenisedBody::particles)
      .def_readonly("bonds", &HomogenisedBody::bonds)
      .def_readonly("surface", &HomogenisedBody::surface, "Particles of the surface")
      .def_readonly("floating", &HomogenisedBody::floating, "Particles of other parts than the largest")
      .def_readonly("moved", &HomogenisedBody::moved, "Whether the body was not in balance as it was given")
      .def_readonly("solver", &HomogenisedBody::solver, "'direct' or 'multigrid'");
  m.def(
      "homogenise_body",
      [](const Snapshot& s, const std::optional<std::vector<std::int64_t>>& surface,
         std::optional<double> volume) {
        const Model& model = *s.model;
        const State& state = *s.state;
        std::vector<ParticleId> particles;
        for (const std::int64_t p : surface.value_or(std::vector<std::int64_t>{})) {
          if (p < 0 || p >= static_cast<std::int64_t>(model.particles()))
            throw py::value_error("homogenise_body: surface has the number " + std::to_string(p) +
                                  ", and there is no such particle");
          particles.emplace_back(static_cast<std::size_t>(p));
        }
        const WithoutLock others;
        return homogenise_body(
            model, state,
            surface ? surface_of(model, state, particles, volume ? *volume : volume_of_box(model, state))
                    : surface_of_box(model, state, volume));
      },
      "state"_a, "surface"_a, "volume"_a);
}

}  // namespace

void bind_elastic(py::module_& m) {
  using namespace py::literals;
  bind_constants(m);
  bind_sheets(m);
  bind_bodies(m);
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
