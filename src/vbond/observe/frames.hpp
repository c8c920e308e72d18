#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/frame_format.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {

/// A bond as its quantities look at it. may_break: its utilisation is worked out.
BondView bond_view(BondId id, const State& state, bool may_break);

/// The particles as points with particle_quantities(); see docs/output.md.
/// load_factor: of a balance.
void write_particles_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                         std::optional<double> load_factor = {}, FrameFormat format = {});

/// The bonds as lines between the particles' centres with bond_quantities().
void write_bonds_vtp(const std::filesystem::path& path, const State& state, UnitSystem units,
                     std::optional<double> load_factor = {}, FrameFormat format = {});

/// The walls as triangles where they are now, with wall_quantities().
void write_walls_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                     std::optional<double> load_factor = {}, FrameFormat format = {});

/// The text of a list for ParaView with these entries.
std::string pvd_list(const std::string& entries);

/// An entry of it: this file, relative to the list, is the body at this time.
std::string pvd_entry(double time, const std::string& file);

/// Appends one frame for OVITO or LAMMPS to an open text; ids count from 1 there.
std::string lammps_frame(const Model& model, const State& state);

/// Writes the frames of a run: frames/particles_STEP.vtp and frames/bonds_STEP.vtp, listed for
/// ParaView in particles.pvd and bonds.pvd, those of walls likewise where there are walls, and dump.lammpstrj
/// if wanted.
class FrameWriter {
 public:
  /// Begins new lists, or with resume_step continues those that there are: later frames, which a killed run
  /// may have written past its checkpoint, are taken off the lists and removed. Throws IoError.
  FrameWriter(const std::filesystem::path& folder, bool lammps_dump, std::optional<std::int64_t> resume_step,
              FrameFormat format = {});

  /// Throws IoError, also if dump.lammpstrj was removed, replaced or changed by others.
  void write(const Model& model, const State& state, std::optional<double> load_factor = {});

  /// Step of the last frame, -1 if there is none.
  std::int64_t last_step() const { return last_step_; }

 private:
  void keep_until(std::int64_t resume_step);
  void write_lists() const;

  std::filesystem::path folder_;
  FrameFormat format_;
  std::optional<GrowingFile> dump_;
  std::string particle_entries_, bond_entries_, wall_entries_;  ///< lines of the .pvd files
  std::int64_t last_step_ = -1;
};

}  // namespace vbond
