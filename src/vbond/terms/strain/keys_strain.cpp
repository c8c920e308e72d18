#include "vbond/terms/strain/keys_strain.hpp"

#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe(Table& t, StrainSpec& s) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("group", s.group, group_name, optional, "which particles");
  t.key("increment", s.increment, NumberCodec{pure, {-1, largest_number, true, false}}, required,
        "strain of each application, < 0 for compression");
  t.check(s.increment != 0, {"increment"}, "must not be 0: nothing would be strained", "leave strain out");
  t.key("direction", s.direction, direction_vector, optional, "along which; its length does not matter");
  t.key("every", s.every, TimeCodec{}, required, "time between applications");
}

}  // namespace vbond::keys

namespace vbond {

void StrainTerm::describe(keys::Table& t, SpecPart<StrainTerm>& s, std::optional<StageKind> kind) {
  t.when(kind == StageKind::dynamics, "kind = \"dynamics\"", [&] {
    t.table(key, s.strain, "affine strain, applied step by step; not where contacts have friction or roll");
  });
}

}  // namespace vbond
