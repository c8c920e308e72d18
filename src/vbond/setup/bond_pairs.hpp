#pragma once
#include <compare>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/make_bond.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/packing/voronoi.hpp"

namespace vbond {

/// Two particles to be bonded, i < j; or i and an image of j, i <= j, of i itself one that is > 0.
struct Pair {
  ParticleId i, j;
  Image image_j{};
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// The same pair, whichever end comes first.
Pair in_order(const Pair& pair);

/// What a pair is bonded at in place of its centres or surfaces: points of the axes of two fibres.
struct CrossingPoints {
  Vec3d offset_i, offset_j;  ///< from the centres of the particles  [length]
  double R_i = 0, R_j = 0;   ///< radii of the fibres there  [length]
};

/// What a set bonds: pairs in order, and, for a selection of crossings, the points of each.
struct SelectedPairs {
  std::vector<Pair> pairs;
  std::vector<CrossingPoints> crossings;
};
/// Pair number k as bond creation sees it.
std::pair<BondSite, BondSite> sites_of(const SelectedPairs& selected, std::size_t k, const Model& model,
                                       const State& state);

/// All pairs with one end in each group and centres no farther apart than `distance` > 0, in order, also
/// through the faces of a cell. Throws std::length_error if they are more than `most`.
std::vector<Pair> pairs_within(const std::vector<Vec3d>& r, double distance, const std::vector<char>& in_a,
                               const std::vector<char>& in_b,
                               double most = std::numeric_limits<double>::infinity(),
                               const CellEdges& cell = {}, const Periodic& periodic = {});

/// The same for pairs whose distance is within `reach`, given a radius >= 0 for each particle.
std::vector<Pair> pairs_within(const std::vector<Vec3d>& r, const std::vector<double>& radius,
                               const BondReach& reach, const std::vector<char>& in_a,
                               const std::vector<char>& in_b,
                               double most = std::numeric_limits<double>::infinity(),
                               const CellEdges& cell = {}, const Periodic& periodic = {});

/// Radical Voronoi cells of the particles as they stand while bond sets are made, one after the other: worked
/// out once for all sets that need the same.
class SharedCells {
 public:
  /// threads: see build().
  explicit SharedCells(int threads = 0) : threads_(threads) {}
  /// For another state, by as many threads.
  SharedCells anew() const { return SharedCells(threads_); }
  /// Of the particles that take part. Cells end `margin` outside of the outermost centres where nothing
  /// repeats.
  const packing::VoronoiCells& of(const Model& model, const State& state, const std::vector<Vec3d>& r,
                                  const std::vector<double>& radius, double margin);

 private:
  int threads_;
  double margin_ = 0;
  std::optional<packing::VoronoiCells> cells_;
};
/// The same for the particles of a state that are there.
std::vector<Pair> pairs_within(const Model& model, const State& state, const BondReach& reach,
                               const std::vector<char>& in_a, const std::vector<char>& in_b, double most);
/// Of these pairs, of a state in which all are there, those whose first particle is one of some. Looks at
/// what is near these alone, of a periodic body at all.
std::vector<Pair> pairs_within(const Model& model, const State& state, const BondReach& reach,
                               const std::vector<char>& in_a, const std::vector<char>& in_b, double most,
                               const PerParticle<char>& some);

/// Of these pairs keeps those whose radical Voronoi cells, of all particles, share a face of which the area
/// is at least `least` times the square of the distance of the centres.
void keep_those_that_share_faces(const Model& model, const State& state, double least, SharedCells& shared,
                                 std::vector<Pair>& pairs);

/// The pairs that set number `set` of the case bonds between the particles as they stand in `state`, in
/// order. Bonded already are those of the state, and of the sets before it where their pairs are given.
/// some: those alone whose first particle is one of these, and it is no mistake if there are none; crossings
/// are not selected so.
SelectedPairs select_pairs(const Case& c, std::size_t set, const Model& model, const State& state,
                           Problems& problems, SharedCells& shared,
                           std::span<const SelectedPairs> before = {},
                           const PerParticle<char>* some = nullptr);

/// A line for each bond set with a file of pairs, where a specimen of rows of a file is cut: whoever wrote
/// the pairs may have had the rows in mind.
std::vector<std::string> notes_on_pairs(const Case& c);

}  // namespace vbond
