#pragma once
#include <algorithm>
#include <cmath>

#include "vbond/model/state.hpp"
#include "vbond/observe/detail/h5_file.hpp"

/// What a checkpoint says of bonds that touch as capsules; only where there are some.
namespace vbond {

using FibreMemories = Column<Id<struct FibreContactOfFile>, FibreMemory>;

template <class Archive, class Memories>
void visit_fibres(Archive& archive, Memories& memories) {
  archive.of_each("/fibres/a_i", memories, &FibreMemory::a_i);
  archive.of_each("/fibres/a_j", memories, &FibreMemory::a_j);
  archive.of_each("/fibres/b_i", memories, &FibreMemory::b_i);
  archive.of_each("/fibres/b_j", memories, &FibreMemory::b_j);
  archive.of_each("/fibres/s", memories, &FibreMemory::s);
  archive.of_each("/fibres/t", memories, &FibreMemory::t);
  archive.of_each("/fibres/R_a", memories, &FibreMemory::R_a);
  archive.of_each("/fibres/R_b", memories, &FibreMemory::R_b);
  archive.of_each("/fibres/normal", memories, &FibreMemory::normal);
  archive.of_each("/fibres/history", memories, &FibreMemory::history);
}

inline void write_fibres(H5Writer& writer, const State& state) {
  const auto touches = [](const Bond& b) { return b.capsule > 0.0; };
  if (std::none_of(state.bonds.begin(), state.bonds.end(), touches)) return;
  writer.of_each("/bonds/capsule", state.bonds, &Bond::capsule);
  if (state.fibre_history.empty()) return;
  const FibreMemories memories(state.fibre_history);
  visit_fibres(writer, memories);
}

inline void read_fibres(H5Reader& reader, State& state) {
  if (!reader.has("/bonds/capsule")) return;
  reader.of_each("/bonds/capsule", state.bonds, &Bond::capsule);
  for (const Bond& b : state.bonds)
    if (!(b.capsule >= 0.0) || !std::isfinite(b.capsule))
      throw IoError("is damaged: the capsule of a bond has an impossible radius");
  if (!reader.has("/fibres/a_i")) return;
  FibreMemories memories;
  memories.resize(reader.rows("/fibres/a_i"));
  visit_fibres(reader, memories);
  for (const FibreMemory& m : memories)
    for (const ParticleId p : {m.a_i, m.a_j, m.b_i, m.b_j})
      if (p.value >= state.r.size()) throw IoError("is damaged: a contact of capsules has impossible ends");
  state.fibre_history.assign(memories.begin(), memories.end());
}

}  // namespace vbond
