#include "vbond/terms/keys_terms.hpp"

#include "vbond/case/keys.hpp"

namespace vbond::keys {

void describe_terms(Table& t, TermSpecs& s, std::optional<StageKind> kind) {
  t.when(!kind || kind != StageKind::modes, "every kind but \"modes\"", [&] {
    t.tables("temperatures", s.temperatures, optional, "what heats bonds that expand",
             [kind](Table& k, TemperatureSpec& heat) { describe(k, heat, kind); });
  });
  t.tables("pressures", s.pressures, optional, "pressures on chains, sheets and the skin of solids",
           [kind](Table& k, PressureSpec& pressure) { describe(k, pressure, kind); });
  t.when(
      !kind || kind == StageKind::dynamics || kind == StageKind::equilibrium || kind == StageKind::fracture,
      "kind = \"dynamics\", \"equilibrium\" or \"fracture\"", [&] {
        t.tables("walls", s.walls, optional, "what moves walls; the others stand still",
                 [kind](Table& k, WallDriveSpec& drive) { describe(k, drive, kind); });
      });
  t.when(kind == StageKind::dynamics, "kind = \"dynamics\"",
         [&] { t.table("strain", s.strain, "affine strain, applied step by step"); });
}

}  // namespace vbond::keys
