#include <algorithm>
#include <array>
#include <string_view>

#include "vbond/report/detail/page_json.hpp"

namespace vbond::page {

Json to_json(const PackedArray& a) {
  const auto one_or_all = [](const std::vector<double>& x) { return x.size() == 1 ? Json(x[0]) : Json(x); };
  Json j{{"offset", a.offset}, {"type", a.type}, {"count", a.count}};
  if (!a.low.empty()) j["low"] = one_or_all(a.low), j["step"] = one_or_all(a.step);
  if (a.delta > 0) j["delta"] = a.delta;
  return j;
}

namespace {

/// The bytes of one field, frame after frame, each as long as all bonds there ever are.
template <class Get>
std::vector<std::uint8_t> of_bonds(const Sequence& s, const std::vector<std::size_t>& frames,
                                   std::size_t bonds, Get get) {
  std::vector<std::uint8_t> all(frames.size() * bonds);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<std::uint8_t>& values = get(s.frames[frames[f]]);
    std::copy(values.begin(), values.end(), all.begin() + static_cast<std::ptrdiff_t>(f * bonds));
  }
  return all;
}

Json bond_fields_json(const Sequence& s, const std::vector<std::size_t>& frames, std::size_t bonds, bool si,
                      Block& block) {
  Json fields = Json::array();
  for (std::size_t k = 0; k < bond_field_count; ++k) {
    if (!s.has_field(k)) continue;
    const BondField& field = bond_fields[k];
    const auto q = of_bonds(
        s, frames, bonds, [k](const QuantisedFrame& f) -> const auto& { return f.fields[k]; });
    const bool has_unit = si || std::string_view(field.unit) == "rad";
    fields.push_back({{"key", field.key},
                      {"label", field.label},
                      {"unit", has_unit ? field.unit : ""},
                      {"signed", field.is_signed},
                      {"array", to_json(block.add(q, s.fields[k], bonds))}});
  }
  return fields;
}

/// The numbers of all particles, frame after frame.
template <class Get>
auto of_particles(const Sequence& s, const std::vector<std::size_t>& frames, Get get) {
  std::decay_t<decltype(get(s.frames[0]))> all;
  for (const std::size_t f : frames) all.insert(all.end(), get(s.frames[f]).begin(), get(s.frames[f]).end());
  return all;
}

Json speed_json(const Sequence& s, const std::vector<std::size_t>& frames, bool si, Block& block) {
  if (s.frames.empty() || s.frames[0].speed.empty()) return Json::array();
  const auto q = of_particles(
      s, frames, [](const QuantisedFrame& f) -> const auto& { return f.speed; });
  return Json::array({{{"key", "speed"},
                       {"label", "speed"},
                       {"unit", si ? "m/s" : ""},
                       {"array", to_json(block.add(q, s.speed, s.frames[0].speed.size()))}}});
}

template <class Values>
bool any_not_zero(const Values& values) {
  return std::any_of(values.begin(), values.end(), [](auto x) { return x != 0; });
}

/// What is broken, and what it has become; nothing where nothing breaks.
void add_breaks(const Sequence& s, const std::vector<std::size_t>& frames, std::size_t bonds, Block& block,
                Json& j) {
  if (!s.may_break || s.frames.empty()) return;
  const auto broken = of_bonds(
      s, frames, bonds, [](const QuantisedFrame& f) -> const auto& { return f.broken; });
  const auto fragment = of_particles(
      s, frames, [](const QuantisedFrame& f) -> const auto& { return f.fragment; });
  const std::array<Range, 1> as_they_are{{{0.0, 1.0}}};
  if (any_not_zero(broken)) j["bond_broken"] = to_json(block.add(broken, as_they_are[0], bonds));
  if (any_not_zero(fragment))
    j["fragment"] = to_json(block.add(fragment, as_they_are, s.frames[0].fragment.size()));
}

/// Which particles are there; nothing where all are in all frames.
void add_there(const Sequence& s, const std::vector<std::size_t>& frames, std::size_t particles, Block& block,
               Json& j) {
  const auto some = [](const QuantisedFrame& f) { return !f.there.empty(); };
  if (std::none_of(s.frames.begin(), s.frames.end(), some)) return;
  std::vector<std::uint8_t> there;
  for (const std::size_t f : frames) {
    const std::vector<std::uint8_t>& of_frame = s.frames[f].there;
    if (of_frame.empty())
      there.insert(there.end(), particles, 1);
    else
      there.insert(there.end(), of_frame.begin(), of_frame.end());
  }
  const std::array<Range, 1> as_they_are{{{0.0, 1.0}}};
  j["there"] = to_json(block.add(there, as_they_are[0], particles));
}

/// Nothing where there are no walls.
void add_walls(const Walls& walls, const std::vector<std::size_t>& frames, Block& block, Json& j) {
  if (walls.triangles.empty()) return;
  std::vector<float> motion;
  for (const std::size_t f : frames)
    motion.insert(motion.end(), walls.motion[f].begin(), walls.motion[f].end());
  j["walls"] = {{"corners", to_json(block.add(walls.corners))},
                {"triangles", to_json(block.add(walls.triangles))},
                {"wall", to_json(block.add(walls.wall))},
                {"motion", to_json(block.add(motion))}};
}

/// Nothing of a body that is not periodic.
void add_cell(const Sequence& s, const std::vector<std::size_t>& frames, Block& block, Json& j) {
  constexpr std::size_t numbers = 12;  // of a cell
  if (s.cell.empty()) return;
  std::vector<float> cells;
  for (const std::size_t f : frames) {
    const auto from = s.cell.begin() + static_cast<std::ptrdiff_t>(numbers * f);
    cells.insert(cells.end(), from, from + numbers);
  }
  j["cell"] = {{"edges", to_json(block.add(cells))}, {"periodic", s.periodic}};
}

/// Numbers of particles as they are, in the type that they fit into.
Json ends_json(const std::vector<std::uint32_t>& ends, std::size_t particles, Block& block) {
  if (bytes_of_end(particles) == sizeof(std::uint32_t)) return to_json(block.add(ends));
  const std::array<Range, 1> as_they_are{{{0.0, 1.0}}};
  return to_json(block.add(std::vector<std::uint16_t>(ends.begin(), ends.end()), as_they_are, 0));
}

/// How many contacts a frame has, and what its forces mean; nothing where they were not written.
void add_contact_count(const FrameContacts& c, Json& frame) {
  if (!c.written) return;
  frame["contacts"] = {{"count", c.i.size()},
                       {"placed", c.shift.size() / numbers_of_shift},
                       {"low", c.range.low},
                       {"step", c.range.step}};
}

/// The contacts of all frames, one after another; nothing where nothing touches.
void add_contacts(const Contacts& contacts, const std::vector<std::size_t>& frames, std::size_t particles,
                  bool si, Block& block, Json& j) {
  if (!contacts.any()) return;
  const auto all = [&](auto member) {
    std::decay_t<decltype(contacts.frames[0].*member)> values;
    for (const std::size_t f : frames) {
      const auto& of_frame = contacts.frames[f].*member;
      values.insert(values.end(), of_frame.begin(), of_frame.end());
    }
    return values;
  };
  for (std::size_t k = 0; k < frames.size(); ++k)
    add_contact_count(contacts.frames[frames[k]], j["frames"][k]);
  j["contacts"] = {{"unit", si ? "N" : ""},
                   {"i", ends_json(all(&FrameContacts::i), particles, block)},
                   {"j", ends_json(all(&FrameContacts::j), particles, block)},
                   {"force", to_json(block.add(all(&FrameContacts::force), {0.0, 1.0}, 0))},
                   {"shift", to_json(block.add(all(&FrameContacts::shift), contacts.shift, 0))}};
}

}  // namespace

