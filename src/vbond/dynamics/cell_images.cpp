#include "vbond/dynamics/cell_images.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vbond/core/images.hpp"
#include "vbond/dynamics/bonding.hpp"
#include "vbond/dynamics/contacts.hpp"
#include "vbond/model/capsules.hpp"
#include "vbond/model/drop.hpp"

namespace vbond {
namespace {

/// What is absent is not known, as the particles of other parts.
std::vector<ParticleId> not_absent(const Model& model, const State& state) {
  std::vector<ParticleId> rest;
  for (const ParticleId p : model.mass.ids())
    if (!is_absent(state, p)) rest.push_back(p);
  return rest;
}

}  // namespace

CellImages::CellImages(const Order& order) : begin_(order.ghosts) {
  for (Row k{order.ghosts}; k.value < order.known; ++k.value) {
    ghosts_.push_back({order.row[order.particle[k]].value, order.image(k)});
    while (first_.size() <= ghosts_.back().of / block_rows) first_.push_back(ghosts_.size() - 1);
  }
}

void CellImages::begin_halo(const HaloColumns& columns) {
  for (std::size_t b = 0; b < first_.size(); ++b) halo_of_block(b, columns);
}

void CellImages::halo_of_block(std::size_t block, const HaloColumns& to) const {
  for (std::size_t g = first_of(block); g < first_of(block + 1); ++g) {
    const auto& [of, image] = ghosts_[g];
    to.pose[begin_ + g] = to.pose[of];
    if (!to.motion.empty()) to.motion[begin_ + g] = to.motion[of];
    to.carry(begin_ + g, image);
  }
}

void CellImages::reverse_sum(std::span<LoadRow> load) {
  for (std::size_t b = 0; b < first_.size(); ++b) reverse_sum_of_block(b, load);
}

void CellImages::reverse_sum_of_block(std::size_t block, std::span<LoadRow> load) const {
  for (std::size_t g = first_of(block); g < first_of(block + 1); ++g) {
    LoadRow& from = load[begin_ + g];
    LoadRow& to = load[ghosts_[g].of];
    to.F += from.F;
    to.M += from.M;
    from = {};
  }
}

std::array<Vec3d, 3> CellImages::edges_times_force(std::span<const LoadRow> load) const {
  std::array<Vec3d, 3> sum{};
  for (std::size_t g = 0; g < ghosts_.size(); ++g) {
    const Image& n = ghosts_[g].image;
    const Vec3d& F = load[begin_ + g].F;
    sum[0] += double(n.a) * F, sum[1] += double(n.b) * F, sum[2] += double(n.c) * F;
  }
  return sum;
}

Share whole_body(const Model& model, const Stage& stage, const State& state) {
  Order order = spatial_order(model.r_0);
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  Share share{.order = {}, .farthest = unlimited, .lost_beyond = unlimited};
  if (!model.cell.any()) {
    share.order = any_absent(state) ? part_of(order, {not_absent(model, state), {}, {}}) : std::move(order);
    return share;
  }
  Holding all{not_absent(model, state), {}, {}};
  std::vector<ImageOf>& images = all.ghosts;
  for (const Bond& b : state.bonds)  // broken ones too: the order of rows is the same after a checkpoint
    if (!image_of_j(b).is_itself() && !is_absent(state, b.i) && !is_absent(state, b.j))
      images.push_back({b.j, image_of_j(b)});
  const BondIndex none;
  const std::vector<char> of_fibre = particles_of_fibres(model.particles(), state.bonds);
  const bool spheres = of_fibre.empty() || std::find(of_fibre.begin(), of_fibre.end(), 0) != of_fibre.end();
  const bool meet = (spheres && particles_touch(model.contact)) || !stage.bonding.empty();
  if (meet) {
    double R_sum = 0.0;
    for (const double R : model.radius) R_sum += R;
    // as far as half the mean radius: images are few, and are found anew every some hundred steps
    const double room = 0.5 * R_sum / static_cast<double>(model.particles());
    share.farthest = 0.5 * room;
    const double reach =
        room + std::max(Contacts(model, order, none).reach(), Bonding(model, stage, order, none).reach());
    std::vector<Vec3d> places;
    for (const ParticleId p : all.own) places.push_back(state.r[p]);
    for_near_images(state.cell, model.cell.periodic, places, reach,
                    [&](std::size_t, std::size_t j, const Image& n, double) {
                      if (!n.is_itself()) images.push_back({all.own[j], n});
                    });
  }
  std::sort(images.begin(), images.end());
  images.erase(std::unique(images.begin(), images.end()), images.end());
  all.apart = !meet && !images.empty();  // parts then have images of their own
  if (meet && !images.empty()) all.early = all.own;
  for (const ImageOf& of : images)
    if (!meet && (all.early.empty() || all.early.back() != of.particle)) all.early.push_back(of.particle);
  share.order = part_of(order, all);
  return share;
}

}  // namespace vbond
