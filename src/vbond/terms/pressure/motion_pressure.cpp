#include "vbond/terms/pressure/motion_pressure.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace vbond {

void MotionPressure::press(std::vector<PressedFacet> facets) {
  if (!belong_to(facets, on_.stage.pressures))
    throw std::invalid_argument("a stage with pressures does not say of each on which facets it acts");
  surfaces_ = PressedSurfaces(on_.stage.pressures, std::move(facets));
  blocks_.assign(on_.team.blocks(), {});
  for (std::size_t k = 0; k < surfaces_.shares().size(); ++k) {
    const std::size_t row = on_.bodies.order.row[surfaces_.shares()[k].p].value;
    blocks_[row / block_rows].push_back({{row}, k});
  }
  for (std::vector<Loaded>& block : blocks_)
    std::stable_sort(block.begin(), block.end(),
                     [](const Loaded& a, const Loaded& b) { return a.row < b.row; });
}

void MotionPressure::read(const State& s) {
  if (s.clock.stage_step != 0 && !surfaces_.any()) press(s.pressed);
}

void MotionPressure::before_stage(bool) {
  PerParticle<Vec3d> r(on_.model.particles());
  for (const ParticleId p : r.ids()) r[p] = on_.bodies.pose[on_.bodies.order.row[p].value].r;
  on_.state.pressed = facets_as_found(on_.stage.pressures, r);
  press(on_.state.pressed);
}

void MotionPressure::begin_step() {
  on_.team.for_blocks([&](const Block& b) {
    for (Loaded& l : blocks_[b.index]) l.begin_step(on_.bodies);
  });
}

void MotionPressure::add_loads(const Block& b, double dt) {
  // by the number of the step, so that a run that goes on from it has the same bits
  const double t = static_cast<double>(on_.state.clock.stage_step + (dt > 0.0 ? 1 : 0)) * on_.stage.dt;
  const auto place = [this](ParticleId p) { return on_.bodies.pose[on_.bodies.order.row[p].value].r; };
  for (Loaded& l : blocks_[b.index]) {
    const PressedSurfaces::Share& share = surfaces_.shares()[l.share];
    const Pressure& p = surfaces_.pressure(share.pressure);
    l.add(p.factor(t) * p.pressure * surfaces_.force(share, place), on_.bodies);
  }
}

void MotionPressure::end_step(double dt) {
  if (dt == 0.0) return;
  double work = 0.0;
  for (const std::vector<Loaded>& block : blocks_)
    for (const Loaded& l : block) work += l.work(on_.bodies);
  on_.books.work_loads += work;
}

std::unique_ptr<MotionTerm> PressureTerm::in_motion(const BodyInMotion& on) {
  return std::make_unique<MotionPressure>(on);
}

}  // namespace vbond
