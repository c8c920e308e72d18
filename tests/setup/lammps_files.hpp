#pragma once
#include <filesystem>
#include <string>

#include "cases.hpp"

namespace vbond::test {

/// The particles of a LAMMPS data file with all the bonds that it brings.
inline Case lammps_case(const std::filesystem::path& file, const std::string& style) {
  Case c = case_of(LammpsSpecimen{{file, {"case.toml", 4, 1}}, style});
  c.specimens[0].mass.reset();
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = SpecimenPairs{};
  c.bonds.push_back(bonds);
  return c;
}

}  // namespace vbond::test
