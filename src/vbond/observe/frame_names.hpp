#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vbond {

/// The files of frames, in the output folder. kind: particles, bonds or walls. Steps have twelve digits, so
/// that names sort for every run shorter than 1e12 steps.

/// frames/KIND_STEP.vtp
std::string frame_name(const char* kind, std::int64_t step);
/// frames/KIND_STEP_PART.vtp: what one part of a body has, counted from 0.
std::string name_of_part(const char* kind, std::int64_t step, int part);
/// frames/KIND_STEP.pvtp: a list of all parts.
std::string name_of_parts(const char* kind, std::int64_t step);

/// The step of a file that has such a name in the folder frames/, or that of such a file half written;
/// nothing for any other name.
std::optional<std::int64_t> step_of_frame(std::string_view name);

}  // namespace vbond
