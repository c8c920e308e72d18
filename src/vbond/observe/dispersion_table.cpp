#include "vbond/observe/dispersion_table.hpp"

#include <fmt/format.h>

#include <numbers>

#include "vbond/observe/csv.hpp"

namespace vbond {

std::string dispersion_table(const RunSummary& summary) {
  std::string text;
  for (const StageSummary& stage : summary.stages) {
    if (!stage.statics || stage.statics->kind != StageKind::modes) continue;
    const StaticResult& r = stage.statics->result;
    if (r.waves.empty()) continue;
    if (text.empty())
      text = "stage,wave,q.x,q.y,q.z,phase.a,phase.b,phase.c,mode,rigid,omega,frequency,omega_squared\n";
    int wave = 0, number = 0;
    for (const NaturalMode& m : r.modes) {
      number = m.wave == wave ? number + 1 : 1;
      wave = m.wave;
      const Wave& w = r.waves[static_cast<std::size_t>(wave - 1)];
      text +=
          fmt::format("{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{},{},{:.17g},{:.17g},{:.17g}\n",
                      csv_quoted(stage.name), wave, w.q.x, w.q.y, w.q.z, w.edges.x, w.edges.y, w.edges.z,
                      number, m.rigid ? 1 : 0, m.omega, m.omega / (2.0 * std::numbers::pi), m.omega2);
    }
  }
  return text;
}

}  // namespace vbond
