#include "vbond/statics/detail/unknowns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "vbond/model/cell_drive.hpp"

namespace vbond {

Unknowns::Unknowns(std::size_t particles, const std::vector<Support>& supports, double length,
                   const Cell& cell, const std::vector<Place>& idle)
    : axes_(supports),
      number_(particles + (cell.any() ? 1 : 0), {0, 0, 0, 0, 0, 0}),
      particles_(particles),
      length_(length),
      cell_length_(cell.length) {
  for (const Support& s : supports) {
    if (is_free_grip(s)) carry(s);
    for (const ParticleId p : s.particles) {
      const bool carried = is_free_grip(s) && p != s.particles.front();
      const HeldDofs of_p = carried ? all_held : axes_.held(s, p);
      for (std::size_t dof = 0; dof < 6; ++dof)
        if (of_p[dof]) number_[p][dof] = held;
    }
  }
  for (const Place& turn : idle)
    if (std::exchange(number_[turn.particle][static_cast<std::size_t>(turn.dof)], held) != held)
      free_turns_.push_back(turn);
  if (cell.any())
    for (std::size_t k = 0; k < 6; ++k)
      if (!cell.free[k]) number_[cell_node()][k] = held;
  for (const ParticleId p : number_.ids())
    for (std::size_t dof = 0; dof < 6; ++dof) {
      if (number_[p][dof] == held) continue;
      number_[p][dof] = size();
      place_.push_back({p, static_cast<int>(dof)});
    }
}

void Unknowns::carry(const Support& grip) {
  if (carried_.empty()) {
    carried_.resize(number_.size());
    for (const ParticleId p : carried_.ids()) carried_[p].by = p;
  }
  for (const ParticleId p : grip.particles) carried_[p] = {grip.particles.front(), true, {}};
}

std::string Unknowns::name(int unknown) const {
  static constexpr const char* dof_names[6] = {"translation along x", "translation along y",
                                               "translation along z", "rotation about x",
                                               "rotation about y",    "rotation about z"};
  const Place p = place(unknown);
  if (is_of_cell(unknown))
    return fmt::format("component {} of the cell", cell_component_names[static_cast<std::size_t>(p.dof)]);
  if (const Vec3d& a = axis(p.particle, p.dof); a != world_axes[static_cast<std::size_t>(p.dof % 3)])
    return fmt::format("{} ({:.3g}, {:.3g}, {:.3g}) of particle {}",
                       p.dof < 3 ? "translation along" : "rotation about", a.x, a.y, a.z, p.particle.value);
  return fmt::format("{} of {}particle {}", dof_names[p.dof], arm(p.particle) ? "the rigid group with " : "",
                     p.particle.value);
}

std::string Unknowns::names_of_largest(const Vector& x) const {
  std::vector<int> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), 0);
  const auto named = std::min<std::ptrdiff_t>(3, x.size());
  std::partial_sort(order.begin(), order.begin() + named, order.end(),
                    [&x](int a, int b) { return std::abs(x[a]) > std::abs(x[b]); });
  std::string text;
  for (std::ptrdiff_t k = 0; k < named; ++k) {
    const int unknown = order[static_cast<std::size_t>(k)];
    if (std::abs(x[unknown]) < 0.1 * std::abs(x[order[0]])) break;
    text += (text.empty() ? "" : ", ") + name(unknown);
  }
  return text;
}

bool Unknowns::is_free_turn(ParticleId p, int dof) const {
  return std::binary_search(free_turns_.begin(), free_turns_.end(), Place{p, dof},
                            [](const Place& a, const Place& b) {
                              return std::pair(a.particle, a.dof) < std::pair(b.particle, b.dof);
                            });
}

std::string Unknowns::names_of_free_turns() const {
  constexpr std::size_t named = 3;
  std::vector<std::uint32_t> numbers;
  for (const Place& turn : free_turns_)
    if (numbers.empty() || numbers.back() != turn.particle.value) numbers.push_back(turn.particle.value);
  const std::size_t all = numbers.size();
  numbers.resize(std::min(named, all));
  return fmt::format("particle{} {}{}", all == 1 ? "" : "s", fmt::join(numbers, ", "),
                     all > named ? fmt::format(" and {} more", all - named) : "");
}

WaveShape Unknowns::shape(const Vector& real, const Vector& imaginary) const {
  const auto moved = [this](const Vector& x) {
    Shape s{PerParticle<Vec3d>(particles_), PerParticle<Vec3d>(particles_)};
    for (const ParticleId p : s.translation.ids()) {
      const Movement m = movement(p, x);
      s.translation[p] = m.shift;
      s.rotation[p] = m.turn / length_;
    }
    return s;
  };
  WaveShape s{moved(real), moved(imaginary)};
  const auto largest_of = [&](PerParticle<Vec3d> Shape::*part) {
    double largest2 = 0.0;
    for (const ParticleId p : s.in_phase.translation.ids())
      largest2 = std::max(largest2, norm2((s.in_phase.*part)[p]) + norm2((s.out_of_phase.*part)[p]));
    return std::sqrt(largest2);
  };
  double largest = largest_of(&Shape::translation);
  const double entry = std::max(real.cwiseAbs().maxCoeff(), imaginary.cwiseAbs().maxCoeff());
  if (!(largest * 1e6 > entry)) largest = largest_of(&Shape::rotation);  // nothing but turns
  if (!(largest > 0.0)) return s;
  for (Shape* part : {&s.in_phase, &s.out_of_phase})
    for (const ParticleId p : part->translation.ids()) {
      part->translation[p] = part->translation[p] / largest;
      part->rotation[p] = part->rotation[p] / largest;
    }
  return s;
}

}  // namespace vbond
