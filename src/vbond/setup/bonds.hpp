#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/body_part.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/setup/bond_pairs.hpp"

namespace vbond {

/// Makes the bonds of set number `set` of the case between the particles as they stand in `state`, in order
/// of (i, j), i < j. Pairs bonded already are passed over if selected by distance or bonded by this same
/// set, and a mistake otherwise.
void add_bonds(const Case& c, std::size_t set, const Model& model, State& state, Problems& problems,
               SharedCells& shared);

/// The same for pairs that have been selected.
void make_bonds(const Case& c, std::size_t set, const Model& model, State& state,
                const SelectedPairs& selected, Problems& problems);
/// What books have of a bond of the state.
struct UnbookedBond {
  BondId bond;
  EnergyOfNewBond energy;
};
/// The same for some of the pairs of a set at centres and surfaces. Books nothing: returns what there is to
/// book, in order of bonds.
std::vector<UnbookedBond> make_some_bonds(const Case& c, std::size_t set, const Model& model, State& state,
                                          const SelectedPairs& selected, Problems& problems);

/// Looks ahead at a set that makes its bonds when particles have moved on from where they stand in `state`.
/// Pairs that are listed are bonded as they stand, and what is wrong with them wherever they stand is
/// recorded. False if it is not known which bonds it will make, as it is for a selection by distance.
bool expect_bonds(const Case& c, std::size_t set, const Model& model, State& state, Problems& problems);

/// The length below which a bond softens without snapping back, if c_A, which is that of length a, goes as
/// 1/a: 2 E G_f/s_c^2. Infinite without softening. weakness: see WithRules.
double longest_softening_bond(const Softening& softening, double c_A, double a, double weakness = 0.0);
/// Records that bonds of a set are longer.
void refuse_snap_back(const BondSpec& spec, const std::string& what, double longest, Problems& problems);

/// Records that bonds of a set would break by their prestrain as they are made.
void refuse_broken_by_prestrain(const BondSpec& spec, const std::string& what, Problems& problems);

/// Which sets have bonds that are by chance weaker than what their prestrain brings, and how many; of bonds
/// made on approach about how many, from a thousand at their distance.
std::vector<std::string> notes_on_prestrain(const Case& c, const Model& model, const BodyPart& body);

/// Longitudinal stiffness of the first bond of the body, or of the one that the first bond set would make;
/// nothing if the case has no bonds.  [force/length]
std::optional<double> first_c_A(const Case& c, const Model& model, const State& state);

}  // namespace vbond
