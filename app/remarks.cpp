#include "remarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/disjoint_sets.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {
namespace {

using Lines = std::vector<std::string>;

double length_of(const Bond& b, const State& state) {
  return norm(between(state, b));
}

PerParticle<std::size_t> bonds_of_particles(const Model& model, const State& state) {
  PerParticle<std::size_t> n;
  n.resize(model.particles());
  for (const Bond& b : state.bonds) ++n[b.i], ++n[b.j];
  return n;
}

/// Centres of the longest bond of each set against the median of that set.
void compare_lengths(const Case& c, const State& state, Lines& lines) {
  constexpr double striking = 3.0;
  for (std::uint32_t set = 0; set < c.bonds.size(); ++set) {
    std::vector<double> lengths;
    const Bond* longest = nullptr;
    for (const Bond& b : state.bonds) {
      if (b.set != set) continue;
      lengths.push_back(length_of(b, state));
      if (longest == nullptr || lengths.back() > length_of(*longest, state)) longest = &b;
    }
    if (longest == nullptr) continue;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    const double most = length_of(*longest, state);
    if (most > striking * *middle)
      lines.push_back(
          fmt::format("bonds \"{}\": the longest, of particles {} and {}, joins centres {:.6g} apart, {:.3g} "
                      "times the median {:.6g}",
                      c.bonds[set].name, longest->i.value, longest->j.value, most, most / *middle, *middle));
  }
}

/// The particles of the specimens, in their order.
struct Range {
  std::size_t first = 0, count = 0;
};

std::vector<Range> ranges_of_specimens(const Case& c, const Model& model) {
  std::vector<Range> ranges(c.specimens.size());
  for (const ParticleId p : model.specimen.ids()) {
    bool is_copy = false;  // of a body that comes in; they stand behind all specimens
    for (const Source& source : model.sources) is_copy = is_copy || source.body_of(p).value_or(0) > 0;
    if (!is_copy) ++ranges[model.specimen[p]].count;
  }
  for (std::size_t s = 1; s < ranges.size(); ++s) ranges[s].first = ranges[s - 1].first + ranges[s - 1].count;
  return ranges;
}

void find_unbonded(const Case& c, const Model& model, const PerParticle<std::size_t>& bonds, Lines& lines) {
  const std::vector<Range> ranges = ranges_of_specimens(c, model);
  for (std::size_t s = 0; s < ranges.size(); ++s) {
    std::size_t loose = 0, first = 0;
    for (std::size_t k = ranges[s].count; k-- > 0;)
      if (bonds[ParticleId{ranges[s].first + k}] == 0) ++loose, first = ranges[s].first + k;
    if (loose > 0 && loose < ranges[s].count)
      lines.push_back(fmt::format("specimen \"{}\": {} of its {} particles have no bond, the first is {}",
                                  c.specimens[s].name, loose, ranges[s].count, first));
  }
}

/// Whether pairs of numbers were written down, which may have been counted from 1.
bool lists_pairs(const BondSpec& b) {
  return std::holds_alternative<PairsFile>(b.select.value) ||
         std::holds_alternative<ListedPairs>(b.select.value);
}

void find_pairs_from_one(const Case& c, const Model& model, const PerParticle<std::size_t>& bonds,
                         Lines& lines) {
  const bool listed = std::any_of(c.bonds.begin(), c.bonds.end(), lists_pairs);
  const std::vector<Range> ranges = ranges_of_specimens(c, model);
  for (std::size_t s = 0; s < ranges.size(); ++s) {
    const auto* csv = std::get_if<CsvSpecimen>(&c.specimens[s].shape);
    const bool has_file = csv && csv->bonds_file;
    if (ranges[s].count < 2 || (!has_file && (!listed || s > 0))) continue;
    const std::size_t first = ranges[s].first;
    if (bonds[ParticleId{first}] == 0 && bonds[ParticleId{first + 1}] > 0)
      lines.push_back(
          fmt::format("specimen \"{}\": no pair names particle {}, the first, and it has no bond: do the "
                      "pairs count from 1? they must count from 0",
                      c.specimens[s].name, has_file ? 0 : first));
  }
}

void compare_meshes(const Case& c, const Model& model, const State& state, Lines& lines) {
  constexpr double striking = 100.0;
  BoundingBox body;
  for (const ParticleId p : state.r.ids()) body.add(state.r[p], model.radius[p]);
  const double size = body.diagonal();
  for (std::size_t w = 0; w < std::min(c.walls.size(), model.walls.size()); ++w) {
    const auto* spec = std::get_if<MeshWallSpec>(&c.walls[w].shape);
    const auto* mesh = std::get_if<MeshWall>(&model.walls[w].shape);
    if (!spec || !mesh || !(size > 0.0)) continue;
    const double extent = box_around(mesh->mesh.corners).diagonal();
    if (extent < striking * size && size < striking * extent) continue;
    lines.push_back(
        fmt::format("wall \"{}\": its mesh is {:.3g} from corner to corner, the body {:.3g}; it has scale = "
                    "{:g}: is that right? 0.001 turns millimetres into metres",
                    model.walls[w].name, extent, size, spec->scale));
  }
}

/// The section of the bonds of a set, if it is given and that of bars between centres.
const Section* section_of(const BondSpec& b) {
  const auto* theory = std::get_if<TheoryParameters>(&b.recipe.parameters);
  return theory && theory->theory != BondTheory::parallel ? &theory->section : nullptr;
}

/// Chains of spheres of a density, against the bars between their centres.
void compare_masses(const Case& c, const Model& model, const State& state,
                    const PerParticle<std::size_t>& bonds, Lines& lines) {
  constexpr double striking = 0.2, striking_of_overlaps = 0.05;  // which count twice what they share
  const std::vector<Range> ranges = ranges_of_specimens(c, model);
  for (std::size_t s = 0; s < ranges.size(); ++s) {
    if (!c.specimens[s].density || c.specimens[s].thickness ||
        std::holds_alternative<FibresSpecimen>(c.specimens[s].shape))
      continue;
    double beads = 0.0, heaviest = 0.0, volume = 0.0;
    bool chain = true, overlap = false;
    for (std::size_t k = 0; k < ranges[s].count; ++k) {
      const ParticleId p{ranges[s].first + k};
      beads += model.mass[p], heaviest = std::max(heaviest, model.mass[p]);
      chain &= bonds[p] == 1 || bonds[p] == 2;
    }
    for (const Bond& b : state.bonds) {
      if (model.specimen[b.i] != s && model.specimen[b.j] != s) continue;
      const Section* section = section_of(c.bonds[b.set]);
      chain &= model.specimen[b.i] == model.specimen[b.j] && section != nullptr;
      if (!chain) break;
      volume += section->A * length_of(b, state);
      overlap |= length_of(b, state) < 0.99 * (model.radius[b.i] + model.radius[b.j]);
    }
    const double bars = *c.specimens[s].density * volume;
    if (!chain || !(bars > 0.0)) continue;
    if (std::abs(beads / bars - 1.0) < (overlap ? striking_of_overlaps : striking)) continue;
    const char* kg = model.units == UnitSystem::si ? " kg" : "";
    lines.push_back(fmt::format(
        "specimen \"{}\": its {}spheres weigh {:.6g}{}, the bars of its bonds {:.6g}{} "
        "(density times section times length), {:+.0f} %; mass = {:.6g} in place of density would "
        "give the weight of the bars",
        c.specimens[s].name, overlap ? "overlapping " : "", beads, kg, bars, kg, 100.0 * (beads / bars - 1.0),
        std::holds_alternative<RodSpecimen>(c.specimens[s].shape)
            ? bars * heaviest / beads  // ends may have half of it
            : bars / static_cast<double>(ranges[s].count)));
  }
}

/// A restitution asks for damping at each contact, by the mass of the whole clump.
void find_clumps_that_damp(const Case& c, const Model& model, Lines& lines) {
  const auto materials = static_cast<std::uint32_t>(std::max<std::size_t>(1, model.materials.size()));
  bool damps = false;
  for (std::uint32_t a = 0; a < materials; ++a)
    for (std::uint32_t b = 0; b <= a; ++b)
      damps = damps || touch_numbers(model.contact, model.materials, b, a).damping > 0.0;
  const auto is_clump = [](const SupportSpec& s) {
    const auto held = std::count(s.held.begin(), s.held.begin() + 3, true);
    return s.rigid && static_cast<std::size_t>(held) + s.along.size() < 3;
  };
  for (const StageSpec& stage : c.stages) {
    if (!damps || is_static(stage.kind)) continue;
    if (std::none_of(stage.supports.begin(), stage.supports.end(), is_clump)) continue;
    lines.push_back(
        "a restitution is met where a rigid group that is free touches at one place; at n places alike "
        "at once it is damped sqrt(n) times as much (docs/contacts.md, which mass counts)");
    return;
  }
}

/// Whether a support of the stage holds one of the particle's translations.
bool stage_holds(const StageSpec& stage, const Model& model, ParticleId p) {
  return std::any_of(stage.supports.begin(), stage.supports.end(), [&](const SupportSpec& s) {
    const bool any =
        !s.along.empty() || std::find(s.held.begin(), s.held.begin() + 3, true) != s.held.begin() + 3;
    const auto groups = resolve_groups({s.group}, model);
    return any &&
           std::find(groups[0].particles.begin(), groups[0].particles.end(), p) != groups[0].particles.end();
  });
}

/// Ends of rods that swing freely carry whole beads, so that frequencies are too low.
void find_whole_ends(const Case& c, const Model& model, const PerParticle<std::size_t>& bonds, Lines& lines) {
  constexpr double striking = 0.01;  // of a frequency
  const auto stage = std::find_if(c.stages.begin(), c.stages.end(),
                                  [](const StageSpec& s) { return s.kind == StageKind::modes; });
  if (stage == c.stages.end()) return;
  const std::vector<Range> ranges = ranges_of_specimens(c, model);
  for (std::size_t s = 0; s < ranges.size(); ++s) {
    const auto* rod = std::get_if<RodSpecimen>(&c.specimens[s].shape);
    if (!rod || rod->half_ends) continue;
    const std::size_t length = ranges[s].count - 1;
    int free = 0;
    for (const std::size_t k : {std::size_t{0}, length})
      if (const ParticleId p{ranges[s].first + k}; bonds[p] == 1 && !stage_holds(*stage, model, p)) ++free;
    const double error = free / static_cast<double>(length);
    if (error < striking) continue;
    lines.push_back(
        fmt::format("specimen \"{}\": {} whole bead{} of its {} bonds, a bar half of one: "
                    "the lowest frequencies are some {:.2g} % too low; half_ends = true mends that",
                    c.specimens[s].name, free == 1 ? "its free end carries a" : "its free ends carry",
                    free == 1 ? "" : "s", length, 100.0 * error));
  }
}

/// Bonds along the free edges of a strip that are as stiff as those within.
void find_stiff_edges(const Case& c, const Model& model, const State& state, Lines& lines) {
  constexpr double striking = 0.02;  // of the stiffness of a strip
  if (c.specimens.size() != 1 || model.cell.any()) return;
  const auto* sheet = std::get_if<SheetSpecimen>(&c.specimens[0].shape);
  if (!sheet || sheet->lattice != SheetLattice::triangular) return;
  const auto along_edge = [](const Bond& b) { return b.i.value == 0 && b.j.value == 1; };
  const auto b = std::find_if(state.bonds.begin(), state.bonds.end(), along_edge);
  if (b == state.bonds.end()) return;
  const BondRecipe& recipe = c.bonds[b->set].recipe;
  const auto* theory = std::get_if<TheoryParameters>(&recipe.parameters);
  if (!theory || theory->theory != BondTheory::shell || recipe.factors.c_A != 1.0) return;
  const std::int64_t rows = sheet->particles[1];
  if (rows < 2) return;
  const double error = 2.0 / (3.0 * (1.0 - theory->material.nu) * static_cast<double>(rows - 1));
  if (error < striking) return;
  lines.push_back(fmt::format(
      "specimen \"{}\": bonds of a free edge have their whole stiffness, which makes a strip of {} "
      "rows {:.2g} % too stiff along them; half of it there mends that (docs/specimens.md, edges "
      "of a strip)",
      c.specimens[0].name, rows, 100.0 * error));
}

}  // namespace

