#pragma once
#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/groups.hpp"

namespace vbond {

/// The cell of a case, if it has one, its own or the box of a file: into the model and the state; particles
/// of specimens are brought into it, but those of LAMMPS data files, which stay where their image flags put
/// them. Notes lattices that do not fit it, and files whose box it is not.
void add_cell(const Case& c, const std::vector<PlacedSpecimen>& specimens, Built& built, Problems& problems);

/// Edges and corner of the cell of a case that has one, also before its specimens are made. Throws CaseError
/// for a cell that is none.
FileBox cell_of_case(const Case& c);

/// The wave vectors of a stage, in whichever way they are given.
WaveVectors waves_of(const StageSpec& s);

/// Refuses what a periodic body cannot have.
void check_periodic(const Case& c, const Model& model, Problems& problems);

}  // namespace vbond
