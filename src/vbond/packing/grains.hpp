#pragma once
#include <cstddef>
#include <vector>

#include "vbond/packing/pack.hpp"

namespace vbond::packing {

/// Grains before they have places, the largest first.
struct Grains {
  std::vector<double> radius;
  std::vector<std::size_t> kind;
  double sizes_off = 0;
};

/// n grains, those of a kind to the next whole number: what is left over goes to the largest remainders.
Grains make_grains(const Request& q, double n);

/// Of one grain.  [length^3]
double mean_volume(const Request& q);

}  // namespace vbond::packing
