#include "vbond/case/names.hpp"

#include <algorithm>
#include <utility>

#include "vbond/core/nearest.hpp"

namespace vbond::keys {
namespace {

/// Words that people write, and those of case files.
constexpr std::pair<std::string_view, std::string_view> synonyms[] = {
    {"euler-bernoulli", "bernoulli-euler"},
    {"euler", "bernoulli-euler"},
    {"eigen", "modes"},
    {"eigenmodes", "modes"},
    {"eigenvalues", "modes"},
    {"eigenfrequencies", "modes"},
    {"frequencies", "modes"},
    {"modal", "modes"},
    {"vibration", "modes"},
    {"static", "equilibrium"},
    {"statics", "equilibrium"},
    {"arc-length", "path"},
    {"riks", "path"},
    {"stability", "buckling"},
    {"transient", "dynamics"},
    {"crack", "fracture"},
    {"radius", "diameter"},
    {"young", "E"},
    {"youngs_modulus", "E"},
    {"modulus", "E"},
    {"poisson", "nu"},
    {"poisson_ratio", "nu"},
    {"rho", "density"},
};

}  // namespace

std::string join(const std::vector<std::string>& names, std::string_view quote) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += ", ";
    text.append(quote).append(name).append(quote);
  }
  return text;
}

std::optional<std::string> meant_name(std::string_view wrong, const std::vector<std::string>& names) {
  for (const auto& [word, name] : synonyms)
    if (word == wrong && std::find(names.begin(), names.end(), name) != names.end()) return std::string(name);
  return nearest_name(wrong, names);
}

}  // namespace vbond::keys
