#pragma once
#include <functional>
#include <string>

/// Multigrid on several processes of MPI. One of them runs the program; the others have their rows of what it
/// solves with, and nothing else of the body. Of builds with PETSc alone.
namespace vbond {

/// To be called by all processes of a program that has begun MPI, before anything else. On the first it
/// returns true at once. The others do here what the first one asks until that calls end_multigrid_ranks();
/// then it returns false on them. Where something goes wrong in one, the others would wait for it for ever:
/// it calls end_all with the reason, which ends them all and does not return.
bool begin_multigrid_ranks(std::function<void(const std::string& why)> end_all);
/// By the first one, once there are no more solvers.
void end_multigrid_ranks();

}  // namespace vbond
