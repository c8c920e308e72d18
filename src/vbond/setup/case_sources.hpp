#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/core/problems.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"
#include "vbond/setup/build.hpp"
#include "vbond/setup/groups.hpp"

namespace vbond {

/// The sources of the case with the first body of each, whose particles wait from now on, at rest: those of
/// the specimens that are named.
void add_sources(const Case& c, const std::vector<PlacedSpecimen>& specimens, Built& built,
                 Problems& problems);
/// All other bodies, behind the particles of all specimens. They belong to the groups of the first.
void add_copies(const Case& c, Built& built);

/// Of a group the first particle that comes in, if any.
std::optional<ParticleId> first_that_comes_in(const std::string& group, const Model& model);
/// E.g. "particle 7 comes in from source "grains"".
std::string of_source(const Model& model, ParticleId p);

/// Refuses regions that no body fits into; a line for each source, with what it lets in.
void check_sources(const Case& c, Built& built, Problems& problems);

/// What comes in and goes in stage k.
void resolve_passage(const Case& c, const Model& model, std::size_t k, Stage& stage, Problems& problems);
/// Refuses what a stage cannot do with particles that come in: supports, shared loads, a strain.
void check_stage_of_sources(const StageSpec& spec, const Model& model, Problems& problems);
/// Refuses static stages that cannot have all particles, and what does not go with sources and sinks.
void check_case_of_sources(const Case& c, Problems& problems);
/// Refuses displacements and volumes of groups with particles that come in.
void check_output_of_sources(const Case& c, const Model& model, Problems& problems);

}  // namespace vbond
