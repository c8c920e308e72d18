#pragma once
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// v += h F/m, omega += h M/Theta.
void kick(const Model& model, const Loads& loads, double h, int threads, State& state);

/// r += h v; q is turned exactly by the angle vector h omega, then normalised.
void drift(double h, int threads, State& state);

}  // namespace vbond
