#pragma once
#include <algorithm>

#include "vbond/model/state.hpp"
#include "vbond/observe/detail/h5_file.hpp"

/// What a checkpoint says of walls; only where a model has some.
namespace vbond {

using WallStates = Column<Id<struct WallOfFile>, WallState>;
using WallMemories = Column<Id<struct TouchOfFile>, WallMemory>;

template <class Archive, class Walls>
void visit_walls(Archive& archive, Walls& walls) {
  archive.of_each("/walls/displacement", walls, &WallState::displacement);
  archive.of_each("/walls/q", walls, &WallState::q);
  archive.of_each("/walls/velocity", walls, &WallState::velocity);
  archive.of_each("/walls/angular_velocity", walls, &WallState::angular_velocity);
  archive.of_each("/walls/force", walls, &WallState::force);
  archive.of_each("/walls/moment", walls, &WallState::moment);
  archive.of_each("/walls/servo", walls, &WallState::servo);
  archive.of_each("/walls/work", walls, &WallState::work);
}

template <class Archive, class Touches>
void visit_touches(Archive& archive, Touches& touches) {
  archive.of_each("/wall_touches/particle", touches, &WallMemory::p);
  archive.of_each("/wall_touches/wall", touches, &WallMemory::wall);
  archive.of_each("/wall_touches/normal", touches, &WallMemory::normal);
  archive.of_each("/wall_touches/history", touches, &WallMemory::history);
}

inline void write_walls(H5Writer& writer, const State& state) {
  if (state.walls.empty()) return;
  const WallStates walls(state.walls);
  visit_walls(writer, walls);
  const auto is_off = [](const WallState& w) { return w.off != 0; };
  if (std::any_of(state.walls.begin(), state.walls.end(), is_off))
    writer.of_each("/walls/off", walls, &WallState::off);
  if (state.wall_history.empty()) return;
  const WallMemories touches(state.wall_history);
  visit_touches(writer, touches);
}

inline void read_walls(H5Reader& reader, State& state) {
  if (!reader.has("/walls/q")) return;
  WallStates walls;
  walls.resize(reader.rows("/walls/q"));
  visit_walls(reader, walls);
  if (reader.has("/walls/off")) reader.of_each("/walls/off", walls, &WallState::off);
  state.walls.assign(walls.begin(), walls.end());
  if (!reader.has("/wall_touches/particle")) return;
  WallMemories touches;
  touches.resize(reader.rows("/wall_touches/particle"));
  visit_touches(reader, touches);
  for (const WallMemory& m : touches)
    if (m.p.value >= state.r.size() || m.wall >= state.walls.size())
      throw IoError("is damaged: a touch of a wall has impossible ends");
  state.wall_history.assign(touches.begin(), touches.end());
}

}  // namespace vbond
