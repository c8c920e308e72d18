#include "vbond/observe/mode_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>
#include <tuple>
#include <vector>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/detail/name_parts.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"

namespace vbond {
namespace {

namespace fs = std::filesystem;

double largest_norm(const PerParticle<Vec3d>& vectors) {
  double largest = 0.0;
  for (const Vec3d& x : vectors) largest = std::max(largest, norm(x));
  return largest;
}

/// Of the box around all particles.  [length]
double diagonal(const Model& model, const State& s) {
  BoundingBox box;
  for (const ParticleId p : s.r.ids()) box.add(s.r[p], model.radius[p]);
  return box.diagonal();
}

/// By factor times Re(shape exp(-i (phase - pi/2))).
State swung(const State& balance, const Swing& swing, double phase, double factor) {
  const double in = factor * std::sin(phase), out = -factor * std::cos(phase);
  if (swing.out_of_phase.translation.empty()) return displaced(balance, swing.in_phase, in);
  Shape sum = swing.in_phase;
  for (const ParticleId p : sum.translation.ids()) {
    sum.translation[p] = in * sum.translation[p] + out * swing.out_of_phase.translation[p];
    sum.rotation[p] = in * sum.rotation[p] + out * swing.out_of_phase.rotation[p];
  }
  return displaced(balance, sum, 1.0);
}

/// Takes a number off the end.
bool take_digits(std::string_view& text) {
  const std::size_t last = text.find_last_not_of("0123456789");
  const std::size_t from = last == std::string_view::npos ? 0 : last + 1;
  if (from == text.size()) return false;
  text.remove_suffix(text.size() - from);
  return true;
}

}  // namespace

State displaced(const State& balance, const Shape& shape, double factor) {
  State s = balance;
  for (const ParticleId p : s.r.ids()) {
    s.r[p] += factor * shape.translation[p];
    s.q[p] = normalised(rotation_of(factor * shape.rotation[p]) * s.q[p]);
  }
  return s;
}

double swing_factor(const Model& model, const State& balance, const Shape& shape, double amplitude) {
  constexpr double most_turn = 0.5;  // rad: more would show bonds bent beyond their law
  const double translation = largest_norm(shape.translation), turn = largest_norm(shape.rotation);
  const double movement = amplitude > 0.0 ? amplitude : 0.1 * diagonal(model, balance);
  double factor = std::numeric_limits<double>::infinity();
  if (translation > 0.0) factor = movement / translation;
  if (turn > 0.0) factor = std::min(factor, most_turn / turn);
  return std::isfinite(factor) ? factor : 0.0;
}

void write_mode_frames(const fs::path& folder, const std::string& stage, int mode, int frames, double factor,
                       const Model& model, const State& balance, const Swing& swing,
                       std::optional<double> load_factor, FrameFormat format) {
  const fs::path modes = folder / "modes";
  make_folder(modes);
  format.wrap = false;  // a particle that swings through a face would jump
  const std::string name = fmt::format("{}{}", stage + "_mode_", mode);
  std::string particles, bonds;
  const double first =
      frames < 3 ? 0.25 : 0.0;  // of a swing: one or two frames show its ends, not its middle
  for (int k = 0; k < frames; ++k) {
    State s = swung(balance, swing, 2.0 * std::numbers::pi * (first + 1.0 * k / frames), factor);
    s.clock = {
        .step = k, .stage_step = k, .stage = balance.clock.stage, .stage_start = 0, .dt = 1.0 / frames};
    const std::string of_particles = fmt::format("{}_{:04}.vtp", name, k);
    const std::string of_bonds = fmt::format("{}_bonds_{:04}.vtp", name, k);
    write_particles_vtp(modes / of_particles, model, s, load_factor, format);
    write_bonds_vtp(modes / of_bonds, s, model.units, load_factor, format);
    particles += pvd_entry(s.clock.time(), of_particles);
    bonds += pvd_entry(s.clock.time(), of_bonds);
  }
  replace_file(modes / (name + ".pvd"), pvd_list(particles), Sync::none);
  replace_file(modes / (name + "_bonds.pvd"), pvd_list(bonds), Sync::none);
}

bool is_mode_file(std::string_view name, const std::string& stage) {
  take_off_end(name, ".part");
  const bool list = take_off_end(name, ".pvd");
  if (!list && !(take_off_end(name, ".vtp") && take_digits(name) && take_off_end(name, "_"))) return false;
  take_off_end(name, "_bonds");
  if (!take_digits(name)) return false;
  return stage.empty() ? take_off_end(name, "_mode_") && !name.empty() : name == stage + "_mode_";
}

std::vector<ListedMode> list_modes(const fs::path& folder) {
  constexpr std::string_view between = "_mode_";
  std::error_code e;
  std::vector<ListedMode> modes;
  for (const auto& entry : fs::directory_iterator(folder / "modes", e)) {
    const std::string name = entry.path().stem().string();
    std::string_view rest = name;
    if (entry.path().extension() != ".pvd" || !take_digits(rest)) continue;
    const std::string number = name.substr(rest.size());
    if (!take_off_end(rest, between) || number.size() > 6) continue;
    modes.push_back(
        {std::string(rest), std::stoi(number), entry.path(), folder / "modes" / (name + "_bonds.pvd")});
  }
  std::sort(modes.begin(), modes.end(), [](const ListedMode& one, const ListedMode& other) {
    return std::tie(one.stage, one.number) < std::tie(other.stage, other.number);
  });
  return modes;
}

void remove_mode_frames(const fs::path& folder, const std::string& stage) {
  std::error_code e;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder / "modes", e))  // none if there is no such folder
    if (is_mode_file(entry.path().filename().string(), stage)) old.push_back(entry.path());
  const auto is_list = [](const fs::path& path) { return path.extension() == ".pvd"; };
  std::partition(old.begin(), old.end(), is_list);
  for (const fs::path& path : old)
    if (!fs::remove(path, e) || e) throw IoError("cannot remove " + path.string() + ": " + e.message());
}

}  // namespace vbond
