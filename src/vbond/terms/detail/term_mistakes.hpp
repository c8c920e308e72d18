#pragma once
#include "vbond/model/detail/mistake_list.hpp"
#include "vbond/model/static_stage.hpp"

namespace vbond {

/// What a program may do wrong with the terms of a stage.
void look_at_terms(const Model& model, const Stage& stage, Mistakes& found);
void look_at_terms(const Model& model, const StaticStage& stage, Mistakes& found);

}  // namespace vbond
