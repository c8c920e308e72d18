#include "vbond/setup/fibres/fibre_vessel.hpp"

#include <fmt/format.h>

#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/setup/case_cell.hpp"

namespace vbond {
namespace {

FibreVessel box_vessel(const FibreBox& box, const std::array<Face, 3>& faces) {
  const Vec3d size = box.max - box.min;
  return {{Vec3d{size.x, 0, 0}, Vec3d{0, size.y, 0}, Vec3d{0, 0, size.z}}, box.min, faces};
}

/// The cell, whose edges may be those of the box of another specimen's file.
FibreVessel cell_vessel(const SpecimenSpec& spec, const Case& c) {
  if (spec.turn || !spec.array.empty())
    refuse_fibres(spec.place, spec, "fibres that fill a cell are turned or copied",
                  "what is turned or copied no longer goes on through the faces of the cell",
                  "leave out turn and array, or give the fibres a box");
  const FileBox box = cell_of_case(c);
  FibreVessel vessel{box.edges, box.corner, {}};
  for (std::size_t k = 0; k < 3; ++k) vessel.faces[k] = c.cell->open[k] ? Face::whole : Face::through;
  return vessel;
}

}  // namespace

void refuse_fibres(const SourcePlace& place, const SpecimenSpec& spec, const std::string& what,
                   const std::string& rule, const std::string& way_out) {
  throw CaseError({place, fmt::format("specimen \"{}\": {}", spec.name, what), rule, way_out});
}

FibreVessel vessel_of(const SpecimenSpec& spec, const FibresSpecimen& s, const Case& c) {
  if (!s.box && !s.layer) {
    if (c.cell) return cell_vessel(spec, c);
    refuse_fibres(spec.place, spec, "there is no place for the fibres",
                  "they fill a box, a layer, or the cell",
                  "add box = { min = [0, 0, 0], max = [10, 10, 10] }, layer = { ... }, or a table [cell]");
  }
  if (s.layer) {
    if (c.cell)
      refuse_fibres(spec.place, spec, "a layer in a case with a cell",
                    "fibres stick out of a layer, and would meet images of others",
                    "leave layer out: the cell is filled, along an edge that is open as a layer");
    return box_vessel(*s.layer, {Face::middle, Face::middle, Face::whole});
  }
  FibreVessel vessel = box_vessel(*s.box, {Face::whole, Face::whole, Face::whole});
  if (!c.cell) return vessel;
  const FileBox box = cell_of_case(c);
  CellEdges cell;
  for (const Vec3d& edge : box.edges) cell.push_back({edge});
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d r = s.box->min;
    for (int k = 0; k < 3; ++k)
      if (corner >> k & 1) component(r, k) = component(s.box->max, k);
    const Vec3d in = in_edges(cell, r - box.corner);
    for (int k = 0; k < 3; ++k)
      if (!c.cell->open[static_cast<std::size_t>(k)] &&
          (component(in, k) < -1e-9 || component(in, k) > 1.0 + 1e-9))
        refuse_fibres(spec.place, spec, "the box reaches beyond the cell",
                      "its fibres would meet images of others",
                      "make it smaller, or leave it out: the cell is filled");
  }
  return vessel;
}

}  // namespace vbond
