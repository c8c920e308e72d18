#include <cstdint>

#include "body.hpp"
#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/checkpoint.hpp"
#include "vbond/observe/seal.hpp"

namespace {

using namespace vbond;

const fuzz::SmallBody& body() {
  static const fuzz::SmallBody made;
  return made;
}

}  // namespace

/// The part of a checkpoint that HDF5 reads, under a seal that fits it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::put(fuzz::folder() / "forged.h5",
                              std::string(seal_size, '\0').append(reinterpret_cast<const char*>(data), size));
  write_seal(file, newest_checkpoint_format, "fuzz");
  try {
    read_checkpoint(file, body().model);
  } catch (const IoError&) {
  }
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (!fuzz::seeds()) return 0;
  Checkpoint c{body().state, {}};
  for (const char* name : {"plain", "overlapping"}) {
    write_checkpoint(fuzz::folder() / "good.h5", body().model, c, "fuzz");
    fuzz::add_seed(name, fuzz::content_of(fuzz::folder() / "good.h5").substr(seal_size));
    c.watch.overlapping = {{ParticleId{0}, ParticleId{2}}};
    c.watch.bonds.resize(2);
  }
  std::exit(0);
}
