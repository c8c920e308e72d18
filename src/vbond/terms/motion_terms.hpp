#pragma once
#include <array>
#include <memory>
#include <vector>

#include "vbond/dynamics/motion_term.hpp"
#include "vbond/terms/terms.hpp"

namespace vbond {

/// The terms of a body in motion. A step goes over those that its stage has, in the order of the list.
class MotionTerms {
 public:
  explicit MotionTerms(const BodyInMotion& on);

  bool any() const { return !all_.empty(); }
  const std::vector<MotionTerm*>& all() { return all_; }
  /// Those that need all particles to have moved before loads are added.
  const std::vector<MotionTerm*>& touching() { return touching_; }
  bool any_touching() const { return !touching_.empty(); }
  /// Those that add loads block by block.
  const std::vector<MotionTerm*>& loading() { return loading_; }
  void write(State& state) const;
  /// What they store.  [energy]
  double energy() const;
  /// The one that is T::Of in motion, also if the stage does not have it.
  template <class T>
  const T& of() const {
    return static_cast<const T&>(*list_[Terms::place_of<typename T::Of>()]);
  }

 private:
  std::array<std::unique_ptr<MotionTerm>, Terms::size> list_;
  std::vector<MotionTerm*> all_, touching_, loading_;
};

}  // namespace vbond
