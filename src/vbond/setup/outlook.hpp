#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "vbond/case/case.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// What is known, before a run, of the state that a stage will begin in.
class Outlook {
 public:
  /// From this state, of which nothing is copied as long as nothing is known to change: it must live as long.
  /// own: if it has own bonds alone.
  Outlook(const State& now, std::shared_ptr<const BondsFromSetUp> own) : now_(&now), own_(std::move(own)) {}

  /// Bonds as far as they are certain. Positions, orientations and velocities are those of now: of a stage
  /// that another one comes before nothing is known of them.
  const State& state() const { return changed_ ? *changed_ : *now_; }
  State& changed() { return changed_ ? *changed_ : changed_.emplace(*now_); }
  /// With the bonds of all processes.
  BodyPart body() const { return body_of(state(), own_); }

  bool pairs_known = true;  ///< these are all bonds
  bool bonds_known = true;  ///< and their constants are those of the bonds to come

 private:
  const State* now_;
  std::optional<State> changed_;
  std::shared_ptr<const BondsFromSetUp> own_;
};

/// Stage k of the case as far as it is known before the stages in front of it have run: of dynamics without
/// its step where that depends on them. Adds its bonds to the outlook. Throws CaseError with what is wrong
/// with it whatever those stages do, so that a run would refuse it as it begins.
std::variant<Stage, StaticStage> look_ahead(const Case& c, const Model& model, std::size_t k,
                                            Outlook& outlook);

}  // namespace vbond
