#pragma once
#include <cstddef>
#include <variant>

#include "vbond/case/case.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// What is known, before a run, of the state that a stage will begin in.
struct Outlook {
  /// Bonds as far as they are certain. Positions, orientations and velocities are those of now: of a stage
  /// that another one comes before nothing is known of them.
  State state;
  bool pairs_known = true;  ///< these are all bonds
  bool bonds_known = true;  ///< and their constants are those of the bonds to come
};

/// Stage k of the case as far as it is known before the stages in front of it have run: of dynamics without
/// its step where that depends on them. Adds its bonds to the outlook. Throws CaseError with what is wrong
/// with it whatever those stages do, so that a run would refuse it as it begins.
std::variant<Stage, StaticStage> look_ahead(const Case& c, const Model& model, std::size_t k,
                                            Outlook& outlook);

}  // namespace vbond
