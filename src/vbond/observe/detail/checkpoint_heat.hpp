#pragma once
#include <functional>

#include "vbond/core/error.hpp"
#include "vbond/model/state.hpp"
#include "vbond/observe/detail/h5_file.hpp"

/// Temperatures, and bonds that expand: files have them only where there are such.
namespace vbond {

using WarmBondsOfFile = Column<Id<struct WarmBondOfFile>, WarmBond>;

/// The columns of these bonds, in the order of files.
template <class Archive, class Bonds>
void visit_warm_bonds(Archive& archive, Bonds& bonds) {
  archive.of_each("/warm_bonds/bond", bonds, &WarmBond::bond);
  archive.of_each("/warm_bonds/expansion", bonds, &WarmBond::expansion);
  archive.of_each("/warm_bonds/a", bonds, &WarmBond::a);
  archive.of_each("/warm_bonds/R_i", bonds, &WarmBond::R_i);
  archive.of_each("/warm_bonds/R_j", bonds, &WarmBond::R_j);
}

inline void write_heat(H5Writer& writer, const State& state) {
  if (!state.temperature.empty())
    writer.of_each("/particles/temperature", state.temperature, std::identity{});
  if (state.warm_bonds.empty()) return;
  const WarmBondsOfFile bonds(state.warm_bonds);
  visit_warm_bonds(writer, bonds);
}

inline void read_heat(H5Reader& reader, State& state) {
  if (reader.has("/particles/temperature")) {
    state.temperature.resize(state.r.size());
    reader.of_each("/particles/temperature", state.temperature, std::identity{});
  }
  if (!reader.has("/warm_bonds/bond")) return;
  WarmBondsOfFile bonds;
  bonds.resize(reader.rows("/warm_bonds/bond"));
  visit_warm_bonds(reader, bonds);
  for (const WarmBond& w : bonds) {
    if (w.bond.value >= state.bonds.size()) throw IoError("is damaged: a bond that expands is not there");
    state.warm_bonds.push_back(w);
  }
}

}  // namespace vbond
