#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/frame_format.hpp"
#include "vbond/statics/results.hpp"

namespace vbond {

/// The body displaced along a shape: positions by factor times the translation, orientations turned by factor
/// times the rotation vector.
State displaced(const State& balance, const Shape& shape, double factor);

/// The factor of a shape at the height of its swing: the largest translation is `amplitude` [length], or for
/// 0 a tenth of the diagonal of the body, but no particle turns by more than half a radian. Zero for an empty
/// shape.
double swing_factor(const Model& model, const State& balance, const Shape& shape, double amplitude);

/// How a mode swings. Of a wave that goes through a periodic body, the particles that there are go round.
struct Swing {
  Swing(Shape shape) : in_phase(std::move(shape)) {}  // NOLINT: most swings have one part
  Swing(Shape real, Shape imaginary) : in_phase(std::move(real)), out_of_phase(std::move(imaginary)) {}
  Shape in_phase;
  Shape out_of_phase;  ///< empty: none
};

/// Writes one swing of a mode about this balance, factor * sin(2 pi k / frames), less the part that is out of
/// phase times factor * cos(2 pi k / frames), as
/// modes/STAGE_mode_N_K.vtp and modes/STAGE_mode_N_bonds_K.vtp with a list for ParaView each, of which a
/// swing takes one unit of time. stage: fit for a file name, as those of case files are. load_factor: at
/// which the mode is critical. Throws IoError.
void write_mode_frames(const std::filesystem::path& folder, const std::string& stage, int mode, int frames,
                       double factor, const Model& model, const State& balance, const Swing& swing,
                       std::optional<double> load_factor = {}, FrameFormat format = {});

/// True for the name of a file that write_mode_frames has written for this stage, or half of it; without a
/// stage, for any.
bool is_mode_file(std::string_view name, const std::string& stage = {});

/// The two lists of a mode.
struct ListedMode {
  std::string stage;
  int number = 0;  ///< from 1
  std::filesystem::path particles, bonds;
};

/// The modes in a folder of a run, of each stage by number; none if it has no folder modes. Throws IoError.
std::vector<ListedMode> list_modes(const std::filesystem::path& folder);

/// Removes what an earlier start has written for this stage; without one, for any. The lists go first, so
/// that none ever names a frame that is gone. Throws IoError.
void remove_mode_frames(const std::filesystem::path& folder, const std::string& stage = {});

}  // namespace vbond
