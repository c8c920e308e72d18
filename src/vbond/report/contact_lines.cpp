#include "vbond/report/contact_lines.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "vbond/core/error.hpp"
#include "vbond/report/frame_read.hpp"

namespace vbond::page {
namespace {

using Per = FrameInput::Per;

[[noreturn]] void refuse_contacts(const std::filesystem::path& file, const char* why) {
  throw IoError(file.string() + ": is damaged: " + why);
}

/// A contact as its file gives it, its ends from the centres of i and j.
struct RawContact {
  std::uint32_t i = 0, j = 0;
  double force = 0;
  Vec3d from, to;
  bool at_centres() const { return from == Vec3d{} && to == Vec3d{}; }
};

/// Where a particle stands among those of its frame, whose numbers increase: some may not be there.
std::size_t place_of(std::int64_t number, const std::vector<std::int64_t>& ids,
                     const std::filesystem::path& file) {
  const auto at = std::lower_bound(ids.begin(), ids.end(), number);
  if (at == ids.end() || *at != number) refuse_contacts(file, "a contact is of a particle that is not there");
  return static_cast<std::size_t>(at - ids.begin());
}

/// Those between centres first. The file has the same numbers for these ends as that of the particles.
std::vector<RawContact> raw_contacts(const FrameFiles& files) {
  const FrameInput particles(files.particles);
  const VtpInput in(files.contacts);
  if (!in.lines() || in.step() != particles.step())
    throw IoError(files.contacts.string() + ": has not the contacts of " + files.particles.string());
  const std::vector<Vec3d> r = particles.vectors(Per::point, "Points"),
                           ends = in.vectors(Per::point, "Points");
  const std::vector<std::int64_t> ids = particles.integers(Per::point, "id"), i = in.integers(Per::cell, "i"),
                                  j = in.integers(Per::cell, "j"),
                                  place = in.integers(Per::end, "connectivity");
  const std::vector<double> force = in.scalars(Per::cell, "normal_force");
  std::vector<Image> shown;
  if (particles.has(Per::point, "image")) shown = particles.images(Per::point, "image");
  const auto end = [&](std::size_t k) {
    if (place[k] < 0 || static_cast<std::size_t>(place[k]) >= ends.size())
      refuse_contacts(files.contacts, "an end of a contact is not there");
    return ends[static_cast<std::size_t>(place[k])];
  };
  std::vector<RawContact> contacts;
  for (std::size_t k = 0; k < force.size(); ++k) {
    RawContact& c = contacts.emplace_back();
    const std::size_t of_i = place_of(i[k], ids, files.contacts),
                      of_j = j[k] == -1 ? of_i : place_of(j[k], ids, files.contacts);
    c.i = static_cast<std::uint32_t>(ids[of_i]);
    c.j = static_cast<std::uint32_t>(ids[of_j]);
    c.force = force[k];
    c.from = end(2 * k) - r[of_i];
    c.to = end(2 * k + 1) - r[of_j];
    const Vec3d from_i = end(2 * k + 1) - r[of_i];
    const bool apart = !shown.empty() && shown[of_i] != shown[of_j];  // only as they are shown are they near
    if (particles.cell() && (apart || norm(from_i) < norm(c.to)))
      c.j = c.i, c.to = from_i;  // an image of j, which may be far from it
  }
  std::stable_partition(contacts.begin(), contacts.end(), [](const RawContact& c) { return c.at_centres(); });
  return contacts;
}

std::uint8_t byte_of(const Range& range, double x) {
  return static_cast<std::uint8_t>(quantised(range, x));
}

/// Takes up the contacts of a frame; what is not at a centre goes into `shifts`.
FrameContacts frame_of(const std::vector<RawContact>& raw, std::vector<double>& shifts) {
  FrameContacts f;
  f.written = true;
  Span span;
  for (const RawContact& c : raw) span.add(c.force);
  f.range = range_of(span, levels_of_8_bits, false);
  for (const RawContact& c : raw) {
    f.i.push_back(c.i), f.j.push_back(c.j);
    f.force.push_back(byte_of(f.range, c.force));
    if (!c.at_centres()) shifts.insert(shifts.end(), {c.from.x, c.from.y, c.from.z, c.to.x, c.to.y, c.to.z});
  }
  return f;
}

}  // namespace

bool Contacts::any() const {
  return std::any_of(frames.begin(), frames.end(), [](const FrameContacts& f) { return !f.i.empty(); });
}

Contacts read_contacts(const std::vector<FrameFiles>& files) {
  Contacts all;
  std::vector<std::vector<double>> shifts(files.size());
  Span span;
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (files[f].contacts.empty()) {
      all.frames.emplace_back();
      continue;
    }
    try {
      all.frames.push_back(frame_of(raw_contacts(files[f]), shifts[f]));
      for (const double x : shifts[f]) span.add(x);
    } catch (const std::domain_error& e) {
      throw IoError(files[f].contacts.string() + ": holds " + e.what());
    }
  }
  all.shift = range_of(span, levels_of_8_bits, true);  // zero, a centre, stays zero
  for (std::size_t f = 0; f < files.size(); ++f)
    for (const double x : shifts[f]) all.frames[f].shift.push_back(byte_of(all.shift, x));
  return all;
}

std::size_t bytes_of_contacts(const FrameFiles& files, std::size_t particles) {
  if (files.contacts.empty()) return 0;
  const std::vector<RawContact> raw = raw_contacts(files);
  const std::size_t each = 2 * bytes_of_end(particles) + 1;
  return std::accumulate(raw.begin(), raw.end(), std::size_t{0},
                         [each](std::size_t sum, const RawContact& c) {
                           return sum + each + (c.at_centres() ? 0 : numbers_of_shift);
                         });
}

std::size_t bytes_of_end(std::size_t particles) {
  return particles - 1 <= std::numeric_limits<std::uint16_t>::max() ? sizeof(std::uint16_t)
                                                                    : sizeof(std::uint32_t);
}

}  // namespace vbond::page
