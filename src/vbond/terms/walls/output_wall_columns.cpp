#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

void add_components(const Vec3d& x, std::vector<Cell>& to) {
  to.insert(to.end(), {x.x, x.y, x.z});
}

}  // namespace

void WallsTerm::add_columns(std::vector<GroupQuantity>& to) {
  to.push_back({"wall",
                "WALL",
                {{"Fx", unit::force, "force of particles on the wall"},
                 {"Fy", unit::force},
                 {"Fz", unit::force},
                 {"Mx", unit::moment, "moment of particles on the wall, about its centre (`moments_about`)"},
                 {"My", unit::moment},
                 {"Mz", unit::moment},
                 {"x", unit::length, "displacement of its centre since the start"},
                 {"y", unit::length},
                 {"z", unit::length},
                 {"work", unit::energy,
                  "work that the wall has done on particles; in motion a part of work_supports"}},
                [](const OutputPlan& plan) { return plan.walls; },
                [](const HistoryValues& v, std::size_t k, std::vector<Cell>& cells) {
                  if (k >= v.walls.size()) return cells.resize(cells.size() + 10);
                  const WallState& w = v.walls[k];
                  add_components(w.force, cells), add_components(w.moment, cells),
                      add_components(w.displacement, cells), cells.emplace_back(w.work);
                }});
}

}  // namespace vbond
