#pragma once
#include "vbond/physics/evm.hpp"
#include "vbond/physics/flow_step.hpp"
#include "vbond/physics/law.hpp"
#include "vbond/physics/vmodel.hpp"
#include "vbond/physics/with_flow.hpp"
#include "vbond/physics/with_offsets.hpp"
#include "vbond/physics/with_rubbing.hpp"
#include "vbond/physics/with_rules.hpp"

namespace vbond {

/// Elastic laws, each as it is, with rules, and with rules and flow.
template <template <class> class... Elastic>
using WithAllRules =
    LawList<Elastic..., WithRules<Elastic>::template Law..., WithFlow<Elastic>::template Law...>;

/// All of these, and those that crack and rub; all that have rules also with offsets.
template <template <class> class... Elastic>
using WithAllRulesAndOffsets =
    LawList<Elastic..., WithRules<Elastic>::template Law..., WithFlow<Elastic>::template Law...,
            WithRubbing<Elastic>::template Law...,
            WithOffsets<WithRules<Elastic>::template Law>::template Law...,
            WithOffsets<WithFlow<Elastic>::template Law>::template Law...,
            WithOffsets<WithRubbing<Elastic>::template Law>::template Law...>;

/// The bond laws of the library: the one list of them. Files keep laws by name, so that the order is free.
/// Case files name an elastic law; the one with rules, that flows, or that rubs is taken where a bond set has
/// any, and the one with offsets where its bonds have some.
using BondLaws = WithAllRulesAndOffsets<VModel, Evm>;

}  // namespace vbond
