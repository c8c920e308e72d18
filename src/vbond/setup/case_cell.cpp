#include "vbond/setup/case_cell.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "vbond/core/images.hpp"
#include "vbond/model/periodic_cell.hpp"

namespace vbond {
namespace {

/// After which distances a block repeats along x, y and z.
std::optional<std::array<double, 3>> period_of(const SpecimenSpec& spec) {
  if (!spec.cut.empty() || spec.turn || !spec.array.empty()) return std::nullopt;
  const auto times = [](double spacing, const auto& cells, const std::array<double, 3>& of_cell) {
    std::array<double, 3> period{};
    for (std::size_t k = 0; k < 3; ++k) period[k] = spacing * static_cast<double>(cells[k]) * of_cell[k];
    return period;
  };
  if (const auto* block = std::get_if<BlockSpecimen>(&spec.shape)) switch (block->lattice) {
      case Lattice::simple_cubic: return times(block->spacing, block->cells, {1.0, 1.0, 1.0});
      case Lattice::fcc:
        return times(block->spacing, block->cells, {std::sqrt(2.0), std::sqrt(2.0), std::sqrt(2.0)});
      case Lattice::hcp:
        return times(block->spacing, block->cells, {1.0, std::sqrt(3.0), std::sqrt(8.0 / 3.0)});
    }
  if (const auto* sheet = std::get_if<SheetSpecimen>(&spec.shape)) {
    const double row = sheet->lattice == SheetLattice::square ? 1.0 : std::sqrt(0.75);
    return times(sheet->spacing, std::array<std::int64_t, 3>{sheet->particles[0], sheet->particles[1], 0},
                 {1.0, row, 0.0});
  }
  return std::nullopt;
}

/// A lattice that is as large as the cell is meant to repeat with it.
void note_fit(const Case& c, Built& built) {
  for (const SpecimenSpec& spec : c.specimens) {
    const auto period = period_of(spec);
    if (!period) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& edge = built.model.cell.edges[k];
      const double along = component(edge, static_cast<int>(k)), misfit = std::abs(along - (*period)[k]);
      if (!built.model.cell.periodic[k] || (*period)[k] == 0.0 || misfit <= 1e-9 * along) continue;
      if (misfit > 0.5 * (*period)[k]) continue;  // it is not meant to fill the cell
      built.notes.push_back(
          fmt::format("specimen \"{}\" repeats after {:.9g} along {}, and edge {} of the cell is {:.9g} "
                      "long: the lattice has "
                      "a seam",
                      spec.name, (*period)[k], "xyz"[k], "abc"[k], along));
    }
  }
}

}  // namespace

void add_cell(const Case& c, Built& built, Problems& problems) {
  if (!c.cell) return;
  CellShape& cell = built.model.cell;
  cell.edges = c.cell->edges;
  cell.corner = c.cell->corner;
  cell.triangular = c.cell->triangular;
  for (std::size_t k = 0; k < 3; ++k) cell.periodic[k] = !c.cell->open[k];
  for (const std::string& mistake : mistakes_in_cell(built.model))
    problems.add(c.cell->place, mistake, "a cell is a parallelepiped with volume",
                 "write for example a = [10, 0, 0], b = [0, 10, 0], c = [0, 0, 10]");
  if (!problems.none()) return;
  built.state.cell = cell_at_start(built.model);
  for (const ParticleId p : built.model.r_0.ids()) {
    const SpecimenSpec& spec = c.specimens[built.model.specimen[p]];
    if (std::holds_alternative<LammpsSpecimen>(spec.shape)) continue;
    Vec3d& r = built.model.r_0[p];
    r += to_image(built.state.cell, image_in_cell(built.state.cell, cell.periodic, cell.corner, r));
  }
  note_fit(c, built);
}

WaveVectors waves_of(const StageSpec& s) {
  if (!s.wave_phases.empty()) return {s.wave_phases, true};
  return {s.wave_vectors, false};
}

