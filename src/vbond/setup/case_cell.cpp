#include "vbond/setup/case_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/names.hpp"
#include "vbond/core/images.hpp"
#include "vbond/model/passage.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/model/torn.hpp"

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
      case Lattice::bcc: {
        const double cell = 2.0 / std::sqrt(3.0);
        return times(block->spacing, block->cells, {cell, cell, cell});
      }
      case Lattice::hcp:
        return times(block->spacing, block->cells, {1.0, std::sqrt(3.0), std::sqrt(8.0 / 3.0)});
    }
  if (const auto* sheet = std::get_if<SheetSpecimen>(&spec.shape);
      sheet != nullptr && sheet->lattice != SheetLattice::random) {
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

/// The edges and the corner of the cell: those of the case, or those of the box of a file.
std::optional<FileBox> box_of_case(const CellSpec& cell, const std::vector<PlacedSpecimen>& specimens,
                                   Problems& problems) {
  if (!cell.from_specimen) return FileBox{cell.edges, cell.corner};
  const std::string& name = cell.from_specimen->value;
  const SourcePlace& place = cell.from_specimen->place;
  const auto refuse = [&](const std::string& what, const std::string& rule, const std::string& way_out) {
    problems.add(place, fmt::format("cell.from_specimen = \"{}\"{}", name, what), rule, way_out);
    return std::nullopt;
  };
  const auto found = std::find_if(specimens.begin(), specimens.end(),
                                  [&](const PlacedSpecimen& s) { return s.spec->name == name; });
  if (found == specimens.end()) {
    std::vector<std::string> names;
    for (const PlacedSpecimen& s : specimens) names.push_back(s.spec->name);
    return refuse("", "there is no such specimen", "the specimens are " + keys::join(names));
  }
  const auto* of_file = std::get_if<LammpsSpecimen>(&found->spec->shape);
  if (!of_file)
    return refuse(": this specimen is no LAMMPS data file", "the box of such a file is meant",
                  "give a, b and c instead");
  if (!found->points.box)
    return refuse(fmt::format(": {} gives no box with volume", of_file->file.value.string()),
                  "a box has lines that end in xlo xhi, ylo yhi and zlo zhi, or in avec, bvec, cvec and abc "
                  "origin",
                  "complete the header of the file, or give a, b and c instead");
  if (!found->spec->array.empty())
    return refuse(": the array of this specimen has more than fits into the box of its file",
                  "the box is that of one copy", "leave out the array, or give a, b and c instead");
  return found->points.box;
}

void refuse_mistakes_in_cell(const CellSpec& cell, const Model& model, Problems& problems) {
  for (const std::string& mistake : mistakes_in_cell(model))
    problems.add(cell.place, mistake, "a cell is a parallelepiped with volume",
                 "write for example a = [10, 0, 0], b = [0, 10, 0], c = [0, 0, 10]");
}

/// Image flags are counted in the box of their file, which is meant to be the cell.
void note_other_boxes(const std::vector<PlacedSpecimen>& specimens, Built& built) {
  const std::array<Vec3d, 3>& cell = built.model.cell.edges;
  for (const PlacedSpecimen& s : specimens) {
    if (!s.points.box) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& edge = s.points.box->edges[k];
      if (!built.model.cell.periodic[k] || norm(edge - cell[k]) <= 1e-9 * norm(cell[k])) continue;
      built.notes.push_back(fmt::format(
          "specimen \"{}\": edge {} of the box of its file is [{:.9g}, {:.9g}, {:.9g}], that of the cell is "
          "[{:.9g}, {:.9g}, {:.9g}]; cell.from_specimen takes the box",
          s.spec->name, "abc"[k], edge.x, edge.y, edge.z, cell[k].x, cell[k].y, cell[k].z));
      break;
    }
  }
}

}  // namespace

FileBox cell_of_case(const Case& c) {
  Problems problems;
  std::vector<PlacedSpecimen> with_box;
  if (c.cell->from_specimen)
    for (const SpecimenSpec& spec : c.specimens) {
      const bool meant = spec.name == c.cell->from_specimen->value;
      with_box.push_back({&spec, 0, {}});
      if (meant && std::holds_alternative<LammpsSpecimen>(spec.shape))
        with_box.back().points = make_specimen(spec, c);
    }
  const std::optional<FileBox> box = box_of_case(*c.cell, with_box, problems);
  problems.throw_if_any();
  Model model;
  model.cell.edges = box->edges;
  model.cell.corner = box->corner;
  for (std::size_t k = 0; k < 3; ++k) model.cell.periodic[k] = !c.cell->open[k];
  refuse_mistakes_in_cell(*c.cell, model, problems);
  problems.throw_if_any();
  return *box;
}

