#pragma once
#include <initializer_list>
#include <vector>

#include "vbond/dynamics/motion_term.hpp"
#include "vbond/terms/heat/motion_heat.hpp"
#include "vbond/terms/pressure/motion_pressure.hpp"
#include "vbond/terms/strain/motion_strain.hpp"
#include "vbond/terms/walls/motion_walls.hpp"

namespace vbond {

/// The list of the terms of a body in motion. A step goes over those that its stage has, in this order. A
/// strain that is imposed has all loads worked out anew: what moves by itself, as walls do, comes after it.
class MotionTerms {
 public:
  explicit MotionTerms(const BodyInMotion& on) : heat(on), strain(on), pressure(on), walls(on) {
    for (MotionTerm* t : std::initializer_list<MotionTerm*>{&heat, &strain, &pressure, &walls})
      if (t->is_there()) {
        all_.push_back(t);
        if (t->touches()) touching_.push_back(t);
      }
  }
  MotionTerms(const MotionTerms&) = delete;
  MotionTerms& operator=(const MotionTerms&) = delete;

  bool any() const { return !all_.empty(); }
  const std::vector<MotionTerm*>& all() { return all_; }
  /// Those that particles touch.
  const std::vector<MotionTerm*>& touching() { return touching_; }
  bool any_touching() const { return !touching_.empty(); }
  void write(State& state) const {
    for (const MotionTerm* t : all_) t->write(state);
  }
  /// What they store.  [energy]
  double energy() const {
    double sum = 0.0;
    for (const MotionTerm* t : all_) sum += t->energy();
    return sum;
  }

  MotionHeat heat;
  MotionStrain strain;
  MotionPressure pressure;
  MotionWalls walls;

 private:
  std::vector<MotionTerm*> all_, touching_;
};

}  // namespace vbond
