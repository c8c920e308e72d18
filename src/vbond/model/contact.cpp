#include "vbond/model/contact.hpp"

#include <algorithm>
#include <utility>

#include "vbond/model/contact_number.hpp"

namespace vbond {

using Number = std::optional<double> Surface::*;

PairNumber number_of_pair(const ContactModel& c, const std::vector<ContactMaterial>& materials,
                          std::uint32_t first, std::uint32_t second, Number number, double otherwise) {
  for (const ContactPair& p : c.between) {
    const bool is_it = (p.materials[0] == first && p.materials[1] == second) ||
                       (p.materials[0] == second && p.materials[1] == first);
    if (is_it && (p.surface.*number)) return {*(p.surface.*number), SaidBy::pair};
  }
  SaidBy said_by = c.surface.*number ? SaidBy::model : SaidBy::nobody;
  const auto of = [&](std::uint32_t m) {
    if (m >= materials.size() || !(materials[m].surface.*number))
      return (c.surface.*number).value_or(otherwise);
    said_by = SaidBy::materials;
    return *(materials[m].surface.*number);
  };
  const double x = of(first), y = of(second);
  return {x == y ? x : std::sqrt(x * y), said_by};
}

TouchNumbers<double> touch_numbers(const ContactModel& c, const std::vector<ContactMaterial>& materials,
                                   std::uint32_t first, std::uint32_t second) {
  const auto elastic = [&](std::uint32_t m) {
    return m < materials.size() ? std::pair(materials[m].E, materials[m].nu) : std::pair(c.E, c.nu);
  };
  const auto [E_1, nu_1] = elastic(first);
  const auto [E_2, nu_2] = elastic(second);
  const TouchForms forms = touch_forms(c);
  const auto of = [&](Number number, double otherwise) {
    return number_of_pair(c, materials, first, second, number, otherwise).value;
  };
  TouchNumbers<double> to;
  switch (forms.normal) {
    case NormalForm::hertz: to.stiffness = effective_modulus(E_1, nu_1, E_2, nu_2); break;
    case NormalForm::one_hertz: to.stiffness = c.c_H / std::sqrt(c.length); break;
    case NormalForm::linear: to.stiffness = c.k; break;
  }
  switch (forms.tangential) {
    case TangentialForm::none: break;
    case TangentialForm::mindlin:
    case TangentialForm::mindlin_force:
    case TangentialForm::mindlin_displacement: to.tangential = mindlin_modulus(E_1, nu_1, E_2, nu_2); break;
    case TangentialForm::linear: to.tangential = c.k_t; break;
  }
  const bool pulls = c.attraction || c.adhesion != AdhesionForm::none;
  to.damping = damping_of_restitution(forms.normal, pulls, of(&Surface::restitution, 1.0));
  to.viscous = c.damping;
  to.tangential_damping = c.tangential_damping;
  to.friction = of(&Surface::friction, 0.0);
  to.rolling = of(&Surface::rolling_friction, 0.0);
  to.twisting = of(&Surface::twisting_friction, 0.0);
  to.rolling_stiffness = c.rolling_stiffness;
  to.work = of(&Surface::work_of_adhesion, 0.0);
  return to;
}

std::string key_beyond_repulsion(const ContactModel& c, const std::vector<ContactMaterial>& materials) {
  if (c.law == ContactLaw::none) return {};
  if (c.tangential != TangentialForm::none) return "contact.tangential";
  if (c.rolling != RollingForm::none) return "contact.rolling";
  if (c.adhesion != AdhesionForm::none) return "contact.adhesion";
  if (c.damping > 0.0) return "contact.damping";
  if (c.keeps_overlap) return "contact.overlap_at_break = \"kept\"";
  const auto damps = [](const Surface& s) { return s.restitution.value_or(1.0) < 1.0; };
  bool any = damps(c.surface);
  for (const ContactMaterial& m : materials) any = any || damps(m.surface);
  for (const ContactPair& p : c.between) any = any || damps(p.surface);
  return any ? "restitution below 1" : "";
}

std::string key_without_balance(const ContactModel& c) {
  if (c.law == ContactLaw::none) return {};
  if (c.adhesion != AdhesionForm::none) return "contact.adhesion";
  if (c.keeps_overlap) return "contact.overlap_at_break = \"kept\"";
  return {};
}

bool is_elastic(const ContactModel& c, const std::vector<ContactMaterial>& materials) {
  if (c.law == ContactLaw::linear || !key_beyond_repulsion(c, materials).empty()) return false;
  return c.law != ContactLaw::hertz ||
         std::all_of(materials.begin(), materials.end(),
                     [&c](const ContactMaterial& m) { return m.E == c.E && m.nu == c.nu; });
}

}  // namespace vbond
