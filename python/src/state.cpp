#include <fmt/format.h>

#include <string>
#include <type_traits>
#include <variant>

#include "bindings.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/observe/detail/values_of.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond::python {
namespace {

template <class T>
constexpr int numbers_each = sizeof(T) / sizeof(double);

/// Columns of particles that have a name in Python, as views that keep the snapshot alive.
template <class Class>
void bind_columns(Class& type) {
  for_each_table(state_table, [&](const auto& table) {
    for_each_field(table, [&]<class Of, class Value, class Member>(const Field<Of, Value, Member>& f) {
      if constexpr (is_particle_column<Value>) {
        if (f.traits.word == nullptr) return;
        constexpr int each = numbers_each<std::remove_cvref_t<decltype(*Value{}.data())>>;
        const auto array = [table, f](const py::object& self) {
          const Value& values = table.in(*self.cast<const Snapshot&>().state).*f.value;
          return view(reinterpret_cast<const double*>(values.data()), values.size(), each, self);
        };
        const std::string shape = each == 1 ? "(n,)" : fmt::format("(n, {})", each);
        const std::string unit =
            *f.unit.si == '\0' ? ""
                               : fmt::format(" [{} in SI, {} in reduced units]", f.unit.si, f.unit.reduced);
        type.def_property_readonly(f.traits.word, array, (f.meaning + (", " + shape) + unit).c_str());
      }
    });
  });
}

template <class Value>
py::array bond_column(const State& s, Value value) {
  std::vector<decltype(value(Bond{}))> values;
  values.reserve(s.bonds.size());
  for (const Bond& b : s.bonds) values.push_back(value(b));
  return copy(values);
}

py::dict bonds_of(const Snapshot& snapshot) {
  const State& s = *snapshot.state;
  py::dict columns;
  columns["i"] = bond_column(s, [](const Bond& b) { return std::int64_t{b.i.value}; });
  columns["j"] = bond_column(s, [](const Bond& b) { return std::int64_t{b.j.value}; });
  columns["length_at_rest"] = bond_column(s, [](const Bond& b) { return b.a; });
  columns["broken"] =
      py::array(bond_column(s, [](const Bond& b) { return std::uint8_t{b.broken}; })).attr("astype")("bool");
  std::vector<BondView> views;
  views.reserve(s.bonds.size());
  for (const BondId k : s.bonds.ids()) views.push_back(bond_view(k, s, true));
  const auto at = [&views](std::size_t k) -> const BondView& { return views[k]; };
  for (const BondQuantity& q : bond_quantities())
    if (!columns.contains(q.name) && (q.cases != Only::cell || !s.cell.empty()))
      std::visit([&](const auto value) { columns[q.name] = copy(values_of(views.size(), at, value)); },
                 q.value);
  return columns;
}

py::dict contacts_of(const Snapshot& snapshot) {
  std::vector<std::int64_t> first, second;
  std::vector<Image> images;
  std::vector<double> overlaps;
  for_touching_pairs(*snapshot.model, *snapshot.state,
                     [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
                       first.push_back(i.value), second.push_back(j.value), overlaps.push_back(overlap);
                       images.push_back(n);
                     });
  py::dict columns;
  columns["i"] = copy(first), columns["j"] = copy(second), columns["overlap"] = copy(overlaps);
  if (!snapshot.state->cell.empty()) columns["image_j"] = copy(images);
  return columns;
}

/// Of the three edges of a cell, a row for each; None without one.
py::object of_edges(const Snapshot& s, Vec3d CellEdge::*what) {
  if (s.state->cell.empty()) return py::none();
  std::vector<Vec3d> rows;
  for (const CellEdge& edge : s.state->cell) rows.push_back(edge.*what);
  return copy(rows);
}

}  // namespace

