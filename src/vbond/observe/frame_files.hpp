#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "vbond/core/bounding_box.hpp"
#include "vbond/model/model.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/frame_format.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {

class Simulation;

/// A bond as its quantities look at it. may_break: its utilisation is worked out.
BondView bond_view(BondId id, const State& state, bool may_break);

/// The particles as points with particle_quantities(); see docs/output.md.
/// load_factor: of a balance.
void write_particles_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                         std::optional<double> load_factor = {}, FrameFormat format = {});

/// The bonds as lines between the particles' centres with bond_quantities(); to an image, where that stands.
void write_bonds_vtp(const std::filesystem::path& path, const State& state, UnitSystem units,
                     std::optional<double> load_factor = {}, FrameFormat format = {});

/// The contacts as lines with contact_quantities(): from centre to centre, or to where a wall is touched.
void write_contacts_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                        std::optional<double> load_factor = {}, FrameFormat format = {});

/// The walls as triangles where they are now, with wall_quantities(); body: the box around its particles at
/// the start, which says how large endless walls are shown.
void write_walls_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                     std::optional<double> load_factor = {}, FrameFormat format = {});
void write_walls_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                     std::optional<double> load_factor, FrameFormat format, const BoundingBox& body);

/// The twelve edges of the cell of a periodic body.
void write_cell_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                    std::optional<double> load_factor = {}, FrameFormat format = {});

/// What part number `part` of a body has; all processes that step the body call this. Its particles as
/// points; and its bonds as lines between these and the particles of other parts that they lead to, with
/// their numbers as "particle". Into frames/ of this folder (name_of_part).
void write_part(const std::filesystem::path& folder, int part, const Simulation& run, FrameFormat format);

/// The lists of so many parts at this step (name_of_parts), for the readers of VTK and for FrameInput.
void write_lists_of_parts(const std::filesystem::path& folder, int parts, const Model& model,
                          std::int64_t step, FrameFormat format);

}  // namespace vbond
