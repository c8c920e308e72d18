#include "refusals.hpp"

#include <string>
#include <utility>
#include <vector>

#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

class Refusals {
 public:
  void refuse(bool has, const SourcePlace& place, const std::string& what) {
    if (has)
      problems_.push_back(
          {place, what, "vbond-lammps cannot do this yet: see docs/ranks.md", "run the case with vbond"});
  }
  void throw_if_any() {
    if (!problems_.empty()) throw CaseError(std::move(problems_));
  }

 private:
  std::vector<Problem> problems_;
};

void look_at(const BondSpec& b, Refusals& r) {
  const std::string name = "bonds \"" + b.name + "\": ";
  r.refuse(b.when == BondTime::approach, b.place, name + "made during a stage (when = \"approach\")");
  r.refuse(b.yield.has_value(), b.place, name + "yield");
  r.refuse(b.creep.has_value(), b.place, name + "creep");
  r.refuse(b.softening.has_value(), b.place, name + "softening");
  r.refuse(b.recipe.damping.by != DampingBy::none, b.place, name + "damping");
  r.refuse(b.recipe.expansion != 0.0, b.place, name + "expansion");
  r.refuse(b.recipe.capsule, b.place, name + "capsules");
}

void look_at(const StageSpec& s, Refusals& r) {
  const std::string name = "stage \"" + s.name + "\": ";
  if (is_static(s.kind)) return r.refuse(true, s.place, name + "static");
  for (const SupportSpec& support : s.supports)
    r.refuse(support.rigid, support.place, name + "rigid support");
  for (const TemperatureSpec& t : s.temperatures) r.refuse(true, t.place, name + "temperature");
  r.refuse(s.local_damping != 0.0, s.place, name + "local damping");
  if (s.strain) r.refuse(true, s.strain->place, name + "imposed strain");
}

}  // namespace

void refuse_beyond_ranks(const Case& c, const Model& model) {
  const SourcePlace file{c.file, 0, 0};
  Refusals r;
  for (const WallSpec& w : c.walls) r.refuse(true, w.place, "wall \"" + w.name + "\"");
  r.refuse(particles_touch(model.contact), file, "contacts");
  bool tops = false;
  for (const ParticleId p : model.mass.ids()) tops |= model.is_top(p);
  r.refuse(tops, file, "particles with three moments of inertia");
  for (const BondSpec& b : c.bonds) look_at(b, r);
  for (const StageSpec& s : c.stages) look_at(s, r);
  r.throw_if_any();
}

}  // namespace vbond::app
