#pragma once
#include <memory>

#include "vbond/observe/detail/h5_tables.hpp"
#include "vbond/statics/fracture_under_way.hpp"

namespace vbond {

/// What a checkpoint within a stage of fracture has besides State. Throws IoError.
void write_fracture(H5Writer& file, const FractureUnderWay& now);
/// Whether the checkpoint is one.
bool has_fracture(const H5Reader& file);
/// state: that of the checkpoint. Refuses what cannot belong to it.
std::shared_ptr<const FractureUnderWay> read_fracture(H5Reader& file, const Model& model, const State& state,
                                                      KnownLaws laws);

}  // namespace vbond
