#include "vbond/packing/soft_spheres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "vbond/core/images.hpp"
#include "vbond/core/sized_points.hpp"

namespace vbond::packing {

/// Grains and images near the cell, sorted for finding pairs.
class NearGrains {
 public:
  NearGrains(const Vessel& vessel, std::span<const Vec3d> r, std::span<const double> radii, double margin) {
    const double largest = *std::max_element(radii.begin(), radii.end());
    if (vessel.cell.empty()) {
      r_.assign(r.begin(), r.end());
    } else {
      std::vector<Vec3d> from_corner(r.begin(), r.end());
      for (Vec3d& at : from_corner) at -= vessel.corner;
      images_ = near_images(vessel.cell, vessel.periodic, from_corner, 2.0 * largest + margin);
      r_ = images_.r;
      for (Vec3d& at : r_) at += vessel.corner;
    }
    for (std::size_t k = 0; k < r_.size(); ++k) radii_.push_back(radii[of(k)]);
    points_ = SizedPoints(radii_, margin);
    points_.sort(r_);
  }
  std::size_t size() const { return r_.size(); }
  std::size_t of(std::size_t k) const { return images_.of.empty() ? k : images_.of[k]; }
  const Vec3d& at(std::size_t k) const { return r_[k]; }
  double radius(std::size_t k) const { return radii_[k]; }
  template <class Scan>
  void scan_near(std::size_t k, Scan&& scan) const {
    points_.scan_near(k, scan);
  }

 private:
  NearImages images_;
  std::vector<Vec3d> r_;
  std::vector<double> radii_;
  SizedPoints points_;
};

namespace {

/// A thread has at least so many grains: for less, handing out work costs more than it saves.
constexpr std::size_t least_part = 4000;

std::vector<std::size_t> order_in_space(std::span<const Vec3d> r, double width) {
  BoundingBox box = box_around(r);
  const Vec3d size = box.high - box.low;
  // 21 bits along each axis, interleaved
  const double cells = std::max({size.x, size.y, size.z}) / width;
  const double per = cells > 0x1p20 ? 0x1p20 / (cells * width) : 1.0 / width;
  const auto spread = [](std::uint64_t x) {
    std::uint64_t code = 0;
    for (int bit = 0; bit < 21; ++bit) code |= (x >> bit & 1) << (3 * bit);
    return code;
  };
  std::vector<std::uint64_t> code(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec3d s = per * (r[i] - box.low);
    code[i] = spread(static_cast<std::uint64_t>(s.x)) | spread(static_cast<std::uint64_t>(s.y)) << 1 |
              spread(static_cast<std::uint64_t>(s.z)) << 2;
  }
  std::vector<std::size_t> order(r.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return code[a] < code[b]; });
  return order;
}

}  // namespace

SoftSpheres::SoftSpheres(const Vessel& vessel, double volume, std::vector<Vec3d> r, std::vector<double> radii,
                         int threads)
    : vessel_(vessel), volume_(volume), radii_(std::move(radii)) {
  const std::size_t n = radii_.size();
  mean_radius_ = std::accumulate(radii_.begin(), radii_.end(), 0.0) / static_cast<double>(n);
  std::vector<double> sorted = radii_;
  std::sort(sorted.begin(), sorted.end());
  largest_radius_ = sorted.back(), small_radius_ = sorted[n / 10];
  order_ = order_in_space(r, 2.0 * mean_radius_);
  grains_.resize(n), motion_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = order_[k];
    grains_[k] = {r[i].x, r[i].y, r[i].z, radii_[i]};
    motion_[k].mass = 1.0;
  }
  sums_.resize(blocks());
  const std::size_t parts =
      std::clamp<std::size_t>(n / least_part, 1, static_cast<std::size_t>(std::max(threads, 1)));
  crew_ = std::make_unique<Crew>(parts);
  for (std::size_t p = 0; p < parts; ++p)
    parts_.push_back({blocks() * p / parts, blocks() * (p + 1) / parts, {}, {}, {}, {}, {}});
}

std::vector<Vec3d> SoftSpheres::positions() const {
  std::vector<Vec3d> r(size());
  for (std::size_t k = 0; k < size(); ++k) r[order_[k]] = {grains_[k].x, grains_[k].y, grains_[k].z};
  return r;
}

