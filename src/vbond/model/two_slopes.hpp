#pragma once
#include "vbond/model/state.hpp"

// Bonds that stretch by one stiffness and are pressed by another.
namespace vbond {

/// What rounding of places may make of the gap beside a particle: 16 eps, for the terms of a distance, of
/// where it stands and of the edges that lead to its images.  [length]
double rounding_of_place(const State& s, ParticleId p);
/// Of lengths: a balance is exact to 1e-10 of the largest force, and so a body strained by 0.1 is to this.
inline constexpr double rounding_of_balance = 1e-11;

bool has_two_slopes(const Bond& b);
/// Whether it bears no axial force, to rounding.
bool is_unstrained(const State& s, BondId k);

}  // namespace vbond