void add_cell(const Case& c, const std::vector<PlacedSpecimen>& specimens, Built& built, Problems& problems) {
  if (!c.cell) return;
  const std::optional<FileBox> box = box_of_case(*c.cell, specimens, problems);
  if (!box) return;
  CellShape& cell = built.model.cell;
  cell.edges = box->edges;
  cell.corner = box->corner;
  cell.triangular = c.cell->triangular;
  for (std::size_t k = 0; k < 3; ++k) cell.periodic[k] = !c.cell->open[k];
  refuse_mistakes_in_cell(*c.cell, built.model, problems);
  if (!problems.none()) return;
  built.state.cell = cell_at_start(built.model);
  for (const ParticleId p : built.model.r_0.ids()) {
    const SpecimenSpec& spec = c.specimens[built.model.specimen[p]];
    if (std::holds_alternative<LammpsSpecimen>(spec.shape) || comes_in(built.model, p)) continue;
    Vec3d& r = built.model.r_0[p];
    r += to_image(built.state.cell, image_in_cell(built.state.cell, cell.periodic, cell.corner, r));
  }
  note_fit(c, built);
  note_other_boxes(specimens, built);
}

namespace {

/// Whether members of the group that one specimen has made stand apart by more or less than where it made
/// them.
const SpecimenSpec* specimen_in_pieces(const Group& group, const std::vector<PlacedSpecimen>& specimens,
                                       const Model& model) {
  std::vector<std::optional<Vec3d>> brought(specimens.size());
  for (const ParticleId p : group.particles) {
    if (comes_in(model, p)) continue;
    const PlacedSpecimen& s = specimens[model.specimen[p]];
    const Vec3d by = between(s.points.r[p.value - s.first], model.r_0[p]);
    std::optional<Vec3d>& first = brought[model.specimen[p]];
    if (!first) first = by;
    constexpr double rounding = 1e-6;  // of an edge
    for (const Vec3d& edge : model.cell.edges)
      if (std::abs(dot(by - *first, edge)) > rounding * norm2(edge)) return s.spec;
  }
  return nullptr;
}

void refuse_torn(const SourcePlace& place, const std::string& who, const std::string& how,
                 Problems& problems) {
  problems.add(place, fmt::format("{}, and {}", who, how), torn_rule, way_out_of_torn);
}
std::string in_words(const Bond& b) {
  return fmt::format("a bond joins its particles {} and {} through a face of the cell", b.i.value, b.j.value);
}
std::string in_words(const SpecimenSpec& cut) {
  return fmt::format("a face of the cell cuts specimen \"{}\"", cut.name);
}
std::string turning(const StageSpec& stage, const SupportSpec& s) {
  return fmt::format("stage \"{}\": the rigid support of group \"{}\" turns it, or lets it turn", stage.name,
                     s.group.value);
}

}  // namespace

void check_turned_pieces(const Case& c, const std::vector<PlacedSpecimen>& specimens, const Built& built,
                         Problems& problems) {
  if (!c.cell) return;
  const auto group = [&](const Placed<std::string>& name) {
    const Group* known = built.model.find_group(name.value);
    return known == nullptr ? Group{} : *known;
  };
  for (const VelocitySpec& v : c.velocities) {
    if (v.kind != VelocityKind::rigid || v.angular_velocity == Vec3d{}) continue;
    const Group turned = group(v.group);
    const std::string who = fmt::format("velocities of kind \"rigid\" turn group \"{}\"", v.group.value);
    if (const SpecimenSpec* cut = specimen_in_pieces(turned, specimens, built.model))
      refuse_torn(v.place, who, in_words(*cut), problems);
    else if (const Bond* b = bond_through_face(built.state, turned.particles))
      refuse_torn(v.place, who, in_words(*b), problems);
  }
  for (const StageSpec& stage : c.stages)
    for (const SupportSpec& s : stage.supports) {
      Support turns;
      turns.rigid = s.rigid, turns.held = directions_of(s).held;
      turns.angular_velocity = is_static(stage.kind) ? s.rotation : s.angular_velocity;
      if (!turns_as_one(turns)) continue;
      if (const SpecimenSpec* cut = specimen_in_pieces(group(s.group), specimens, built.model))
        refuse_torn(s.place, turning(stage, s), in_words(*cut), problems);
    }
}

void refuse_turned_through_face(const StageSpec& spec, const std::vector<Support>& supports,
                                const State& state, bool ahead, Problems& problems) {
  for (std::size_t k = 0; k < supports.size(); ++k)
    if (const Bond* b =
            turns_as_one(supports[k]) ? bond_through_face(state, supports[k].particles, ahead) : nullptr)
      refuse_torn(spec.supports[k].place, turning(spec, spec.supports[k]), in_words(*b), problems);
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

void check_periodic(const Case& c, const Model& model, Problems& problems) {
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
    if (!c.walls.empty())
      refuse(s.place, fmt::format("stage \"{}\": walls, which stand still while the cell moves", s.name),
             "move the walls in a cell that stands still, or leave them out");
    if (!s.loads.empty() || !(s.gravity == Vec3d{}))
      refuse(s.place, fmt::format("stage \"{}\": loads or gravity on a body whose cell moves", s.name),
             "load the body by the stress of the cell");
    const std::array<bool, 3> open = c.cell->open;
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (s.cell->component[k] && open[axis])
          for (int world = 0; world < 3; ++world)
            if (component(model.cell.edges[axis], world) != 0.0 &&
                (cell_component_axes[k][0] == world || cell_component_axes[k][1] == world))
              problems.add(s.cell->component[k]->place,
                           fmt::format("stage \"{}\": cell.{}", s.name, cell_component_names[k]),
                           fmt::format("the body is open along {}", "xyz"[world]),
                           "leave it out: nothing repeats there, and there is no stress");
  }
}

}  // namespace vbond
