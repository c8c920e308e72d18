#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>
#include <vector>

#include "vbond/observe/contact_list.hpp"
#include "vbond/observe/detail/values_of.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/in_cell.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/observe/vtp.hpp"

namespace vbond {
namespace {

/// Contacts go where their first particles are shown. They are found where particles are: what they remember
/// is of places to the bit.
void show_in_cell(const Model& model, const State& state, std::vector<ListedContact>& contacts) {
  const PerParticle<Image> images = images_in_cell(model, state);
  const auto image = [&images](std::int64_t p) {
    return p < 0 ? Image{} : images[ParticleId{static_cast<std::size_t>(p)}];
  };
  for (ListedContact& c : contacts) {
    const Vec3d way = to_image(state.cell, image(c.i));
    c.from += way, c.to += way;
    if (c.j >= 0) c.of_j = c.of_j + image(c.i) - image(c.j);
  }
}

}  // namespace

void write_contacts_vtp(const std::filesystem::path& path, const Model& model, const State& state,
                        std::optional<double> load_factor, FrameFormat format) {
  std::vector<ListedContact> contacts = list_contacts(model, state, load_factor.has_value());
  if (format.wrap && !state.cell.empty()) show_in_cell(model, state, contacts);
  std::vector<Vec3d> points;
  std::vector<std::int64_t> ends;
  for (const ListedContact& c : contacts) {
    points.insert(points.end(), {c.from, c.to});
    ends.push_back(static_cast<std::int64_t>(ends.size())),
        ends.push_back(static_cast<std::int64_t>(ends.size()));
  }
  VtpFile f = VtpFile::of_lines(points, ends, format);
  f.set_unit_of_points(unit::length.in(model.units));
  const auto view = [&contacts](std::size_t k) -> const ListedContact& { return contacts[k]; };
  for (const ContactQuantity& q : contact_quantities())
    std::visit(
        [&](const auto value) {
          f.add_cell_data(q.name, values_of(contacts.size(), view, value), q.unit.in(model.units));
        },
        q.value);
  f.write(path, state.clock.time(), state.clock.step, load_factor);
}

}  // namespace vbond
