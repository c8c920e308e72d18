#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <span>
#include <variant>

#include "bindings.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/report/frame_read.hpp"
#include "vbond/report/history_read.hpp"

namespace vbond::python {
namespace {

namespace fs = std::filesystem;

template <class View>
py::array array_of(const FrameInput& in, FrameInput::Per per, const char* name, double (*)(const View&)) {
  return copy(in.scalars(per, name));
}
template <class View>
py::array array_of(const FrameInput& in, FrameInput::Per per, const char* name, Vec3d (*)(const View&)) {
  return copy(in.vectors(per, name));
}
template <class View>
py::array array_of(const FrameInput& in, FrameInput::Per per, const char* name,
                   std::int64_t (*)(const View&)) {
  return copy(in.integers(per, name));
}
template <class View>
py::array array_of(const FrameInput& in, FrameInput::Per per, const char* name,
                   std::uint8_t (*)(const View&)) {
  return copy(in.bytes(per, name));
}
template <class View>
py::array array_of(const FrameInput& in, FrameInput::Per per, const char* name, Image (*)(const View&)) {
  return copy(in.images(per, name));
}

/// The arrays of a file that the table names, as far as it has them.
template <class Quantity>
void add_arrays(const FrameInput& in, FrameInput::Per per, std::span<const Quantity> table, py::dict& to) {
  for (const Quantity& q : table)
    if (in.has(per, q.name))
      std::visit([&](const auto value) { to[q.name] = array_of(in, per, q.name, value); }, q.value);
}

py::dict read_particles(const fs::path& path) {
  const FrameInput in(path);
  py::dict arrays;
  arrays["position"] = copy(in.vectors(FrameInput::Per::point, "Points"));
  if (const auto& cell = in.cell()) {
    arrays["cell"] = copy(std::vector<Vec3d>(cell->edges.begin(), cell->edges.end()));
    arrays["cell_corner"] =
        py::array(copy(std::vector<double>{cell->corner.x, cell->corner.y, cell->corner.z}));
  }
  add_arrays(in, FrameInput::Per::point, particle_quantities(), arrays);
  return arrays;
}

py::dict read_bonds(const fs::path& path) {
  const FrameInput in(path);
  py::dict arrays;
  std::vector<std::int64_t> ends = in.integers(FrameInput::Per::end, "connectivity");
  if (in.has(FrameInput::Per::cell, "image_j")) {  // ends at images have points of their own
    const std::vector<std::int64_t> of = in.integers(FrameInput::Per::point, "particle");
    for (std::int64_t& end : ends) {
      if (end < 0 || static_cast<std::size_t>(end) >= of.size())
        throw IoError(path.string() + ": is damaged: a bond has impossible ends");
      end = of[static_cast<std::size_t>(end)];
    }
  }
  std::vector<std::int64_t> i, j;
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2) i.push_back(ends[k]), j.push_back(ends[k + 1]);
  arrays["i"] = copy(i), arrays["j"] = copy(j);
  add_arrays(in, FrameInput::Per::cell, bond_quantities(), arrays);
  return arrays;
}

py::list listed(const fs::path& pvd) {
  py::list frames;
  for (const ListedFrame& f : read_pvd(pvd)) frames.append(py::make_tuple(f.time, f.file));
  return frames;
}

py::dict read_table(const fs::path& path) {
  py::dict columns;
  for (const page::HistoryColumn& c : page::read_history(path).columns)
    columns[py::str(c.name)] = copy(c.values);
  return columns;
}

}  // namespace

void bind_files(py::module_& m) {
  using namespace py::literals;
  m.def("read_particles", &read_particles, "path"_a);
  m.def("read_bonds", &read_bonds, "path"_a);
  m.def("read_pvd", &listed, "path"_a);
  m.def("read_history", &read_table, "path"_a);
}

}  // namespace vbond::python
