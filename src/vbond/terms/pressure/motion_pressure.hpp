#pragma once
#include <cstddef>
#include <vector>

#include "vbond/dynamics/motion_term.hpp"
#include "vbond/dynamics/working_load.hpp"
#include "vbond/terms/pressure/pressed.hpp"

namespace vbond {

/// Pressures of a stage of motion. All particles move before any of their loads are added, since a facet may
/// have corners anywhere. A particle sums up its own facets, in their order.
class MotionPressure final : public MotionTerm {
 public:
  explicit MotionPressure(const BodyInMotion& on) : on_(on) {}

  bool is_there() const override { return !on_.stage.pressures.empty(); }
  bool touches() const override { return true; }
  /// Of a stage that is under way: its facets. Throws std::invalid_argument if it has none.
  void read(const State& state) override;
  /// The facets as the stage begins; the state keeps them.
  void before_stage(bool run_begins) override;
  void begin_step() override;
  void add_loads(const Block& block, double dt) override;
  void end_step(double dt) override;

 private:
  struct Loaded : WorkingLoad {
    std::size_t share = 0;
  };
  void press(std::vector<PressedFacet> facets);

  const BodyInMotion on_;
  PressedSurfaces surfaces_;
  std::vector<std::vector<Loaded>> blocks_;
};

}  // namespace vbond
