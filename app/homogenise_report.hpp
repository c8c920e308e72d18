#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vbond/case/case.hpp"
#include "vbond/statics/elastic_constants.hpp"

namespace vbond::app {

/// What `vbond homogenise --report` shows; web/FORMAT.md has the form.
struct MaterialPage {
  /// A C among what was found.
  struct Material {
    std::string key;                            ///< where it stands in `found`; empty: at its top
    std::string name;                           ///< may be empty
    std::optional<ElasticConstants> constants;  ///< none: C alone is known
  };
  nlohmann::ordered_json found;              ///< what --json prints
  std::vector<std::string> facts;            ///< sentences
  std::vector<std::string> notes, warnings;  ///< likewise
  std::vector<Material> materials;           ///< none: a sheet
};

/// Throws std::invalid_argument unless the path is NAME.html in a folder that is there, and nothing stands
/// there yet.
void require_new_page(const std::filesystem::path& path);

/// The JSON of the page, with moduli by direction.
std::string as_json(const MaterialPage& page, const Case& c);

}  // namespace vbond::app
