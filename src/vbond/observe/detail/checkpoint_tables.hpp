#pragma once
#include <cstdint>
#include <tuple>
#include <vector>

#include "vbond/model/field_table.hpp"
#include "vbond/model/state_table.hpp"
#include "vbond/observe/watch.hpp"

/// What a checkpoint holds besides State: what the watch has seen, and the particles' constants.
namespace vbond {

using PairOfParticles = std::pair<ParticleId, ParticleId>;
using ParticleInWall = std::pair<ParticleId, std::uint32_t>;

inline constexpr auto watch_table = std::tuple{
    rows_of("/watch/", &WatchRecord::bonds, {},
            field("worst", &BondRecord::worst, unit::none,
                  "worst range of each bond: 0 good, 1 strained, 2 snapped"),
            field("was_short", &BondRecord::was_short, unit::none,
                  "1: the bond has been shorter than half its length at rest")),
    fields_of<WatchRecord>(
        "/watch/", field("strained", &WatchRecord::strained, unit::none, "bonds that were found strained"),
        field("snapped", &WatchRecord::snapped, unit::none, "bonds that were found snapped"),
        field("shortened", &WatchRecord::shortened, unit::none, "bonds that were found short"),
        field(
            "fastest", &WatchRecord::fastest, unit::none,
            "largest way of a particle in a step over the longest that contacts can follow; only if one was "
            "too fast",
            {.filed = Filed::where_any}),
        field("farthest_turn", &WatchRecord::farthest_turn, unit::angle,
              "largest angle by which a particle turned in a step; only if one turned too far",
              {.filed = Filed::where_any})),
    rows_of("/watch/overlapping_", &WatchRecord::overlapping, {.filed = Filed::where_any},
            field("i", &PairOfParticles::first, unit::none,
                  "first particles of pairs that were found to overlap; only if there are any"),
            field("j", &PairOfParticles::second, unit::none, "second particles of these pairs")),
    rows_of("/watch/", &WatchRecord::stretched, {.filed = Filed::where_any},
            field("stretched", &BondId::value, unit::none,
                  "bonds that were found longer than twice their length; only if there are any")),
    rows_of("/watch/in_wall_", &WatchRecord::in_walls, {.filed = Filed::where_any},
            field("particle", &ParticleInWall::first, unit::none,
                  "particles that were found to overlap walls; only if there are any"),
            field("wall", &ParticleInWall::second, unit::none, "number of the wall of each")),
    rows_of("/watch/deep_", &WatchRecord::deep, {.filed = Filed::where_any},
            field("i", &DeepPair::i, unit::none,
                  "first particles of pairs that are deep in one another; only if there are any"),
            field("j", &DeepPair::j, unit::none, "second particles of these pairs"),
            field("entered", &DeepPair::entered, unit::length, "r_j - r_i as they came so deep"),
            field("nearest", &DeepPair::nearest, unit::length, "least distance of their centres since"),
            field("last_step", &DeepPair::last_step, unit::none, "last step at which they still were")),
};

/// What must be the same for a checkpoint to fit a model.
inline constexpr auto model_table = std::tuple{
    fields_of<Model>(
        "/model/", field("units", &Model::units, unit::none, "0 reduced, 1 SI"),
        field("mass", &Model::mass, unit::mass, "of the particles", {.known = Known::by_owner}),
        field("inertia", &Model::inertia, unit::inertia,
              "moments of inertia of the particles, the least where they differ", {.known = Known::by_owner}),
        field("radius", &Model::radius, unit::length, "of the particles"),
        field("r_0", &Model::r_0, unit::length, "first positions", {.known = Known::by_owner})),
    rows_of("/model/principal_", &Model::principal, {.filed = Filed::where_any},
            field("moments", &PrincipalInertia::moments, unit::inertia,
                  "about their principal axes; only if those of a particle differ, as are its axes"),
            field("axes", &PrincipalInertia::axes, unit::none,
                  "quaternions from the principal axes to the body")),
};

/// The cell of a model, if it has one, as a row of a table.
struct FirstCell {
  Vec3d a, b, c;
  Image repeats;  // 1 along edges that do
  std::uint32_t triangular = 0;
  friend bool operator==(const FirstCell&, const FirstCell&) = default;
};
struct FirstCells {
  std::vector<FirstCell> cells;
};
inline FirstCells first_cells(const Model& model) {
  if (!model.cell.any()) return {};
  const auto& [a, b, c] = model.cell.edges;
  const auto& [along_a, along_b, along_c] = model.cell.periodic;
  return {{{a, b, c, {along_a, along_b, along_c}, model.cell.triangular}}};
}

/// What must be the same of it; older checkpoints do not have it.
inline constexpr auto cell_table = std::tuple{
    rows_of(
        "/model/cell_", &FirstCells::cells, {.filed = Filed::where_any},
        field("a", &FirstCell::a, unit::length, "an edge of the cell at the start; only where there is one"),
        field("b", &FirstCell::b, unit::length, "likewise"),
        field("c", &FirstCell::c, unit::length, "likewise"),
        field("repeats", &FirstCell::repeats, unit::none, "along which of them the body repeats: 1"),
        field("triangular", &FirstCell::triangular, unit::none,
              "1: its deformation gradient is upper triangular; 0: symmetric")),
};

}  // namespace vbond
