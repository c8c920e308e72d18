#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/watch.hpp"

namespace vbond {

/// The newest format of a checkpoint: of one within a stage of fracture.
inline constexpr std::int32_t newest_checkpoint_format = 5;

struct FractureUnderWay;
struct BondsFromSetUp;
struct StateOfPart;

/// All that is needed to go on as if nothing had happened: the state bit for bit, and what the watch
/// has already reported. The model and the stages are built again from the case.
struct Checkpoint {
  State state;
  WatchRecord watch;
  std::shared_ptr<const FractureUnderWay> under_way = {};  ///< within a stage of fracture; else null
  friend bool operator==(const Checkpoint&, const Checkpoint&) = default;
};

/// Writes checkpoint.h5 so that `path` is at every moment either the old or the new checkpoint.
/// The particles' constants go with it, to tell on reading that the model is still the same.
/// Throws IoError.
void write_checkpoint(const std::filesystem::path& path, const Model& model, const State& state,
                      const WatchRecord& watch, const std::string& program_version,
                      const FractureUnderWay* under_way = nullptr);
inline void write_checkpoint(const std::filesystem::path& path, const Model& model,
                             const Checkpoint& checkpoint, const std::string& program_version) {
  write_checkpoint(path, model, checkpoint.state, checkpoint.watch, program_version,
                   checkpoint.under_way.get());
}

/// The same file, of a body that several processes share: all of them call this together. Each sends what it
/// has, a piece at a time, to the one that leads, which writes it, and throws if it cannot.
void write_checkpoint(const std::filesystem::path& path, const Model& model, const StateOfPart& part,
                      const WatchRecord& watch, const std::string& program_version);

/// Reads a checkpoint back. Throws IoError if the file is missing, damaged, not a checkpoint of vbond
/// or of another format, or if it belongs to a model with other particles than this one, or if its bonds are
/// of a law that is neither the library's nor one of `laws`.
Checkpoint read_checkpoint(const std::filesystem::path& path, const Model& model,
                           std::span<const BondLaw* const> laws = {});

/// The same, by one of several processes that each keep their own bonds alone.
struct CheckpointInPart {
  Checkpoint checkpoint;    ///< with own bonds, and the orientations, velocities, loads that `made` has
  bool same_bonds = false;  ///< whether these are as `made` has them, but for what has broken
};
/// made: the body as its case is set up, with own bonds. No process asks another for anything here.
CheckpointInPart read_checkpoint(const std::filesystem::path& path, const Model& model, State made,
                                 const BondsFromSetUp& own);

}  // namespace vbond
