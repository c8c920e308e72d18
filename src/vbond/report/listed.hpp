#pragma once
#include <filesystem>
#include <vector>

/// The frames that the lists in a folder name.
namespace vbond::page {

/// The files of a frame. Walls and contacts: empty if there are none.
struct FrameFiles {
  double time = 0;
  std::filesystem::path particles, bonds, walls{}, contacts{};
};

/// Frames that two lists have in common: while a run is writing, one may be longer. Throws IoError.
std::vector<FrameFiles> listed_frames(const std::filesystem::path& particles_pvd,
                                      const std::filesystem::path& bonds_pvd);

/// Adds the walls of a third list, where it has the frame. Throws IoError.
void add_walls(std::vector<FrameFiles>& frames, const std::filesystem::path& walls_pvd);

/// Adds contacts likewise: they may have been asked for later on. Throws IoError.
void add_contacts(std::vector<FrameFiles>& frames, const std::filesystem::path& contacts_pvd);

}  // namespace vbond::page
