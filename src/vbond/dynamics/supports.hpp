#pragma once
#include "vbond/model/loads.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// Gives every held degree of freedom its prescribed velocity at stage time t and books the change of
/// kinetic energy as work of the supports: at the start of a stage, and after damping.
void hold_velocities(const Model& model, const Stage& stage, double t, State& state);

/// The same after a kick over [t, t + h] by these loads. The support's impulse is what the prescribed
/// change of velocity needs beyond the loads; it acts at the mean prescribed velocity, so the work is
/// exact for constant velocities and second order otherwise.
void hold_velocities_after_kick(const Model& model, const Stage& stage, const Loads& loads, double t,
                                double h, State& state);

/// Adds point loads at stage time t and gravity.
void add_applied_loads(const Model& model, const Stage& stage, double t, Loads& loads);

/// Books the work of point loads and gravity over a drift from stage time t to t + h at the present
/// velocities; loads that change in time by the trapezoidal rule.
void book_applied_work(const Model& model, const Stage& stage, double t, double h, int threads, State& state);

}  // namespace vbond