std::vector<std::string> remarks(const Case& c, const Model& model, const State& state) {
  Lines lines;
  compare_meshes(c, model, state, lines);
  find_clumps_that_damp(c, model, lines);
  if (state.bonds.empty()) return lines;
  const PerParticle<std::size_t> bonds = bonds_of_particles(model, state);
  compare_lengths(c, state, lines);
  compare_masses(c, model, state, bonds, lines);
  const auto later = [](const BondSpec& b) { return b.when != BondTime::start; };
  if (std::any_of(c.bonds.begin(), c.bonds.end(), later)) return lines;  // which may join the others
  find_whole_ends(c, model, bonds, lines);
  find_stiff_edges(c, model, state, lines);
  find_unbonded(c, model, bonds, lines);
  find_pairs_from_one(c, model, bonds, lines);
  return lines;
}

std::string bodies_in_words(const Model& model, const State& state) {
  DisjointSets<ParticleId> sets(model.particles());
  for (const Bond& b : state.bonds) sets.join(b.i, b.j);
  PerParticle<std::size_t> size;
  size.resize(model.particles());
  for (const ParticleId p : size.ids()) ++size[sets.smallest(p)];
  std::size_t bodies = 0, single = 0, smallest = model.particles(), largest = 0;
  for (const std::size_t n : size) {
    if (n == 0) continue;
    single += n == 1;
    if (n == 1) continue;
    ++bodies, smallest = std::min(smallest, n), largest = std::max(largest, n);
  }
  if (bodies == 0 || (bodies == 1 && single == 0)) return {};
  std::string text = fmt::format("{}, ", bodies);
  text += bodies == 1           ? fmt::format("of {} particles", largest)
          : smallest == largest ? fmt::format("of {} particles each", largest)
                                : fmt::format("of {} to {} particles", smallest, largest);
  if (single > 0) text += fmt::format("; {} bonded to none", single);
  return text;
}

}  // namespace vbond::app
