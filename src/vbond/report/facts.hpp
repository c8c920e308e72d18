#pragma once
#include <optional>

#include "vbond/case/case.hpp"
#include "vbond/observe/summary.hpp"
#include "vbond/report/page.hpp"
#include "vbond/setup/build.hpp"

/// The run in rows for people.
namespace vbond::page {

/// What was run, and what came out.
Lines facts_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary,
               const StepFacts& step);
Lines results_of(const RunSummary& summary);

/// The step of the first stage of dynamics, as far as it is known.
StepFacts step_of(const Case& c, const Built& built, const std::optional<RunSummary>& summary);

/// Between which pairs there are contacts.
const char* contacts_in_words(const Model& model);

}  // namespace vbond::page