void SoftSpheres::set_scale(double scale) {
  scale_ = scale;
  for (std::size_t k = 0; k < size(); ++k) grains_[k].R = scale * radii_[order_[k]];
  for (std::size_t k = size(); k < grains_.size(); ++k) grains_[k].R = grains_[image_of_[k - size()]].R;
}

void SoftSpheres::list_near() {
  const std::size_t n = size();
  std::vector<Vec3d> r(n);
  std::vector<double> R(n);
  for (std::size_t k = 0; k < n; ++k) {
    r[k] = {grains_[k].x, grains_[k].y, grains_[k].z};
    R[k] = grains_[k].R;
    if (!is_finite(r[k])) throw std::logic_error("a grain has no finite place");
  }
  const NearGrains near(vessel_, r, R, skin_);
  listed_scale_ = scale_;
  listed_at_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3d& at = listed_at_[k] = near.at(k);  // in the cell
    grains_[k] = {at.x, at.y, at.z, R[k]};
  }
  grains_.resize(near.size());
  image_of_.resize(near.size() - n);
  image_shift_.resize(near.size() - n);
  for (std::size_t k = n; k < near.size(); ++k) {
    const std::size_t of = near.of(k);
    image_of_[k - n] = static_cast<std::uint32_t>(of);
    image_shift_[k - n] = between(near.at(of), near.at(k));
    grains_[k] = {near.at(k).x, near.at(k).y, near.at(k).z, R[of]};
  }
  crew_->for_each([&](std::size_t p) { list_part(parts_[p], near); });
}

void SoftSpheres::list_part(Part& part, const NearGrains& near) {
  part.first.assign(1, 0), part.wall_first.assign(1, 0);
  part.near.clear(), part.wall.clear();
  const std::size_t first = part.first_block * block_size,
                    last = std::min(size(), part.last_block * block_size);
  for (std::size_t i = first; i < last; ++i) {
    const Vec3d r = near.at(i);
    const double R = near.radius(i) + skin_;
    near.scan_near(i, [&](const CellGrid::Point* from, const CellGrid::Point* to) {
      for (const CellGrid::Point* q = from; q != to; ++q)
        if (q->i != i && norm2(between(r, q->r)) < sq(R + near.radius(q->i)))
          part.near.push_back(static_cast<std::uint32_t>(q->i));
    });
    part.first.push_back(static_cast<std::uint32_t>(part.near.size()));
    for (std::size_t w = 0; w < vessel_.walls.size(); ++w)
      if (vessel_.walls[w]->depth(r) < R) part.wall.push_back(static_cast<std::uint32_t>(w));
    part.wall_first.push_back(static_cast<std::uint32_t>(part.wall.size()));
  }
}

void SoftSpheres::place_images(std::size_t first, std::size_t last) {
  for (std::size_t k = first; k < last; ++k) {
    const Grain& g = grains_[image_of_[k]];
    const Vec3d& s = image_shift_[k];
    grains_[size() + k] = {g.x + s.x, g.y + s.y, g.z + s.z, g.R};
  }
}

