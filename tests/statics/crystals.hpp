#pragma once
#include <cstddef>

#include "vbond/statics/elastic_constants.hpp"

namespace vbond::testing {

/// Of a cubic crystal, its edges along the axes.
inline Constants cubic(double C11, double C12, double C44) {
  Constants C{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) C[a][b] = a == b ? C11 : C12;
  for (std::size_t a = 3; a < 6; ++a) C[a][a] = C44;
  return C;
}

}  // namespace vbond::testing
