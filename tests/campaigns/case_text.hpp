#pragma once
#include <cstdio>
#include <string>

#include "vbond/core/vec3.hpp"

/// Values as campaigns write them into cases: with all digits.
namespace vbond::testing {

inline std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
inline std::string vector(const Vec3d& x) {
  return "[" + number(x.x) + ", " + number(x.y) + ", " + number(x.z) + "]";
}

}  // namespace vbond::testing
