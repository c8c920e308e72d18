#pragma once
#include "vbond/physics/evm.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/vmodel.hpp"
#include "vbond/physics/vmodel_cubic.hpp"

namespace vbond {

/// The bond laws of the library: the one list of them. Files keep laws by name, so that the order is free.
using BondLaws = LawList<VModel, Evm, VModelCubic>;

}  // namespace vbond