Json sequence_json(const Sequence& s, const Report& report, const std::vector<std::size_t>& kept,
                   Block& block) {
  const bool si = report.units == UnitSystem::si, is_run = s.kind == SequenceKind::run;
  const std::size_t bonds = report.body.bonds.size() / 2, particles = report.body.radius.size();
  Json frames = Json::array();
  std::vector<std::uint16_t> displacement;
  for (const std::size_t f : kept) {
    const QuantisedFrame& frame = s.frames[f];
    frames.push_back({{"step", frame.step},
                      {"time", frame.time},
                      {"stage", is_run ? report.stage_of_frame.at(f) : s.stage},
                      {"bonds", frame.bonds()}});
    displacement.insert(displacement.end(), frame.displacement.begin(), frame.displacement.end());
  }
  const auto range = of_bonds(
      s, kept, bonds, [](const QuantisedFrame& f) -> const auto& { return f.range; });
  Json j{{"kind", is_run ? "run" : "mode"},
         {"name", s.name},
         {"note", s.note},
         {"loop", !is_run},
         {"frames", std::move(frames)}};
  j["origin"] = s.origin;
  j["reference"] = to_json(block.add(s.reference));
  j["displacement"] = to_json(block.add(displacement, s.displacement, 3 * particles));
  j["particle_fields"] = speed_json(s, kept, si, block);
  j["bond_fields"] = bond_fields_json(s, kept, bonds, si, block);
  j["bond_range"] = to_json(block.add(range, {0.0, 1.0}, bonds));
  add_breaks(s, kept, bonds, block, j);
  add_there(s, kept, particles, block, j);
  add_walls(s.walls, kept, block, j);
  add_cell(s, kept, block, j);
  add_contacts(s.contacts, kept, particles, si, block, j);
  return j;
}

}  // namespace vbond::page