void SoftSpheres::add_forces(Part& part, std::size_t block) {
  struct Touch {
    double x, y, z, d2, R;
  };
  std::array<Touch, 32> touch;
  Sums sums;
  const std::size_t first = block * block_size, last = std::min(size(), first + block_size);
  const std::size_t of_part = part.first_block * block_size;
  for (std::size_t i = first; i < last; ++i) {
    const Grain g = grains_[i];
    double Fx = 0, Fy = 0, Fz = 0, energy = 0, growth = 0, virial = 0, overlap = 0, contacts = 0, deepest = 0;
    const std::uint32_t *near = part.near.data() + part.first[i - of_part], *const end =
                                                                                part.near.data() +
                                                                                part.first[i - of_part + 1];
    while (near != end) {
      std::size_t touching = 0;  // collected without a branch, which no processor could foresee
      for (; near != end && touching < touch.size(); ++near) {
        const Grain& o = grains_[*near];
        const double x = between(g.x, o.x), y = between(g.y, o.y), z = between(g.z, o.z);
        const double d2 = x * x + y * y + z * z, sum = g.R + o.R;
        touch[touching] = {x, y, z, d2, o.R};
        touching += d2 < sum * sum ? 1 : 0;
      }
      for (std::size_t k = 0; k < touching; ++k) {
        const auto& [x, y, z, d2, R] = touch[k];
        const double d = std::sqrt(d2), delta = g.R + R - d, per = d > 0.0 ? delta / d : 0.0;
        Fx -= per * x, Fy -= per * y, Fz -= per * z;
        energy += 0.25 * delta * delta, virial += 0.5 * delta * d, growth += 0.5 * delta * (g.R + R);
        overlap += 0.5 * delta, contacts += 0.5;
        deepest = std::max(deepest, delta / std::min(g.R, R));
      }
    }
    double touching = 2.0 * contacts;
    for (std::uint32_t k = part.wall_first[i - of_part]; k < part.wall_first[i - of_part + 1]; ++k) {
      part.feels.clear();
      vessel_.walls[part.wall[k]]->feel(vessel_.in_cell({g.x, g.y, g.z}), g.R, part.feels);
      for (const Feel& f : part.feels) {
        const double delta = g.R - f.depth;
        Fx += delta * f.inward.x, Fy += delta * f.inward.y, Fz += delta * f.inward.z;
        energy += 0.5 * delta * delta, virial += delta * f.depth, growth += delta * g.R;
        overlap += delta, contacts += 1.0, touching += 1.0;
        deepest = std::max(deepest, delta / g.R);
      }
    }
    Motion& m = motion_[i];
    m.F = {Fx, Fy, Fz};
    m.contacts = touching;
    const double F2 = norm2(m.F);
    sums.power += dot(m.F, m.v), sums.v2 += m.mass * norm2(m.v), sums.F2 += F2 / m.mass;
    sums.F2_plain += F2, sums.energy += energy, sums.virial += virial, sums.growth += growth;
    sums.overlap += overlap, sums.contacts += contacts;
    sums.largest_overlap = std::max(sums.largest_overlap, deepest);
    sums.largest_way2 = std::max(sums.largest_way2, norm2(Vec3d{g.x, g.y, g.z} - listed_at_[i]));
  }
  sums_[block] = sums;
}

void SoftSpheres::find_forces() {
  const std::size_t images = image_of_.size(), parts = parts_.size();
  if (images > 0)
    crew_->for_each([&](std::size_t p) { place_images(images * p / parts, images * (p + 1) / parts); });
  for_blocks([this](Part& part, std::size_t b) { add_forces(part, b); });
}

void SoftSpheres::move(double dt, double mix_v, double mix_F, double back) {
  for_blocks([&](Part&, std::size_t b) {
    const std::size_t first = b * block_size, last = std::min(size(), first + block_size);
    for (std::size_t i = first; i < last; ++i) {
      Motion& m = motion_[i];
      Grain& g = grains_[i];
      if (back != 0.0) {
        g.x -= back * m.v.x, g.y -= back * m.v.y, g.z -= back * m.v.z;
        m.v = {};
      }
      const double per_mass = 1.0 / m.mass;
      m.v = mix_v * m.v + ((mix_F + dt) * per_mass) * m.F;
      const double way2 = dt * dt * norm2(m.v), most = 0.2 * g.R;
      if (way2 > most * most) m.v = (most / std::sqrt(way2)) * m.v;
      g.x += dt * m.v.x, g.y += dt * m.v.y, g.z += dt * m.v.z, g.R *= grown_;
    }
  });
}

/// The same step of the size; before that of the places, which gives it to the grains.
void SoftSpheres::grow(double dt, double mix_v, double mix_F, double back) {
  double change = -back * growth_v_;
  if (back != 0.0) growth_v_ = 0.0;
  growth_v_ = mix_v * growth_v_ + (mix_F + dt) / growth_mass_ * growth_;
  constexpr double most = 1e-3;
  if (dt * std::abs(growth_v_) > most) growth_v_ = std::copysign(most / dt, growth_v_);
  change += dt * growth_v_;
  grown_ = 1.0 + change, scale_ *= grown_;
}

SoftSpheres::Sums SoftSpheres::total() const {
  Sums all;
  for (const Sums& s : sums_) {
    all.power += s.power, all.v2 += s.v2, all.F2 += s.F2, all.F2_plain += s.F2_plain;
    all.energy += s.energy, all.virial += s.virial, all.growth += s.growth, all.overlap += s.overlap,
        all.contacts += s.contacts;
    all.largest_overlap = std::max(all.largest_overlap, s.largest_overlap);
    all.largest_way2 = std::max(all.largest_way2, s.largest_way2);
  }
  return all;
}

