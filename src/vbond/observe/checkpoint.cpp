#include "vbond/observe/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/mistakes.hpp"
#include "vbond/observe/detail/checkpoint_tables.hpp"
#include "vbond/observe/detail/fracture_file.hpp"
#include "vbond/observe/detail/h5_parts.hpp"
#include "vbond/observe/detail/h5_read_part.hpp"
#include "vbond/observe/detail/h5_tables.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/seal.hpp"

namespace vbond {
namespace {

// Within a stage of fracture the state alone would be that of another run: a program that knows only the
// older format must not go on from it.
constexpr std::int32_t format_version = 4, format_within_fracture = newest_checkpoint_format;

void check_fingerprint(H5Reader& reader, const Model& model) {
  const std::size_t n = reader.rows("/model/mass");
  if (n != model.particles())
    throw IoError(
        fmt::format("belongs to another case: it has {} particles, the case has {}", n, model.particles()));
  Model m;
  read_tables(reader, model_table, {.particles = n}, {}, m);
  m.r_0.hold(model.r_0.held());  // of several processes each knows its own
  FirstCells at_start;
  read_tables(reader, cell_table, {}, {}, at_start);
  const bool another_cell = !at_start.cells.empty() && at_start.cells != first_cells(model).cells;
  const char* differs = m.units != model.units                                         ? "units"
                        : m.mass != model.mass                                         ? "masses"
                        : m.inertia != model.inertia || m.principal != model.principal ? "moments of inertia"
                        : m.radius != model.radius                                     ? "radii"
                        : m.r_0 != model.r_0                                           ? "first positions"
                        : another_cell                                                 ? "cells at the start"
                                                                                       : nullptr;
  if (differs)
    throw IoError(fmt::format("belongs to another case, or the case was changed: its {} differ", differs));
}

/// What no watch can have seen.
void check_sense(const WatchRecord& watch, const FileSizes& sizes) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw IoError(fmt::format("is damaged: {}", what));
  };
  const auto all = [](const auto& rows, auto holds) { return std::all_of(rows.begin(), rows.end(), holds); };
  const std::size_t n = sizes.particles, bonds = sizes.bonds;
  require(watch.bonds.size() <= bonds, "it watches missing bonds");
  require(all(watch.overlapping, [n](const auto& p) { return p.first < p.second && p.second.value < n; }),
          "an overlap has impossible ends");
  require(all(watch.stretched, [bonds](BondId k) { return k.value < bonds; }),
          "a stretched bond is none of its bonds");
  require(all(watch.in_walls, [n](const auto& in) { return in.first.value < n; }),
          "a wall is overlapped by no particle");
  require(all(watch.deep, [n](const auto& d) { return d.second.i < d.second.j && d.second.j.value < n; }),
          "a deep pair has impossible ends");
}

void check_sense(const Model& model, const State& state) {
  for (const auto& mistakes : {mistakes_in(model, state), mistakes_in_values(model, state)})
    if (!mistakes.empty()) throw IoError("is damaged: " + mistakes.front());
}

/// A checkpoint under way: model, cell and state come first.
class NewCheckpoint {
 public:
  NewCheckpoint(const std::filesystem::path& path, UnitSystem units)
      : file_(path), writer_(file_.part(), units) {}
  H5Writer& writer() { return writer_; }
  /// All else. It then takes the place of an older one.
  void publish(const WatchRecord& watch, const FractureUnderWay* under_way,
               const std::string& program_version) {
    write_tables(writer_, watch_table, watch);
    if (under_way) write_fracture(writer_, *under_way);
    writer_.finish();
    write_seal(file_.part(), under_way ? format_within_fracture : format_version, program_version);
    file_.publish(Sync::to_disk);
  }

 private:
  Replacement file_;
  H5Writer writer_;
};

/// Does the work of writing a checkpoint. Throws IoError that says what is there if it fails.
template <class Work>
void try_to_write(const std::filesystem::path& path, Work work) {
  try {
    work();
  } catch (const IoError& e) {
    std::error_code unknown;
    const bool older = std::filesystem::exists(path, unknown);
    throw IoError(path.string() +
                  (older ? ": there is no new checkpoint, an older one is still there: "
                         : ": there is no checkpoint, this would have been the first: ") +
                  e.what());
  }
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Model& model, const State& state,
                      const WatchRecord& watch, const std::string& program_version,
                      const FractureUnderWay* under_way) {
  const H5Silence silence;
  try_to_write(path, [&] {
    NewCheckpoint checkpoint(path, model.units);
    write_tables(checkpoint.writer(), model_table, model);
    write_tables(checkpoint.writer(), cell_table, first_cells(model));
    write_tables(checkpoint.writer(), state_table, state);
    checkpoint.publish(watch, under_way, program_version);
  });
}

void write_checkpoint(const std::filesystem::path& path, const Model& model, const StateOfPart& part,
                      const WatchRecord& watch, const std::string& program_version) {
  try_to_write(path, [&] {
    LeadersWork lead(part.all.leads());
    std::optional<H5Silence> silence;
    std::optional<NewCheckpoint> checkpoint;
    lead([&] { silence.emplace(), checkpoint.emplace(path, model.units); });
    BodyInPieces body(part, lead, [&]() -> H5Writer& { return checkpoint.value().writer(); });
    body.write(model_table, model);
    body.write(cell_table, first_cells(model));
    body.write(state_table, part.state);
    lead([&] { checkpoint->publish(watch, nullptr, program_version); });
    lead.end();
  });
}

namespace {

/// read(reader, sizes) reads what is in the file, once that is known to be of this model.
template <class Read>
auto try_to_read(const std::filesystem::path& path, const Model& model, Read read) {
  open_file(path, "rb");  // a missing or forbidden file is told in the system's words
  const H5Silence silence;
  try {
    check_seal(path, format_version, format_within_fracture);
    H5Reader reader(path);
    check_fingerprint(reader, model);
    return read(reader, FileSizes{.particles = model.particles(), .bonds = reader.rows("/bonds/i")});
  } catch (const IoError& e) {
    throw IoError(path.string() + ": " + e.what());
  }
}

/// After its state.
void read_rest(H5Reader& reader, const FileSizes& sizes, const Model& model,
               std::span<const BondLaw* const> laws, Checkpoint& c) {
  read_tables(reader, watch_table, sizes, laws, c.watch);
  check_sense(model, c.state);
  check_sense(c.watch, sizes);
}

}  // namespace

Checkpoint read_checkpoint(const std::filesystem::path& path, const Model& model,
                           std::span<const BondLaw* const> laws) {
  return try_to_read(path, model, [&](H5Reader& reader, const FileSizes& sizes) {
    Checkpoint c;
    read_tables(reader, state_table, sizes, laws, c.state);
    read_rest(reader, sizes, model, laws, c);
    if (has_fracture(reader)) c.under_way = read_fracture(reader, model, c.state, laws);
    return c;
  });
}

CheckpointInPart read_checkpoint(const std::filesystem::path& path, const Model& model, State made,
                                 const BondsFromSetUp& own) {
  return try_to_read(path, model, [&](H5Reader& reader, const FileSizes& sizes) {
    CheckpointInPart read;
    if (sizes.bonds != own.whole) return read;
    StateInPart part(reader, sizes, own.part.names, made.q.held(), {});
    State& state = read.checkpoint.state;
    state.bonds = std::move(made.bonds);
    made = {};  // makes room for what is read
    read.same_bonds = part.read(state_table, state);
    read_rest(reader, sizes, model, {}, read.checkpoint);
    return read;
  });
}

}  // namespace vbond
