#include <cstdint>

#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/report/warnings.hpp"

namespace {

using namespace vbond;

std::optional<RunSummary> read(const std::filesystem::path& file) {
  try {
    return read_summary(file);
  } catch (const IoError&) {
    return std::nullopt;
  }
}

}  // namespace

/// A run.json that is accepted is so again after it was written, and the page finds words for it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::put(fuzz::folder() / "run.json", {reinterpret_cast<const char*>(data), size});
  const std::optional<RunSummary> summary = read(file);
  if (!summary) return 0;
  fuzz::put(file, to_json(*summary));
  if (!read(file)) std::abort();
  const page::History history;
  const page::Body body;
  page::warnings({.summary = summary,
                  .history = history,
                  .body = body,
                  .units = UnitSystem::si,
                  .stages = 3,
                  .resume_command = "",
                  .step = {},
                  .files = {}});
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!fuzz::seeds()) return 0;
  RunSummary r;
  r.title = "seed", r.version = "0.1.0";
  r.stages = {{"push", StopReason::peak, 100, 0.01, 1.0, 3e-4, 0.9, {}, {}},
              {"wild", StopReason::diverged, 7, 0.01, 1.1, {}, {}, {}, "particle 2: not finite"}};
  StaticResult found;
  found.ended = "found";
  found.unstable = 1;
  found.special_points = {{PointKind::limit_point, 0.5, 3, 0, 1, 0.1}};
  found.critical_loads.resize(2);
  found.critical_loads[0].force = 2.0;
  found.modes.resize(3);
  found.modes[0].rigid = true;
  for (const StageKind kind :
       {StageKind::equilibrium, StageKind::path, StageKind::buckling, StageKind::modes}) {
    StageSummary s;
    s.name = to_text(kind);
    s.statics = StaticSummary{kind, found, ""};
    r.stages.push_back(s);
    RunSummary one = r;
    one.stages = {s};
    fuzz::add_seed(s.name, to_json(one));
  }
  fuzz::add_seed("all", to_json(r));
  std::exit(0);
}
