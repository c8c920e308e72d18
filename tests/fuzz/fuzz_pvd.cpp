#include <cstdint>

#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/vtp.hpp"
#include "vbond/report/frame_read.hpp"

/// A list of frames, read for the page and to be continued by a resumed run; or one of the parts of a frame.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbond;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto list = fuzz::put(fuzz::folder() / "particles.pvd", text);
  fuzz::put(fuzz::folder() / "bonds.pvd", text);
  try {
    for (const ListedFrame& frame : read_pvd(list))
      if (frame.file.string().find("..") == 0) std::abort();  // below the folder of the list, always
  } catch (const IoError&) {
  }
  try {
    FrameInput(fuzz::put(fuzz::folder() / "parts.pvtp", text));
  } catch (const IoError&) {
  }
  try {
    const FrameWriter writer(fuzz::folder().path(), false, 50);
    read_pvd(list);  // what it has kept is a list again
  } catch (const IoError&) {
  }
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!vbond::fuzz::seeds()) return 0;
  const std::string two = vbond::pvd_entry(0.5, "frames/particles_000000000000.vtp") +
                          vbond::pvd_entry(1e-9, "frames/particles_000000000070.vtp");
  vbond::fuzz::add_seed("list", vbond::pvd_list(two));
  vbond::fuzz::add_seed("empty", vbond::pvd_list(""));
  const auto parts = vbond::fuzz::folder() / "parts.pvtp";
  const vbond::VtpFile one_point = vbond::VtpFile::of_points({{}});
  one_point.write_list(parts, {"one.vtp", "other.vtp"});
  vbond::fuzz::add_seed("parts", vbond::fuzz::content_of(parts));
  std::exit(0);
}
