#include "print_contacts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "vbond/core/printable.hpp"
#include "vbond/model/contact_number.hpp"

namespace vbond::app {
namespace {

constexpr std::uint32_t most_pairs = 20;  // of materials that are printed

bool in_si(const Model& model) {
  return model.units == UnitSystem::si;
}

std::string in_words(const Vec3d& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x, x.y, x.z);
}

// ---- contacts ---------------------------------------------------------------------------------------

std::string law_in_words(const ContactModel& c) {
  std::string words;
  switch (c.law) {
    case ContactLaw::none: break;
    case ContactLaw::paper_hertz: words = "the paper's Hertz form, c_H/sqrt(length) d^(3/2)"; break;
    case ContactLaw::hertz: words = "Hertz, 4/3 E* sqrt(R*) d^(3/2)"; break;
    case ContactLaw::linear: words = "linear, k d"; break;
  }
  switch (c.adhesion) {
    case AdhesionForm::none: break;
    case AdhesionForm::jkr: words += "; adhesion by JKR"; break;
    case AdhesionForm::dmt: words += "; adhesion by DMT"; break;
  }
  switch (c.tangential) {
    case TangentialForm::none: words += "; no friction"; break;
    case TangentialForm::mindlin: words += "; friction by Mindlin's spring"; break;
    case TangentialForm::linear: words += "; friction by a linear spring"; break;
    case TangentialForm::mindlin_force:
      words += "; friction by Mindlin's spring, whose force stays when the contact is relieved";
      break;
    case TangentialForm::mindlin_displacement:
      words += "; friction by Mindlin's spring times the slip";
      break;
  }
  switch (c.rolling) {
    case RollingForm::none: break;
    case RollingForm::constant:
      words += "; rolling against a constant moment, which creeps on an incline";
      break;
    case RollingForm::spring: words += "; rolling against a spring (type C)"; break;
  }
  return words;
}

const char* in_words(SaidBy who) {
  switch (who) {
    case SaidBy::pair: return "contact.between";
    case SaidBy::materials: return "[[material]]";
    case SaidBy::model: return "[contact]";
    case SaidBy::nobody: return "default";
  }
  return "";
}

/// The numbers of a pair that the law of the case makes use of.
std::string numbers_in_words(const Model& model, std::uint32_t first, std::uint32_t second) {
  const ContactModel& c = model.contact;
  const TouchNumbers<double> numbers = touch_numbers(c, model.materials, first, second);
  const bool si = in_si(model);
  std::string words;
  switch (c.law) {
    case ContactLaw::none: break;
    case ContactLaw::hertz: words = fmt::format("E* = {:.6g}{}", numbers.stiffness, si ? " Pa" : ""); break;
    case ContactLaw::paper_hertz:
      words = fmt::format("c_H/sqrt(length) = {:.6g}{}", numbers.stiffness, si ? " N/m^1.5" : "");
      break;
    case ContactLaw::linear: words = fmt::format("k = {:.6g}{}", numbers.stiffness, si ? " N/m" : ""); break;
  }
  const auto add = [&](const char* name, std::optional<double> Surface::*number, double otherwise,
                       const char* unit = "") {
    const PairNumber x = number_of_pair(c, model.materials, first, second, number, otherwise);
    words += fmt::format(", {} = {:.6g}{} ({})", name, x.value, unit, in_words(x.said_by));
  };
  add("e", &Surface::restitution, 1.0);
  if (c.damping > 0.0) words += fmt::format(", c_n = {:.6g}{}", c.damping, si ? " N s/m" : "");
  if (c.tangential != TangentialForm::none) add("mu", &Surface::friction, 0.0);
  if (c.rolling != RollingForm::none) {
    add("mu_r", &Surface::rolling_friction, 0.0);
    add("mu_t", &Surface::twisting_friction, 0.0);
  }
  if (c.adhesion != AdhesionForm::none) add("w", &Surface::work_of_adhesion, 0.0, si ? " J/m^2" : "");
  return words;
}

std::vector<bool> materials_of_particles(const Model& model) {
  std::vector<bool> are(model.materials.size(), false);
  if (!are.empty())
    for (const ParticleId p : model.mass.ids()) are[model.material_of(p)] = true;
  return are;
}

// ---- walls ------------------------------------------------------------------------------------------

const char* in_words(WallSide side) {
  return side == WallSide::inside ? "particles inside" : "particles outside";
}
std::string shape_in_words(const PlaneWallSpec& w) {
  return fmt::format("plane through {}, particles on the side of {}", in_words(w.point), in_words(w.normal));
}
std::string shape_in_words(const DiscWallSpec& w) {
  return fmt::format("disc at {} across {}, radius {:.6g}", in_words(w.centre), in_words(w.normal), w.radius);
}
std::string shape_in_words(const CylinderWallSpec& w) {
  return fmt::format("cylinder at {} along {}, radius {:.6g}, {}", in_words(w.centre), in_words(w.axis),
                     w.radius,
                     w.length ? fmt::format("length {:.6g}, felt from both sides", *w.length)
                              : fmt::format("endless, {}", in_words(w.side)));
}
std::string shape_in_words(const SphereWallSpec& w) {
  return fmt::format("sphere at {}, radius {:.6g}, {}", in_words(w.centre), w.radius, in_words(w.side));
}
std::string shape_in_words(const BoxWallSpec& w) {
  return fmt::format("box from {} to {}, felt from both sides", in_words(w.min), in_words(w.max));
}
std::string shape_in_words(const MeshWallSpec& w) {
  return fmt::format("mesh of {}, felt from both sides", w.file.value.filename().string());
}

std::string motion_in_words(const WallDriveSpec& d, const Model& model) {
  if (d.off) return "is off";
  const bool si = in_si(model);
  std::string words;
  const auto add = [&words](const std::string& part) { words += (words.empty() ? "" : ", ") + part; };
  if (d.velocity != Vec3d{}) add(fmt::format("moves at {}{}", in_words(d.velocity), si ? " m/s" : ""));
  if (d.angular_velocity != Vec3d{})
    add(fmt::format("turns at {}{}", in_words(d.angular_velocity), si ? " rad/s" : ""));
  if (!words.empty() && !d.factor.points.empty()) words += " times a factor of time";
  if (d.displacement != Vec3d{})
    add(fmt::format("goes by {}{} as the load factor grows to 1", in_words(d.displacement), si ? " m" : ""));
  if (d.rotation != Vec3d{})
    add(fmt::format("turns by {} rad as the load factor grows to 1", in_words(d.rotation)));
  if (d.oscillation)
    add(fmt::format("swings by {}{} at {:.6g}{}", in_words(d.oscillation->amplitude), si ? " m" : "",
                    d.oscillation->frequency, si ? " Hz" : ""));
  if (d.servo)
    add(fmt::format("is pressed along {} by {:.6g}{}{}", in_words(d.servo->direction), d.servo->force,
                    si ? " N" : "", d.servo->factor.points.empty() ? "" : " times a factor of time"));
  return words;
}

}  // namespace

