#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "commands.hpp"
#include "prepare.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/bounding_box.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::app {
namespace {

/// What kind = "csv" reads again, bit for bit.
std::string csv(const Model& model) {
  std::string text = "x,y,z,radius,mass\n";
  const auto out = std::back_inserter(text);
  for (const ParticleId p : model.r_0.ids()) {
    const Vec3d& r = model.r_0[p];
    fmt::format_to(out, "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", r.x, r.y, r.z, model.radius[p],
                   model.mass[p]);
  }
  return text;
}

/// A LAMMPS data file of atom_style sphere; a type for each specimen.
std::string lammps(const Case& c, const Model& model) {
  std::string text = fmt::format("# {}, packed by vbond\n\n{} atoms\n{} atom types\n\n", printable(c.title),
                                 model.particles(), c.specimens.size());
  const auto out = std::back_inserter(text);
  if (model.cell.any()) {  // general triclinic
    constexpr const char* names[] = {"avec", "bvec", "cvec"};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& e = model.cell.edges[k];
      fmt::format_to(out, "{:.17g} {:.17g} {:.17g} {}\n", e.x, e.y, e.z, names[k]);
    }
    const Vec3d& o = model.cell.corner;
    fmt::format_to(out, "{:.17g} {:.17g} {:.17g} abc origin\n", o.x, o.y, o.z);
  } else {
    BoundingBox box;
    for (const ParticleId p : model.r_0.ids()) box.add(model.r_0[p], model.radius[p]);
    fmt::format_to(out, "{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{:.17g} {:.17g} zlo zhi\n",
                   box.low.x, box.high.x, box.low.y, box.high.y, box.low.z, box.high.z);
  }
  text += "\nAtoms # sphere\n\n";  // id type diameter density x y z
  for (const ParticleId p : model.r_0.ids()) {
    const double R = model.radius[p], volume = 4.0 / 3.0 * std::numbers::pi * R * R * R;
    const Vec3d& r = model.r_0[p];
    fmt::format_to(out, "{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", p.value + 1, model.specimen[p] + 1,
                   2.0 * R, R > 0.0 ? model.mass[p] / volume : model.mass[p], r.x, r.y, r.z);
  }
  return text;
}

}  // namespace

int pack(const RunOptions& options, const std::filesystem::path& file) {
  const Case c = read_case(options.case_file, options.changes);
  if (std::filesystem::exists(file))
    throw IoError(file.string() + " is there already: remove it, or choose another name");
  Case particles = c;  // bonds, stages and what is written are no part of a packing
  particles.bonds.clear(), particles.stages.clear(), particles.velocities.clear(), particles.walls.clear();
  particles.contact = {}, particles.contact_between.clear(), particles.output = {};
  const Built built = build(particles);
  if (built.packings.empty())
    throw CaseError(Problem{{c.file, 0, 0},
                            "the case packs no grains",
                            "this command writes particles that a specimen of kind = \"packing\" makes",
                            "add such a specimen: docs/packings.md"});
  replace_file(file, file.extension() == ".data" ? lammps(c, built.model) : csv(built.model));
  print_notes(built.notes);
  fmt::print("{} particles in {}\n", built.model.particles(), file.string());
  return done;
}

}  // namespace vbond::app
