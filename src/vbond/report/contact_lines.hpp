#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/report/block.hpp"
#include "vbond/report/listed.hpp"

namespace vbond::page {

/// The contacts of a frame as the page draws them: lines, as wide as their normal force is large.
struct FrameContacts {
  bool written = false;  ///< the frame has a file of them
  /// Of each contact the particles that its ends go with. Of a wall both are the particle.
  std::vector<std::uint32_t> i, j;
  std::vector<std::uint8_t> force;  ///< normal, repulsion is positive, in the range of this frame
  Range range;                      ///< of `force`  [force]
  std::vector<std::uint8_t> shift;  ///< of the last contacts, whose ends are not both at centres: six each
};
constexpr std::size_t numbers_of_shift = 6;  ///< from the centre of i to one end, from that of j to the other

struct Contacts {
  std::vector<FrameContacts> frames;
  Range shift;       ///< of all frames  [length]
  bool any() const;  ///< in any of the frames
};

/// Reads the contacts of these frames. A frame's largest force may be far below that of the run, as after an
/// impact: so each has a range of its own. Throws IoError.
Contacts read_contacts(const std::vector<FrameFiles>& files);

/// Bytes that the contacts of a frame take in the block, in a body of so many particles. Throws IoError.
std::size_t bytes_of_contacts(const FrameFiles& files, std::size_t particles);

/// Bytes that each end takes there, in a body of so many particles: its number fits into them.
std::size_t bytes_of_end(std::size_t particles);

}  // namespace vbond::page
