#include "vbond/report/fit_frames.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "vbond/core/error.hpp"
#include "vbond/report/frame_read.hpp"

namespace vbond::page {
namespace {

/// Why a frame cannot be opened; empty if it can.
std::string trouble_with(const FrameFiles& files) {
  try {
    const FrameInput particles(files.particles), bonds(files.bonds);
    if (!files.walls.empty()) FrameInput walls(files.walls);
    if (!files.contacts.empty()) FrameInput contacts(files.contacts);
    return {};
  } catch (const IoError& e) {
    return e.what();
  }
}

/// Of one frame: bonds are most in the last one, but contacts come and go, so that some are looked at.
std::size_t largest_frame(const std::vector<FrameFiles>& frames) {
  constexpr std::size_t looked_at = 8;
  std::size_t most = bytes_of_frame(frames.back());
  for (const std::size_t k : thinned(frames.size(), (frames.size() + looked_at - 1) / looked_at))
    if (!frames[k].contacts.empty()) most = std::max(most, bytes_of_frame(frames[k]));
  return most;
}

std::size_t bytes_of(const SequenceFiles& s) {
  return s.frames.empty() ? 0 : s.frames.size() * bytes_of_frame(s.frames.back());
}

/// The smallest stride by which thinned(), which keeps 1 + ceil((n - 1) / stride), keeps no more than this.
std::size_t stride_to(std::size_t most, std::size_t n) {
  return n <= most ? 1 : (n - 1 + most - 2) / (most - 1);
}

void thin_run(SequenceFiles& run, const PageLimits& limits, std::size_t bytes,
              std::vector<std::string>& left_out) {
  const std::size_t written = run.frames.size();
  const std::size_t fit = bytes / std::max<std::size_t>(largest_frame(run.frames), 1);
  const std::size_t most = std::max<std::size_t>(2, std::min(limits.frames, fit));
  const std::size_t stride = stride_to(most, written);
  if (stride == 1) return;
  std::vector<FrameFiles> kept;
  for (const std::size_t k : thinned(written, stride)) kept.push_back(run.frames[k]);
  run.frames = std::move(kept);
  left_out.push_back(fmt::format(
      "Of the {} frames of the run one in {} was read, and the last one: a page is made of no more than {}. "
      "ParaView shows them all.",
      written, stride,
      fit < limits.frames ? fmt::format("{:g} MB of numbers before compression",
                                        static_cast<double>(limits.packed_bytes) / 1e6)
                          : fmt::format("{} frames", limits.frames)));
}

}  // namespace

std::vector<Warning> drop_unreadable_ends(std::vector<SequenceFiles>& all) {
  std::vector<Warning> warnings;
  for (SequenceFiles& s : all) {
    const std::size_t listed = s.frames.size();
    std::string first;
    for (std::string why; !s.frames.empty() && !(why = trouble_with(s.frames.back())).empty();) {
      first = why;
      s.frames.pop_back();
    }
    const std::size_t lost = listed - s.frames.size();
    if (lost == 0) continue;
    const bool is_run = s.kind == SequenceKind::run;
    warnings.push_back(
        {Level::warning,
         fmt::format("{} left out, because files are missing or cut short: {}",
                     is_run && lost == 1 ? fmt::format("The last of the {} frames of the run is", listed)
                     : is_run ? fmt::format("The last {} of the {} frames of the run are", lost, listed)
                              : s.name + " is",
                     first)});
    if (!is_run) s.frames.clear();  // part of a swing is none
  }
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& s) { return s.frames.empty(); }),
            all.end());
  return warnings;
}

void fit_frames(std::vector<SequenceFiles>& all, const PageLimits& limits,
                std::vector<std::string>& left_out) {
  std::size_t modes = 0, dropped = 0;
  for (const SequenceFiles& s : all)
    if (s.kind == SequenceKind::mode) modes += bytes_of(s);
  while (modes > limits.packed_bytes) {  // so the last one is a mode
    modes -= bytes_of(all.back());
    all.pop_back();
    ++dropped;
  }
  if (dropped > 0)
    left_out.push_back(fmt::format(
        "{} left out: a page is made of no more than {:g} MB of numbers before compression. ParaView shows "
        "them.",
        dropped == 1 ? std::string("The last mode is") : fmt::format("The last {} modes are", dropped),
        static_cast<double>(limits.packed_bytes) / 1e6));
  if (!all.empty() && all[0].kind == SequenceKind::run)
    thin_run(all[0], limits, limits.packed_bytes - modes, left_out);
}

}  // namespace vbond::page
