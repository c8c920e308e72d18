#pragma once
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

/// What a program may do wrong when it makes a body or a stage itself: a case file is checked as it is read.
namespace vbond {

/// Each mistake as one line that says what is wrong and the rule, the first particle or entry of its kind by
/// number; empty: none. Takes time in proportion to the body.
std::vector<std::string> mistakes_in(const Model& model);
/// Whether a state is of a body of this model, which has no mistakes itself: sizes, bonds, clock.
std::vector<std::string> mistakes_in(const Model& model, const State& state);
/// Whether its numbers are finite and its orientations rotations. Not asked of a state that a run has come
/// to: Diverged and NoEquilibrium tell of that.
std::vector<std::string> mistakes_in_values(const Model& model, const State& state);
std::vector<std::string> mistakes_in(const Model& model, const Stage& stage);
std::vector<std::string> mistakes_in(const Model& model, const StaticStage& stage);

/// What these supports cannot do with a state as a stage begins; none for a stage under way. Of a state
/// without mistakes.
std::vector<std::string> mistakes_in(const std::vector<Support>& supports, const State& state);

/// Throws std::invalid_argument with all of them, a line each, after `who`; does nothing without any.
void refuse(const std::string& who, const std::vector<std::string>& mistakes);

/// Throws std::invalid_argument with all mistakes of model, state and stage.
template <class AnyStage>
void require_consistent(const std::string& who, const Model& model, const AnyStage& stage,
                        const State& state) {
  refuse(who, mistakes_in(model));
  std::vector<std::string> mistakes = mistakes_in(model, state);
  for (std::string& m : mistakes_in(model, stage)) mistakes.push_back(std::move(m));
  refuse(who, mistakes);
  refuse(who, mistakes_in(stage.supports, state));
}

}  // namespace vbond
