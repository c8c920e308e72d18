#pragma once
#include "vbond/core/communicator.hpp"
#include "vbond/dynamics/handover.hpp"
#include "vbond/dynamics/step_memory.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

/// A body in parts between two stages of dynamics. Each part knows then about what it knew after the set-up.
/// All parts call these functions together.
namespace vbond {

/// What a part knows of bonds goes from `part` to what is returned. State and model have from then on the
/// masses of all particles; also their places, then and at first, unless parts keep their own; and their
/// motion likewise.
BondsFromSetUp open_part(PartHandedOver& part, RanksKeep keep, Model& model, State& state,
                         const Communicator& all);

/// The same as it was handed over; state and model may have more than that.
PartHandedOver closed_part(PartHandedOver part, BondsFromSetUp bonds);

/// Such a state, or one of the set-up (part: nullptr), becomes that of the whole body, and so does the model.
State whole_of(State state, BondsFromSetUp bonds, const PartHandedOver* part, Model& model);

}  // namespace vbond
