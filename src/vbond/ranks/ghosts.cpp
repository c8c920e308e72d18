#include "vbond/ranks/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "vbond/core/bounding_box.hpp"
#include "vbond/core/images.hpp"
#include "vbond/core/near_pairs.hpp"

namespace vbond {
namespace {

/// All places that may be near one of these, with whose image each is.
NearImages with_images(Places among, const Model& model, const State& state, double reach) {
  NearImages places;
  if (model.cell.any()) {
    places = near_images(state.cell, model.cell.periodic, among.r, reach);
    for (std::size_t& k : places.of) k = among.of[k].value;
    return places;
  }
  places.points = among.r.size();
  places.image.resize(places.points);
  for (const ParticleId p : among.of) places.of.push_back(p.value);
  places.r = std::move(among.r);
  return places;
}

struct NearBorder {
  std::vector<std::size_t> others, own;
};

/// Those of the places that are not a rank's own particles themselves and may be near one of these; and those
/// of its own to which they may be near: ones in the box of the others, or within reach of it.
NearBorder near_border(const NearImages& places, const PerParticle<char>& is_own, double reach) {
  const auto is_own_place = [&](std::size_t k) {
    return k < places.points && is_own[ParticleId{places.of[k]}] != 0;
  };
  BoundingBox own, others;
  NearBorder near;
  for (std::size_t k = 0; k < places.points; ++k)
    if (is_own_place(k)) own.add(places.r[k]);
  for (std::size_t k = 0; k < places.r.size(); ++k)
    if (!is_own_place(k) && own.is_near(places.r[k], reach))
      near.others.push_back(k), others.add(places.r[k]);
  for (std::size_t k = 0; k < places.points; ++k)
    if (is_own_place(k) && others.is_near(places.r[k], reach)) near.own.push_back(k);
  return near;
}

}  // namespace

Places present_places(const State& state) {
  Places all;
  for (const ParticleId p : state.r.ids())
    if (!is_absent(state, p)) all.of.push_back(p), all.r.push_back(state.r[p]);
  return all;
}

double longest_bond(const State& state) {
  double longest2 = 0.0;
  for (const Bond& b : state.bonds)
    if (!b.broken) longest2 = std::max(longest2, norm2(between(state, b)));
  return std::sqrt(longest2);
}

std::vector<ImageOf> ghosts_of(const std::vector<ParticleId>& own, Places among, const Model& model,
                               const State& state, double reach, bool all) {
  PerParticle<char> is_own(model.particles(), 0);
  for (const ParticleId p : own) is_own[p] = 1;
  std::vector<ImageOf> ghosts;
  const auto add = [&](ParticleId p, const Image& n) {
    if (is_own[p] == 0 || !n.is_itself()) ghosts.push_back({p, n});
  };
  for (const Bond& b : state.bonds)
    if (!b.broken && is_own[b.i] != 0) add(b.j, image_of_j(b));
  if (all)
    for (const ParticleId p : is_own.ids())
      if (!is_absent(state, p)) add(p, {});
  if (reach > 0.0) {
    const NearImages places = with_images(std::move(among), model, state, reach);
    const NearBorder near = near_border(places, is_own, reach);
    std::vector<Vec3d> r;
    for (const std::size_t k : near.own) r.push_back(places.r[k]);
    CellGrid grid;
    grid.sort(r, reach, {}, near.own);
    // particles in the cell have all their neighbours there, or among the images around it
    const auto add_where_near = [&](std::size_t k) {
      grid.scan_near(places.r[k], [&](const CellGrid::Point* first, const CellGrid::Point* last) {
        for (const CellGrid::Point* p = first; p != last; ++p)
          if (norm2(between(places.r[k], p->r)) <= sq(reach))
            add(ParticleId{places.of[k]}, places.image[k] - places.image[p->i]);
      });
    };
    for (const std::size_t k : near.others) add_where_near(k);
    if (model.cell.any())
      for (const std::size_t k : near.own) add_where_near(k);  // they may lie edges apart
  }
  std::sort(ghosts.begin(), ghosts.end());
  ghosts.erase(std::unique(ghosts.begin(), ghosts.end()), ghosts.end());
  return ghosts;
}

void put_in_rows(const Order& order, std::vector<ImageOf>& ghosts, std::vector<int>& owners) {
  struct Ghost {
    Row row;
    ImageOf of;
    int owner;
  };
  std::vector<Ghost> sorted;
  for (std::size_t k = 0; k < ghosts.size(); ++k)
    sorted.push_back({order.row[ghosts[k].particle], ghosts[k], owners[k]});
  std::sort(sorted.begin(), sorted.end(),
            [](const Ghost& a, const Ghost& b) { return std::pair(a.row, a.of) < std::pair(b.row, b.of); });
  for (std::size_t k = 0; k < ghosts.size(); ++k) ghosts[k] = sorted[k].of, owners[k] = sorted[k].owner;
}

void add_bonded_to_ghosts(const std::vector<ParticleId>& own, const State& state,
                          std::vector<ParticleId>& to) {
  PerParticle<char> is_own(state.r.size());
  for (const ParticleId p : own) is_own[p] = 1;
  for (const Bond& b : state.bonds)
    if (!b.broken && is_own[b.i] != 0 && (is_own[b.j] == 0 || !image_of_j(b).is_itself())) to.push_back(b.i);
}

}  // namespace vbond
