#pragma once
#include <nlohmann/json.hpp>

#include "judge.hpp"

/// Records as JSON, to hand them from process to process.
namespace vbond::campaign {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReferencePoint, kind, load_factor, error, regained, beyond_range)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference::Turning, load_factor, turned)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference, points, searched_to, unstable_at_start, ended, undecided, nodes,
                                   passings, turning)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Answer, failure, message, ended, loads, searched_to, factors, seconds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Judgement, verdict, why)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CaseRecord, number, kind, what, reference, buckling, path, of_buckling,
                                   of_path, reference_seconds)

}  // namespace vbond::campaign
