#pragma once
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/dynamics/step_memory.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/run/run.hpp"

namespace vbond {

/// 1536 is "1.5 KiB".
std::string bytes_in_units(double bytes);

/// Throws CaseError if the particles that the case makes cannot fit into memory: before any is made.
void require_memory(const Case& c);

/// The same for a body with its bonds, as the time loop will hold it; of which this process may have its own.
void require_memory(const Case& c, const Model& model, const BodyPart& body);

/// What a rule of bonding on approach may bond, as the particles stand now.
struct BondsToCome {
  std::string name;   ///< of the bond set
  double distance;    ///< the largest at which a pair is bonded  [length]
  double pairs_now;   ///< within it
  double pairs_ever;  ///< that it may bond at all
};
/// Of all stages from the next one on. Throws CaseError where the pairs that are near enough already do not
/// fit into memory as bonds.
std::vector<BondsToCome> bonds_to_come(const Case& c, const Run& run);

/// What each of several ranks has of such a case.
RanksKeep ranks_keep(const Case& c);

/// The ranks of a run that share this machine.
struct RanksHere {
  int number = 1;
  int all = 1;  ///< ranks of the run, on all machines
};

/// As above, of these ranks together: each holds all particles, and all bonds or its own.
void require_memory(const Case& c, const RanksHere& ranks);
void require_memory(const Case& c, const Model& model, const BodyPart& body, const RanksHere& ranks);

/// How much memory there may be, and whose limit that is.
std::string memory_limit_in_words();

}  // namespace vbond
