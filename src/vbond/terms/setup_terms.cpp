#include "vbond/terms/setup_terms.hpp"

namespace vbond {

void resolve_terms(const StageResolver& resolver, StageTerms& stage) {
  Terms::for_each([&]<class T>(T) { T::resolve(resolver, stage); });
}

void complete_terms(const StageResolver& resolver, const State& state, StageTerms& stage) {
  Terms::for_each([&]<class T>(T) { T::complete(resolver, state, static_cast<StagePart<T>&>(stage)); });
}

}  // namespace vbond
