#include "vbond/terms/detail/term_mistakes.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

void look_at_terms(const Model& model, const Stage& stage, Mistakes& found) {
  Terms::for_each([&]<class T>(T) { T::look_at_motion(model, stage, found); });
}

void look_at_terms(const Model& model, const StaticStage& stage, Mistakes& found) {
  Terms::for_each([&]<class T>(T) { T::look_at_rest(model, stage, found); });
}

}  // namespace vbond
