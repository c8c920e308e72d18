#include "vbond/report/listed.hpp"

#include <algorithm>

#include "vbond/core/error.hpp"
#include "vbond/report/vtp_read.hpp"

namespace vbond::page {
namespace {

/// Both are in order of time.
void add_files(std::vector<FrameFiles>& frames, const std::filesystem::path& pvd,
               std::filesystem::path FrameFiles::*file) {
  const std::vector<ListedFrame> listed = read_pvd(pvd);
  auto at = listed.begin();
  for (FrameFiles& f : frames) {
    at = std::find_if(at, listed.end(), [&f](const ListedFrame& l) { return l.time >= f.time; });
    if (at != listed.end() && at->time == f.time) f.*file = at->file;
  }
}

}  // namespace

std::vector<FrameFiles> listed_frames(const std::filesystem::path& particles_pvd,
                                      const std::filesystem::path& bonds_pvd) {
  const std::vector<ListedFrame> particles = read_pvd(particles_pvd), bonds = read_pvd(bonds_pvd);
  std::vector<FrameFiles> frames;
  for (std::size_t k = 0; k < std::min(particles.size(), bonds.size()); ++k) {
    if (particles[k].time != bonds[k].time)
      throw IoError(particles_pvd.string() + " and " + bonds_pvd.filename().string() +
                    " do not list the same frames");
    frames.push_back({particles[k].time, particles[k].file, bonds[k].file});
  }
  return frames;
}

void add_walls(std::vector<FrameFiles>& frames, const std::filesystem::path& walls_pvd) {
  add_files(frames, walls_pvd, &FrameFiles::walls);
}

void add_contacts(std::vector<FrameFiles>& frames, const std::filesystem::path& contacts_pvd) {
  add_files(frames, contacts_pvd, &FrameFiles::contacts);
}

}  // namespace vbond::page