namespace {

void check_waves(const Case& c, const StageSpec& s, Problems& problems) {
  const WaveVectors waves = waves_of(s);
  for (const Vec3d& q : waves.q)
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = waves.of_edges ? component(q, static_cast<int>(k)) : dot(q, c.cell->edges[k]);
      if (c.cell->open[k] && along != 0.0)
        problems.add(s.place,
                     fmt::format("stage \"{}\": a wave vector goes along the open edge {} of the cell",
                                 s.name, "abc"[k]),
                     "nothing repeats there", "let it be normal to that edge");
    }
}

}  // namespace

void check_periodic(const Case& c, Problems& problems) {
  if (!c.cell) {
    for (const StageSpec& s : c.stages) {
      if (s.cell)
        problems.add(s.place, fmt::format("stage \"{}\" moves the cell", s.name), "the case has no cell",
                     "add a table [cell] with its edges a, b and c");
      if (!waves_of(s).q.empty())
        problems.add(s.place, fmt::format("stage \"{}\" has wave vectors", s.name), "the case has no cell",
                     "add a table [cell] with its edges a, b and c");
    }
    return;
  }
  const auto refuse = [&problems](const SourcePlace& place, const std::string& what, const char* way_out) {
    problems.add(place, what, "a periodic body does not have this", way_out);
  };
  for (const BondSpec& b : c.bonds) {
    if (b.recipe.capsule)
      refuse(b.place, fmt::format("bonds \"{}\" touch as capsules", b.name), "leave capsule_radius out");
    if (b.when == BondTime::approach)
      refuse(b.place, fmt::format("bonds \"{}\" are made on approach", b.name),
             "use when = \"start\" or \"stage\"");
  }
  if (!c.walls.empty())
    refuse(c.cell->place, "the case has walls, which would end at the faces of the cell",
           "leave the walls out, or the table [cell]");
  if (c.watch.on_unphysical == OnUnphysical::drop)
    refuse(c.cell->place, "watch.on_unphysical = \"drop\"", "use \"stop\"");
  for (const StageSpec& s : c.stages) {
    if (s.strain)
      refuse(s.strain->place, fmt::format("stage \"{}\": strain", s.name),
             "move the cell: cell.xx = { rate = 1e-3 }");
    check_waves(c, s, problems);
    const auto gives_way = [](const std::optional<CellComponentSpec>& k) { return k && k->stress; };
    if (s.kind == StageKind::buckling && s.cell && waves_of(s).q.empty() &&
        std::any_of(s.cell->component.begin(), s.cell->component.end(), gives_way))
      problems.add(
          s.place, fmt::format("stage \"{}\": components of the cell give way to a stress", s.name),
          "a stress on a cell that strains has no potential: critical loads of what repeats with the "
          "cell are those of a cell that is strained",
          "give strains, or wave_vectors: critical loads of waves are found under stresses too");
    if (!s.cell) continue;
    for (const SupportSpec& support : s.supports)
      refuse(support.place,
             fmt::format("stage \"{}\": a support, which stands still while the cell moves", s.name),
             "leave it out: the cell itself holds the body");
    if (!s.loads.empty() || !(s.gravity == Vec3d{}))
      refuse(s.place, fmt::format("stage \"{}\": loads or gravity on a body whose cell moves", s.name),
             "load the body by the stress of the cell");
    const std::array<bool, 3> open = c.cell->open;
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (s.cell->component[k] && open[axis])
          for (int world = 0; world < 3; ++world)
            if (component(c.cell->edges[axis], world) != 0.0 &&
                (cell_component_axes[k][0] == world || cell_component_axes[k][1] == world))
              problems.add(s.cell->component[k]->place,
                           fmt::format("stage \"{}\": cell.{}", s.name, cell_component_names[k]),
                           fmt::format("the body is open along {}", "xyz"[world]),
                           "leave it out: nothing repeats there, and there is no stress");
  }
}

}  // namespace vbond
