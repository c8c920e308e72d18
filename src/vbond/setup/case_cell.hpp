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

/// Refuses [[velocities]] and rigid supports that turn a group of which specimens have been brought into the
/// cell in pieces; and velocities of a group that bonds join through a face of the cell.
void check_turned_pieces(const Case& c, const std::vector<PlacedSpecimen>& specimens, const Built& built,
                         Problems& problems);
/// Refuses rigid supports of a stage that turn particles which bonds join through a face of the cell. ahead:
/// before the stages in front of it have run, when only bonds count that cannot break.
void refuse_turned_through_face(const StageSpec& spec, const std::vector<Support>& supports,
                                const State& state, bool ahead, Problems& problems);

/// Refuses what a periodic body cannot have.
void check_periodic(const Case& c, const Model& model, Problems& problems);

}  // namespace vbond
