#include "vbond/model/bond_law.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "vbond/model/define_law.hpp"
#include "vbond/physics/laws.hpp"

namespace vbond {

std::span<const BondLaw* const> bond_laws() {
  static const auto laws = [] {
    std::array<const BondLaw*, BondLaws::size> all{};
    std::size_t k = 0;
    BondLaws::for_each([&]<template <class> class Law>(LawTag<Law>) { all[k++] = &bond_law<Law>; });
    return all;
  }();
  return laws;
}

std::span<const BondLaw* const> named_laws() {
  static const auto laws = [] {
    std::vector<const BondLaw*> named(bond_laws().begin(), bond_laws().end());
    std::erase_if(named, [](const BondLaw* law) { return law->has_rules; });
    return named;
  }();
  return laws;
}

const BondLaw* with_rules(const BondLaw& law, const BondRules& rules) {
  if (law.has_rules) return &law;
  if (rules.rubbing.any()) return law.with_rubbing;
  return rules.flow() ? law.with_flow : law.with_rules;
}

const BondLaw* with_offsets(const BondLaw& law) {
  const std::string name = std::string(law.name) + std::string(name_with_offsets);
  for (const BondLaw* const form : bond_laws())
    if (form->name == name) return form;
  return nullptr;
}

const BondLaw* find_law(std::string_view name, std::span<const BondLaw* const> others) {
  for (const std::span<const BondLaw* const> laws : {bond_laws(), others})
    for (const BondLaw* const law : laws)
      for (const BondLaw* const form : {law, law->with_rules, law->with_flow, law->with_rubbing})
        if (form != nullptr && form->name == name) return form;
  return nullptr;
}

}  // namespace vbond