void print_contact_law(const Model& model) {
  const ContactModel& c = model.contact;
  if (c.law == ContactLaw::none) return;
  fmt::print("contact law      {}\n", law_in_words(c));
  const auto materials = static_cast<std::uint32_t>(model.materials.size());
  if (materials == 0) fmt::print("contact          {}\n", numbers_in_words(model, 0, 0));
  const std::vector<bool> of_particles = materials_of_particles(model);
  std::uint32_t pairs = 0, printed = 0;
  for (std::uint32_t first = 0; first < materials; ++first)
    for (std::uint32_t second = first; second < materials; ++second) {
      if (!of_particles[first] && !of_particles[second]) continue;  // walls do not touch each other
      if (++pairs > most_pairs) continue;
      ++printed;
      fmt::print("contact          {} with {}: {}\n", printable(model.materials[first].name),
                 printable(model.materials[second].name), numbers_in_words(model, first, second));
    }
  if (printed < pairs) fmt::print("contact          and {} more pairs of materials\n", pairs - printed);
  if (can_make_energy(c.tangential))
    fmt::print(
        "contact          note: this form of friction can make energy: a contact that is pressed, sheared, "
        "relieved and sheared back may give more than it took; tangential = \"mindlin\" does not\n");
  if (const std::string key = key_without_balance(c); !key.empty())
    fmt::print("contact          a stage at rest would refuse these contacts, which do more than repel: {}\n",
               key);
  else if (has_friction(c))
    fmt::print("contact          a stage at rest takes these contacts without friction: {}\n",
               key_beyond_repulsion(c, model.materials));
}

void print_capsules(const Case& c, const Model& model) {
  for (const BondSpec& set : c.bonds)
    if (set.recipe.capsule)
      fmt::print("contact          bonds \"{}\" touch as capsules, {}\n", printable(set.name),
                 set.recipe.capsule_radius > 0.0
                     ? fmt::format("radius {:.6g}{}", set.recipe.capsule_radius, in_si(model) ? " m" : "")
                     : "of the smaller radius of their particles");
}

void print_walls(const Case& c, const Model& model) {
  for (std::size_t w = 0; w < std::min(c.walls.size(), model.walls.size()); ++w) {
    const Wall& wall = model.walls[w];
    const std::string shape =
        std::visit([](const auto& spec) { return shape_in_words(spec); }, c.walls[w].shape);
    const std::string material =
        wall.material < model.materials.size() ? ", of " + model.materials[wall.material].name : "";
    fmt::print("wall {:<11} {}{}\n", printable(wall.name), shape, printable(material));
    bool moves = false;
    for (const StageSpec& stage : c.stages)
      for (const WallDriveSpec& d : stage.walls)
        if (d.wall.value == wall.name) {
          fmt::print("                 in stage {} it {}\n", printable(stage.name),
                     motion_in_words(d, model));
          moves = true;
        }
    if (!moves) fmt::print("                 stands still\n");
  }
}

}  // namespace vbond::app
