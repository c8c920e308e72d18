#pragma once
#include "vbond/packing/pack.hpp"

namespace vbond::packing {

/// Removes or grows the grains with too few neighbours, if the request wants it: r, radius, kind and counts
/// of the packing. A grain grows in the hole that it is in, between grains that stay where they are, until
/// that holds it or until it is as large as the largest of its kind.
void settle_floaters(const Request& request, Packing& packing);

}  // namespace vbond::packing
