#pragma once
#include <string>

#include "vbond/case/case.hpp"
#include "vbond/core/error.hpp"
#include "vbond/setup/fibres/fibre_field.hpp"

namespace vbond {

/// Where the fibres of a specimen are put: a box, a layer, or the cell of the case. Throws CaseError.
FibreVessel vessel_of(const SpecimenSpec& spec, const FibresSpecimen& s, const Case& c);

/// Throws CaseError, of a specimen of fibres.
[[noreturn]] void refuse_fibres(const SourcePlace& place, const SpecimenSpec& spec, const std::string& what,
                                const std::string& rule, const std::string& way_out);

}  // namespace vbond
