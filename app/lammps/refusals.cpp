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
  r.refuse(b.recipe.capsule, b.place, name + "capsules");
}

void look_at(const StageSpec& s, Refusals& r) {
  const std::string name = "stage \"" + s.name + "\": ";
  if (is_static(s.kind)) r.refuse(true, s.place, name + "static");
}

}  // namespace

void refuse_beyond_ranks(const Case& c) {
  Refusals r;
  for (const BondSpec& b : c.bonds) look_at(b, r);
  for (const StageSpec& s : c.stages) look_at(s, r);
  r.throw_if_any();
}

}  // namespace vbond::app
