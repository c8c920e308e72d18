#pragma once
#include <optional>

#include "vbond/terms/heat/keys_heat.hpp"
#include "vbond/terms/pressure/keys_pressure.hpp"
#include "vbond/terms/strain/keys_strain.hpp"
#include "vbond/terms/terms.hpp"
#include "vbond/terms/walls/keys_walls.hpp"

namespace vbond {

/// What a stage says of the terms: SpecPart of each, in the headers above.
struct TermSpecs : Terms::OfSpec {};

namespace keys {
class Table;
/// Keys of a stage of this kind; those of every kind if it is not known.
void describe_terms(Table& t, TermSpecs& s, std::optional<StageKind> kind);
}  // namespace keys

}  // namespace vbond
