#pragma once
#include <string>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

/// Of which stages sensitivities can be followed.
namespace vbond {

/// What supports leave of the turns of a particle.
struct Turns {
  unsigned held = 0;       ///< bits: of supports along the axes of the world
  bool turned = false;     ///< by these
  bool by_way = false;     ///< two axes are free, or one beside a turn: these do not commute
  bool about_one = false;  ///< one axis is free
};

/// Supports with axes of their own, and grips, count alone.
PerParticle<Turns> turns_in(const Model& model, const StaticStage& stage);

/// What of a stage, or of the state that it begins in, cannot be followed; empty: nothing.
std::string cannot_follow(const Model& model, const StaticStage& stage, const State& state);
/// Whether what the particles have done before is all that a stage takes from it.
std::string cannot_follow_after(const Model& model, const StaticStage& stage, bool after_path);

}  // namespace vbond
