#pragma once
#include "body_plan.hpp"

namespace vbond::campaign {

/// One case: a body and how it is asked for its critical loads. Case k is the same whatever the number of
/// cases.
struct RandomCase {
  int number = 0;
  BodyPlan plan;
  int count = 1;            ///< of critical loads that buckling shall find
  double first_step = 0.1;  ///< of the path, as a part of the first critical load factor
  double largest_step = 0;  ///< of the path  [length]; 0: automatic
};

RandomCase random_case(unsigned seed, int number);

}  // namespace vbond::campaign
