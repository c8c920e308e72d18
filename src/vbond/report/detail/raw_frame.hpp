#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/report/frame_read.hpp"
#include "vbond/report/sequence.hpp"

namespace vbond::page {

/// One frame as its files give it.
struct RawFrame {
  std::int64_t step = 0;
  std::vector<Vec3d> displacement;
  std::vector<double> speed;
  std::array<std::vector<double>, bond_field_count> fields;  ///< empty: not there
  std::vector<std::uint8_t> range, broken;
  std::vector<std::int64_t> fragment;
  std::vector<std::uint8_t> there;  ///< empty: all particles are
};

/// all: how many particles the body has. about: displacements of a mode are from its first frame.
RawFrame read_frame(const FrameInput& particles, const FrameInput& bonds, const std::vector<Vec3d>* about,
                    std::size_t all);

/// Whether a frame is of a run whose bonds may break, and of one whose bonds flow.
bool tells_of_breaks(const FrameInput& particles, const FrameInput& bonds);
bool tells_of_flow(const FrameInput& bonds);

/// Bonds whose elongation has no length to be relative to.
std::size_t count_without_length(const FrameInput& bonds);

/// The numbers of the particles of a frame, in increasing order; empty: they are 0, 1, 2 ... of so many.
std::vector<std::size_t> numbers_of_some(const FrameInput& particles, std::size_t all);

/// Puts the values of these particles where their numbers are; others are as new.
template <class T>
void spread(const std::vector<std::size_t>& numbers, std::size_t all, std::vector<T>& values) {
  if (values.empty() && !numbers.empty()) return;
  std::vector<T> spread(all);
  for (std::size_t k = 0; k < numbers.size(); ++k) spread[numbers[k]] = values[k];
  values = std::move(spread);
}

}  // namespace vbond::page
