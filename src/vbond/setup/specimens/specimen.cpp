#include "vbond/setup/specimens/specimen.hpp"

#include <fmt/format.h>

#include "vbond/setup/fibres/fibres.hpp"
#include "vbond/setup/specimens/surface.hpp"
#include "vbond/setup/text_file.hpp"

namespace vbond {
namespace {

template <class Counts>
double product(const Counts& counts) {
  double n = 1.0;
  for (const std::int64_t count : counts) n *= static_cast<double>(count);
  return n;
}

double count(const BlockSpecimen& s) {
  return particles_in_cell(s.lattice) * product(s.cells);
}
double count(const SheetSpecimen& s) {
  return s.lattice == SheetLattice::random ? 0.0 : product(s.particles);
}
double count(const ListedSpecimen& s) {
  return static_cast<double>(s.positions.size());
}
/// The same with its files as seen from the folder of the case.
CsvSpecimen with_files_beside(const std::string& case_file, CsvSpecimen spec) {
  spec.file.value = beside_case(case_file, spec.file.value);
  if (spec.bonds_file) spec.bonds_file->value = beside_case(case_file, spec.bonds_file->value);
  return spec;
}

double count(const CylinderSpecimen& s) {
  return count_points(s);
}
double count(const ConeSpecimen& s) {
  return count_points(s);
}
double count(const SphereSpecimen& s) {
  return count_points(s);
}
double count(const FibresSpecimen& s) {
  return count_points(s);
}
double count(const CsvSpecimen&) {
  return 0.0;
}
double count(const LammpsSpecimen&) {
  return 0.0;
}
double count(const PackingSpecimen& s) {  // without a number only packing tells
  return s.floaters == FloatingGrains::remove ? 0.0 : static_cast<double>(s.particles.value_or(0));
}
template <class Curve>
double count(const Curve& s) {
  return static_cast<double>(s.particles);
}

bool has_inertia(const SpecimenSpec& s) {
  return s.inertia || s.principal_inertia || s.inertia_tensor || s.solid;
}

}  // namespace

double count_points(const SpecimenSpec& spec) {
  if (!spec.cut.empty()) return 0.0;
  return count_copies(spec) * std::visit([](const auto& shape) { return count(shape); }, spec.shape);
}

bool brings_bonds(const SpecimenSpec& spec) {
  if (const auto* csv = std::get_if<CsvSpecimen>(&spec.shape)) return csv->bonds_file.has_value();
  if (const auto* sheet = std::get_if<SheetSpecimen>(&spec.shape))
    return sheet->lattice == SheetLattice::random;
  return std::holds_alternative<LammpsSpecimen>(spec.shape) ||
         std::holds_alternative<FibresSpecimen>(spec.shape) ||
         std::holds_alternative<CylinderSpecimen>(spec.shape) ||
         std::holds_alternative<ConeSpecimen>(spec.shape) ||
         std::holds_alternative<SphereSpecimen>(spec.shape);
}

SpecimenPoints make_specimen(const SpecimenSpec& spec, const Case& c, int threads) {
  const std::string& case_file = c.file;
  SpecimenPoints points = std::visit(
      [&](const auto& shape) {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, CsvSpecimen>)
          return read_csv_specimen(with_files_beside(case_file, shape));
        else if constexpr (std::is_same_v<Shape, LammpsSpecimen>)
          return read_lammps_specimen(beside_case(case_file, shape.file.value), shape.atom_style.value_or(""),
                                      shape.file.place, shape.velocities);
        else if constexpr (std::is_same_v<Shape, PackingSpecimen>)
          return make_packing(shape, spec, c.cell ? &*c.cell : nullptr, case_file, threads);
        else if constexpr (std::is_same_v<Shape, FibresSpecimen>)
          return make_fibres(spec, c);
        else
          return make_points(shape, spec.place);
      },
      spec.shape);
  for (std::string& note : points.notes)
    if (!points.shares.empty()) note = fmt::format("specimen \"{}\": {}", spec.name, note);
  if (spec.thickness) give_wall(*spec.thickness, spec.density.value_or(0.0), !has_inertia(spec), points);
  arrange(spec, case_file, points);
  return points;
}

}  // namespace vbond
