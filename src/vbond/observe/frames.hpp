#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/frame_format.hpp"

namespace vbond {

class Simulation;

/// The text of a list for ParaView with these entries.
std::string pvd_list(const std::string& entries);

/// An entry of it: this file, relative to the list, is the body at this time.
std::string pvd_entry(double time, const std::string& file);

/// One frame of a dump for OVITO or LAMMPS; ids count from 1 there. Of a periodic body with the cell as box
/// and positions that go on; with format.wrap those of the images in the cell, and by which they are away
/// (ix, iy, iz). All frames of a run have boxes of one style, which its cell and the way in which it may move
/// tell.
std::string lammps_frame(const Model& model, const State& state, const FrameFormat& format = {});

/// Writes the frames of a run: frames/particles_STEP.vtp and frames/bonds_STEP.vtp, listed for
/// ParaView in particles.pvd and bonds.pvd, those of walls likewise where there are walls, that of the cell
/// of a periodic body, those of contacts and dump.lammpstrj if wanted. Of a body in parts, each process
/// writes what it has, unless the frame needs the whole body: for dump.lammpstrj, stress or contacts.
class FrameWriter {
 public:
  /// Begins new lists, or with resume_step continues those that there are: later frames, which a killed run
  /// may have written past its checkpoint, are taken off the lists and removed. Throws IoError.
  /// writes_all: false where another process writes all but for the part of this one.
  FrameWriter(const std::filesystem::path& folder, bool lammps_dump, std::optional<std::int64_t> resume_step,
              FrameFormat format = {}, bool writes_all = true);

  /// Throws IoError, also if dump.lammpstrj was removed, replaced or changed by others.
  void write(const Model& model, const State& state, std::optional<double> load_factor = {});
  /// The same of a body that several processes step, each of which writes what it has.
  void write(const Simulation& run);

  /// Step of the last frame, -1 if there is none.
  std::int64_t last_step() const { return last_step_; }

 private:
  void keep_until(std::int64_t resume_step);
  void add_to_lists(const Clock& clock, std::string (*name)(const char* kind, std::int64_t step));
  void write_lists() const;

  std::filesystem::path folder_;
  FrameFormat format_;
  bool dumps_;
  bool writes_all_;
  std::optional<GrowingFile> dump_;
  std::string particle_entries_, bond_entries_, wall_entries_, contact_entries_,
      cell_entries_;  ///< lines of the .pvd files
  std::int64_t last_step_ = -1;
};

}  // namespace vbond
