// What stands in the page of `vbond homogenise --report`.
#include "homogenise_report.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace vbond::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int degrees_apart = 2;  // moduli are of the fourth degree in directions: lines between seem smooth

struct Plane {
  const char* name;
  Vec3d from, to;
};
constexpr std::array<Plane, 3> planes{
    {{"xy", {1, 0, 0}, {0, 1, 0}}, {"yz", {0, 1, 0}, {0, 0, 1}}, {"zx", {0, 0, 1}, {1, 0, 0}}}};

/// Moduli along directions once around in a plane.
Json around(const ElasticConstants& C, const Plane& plane) {
  Json j{{"plane", plane.name}};
  for (int degrees = 0; degrees < 360; degrees += degrees_apart) {
    const double t = degrees * std::numbers::pi / 180.0;
    const Vec3d n = std::cos(t) * plane.from + std::sin(t) * plane.to;
    const Extremes G = C.shear_moduli(n), nu = C.poissons_ratios(n);
    j["degrees"].push_back(degrees);
    j["E"].push_back(C.youngs_modulus(n));
    j["G_least"].push_back(G.least.value), j["G_largest"].push_back(G.largest.value);
    j["nu_least"].push_back(nu.least.value), j["nu_largest"].push_back(nu.largest.value);
  }
  return j;
}

Json as_json(const MaterialPage::Material& m) {
  Json j{{"key", m.key}, {"name", m.name}, {"planes", Json::array()}};
  if (m.constants)
    for (const Plane& plane : planes) j["planes"].push_back(around(*m.constants, plane));
  return j;
}

}  // namespace

void require_new_page(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  const std::string option = "--report " + path.string();
  if (path.extension() != ".html")
    throw std::invalid_argument(option + ": the report is a page for browsers\n  name it NAME.html");
  if (!path.parent_path().empty() && !fs::is_directory(path.parent_path()))
    throw std::invalid_argument(option + ": there is no such folder\n  make it first");
  if (fs::exists(fs::symlink_status(path)))
    throw std::invalid_argument(option + ": it is there already\n  give another name, or remove it");
}

std::string as_json(const MaterialPage& page, const Case& c) {
  Json j{{"format", 1}, {"program", "vbond " VBOND_VERSION}, {"title", c.title}};
  j["case"] = std::filesystem::path(c.file).filename().string();
  j["units"] = c.units == UnitSystem::si ? "SI" : "reduced";
  j["facts"] = page.facts, j["warnings"] = Json::array();
  for (const auto& [level, texts] : {std::pair{"warning", &page.warnings}, {"note", &page.notes}})
    for (const std::string& text : *texts) j["warnings"].push_back({{"level", level}, {"text", text}});
  j["found"] = page.found, j["materials"] = Json::array();
  for (const MaterialPage::Material& m : page.materials) j["materials"].push_back(as_json(m));
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace vbond::app
