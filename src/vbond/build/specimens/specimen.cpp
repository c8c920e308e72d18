#include "vbond/build/specimens/specimen.hpp"

#include "vbond/build/text_file.hpp"

namespace vbond {

SpecimenPoints make_specimen(const SpecimenSpec& spec, const std::string& case_file) {
  return std::visit(
      [&](const auto& shape) {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, CsvSpecimen>)
          return read_csv_specimen(beside_case(case_file, shape.file.value), shape.file.place);
        else if constexpr (std::is_same_v<Shape, LammpsSpecimen>)
          return read_lammps_specimen(beside_case(case_file, shape.file.value), shape.atom_style,
                                      shape.file.place);
        else
          return make_points(shape, spec.place);
      },
      spec.shape);
}

}  // namespace vbond
