#pragma once
#include <tuple>
#include <vector>

#include "vbond/model/field_table.hpp"
#include "vbond/terms/term.hpp"
#include "vbond/terms/walls/wall.hpp"

namespace vbond {

struct WallsTerm;

template <>
struct StagePart<WallsTerm> {
  std::vector<WallDrive> walls;  ///< of motion, equilibrium and fracture; other walls stand still
  bool any() const { return !walls.empty(); }
};

template <>
struct StatePart<WallsTerm> {
  std::vector<WallState> walls;          ///< of each wall; empty: as at the start, at rest
  std::vector<WallMemory> wall_history;  ///< of touches that remember something, in order of (p, wall)
  friend bool operator==(const StatePart&, const StatePart&) = default;
};

/// The walls of a model (Model::walls): what they do to particles, and what moves them.
struct WallsTerm : Term {
  static constexpr const char* key = "walls";
  static constexpr auto state_tables = std::tuple{
      rows_of(
          "/walls/", &StatePart<WallsTerm>::walls, {.filed = Filed::where_any},
          field("displacement", &WallState::displacement, unit::length,
                "of the walls' centres since the start; only where there are walls"),
          field("q", &WallState::q, unit::none, "orientations of walls, quaternions w, x, y, z"),
          field("velocity", &WallState::velocity, unit::velocity, "of the walls' centres, half a step ago"),
          field("angular_velocity", &WallState::angular_velocity, unit::angular_velocity,
                "of walls, half a step ago"),
          field("force", &WallState::force, unit::force, "of particles on walls"),
          field("moment", &WallState::moment, unit::moment,
                "of particles on walls, about the walls' centres"),
          field("servo", &WallState::servo, unit::velocity,
                "speed of walls along the direction of their servo"),
          field("work", &WallState::work, unit::energy, "that walls have done on particles"),
          field("off", &WallState::off, unit::none,
                "1 for walls that the stage takes away; only where there are such",
                {.filed = Filed::where_any})),
      rows_of(
          "/wall_touches/", &StatePart<WallsTerm>::wall_history,
          {.known = Known::listed, .filed = Filed::where_any},
          field("particle", &WallMemory::p, unit::none, "particles that touch walls; only if there are any"),
          field("wall", &WallMemory::wall, unit::none, "number of the wall that each touches"),
          field("normal", &WallMemory::normal, unit::none, "unit vectors from the wall to the particle"),
          field("history", &WallMemory::history, unit::none,
                "what is remembered of the touch, as /contacts/history"))};
  static void look_at_motion(const Model& model, const Stage& stage, Mistakes& found);
  static void look_at_rest(const Model& model, const StaticStage& stage, Mistakes& found);
  static void describe(keys::Table& t, SpecPart<WallsTerm>& s, std::optional<StageKind> kind);
  static void resolve(const StageResolver& resolver, StagePart<WallsTerm>& to);
  static std::unique_ptr<MotionTerm> in_motion(const BodyInMotion& on);
  static std::unique_ptr<RestTerm> at_rest(const StaticBody& body, State& state);
  static void add_columns(std::vector<GroupQuantity>& to);
};

}  // namespace vbond
