#include "vbond/terms/motion_terms.hpp"

namespace vbond {

std::unique_ptr<MotionTerm> Term::in_motion(const BodyInMotion&) {
  return nullptr;
}

MotionTerms::MotionTerms(const BodyInMotion& on) {
  auto next = list_.begin();
  Terms::for_each([&]<class T>(T) { *next++ = T::in_motion(on); });
  for (const auto& t : list_)
    if (t != nullptr && t->is_there()) {
      all_.push_back(t.get());
      if (t->touches()) touching_.push_back(t.get());
      if (t->adds_loads()) loading_.push_back(t.get());
    }
}

void MotionTerms::write(State& state) const {
  for (const MotionTerm* t : all_) t->write(state);
}

double MotionTerms::energy() const {
  double sum = 0.0;
  for (const MotionTerm* t : all_) sum += t->energy();
  return sum;
}

}  // namespace vbond