/// Of a grain that many others touch, so that none is faster than the step allows.
void SoftSpheres::set_masses() {
  for (Motion& m : motion_) m.mass = std::max(1.0, m.contacts / 6.0);
}

bool SoftSpheres::is_list_stale(const Sums& s) const {
  const double grown = 2.0 * largest_radius_ * std::max(0.0, scale_ - listed_scale_);
  return !(2.0 * std::sqrt(s.largest_way2) + grown < skin_);
}

Relaxed SoftSpheres::judge(const Sums& s, const RelaxGoal& goal) const {
  Relaxed result;
  result.growth = s.growth;
  const double mean_overlap = s.contacts > 0.0 ? s.overlap / s.contacts : 0.0;
  result.mean_overlap = mean_overlap / (2.0 * scale_ * mean_radius_);
  result.largest_overlap = s.largest_overlap;
  result.unbalanced =
      mean_overlap > 0.0 ? std::sqrt(s.F2_plain / static_cast<double>(size())) / mean_overlap : 0.0;
  result.enough = s.largest_overlap <= goal.overlap || result.mean_overlap < goal.mean_overlap;
  result.balanced = !result.enough && result.unbalanced < goal.unbalanced &&
                    !(goal.growth > 0.0 && std::abs(s.growth / goal.growth - 1.0) > 0.01);
  result.energy = s.energy;
  result.pressure = s.virial / (3.0 * volume_);
  return result;
}

Relaxed SoftSpheres::relax(const RelaxGoal& goal) {
  constexpr double dt_at_first = 0.2, dt_most = 0.4, much = 0.1, little = 0.01, touching = 1e-3;
  constexpr int wait = 20;
  double dt = dt_at_first, mix = much;
  int downhill = 0;
  for (Motion& m : motion_) m.v = {};
  skin_ = 0.3 * scale_ * small_radius_;
  list_near();
  find_forces();
  set_masses();
  grown_ = 1.0, growth_v_ = 0.0;
  // as fast as grains: of as many springs as there are contacts
  growth_mass_ = 2.0 * static_cast<double>(size()) * sq(2.0 * scale_ * mean_radius_);
  const auto sum_up = [&] {
    Sums all = total();
    if (!(goal.growth > 0.0)) return all;
    growth_ = goal.growth - all.growth;
    all.power += growth_ * growth_v_, all.v2 += growth_mass_ * sq(growth_v_);
    all.F2 += sq(growth_) / growth_mass_;
    return all;
  };
  Sums s = sum_up();
  std::int64_t lists = 1, since_list = 0;
  Relaxed result;
  for (;; ++result.iterations) {
    const std::int64_t so_far = result.iterations;
    result = judge(s, goal);
    result.iterations = so_far;
    if (result.enough || result.balanced || result.iterations >= goal.iterations) break;
    double back = 0.0;
    if (s.power > 0.0) {
      if (++downhill > wait) dt = std::min(1.1 * dt, dt_most), mix *= 0.99;
    } else if (result.iterations > 0) {
      back = 0.5 * dt;
      // near balance soft modes take long ways, from which much mixing would turn them
      downhill = 0, mix = result.mean_overlap > touching ? much : little;
    }
    const bool mixes = back == 0.0 && s.F2 > 0.0;
    const double mix_v = mixes ? 1.0 - mix : 1.0, mix_F = mixes ? mix * std::sqrt(s.v2 / s.F2) : 0.0;
    if (goal.growth > 0.0) grow(dt, mix_v, mix_F, back);
    move(dt, mix_v, mix_F, back);
    find_forces();
    s = sum_up();
    ++since_list;
    const double thinnest = 0.03 * scale_ * small_radius_;
    const bool is_too_long =
        since_list >= 100 && skin_ > thinnest && 20.0 * std::sqrt(s.largest_way2) < skin_;
    if (is_list_stale(s) || is_too_long) {
      // a skin for which lists last long but are not long
      if (since_list < 10)
        skin_ = std::min(1.5 * skin_, 0.6 * scale_ * small_radius_);
      else if (since_list >= 100)
        skin_ = std::max((is_too_long ? 0.3 : 0.7) * skin_, thinnest);
      list_near();
      find_forces();
      set_masses();
      s = sum_up();
      since_list = 0, ++lists;
    }
  }
  iterations_ += result.iterations;
  return result;
}

}  // namespace vbond::packing
