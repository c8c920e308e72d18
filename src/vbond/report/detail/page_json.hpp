#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "vbond/report/block.hpp"
#include "vbond/report/page.hpp"

namespace vbond::page {

using Json = nlohmann::ordered_json;

/// Where an array stands in the block, as web/FORMAT.md describes it.
Json to_json(const PackedArray& a);

/// A sequence of the report with these of its frames, whose numbers go into the block.
Json sequence_json(const Sequence& s, const Report& report, const std::vector<std::size_t>& kept,
                   Block& block);

}  // namespace vbond::page
