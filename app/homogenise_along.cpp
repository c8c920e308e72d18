// The constants of a cell at each balance of its static stages, as a table.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "commands.hpp"
#include "homogenise_along.hpp"
#include "signals.hpp"
#include "vbond/core/error.hpp"
#include "vbond/model/cell_drive.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/run/run.hpp"
#include "vbond/statics/homogenise.hpp"

namespace vbond::app {
namespace {

std::string header() {
  std::string text = "stage,load_factor";
  for (const auto& name : cell_component_names) text += fmt::format(",cell_strain_{}", name);
  for (const auto& name : cell_component_names) text += fmt::format(",cell_stress_{}", name);
  text += ",density,E_hill,nu_hill";
  for (const auto& row : cell_component_names)
    for (const auto& column : cell_component_names) text += fmt::format(",C_{}_{}", row, column);
  return text + '\n';
}

/// Strain as history.csv has it: the deformation gradient, less 1.
std::string row_of(const BodyView& body, const std::string& stage, const Homogenised& h) {
  std::string text = fmt::format("{},{:.17g}", stage, body.balance()->load_factor);
  const auto gradient = cell_components(cell_gradient(body.model().cell, body.state().cell));
  for (std::size_t k = 0; k < 6; ++k) text += fmt::format(",{:.10g}", gradient[k] - (k < 3 ? 1.0 : 0.0));
  for (const double s : h.stress) text += fmt::format(",{:.10g}", s);
  text += fmt::format(",{:.10g}", h.density);
  std::string why;
  const std::optional<ElasticConstants> known = constants_of(h.C, why);
  text += known ? fmt::format(",{:.10g},{:.10g}", known->hill().E(), known->hill().nu()) : ",,";
  for (const auto& row : h.C)
    for (const double C : row) text += fmt::format(",{:.10g}", C);
  return text + '\n';
}

}  // namespace

int homogenise_along(const Case& c, Built built, int threads) {
  if (std::none_of(c.stages.begin(), c.stages.end(), [](const StageSpec& s) { return is_static(s.kind); }))
    throw CaseError(Problem{{c.file, 0, 0},
                            "the case has no static stage",
                            "--along takes the balances of static stages",
                            "add a stage of kind = \"equilibrium\" or \"path\", or leave --along out"});
  catch_signals();
  Run run(std::move(built.model), std::move(built.state), stages_of(c, threads), threads);
  run.check();
  fmt::print("{}", header());
  RunHooks hooks;
  hooks.interrupted = [] { return caught_signal() != 0; };
  hooks.tell = [](const std::string& text) { fmt::print(stderr, "{}\n", text); };
  hooks.balance = [&run](const BodyView& body) {
    const std::string stage = run.stages().name(run.stage_index());
    try {
      fmt::print("{}", row_of(body, stage, homogenise(body.model(), body.state())));
    } catch (const NoEquilibrium& e) {
      fmt::print(stderr, "stage \"{}\", load factor {:.9g}: no constants: {}\n", stage,
                 body.balance()->load_factor, e.what());
    }
  };
  run.set_hooks(std::move(hooks));
  run.run();
  return run.complete() ? done : 128 + caught_signal();
}

}  // namespace vbond::app