void bind_state(py::module_& m) {
  py::class_<Snapshot> type(
      m, "State",
      "The body at one time. Its arrays are views without a copy, cannot be written to, and stay as "
      "they are whatever the run does. Particles and bonds are numbered from 0, as in the case.");
  bind_columns(type);
  type.def_property_readonly(
          "displacements",
          [](const Snapshot& s) {
            std::vector<Vec3d> u;
            for (const ParticleId p : s.state->r.ids())
              u.push_back(s.state->r[p] - first_place(*s.model, *s.state, p));
            return copy(u);
          },
          "positions less those at the start of the run, or as a body came in, (n, 3) [length]; worked out "
          "at each call")
      .def_property_readonly(
          "masses",
          [](const py::object& self) {
            const auto& mass = self.cast<const Snapshot&>().model->mass;
            return view(mass.data(), mass.size(), 1, self);
          },
          "(n,) [mass]")
      .def_property_readonly(
          "radii",
          [](const py::object& self) {
            const auto& radius = self.cast<const Snapshot&>().model->radius;
            return view(radius.data(), radius.size(), 1, self);
          },
          "(n,) [length]")
      .def_property_readonly(
          "there",
          [](const Snapshot& s) {
            std::vector<std::uint8_t> there;
            for (const ParticleId p : s.state->r.ids()) there.push_back(!is_absent(*s.state, p));
            return py::array(copy(there)).attr("astype")("bool");
          },
          "Which particles are there, (n,): not those whose body has not come in yet, and not those that a "
          "sink "
          "has taken or that were dropped. Numbers of the others mean nothing")
      .def_property_readonly(
          "time", [](const Snapshot& s) { return s.state->clock.time(); }, "Of the run [time]")
      .def_property_readonly(
          "step", [](const Snapshot& s) { return s.state->clock.step; }, "Steps since the start of the run")
      .def_property_readonly(
          "groups",
          [](const Snapshot& s) {
            py::dict groups;
            for (const Group& g : s.model->groups) {
              std::vector<std::int64_t> particles;
              for (const ParticleId p : g.particles) particles.push_back(p.value);
              groups[py::str(g.name)] = copy(particles);
            }
            return groups;
          },
          "Particles of each group of the case, by its name")
      .def_property_readonly(
          "bonds", &bonds_of,
          "Columns of all bonds, also of broken ones, as a dict of arrays (m,): particles i and j, "
          "length_at_rest, broken, and all that frames have (docs/output.md): axial_force, "
          "shear_force, bending_moment, torque, U_L, ... Of a periodic body also image_j (m, 3): the bond "
          "joins "
          "i with the image of j that is image_j @ cell away from j. Worked out at each call")
      .def_property_readonly(
          "contacts", &contacts_of,
          "Columns of the pairs of particles that repel each other, as a dict of arrays (c,): particles "
          "i < j and the overlap that they feel [length]; of a periodic body image_j (c, 3) as in bonds. "
          "Without walls and capsules. Worked out at each call")
      .def_property_readonly(
          "cell", [](const Snapshot& s) { return of_edges(s, &CellEdge::along); },
          "Edges a, b and c of the cell of a periodic body, (3, 3), an edge in each row [length]; None if it "
          "is "
          "not periodic")
      .def_property_readonly(
          "cell_rates", [](const Snapshot& s) { return of_edges(s, &CellEdge::rate); },
          "How these edges changed in the last step, (3, 3) [velocity]; or None")
      .def_property_readonly(
          "cell_stress",
          [](const Snapshot& s) -> py::object {
            if (s.state->cell.empty()) return py::none();
            const auto& row = cell_stress(*s.model, *s.state).row;
            return copy(std::vector<Vec3d>(row.begin(), row.end()));
          },
          "Cauchy's stress of a periodic body, (3, 3), tension > 0, as in history.csv but for its part that "
          "is "
          "not symmetric [stress]; or None. Worked out at each call")
      .def("__len__", [](const Snapshot& s) { return s.model->particles(); })
      .def("__repr__", [](const Snapshot& s) {
        return "<vbond.State: " + std::to_string(s.model->particles()) + " particles, " +
               std::to_string(s.state->bonds.size()) + " bonds, step " + std::to_string(s.state->clock.step) +
               ">";
      });
}

}  // namespace vbond::python
