#include "resume_from.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "status.hpp"
#include "vbond/core/error.hpp"
#include "vbond/terms/heat/heat.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

/// The names of the stages that the run had. A run goes on without a status that can be read: that is told.
std::vector<std::string> names_of_stages(const fs::path& folder) {
  try {
    return read_status(folder).stage.names;
  } catch (const std::invalid_argument& e) {
    const std::string why = e.what();
    say("warning: not checked whether the stages of resolved.toml are those that have begun: " +
            why.substr(0, why.find('\n')) + "\n",
        stderr);
    return {};
  }
}

/// A checkpoint counts stages: those that have begun must be the first ones still.
void check_stages(const Case& c, const Clock& now, const fs::path& folder) {
  const std::vector<std::string> names = names_of_stages(folder);
  const auto begun = static_cast<std::size_t>(now.stage) + (now.stage_step > 0 ? 1 : 0);
  for (std::size_t k = 0; k < std::min(begun, names.size()); ++k) {
    if (k < c.stages.size() && c.stages[k].name == names[k]) continue;
    throw CaseError(
        {k < c.stages.size() ? c.stages[k].place : SourcePlace{(folder / "resolved.toml").string(), 0, 0},
         fmt::format("resolved.toml was edited: stage {} of the run was \"{}\"{}", k + 1, names[k],
                     k < c.stages.size() ? ", and is \"" + c.stages[k].name + "\" now" : ""),
         "stages that have begun keep their place and their name; others may be edited",
         "undo the edit, or start a new run of the edited case with vbond run"});
  }
}

/// Whether the bonds of the start are those the run began with. One that is elastic keeps its constants for
/// good.
bool keeps_bonds(const State& start, const State& now) {
  const PerBond<Bond>& made = start.bonds;
  const auto later = std::find_if(now.warm_bonds.begin(), now.warm_bonds.end(),
                                  [&](const WarmBond& w) { return w.bond.value >= made.size(); });
  const bool expand_alike =
      std::equal(start.warm_bonds.begin(), start.warm_bonds.end(), now.warm_bonds.begin(), later);
  auto warm = now.warm_bonds.begin();  // in order of bonds
  const auto is_kept = [&](BondId k) {
    const bool expands = warm != now.warm_bonds.end() && warm->bond == k;
    Bond kept = expands ? with_growth(now, *warm++, 0.0) : now.bonds[k];  // as it was made
    kept.broken = made[k].broken, kept.mode = made[k].mode;
    return made[k] == kept;
  };
  bool all_kept = expand_alike && made.size() <= now.bonds.size();
  for (BondId k{0}; all_kept && k.value < made.size(); ++k.value) all_kept = is_kept(k);
  return all_kept;
}

/// What may not be edited before going on.
void check_edits(const Case& c, const Clock& clock, bool all_kept, const fs::path& case_file) {
  const auto stage = static_cast<std::size_t>(clock.stage);
  if (stage > c.stages.size() || (stage == c.stages.size() && clock.stage_step > 0))
    throw CaseError(
        {{case_file.string(), 0, 0},
         fmt::format("resolved.toml was edited: it has {} stages, and the checkpoint is in stage {}",
                     c.stages.size(), clock.stage + 1),
         "stages that have begun cannot be left out",
         "undo the edit"});
  if (all_kept) return;
  throw CaseError(
      {{case_file.string(), 0, 0},
       "resolved.toml was edited: its bonds are not those of the checkpoint",
       "bonds are made once and kept with their constants; durations, loads and output may be edited",
       "undo the edit, or start a new run of the edited case with vbond run"});
}

}  // namespace

Checkpoint resume_from(Processes& processes, const Case& c, Built& built, const fs::path& folder) {
  Checkpoint checkpoint;
  bool all_kept = true;
  processes.exchange().together([&] {
    const fs::path file = folder / "checkpoint.h5";
    if (built.own != nullptr) {
      CheckpointInPart read = read_checkpoint(file, built.model, std::move(built.state), *built.own);
      checkpoint = std::move(read.checkpoint), all_kept = read.same_bonds;
    } else {
      checkpoint = read_checkpoint(file, built.model);
      all_kept = keeps_bonds(built.state, checkpoint.state);
    }
    built.state = {};
  });
  if (built.own != nullptr) count_bonds_of_each(*built.own, checkpoint.state);  // some have broken
  check_edits(c, checkpoint.state.clock, !processes.exchange().any(!all_kept), folder / "resolved.toml");
  check_stages(c, checkpoint.state.clock, folder);
  return checkpoint;
}

}  // namespace vbond::app
