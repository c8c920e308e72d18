#pragma once
#include <functional>
#include <optional>
#include <string>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// Where a body stands at a kink of its energy: a bond at rest whose slopes in tension and compression
/// differ, or a contact of finite stiffness (law = "linear") that just touches. To one side it is stiff as it
/// is not to the other, so that there is no single tangent, and rounding would choose one.
namespace vbond {

struct Kink {
  std::string what;     ///< e.g. "particles 3 and 4 just touch, ..."
  std::string way_out;  ///< what to do
};

/// The first kink where this particle moves, or any; nothing if there is none.
using Moves = std::function<bool(ParticleId)>;
std::optional<Kink> kink_at(const Model& model, const State& state, const Moves& moves = nullptr);

/// Both on the stiffer side of each kink: particles that just touch do, and each bond has the larger of its
/// two slopes, wherever it stands, since motion takes it over.
Model with_what_just_touches(const Model& model, const State& state);
State with_stiffer_slopes(State state);

}  // namespace vbond
