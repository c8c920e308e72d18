#pragma once
#include "vbond/physics/evm.hpp"
#include "vbond/physics/flow_step.hpp"
#include "vbond/physics/flowing.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/ruled.hpp"
#include "vbond/physics/vmodel.hpp"

namespace vbond {

/// The bond laws of the library: the one list of them. Files keep laws by name, so that the order is free.
/// Case files name a law without rules; the one with rules, or that flows, is taken where a bond set has any.
using BondLaws = LawList<VModel, Evm, RuledVModel, RuledEvm, FlowingVModel, FlowingEvm>;

}  // namespace vbond
