#include <array>
#include <cstdint>

#include "input.hpp"
#include "vbond/core/error.hpp"
#include "vbond/setup/specimens/specimen.hpp"

/// The first byte chooses the atom style, the rest is the data file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbond;
  constexpr std::array styles{"bond",   "sphere", "bpm/sphere", "atomic",
                              "charge", "angle",  "molecular",  "full"};
  if (size == 0) return 0;
  const auto file =
      fuzz::put(fuzz::folder() / "forged.data", {reinterpret_cast<const char*>(data) + 1, size - 1});
  try {
    const SpecimenPoints points =
        read_lammps_specimen(file, styles[data[0] % styles.size()], {"fuzz.toml", 1, 1});
    const auto n = static_cast<std::int64_t>(points.r.size());
    for (const FileBond& bond : points.bonds)
      for (const std::int64_t end : bond.pair)
        if (end < 0 || end >= n) std::abort();
  } catch (const CaseError&) {
  }
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using vbond::fuzz::add_seed;
  if (!vbond::fuzz::seeds()) return 0;
  const std::string head =
      "title\n\n2 atoms\n1 bonds\n1 atom types\n1 bond types\n\n-5 5 xlo xhi\n-5 5 ylo yhi\n0 1 zlo zhi\n";
  const std::string bonds = "\nBonds\n\n1 1 1 2\n";
  add_seed("bond", std::string(1, '\0') + head +
                       "\nMasses\n\n1 2.5\n\nAtoms # bond\n\n1 1 1 0 0 0 0 0 1\n2 1 1 1 0 0 0 0 0\n" +
                       "\nVelocities\n\n1 0 0 0\n2 1 0 0\n" + bonds);
  add_seed("sphere", "\x01" + head +
                         "0 0 0 xy xz yz\n\nAtoms # sphere\n\n1 1 0.5 2 0 0 0\n2 1 0.5 2 1 0 0 # end\n" +
                         "\nVelocities\n\n1 0 0 0 0 0 0\n2 1 0 0 0 0 1\n" + bonds);
  add_seed("general",
           std::string(1, '\0') +
               "title\n\n2 atoms\n1 bonds\n\n5 1 0 avec\n-1 5 0 bvec\n0 1 5 cvec\n-1 0 2 abc origin\n" +
               "\nMasses\n\n1 2.5\n\nAtoms # bond\n\n1 1 1 0 0 0 0 -1 1\n2 1 1 4 0 0 0 0 0\n" + bonds);
  add_seed("tilted", std::string(1, '\0') + head +
                         "1 -0.5 0.25 xy xz yz\n\nMasses\n\n1 2.5\n\nAtoms # bond\n\n" +
                         "1 1 1 0 0 0 2 0 -1\n2 1 1 4 0 0 0 1 0\n" + bonds);
  std::exit(0);
}
