#include "output_size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <variant>

#include "vbond/model/stage.hpp"
#include "vbond/observe/history.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/run/memory_needed.hpp"

namespace vbond::app {
namespace {

/// Of one value of an array: real numbers by the format, whole ones of 32 bits.
template <class View>
double bytes_of(double (*)(const View&), double real) {
  return real;
}
template <class View>
double bytes_of(Vec3d (*)(const View&), double real) {
  return 3.0 * real;
}
template <class View>
double bytes_of(std::int64_t (*)(const View&), double) {
  return 4.0;
}
template <class View>
double bytes_of(std::uint8_t (*)(const View&), double) {
  return 1.0;
}
template <class View>
double bytes_of(Image (*)(const View&), double) {
  return 12.0;
}

template <class Quantities>
double bytes_of_all(const Quantities& quantities, const OutputPlan& plan, double real) {
  double sum = 0.0;
  for (const auto& q : quantities)
    if (is_in(q.cases, plan)) sum += std::visit([=](auto value) { return bytes_of(value, real); }, q.value);
  return sum;
}

/// How often something is due in steps of dynamics, at the start and at each stage's end, too.
double times_due(double every, const Case& c, const Model& model, const std::vector<std::int64_t>& steps) {
  double times = 1.0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (steps[k] == 0) continue;
    const double dt = c.stages[k].duration.resolve(model.T_0) / static_cast<double>(steps[k]);
    const std::int64_t interval = std::isfinite(every) ? steps_in(every, dt) : steps[k];
    times += std::ceil(static_cast<double>(steps[k]) / static_cast<double>(interval));
  }
  return times;
}

/// Frames of modes and critical loads.
double frames_of_modes(const Case& c) {
  double frames = 0.0;
  for (const StageSpec& s : c.stages)
    if (s.kind == StageKind::modes || s.kind == StageKind::buckling)
      frames += static_cast<double>(s.count) * s.frames_per_mode;
  return frames;
}

}  // namespace

double bytes_of_frame(const Model& model, const State& state, const OutputPlan& plan) {
  const double real = plan.frame_format.single_precision ? 4.0 : 8.0, whole = 4.0;
  const auto n = static_cast<double>(model.particles()), bonds = static_cast<double>(state.bonds.size());
  const double point = 3.0 * real;
  const double of_particles = n * (point + 2.0 * whole + bytes_of_all(particle_quantities(), plan, real));
  const double of_bonds = n * (point + (plan.cell ? whole : 0.0)) +
                          bonds * (3.0 * whole + bytes_of_all(bond_quantities(), plan, real));
  return of_particles + of_bonds;
}

void print_output_size(const Case& c, const OutputPlan& plan, const Model& model, const State& state,
                       const std::vector<std::int64_t>& steps) {
  constexpr double of_a_cell = 20.0;  // 17 digits, a sign, a point and a comma
  const bool dynamic = std::any_of(steps.begin(), steps.end(), [](std::int64_t n) { return n > 0; });
  const char* points = plan.statics ? ", and one for each point of static stages" : "";
  double total = 0.0;
  if (dynamic) {
    const auto columns = static_cast<double>(history_columns(plan).size());
    const double rows = times_due(plan.history_every, c, model, steps);
    total += rows * columns * of_a_cell;
    fmt::print("output           history.csv: at most {:.0f} rows of {:.0f} columns, some {}{}\n", rows,
               columns, bytes_in_units(rows * columns * of_a_cell), points);
  }
  const double frame = bytes_of_frame(model, state, plan), modes = frames_of_modes(c);
  const char* packed = plan.frame_format.compressed ? " before compression" : "";
  if (plan.frames_every && dynamic) {
    const double frames = times_due(*plan.frames_every, c, model, steps);
    total += frames * frame;
    fmt::print("output           at most {:.0f} frames of some {}: {}{}{}{}\n", frames, bytes_in_units(frame),
               bytes_in_units(frames * frame), packed,
               plan.frame_format.contacts ? "; contacts are extra" : "", points);
  }
  if (modes > 0.0) {
    total += modes * frame;
    fmt::print("output           at most {:.0f} frames of modes of some {}: {}{}\n", modes,
               bytes_in_units(frame), bytes_in_units(modes * frame), packed);
  }
  std::error_code unknown;
  const std::filesystem::space_info here = std::filesystem::space(".", unknown);
  if (!unknown && total > static_cast<double>(here.available))
    fmt::print("output           that is MORE than the {} free here\n",
               bytes_in_units(static_cast<double>(here.available)));
}

}  // namespace vbond::app
