#include "vbond/observe/contact_list.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "vbond/dynamics/touch_kernel.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/contact.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/physics/touch.hpp"
#include "vbond/terms/walls/resting_walls.hpp"

namespace vbond {
namespace {

/// What is asked of every contact, however it is made up.
struct Pressed {
  Vec3d normal;  ///< unit vector from i
  double overlap, R;
  double times = 1;  ///< how often the elastic force counts: contacts within fibres
};

/// Fills in the forces: the elastic one along the normal, and what the last step has left in the memory.
void add_forces(const Pressed& p, const TouchForms& forms, const TouchNumbers<double>& c,
                const PairHistory& memory, ListedContact& to) {
  const TouchHistory<double> h = touch_history(memory);
  const NormalForce<double> N = normal_force(forms, c, p.R, p.overlap);
  to.overlap = p.overlap;
  to.radius = forms.normal == NormalForm::linear ? std::sqrt(p.R * std::max(p.overlap, 0.0)) : N.a;
  to.force = h.F_t + h.F_d - (p.times * N.F) * p.normal;
  to.normal_force = -dot(to.force, p.normal);
  to.friction = norm(across(to.force, p.normal));
  const double k_t = forms.tangential == TangentialForm::none ? 0.0 : tangential_stiffness(forms, c, h.a);
  to.slip = k_t > 0.0 ? norm(h.F_t) / k_t : 0.0;
}

/// A particle and an image of another one.
struct TouchingPair {
  ParticleId i, j;
  Image image_j;
};

void list_pair(const Model& model, const State& s, const TouchingPair& pair, double overlap,
               const PairHistory& memory, std::vector<ListedContact>& to) {
  const auto [i, j, n] = pair;
  ListedContact& c = to.emplace_back();
  c.i = static_cast<std::int64_t>(i.value), c.j = static_cast<std::int64_t>(j.value);
  c.of_j = n;
  const Vec3d r_ij = between(s, i, j, n);
  c.from = s.r[i], c.to = n.is_itself() ? s.r[j] : s.r[i] + r_ij;
  add_forces({normalised(r_ij), overlap, reduced_radius(model.radius[i], model.radius[j])},
             touch_forms(model.contact), touch_numbers(model, i, j), memory, c);
}

/// Pairs that overlap, and pairs that adhesion holds together beyond that: these are remembered as touching.
void list_particles(const Model& model, const State& s, std::vector<ListedContact>& to) {
  for_touching_pairs(model, s, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    const PairMemory* memory = memory_of(s, i, j, n);
    list_pair(model, s, {i, j, n}, overlap, memory ? memory->history : PairHistory{}, to);
  });
  if (model.contact.adhesion == AdhesionForm::jkr)
    for (const PairMemory& m : s.contact_history) {
      const double overlap =
          model.radius[m.i] + model.radius[m.j] - norm(between(s, m.i, m.j, m.image_j)) - m.kept;
      if (m.history[3] > 0.0 && !(overlap > 0.0) && !are_one_body(s, m.i, m.j, m.image_j))
        list_pair(model, s, {m.i, m.j, m.image_j}, overlap, m.history, to);
    }
  std::sort(to.begin(), to.end(), [](const ListedContact& a, const ListedContact& b) {
    return std::tie(a.i, a.j, a.of_j) < std::tie(b.i, b.j, b.of_j);
  });
}

void list_fibres(const Model& model, const State& s, std::vector<ListedContact>& to) {
  if (!any_capsules(model.contact, s.bonds)) return;
  const auto middle = [&s](const FibrePlace& f) {
    return on_segment(place_of(s.r, s.cell, f.i), place_of(s.r, s.cell, f.j), f.s);
  };
  for (const auto& [f, p, history] : fibre_touches(model, s)) {
    ListedContact& c = to.emplace_back();
    c.i = static_cast<std::int64_t>(f.a.i.particle.value);
    c.j = static_cast<std::int64_t>(f.b.i.particle.value);
    c.of_j = f.b.i.image;
    c.from = middle(f.a), c.to = middle(f.b);
    add_forces({p.n, p.overlap, p.R, static_cast<double>(f.weight)}, fibre_forms(model.contact),
               touch_numbers(model, f.a.i.particle, f.b.i.particle), history, c);
  }
}

void list_walls(const Model& model, const State& s, std::vector<ListedContact>& to) {
  const RestingWalls walls(model);
  if (!walls.any()) return;
  const TouchForms forms = touch_forms(model.contact);
  const auto numbers = [&model](std::uint32_t wall, std::uint32_t material) {
    return touch_numbers(model.contact, model.materials, material, model.walls[wall].material);
  };
  double reach = 0.0;  // adhesion holds on not nearly as far as this
  if (forms.adhesion == AdhesionForm::jkr)
    reach = *std::max_element(model.radius.begin(), model.radius.end());
  for (const RestingTouch& t : walls.near(s, reach)) {
    const PairHistory memory = memory_of(s, t);
    if (std::isnan(t.overlap) || (!(t.overlap > 0.0) && !(memory[3] > 0.0))) continue;
    ListedContact& c = to.emplace_back();
    c.i = static_cast<std::int64_t>(t.p.value), c.wall = t.wall;
    c.from = s.r[t.p], c.to = s.r[t.p] - t.distance * t.normal;
    add_forces({-t.normal, t.overlap, t.reduced_radius}, forms, numbers(t.wall, model.material_of(t.p)),
               memory, c);
  }
}

}  // namespace

std::vector<ListedContact> list_contacts(const Model& model, const State& state, bool at_rest) {
  if (at_rest) {  // nothing but what is not felt of overlaps is remembered
    State resting = state;
    for (PairMemory& m : resting.contact_history) m.history = {};
    resting.fibre_history.clear(), resting.wall_history.clear();
    return list_contacts(model, resting);
  }
  std::vector<ListedContact> all;
  list_particles(model, state, all);
  list_fibres(model, state, all);
  list_walls(model, state, all);
  return all;
}

}  // namespace vbond
