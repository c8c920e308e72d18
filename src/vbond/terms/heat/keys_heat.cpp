#include "vbond/terms/heat/keys_heat.hpp"

#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe(Table& t, TemperatureSpec& s, std::optional<StageKind> kind) {
  t.locate(s.place);
  default_to_all(s.group);
  t.key("group", s.group, group_name, optional, "which particles; a bond has the mean of its two");
  t.when(!kind || !is_static(*kind), "kind = \"dynamics\"", [&] {
    t.key("temperature", s.temperature, number(pure), required,
          "above that at which bonds have their lengths, in the unit of 1/expansion");
    describe(t, s.factor);
  });
  t.when(!kind || (is_static(*kind) && kind != StageKind::modes),
         "kind = \"equilibrium\", \"path\", \"buckling\" or \"fracture\"", [&] {
           t.key("change", s.change, number(pure), required,
                 "of the temperature that the stage finds, at load factor 1");
         });
}

}  // namespace vbond::keys

namespace vbond {

void HeatTerm::describe(keys::Table& t, SpecPart<HeatTerm>& s, std::optional<StageKind> kind) {
  t.when(!kind || kind != StageKind::modes, "every kind but \"modes\"", [&] {
    t.tables(key, s.temperatures, keys::optional,
             "what heats bonds that expand; where groups overlap the last entry counts in motion, and "
             "changes add up at rest",
             [kind](keys::Table& k, TemperatureSpec& heat) { keys::describe(k, heat, kind); });
  });
}

}  // namespace vbond
