#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/model/static_stage.hpp"

/// Bonds that grow with temperature: a = a_0 (1 + g), g = alpha T, and so do the attachment distances, with T
/// the mean of the two particles' temperatures. The coefficients stay.
namespace vbond {

/// By what part of its lengths at temperature 0 a bond has grown.
inline double growth_of(const State& s, const WarmBond& w) {
  return growth_of(s, s.bonds[w.bond], w.expansion);
}
/// The bond as it would be if it had grown by this part.
Bond with_growth(const State& s, const WarmBond& w, double growth);
/// Bonds that are not broken get the lengths that belong to their temperatures.
void take_lengths(State& s);

/// What growth does to the energy of a bond as its particles stand: dU/dg = -a_0 N - F.(R_i n_i - R_j n_j),
/// with the R at g = 0. For laws whose energy depends on the length at rest by D - a alone.  [energy]
double power_of_growth(const Bond& b, const WarmBond& w, const BondPose<double>& pose,
                       const BondHistory& history);

/// Between which growths the temperatures of a stage take a bond that expands, where those of one particle
/// may come at any time of another's; at rest up to load factor 1, or the largest of the stage.
struct GrowthRange {
  double least = 0, largest = 0;
};
/// Of each bond that expands, in the order of State::warm_bonds.
std::vector<GrowthRange> growth_in(const State& s, const Stage& stage);
std::vector<GrowthRange> growth_in(const State& s, const StaticStage& stage);
/// The first bond that the stage would take all length from, in words; nothing if there is none.
std::optional<std::string> bond_without_length(const State& s, const std::vector<GrowthRange>& growth);

/// The first n bonds stay, those after them are taken back.
void keep_bonds(State& s, std::size_t n);

}  // namespace vbond
