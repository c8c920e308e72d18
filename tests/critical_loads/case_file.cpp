#include "case_file.hpp"

#include <fmt/format.h>

#include "reference.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::campaign {

int print_reference_of(const std::string& file, int count) {
  const Case c = read_case(file);
  Built built = build(c);
  const StaticStage stage = build_static_stage(c, built.model, 0, built.state);
  const Reference r = find_reference(built.model, stage, built.state, {count, 0, false, 20000});
  for (const ReferencePoint& p : r.points)
    fmt::print("{} at load factor {:.12g} (+- {:.1g})\n",
               p.kind == PointKind::limit_point ? "limit point" : "bifurcation", p.load_factor,
               p.error * p.load_factor);
  fmt::print("ended: {}; searched to {:.9g}; {} balances\n", r.ended, r.searched_to, r.nodes);
  return 0;
}

}  // namespace vbond::campaign
