#pragma once

namespace vbond {

/// How the numbers of a frame are stored, and which.
struct FrameFormat {
  bool single_precision = false;  ///< 32 bits for each real number, not 64
  bool compressed = true;         ///< by zlib, array by array
  bool stress = false;            ///< of each particle
  bool breaks = false;            ///< with what tells of bonds that may break
  bool capsules = false;          ///< with the radii of bonds that touch as capsules
  bool flow = false;              ///< with what has become of bonds that flow
  bool walls = false;             ///< with a file for the walls
  bool contacts = false;          ///< with a file for the contacts
  bool cell = false;              ///< with a file for the cell of a periodic body
  bool cell_shears = true;        ///< components yz, xz, xy of the cell may move: for the box of the dump
  bool wrap = false;              ///< particles of a periodic body stand in its cell
  bool long_integers = false;     ///< 64 bits for each, also where 32 would do
  friend bool operator==(const FrameFormat&, const FrameFormat&) = default;
};

}  // namespace vbond
