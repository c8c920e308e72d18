#pragma once
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/packing/vessel.hpp"

namespace vbond {

/// What the grains of a specimen are packed into: its regions, or the cell of the case, or both. `notes`
/// takes what is made of files. Throws CaseError.
packing::Vessel vessel_of(const PackingSpecimen& s, const SourcePlace& place, const CellSpec* cell,
                          const std::string& case_file, std::vector<std::string>& notes);

}  // namespace vbond
