#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "vbond/core/crew.hpp"
#include "vbond/packing/vessel.hpp"

namespace vbond::packing {

/// When a search for balance ends.
struct RelaxGoal {
  double overlap = 0;  ///< the largest is no more than this part of the smaller radius: enough
  double mean_overlap =
      0;  ///< the mean of contacts is below this part of the mean diameter: they hardly touch
  /// If > 0, all radii change by one factor until growing takes this force: energy over the logarithm of the
  /// factor.  [length^2], stiffness 1
  double growth = 0;
  double unbalanced = 1e-3;             ///< the root mean square force over the mean force of contacts
  std::int64_t iterations = 1'000'000;  ///< at most
};

/// Where it ended.
struct Relaxed {
  bool balanced = false;  ///< grains press on each other, in balance
  bool enough = false;    ///< the overlaps are as small as asked
  std::int64_t iterations = 0;
  double energy = 0;           ///< stiffness 1: sum of overlap^2 / 2  [length^2]
  double mean_overlap = 0;     ///< of contacts, walls among them, over the mean diameter
  double largest_overlap = 0;  ///< over the smaller radius; of walls over the radius
  double unbalanced = 0;
  double growth = 0;    ///< of the energy over the logarithm of a factor of all radii  [length^2]
  double pressure = 0;  ///< the virial of grains over 3 V  [1 / length], stiffness 1
};

/// Spheres that repel each other and walls in proportion to their overlap, and the search for their balance
/// by FIRE (Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006; as by Guenole et al., Comput. Mater. Sci. 175,
/// 109584, 2020). Results do not depend on the number of threads: sums go by blocks of grains, in their
/// order.
class SoftSpheres {
 public:
  /// radii: one each, > 0; they are used times a scale. `volume`: of the vessel.
  SoftSpheres(const Vessel& vessel, double volume, std::vector<Vec3d> r, std::vector<double> radii,
              int threads);

  std::size_t size() const { return radii_.size(); }
  double scale() const { return scale_; }
  void set_scale(double scale);
  /// Radii before the scale.
  const std::vector<double>& radii() const { return radii_; }
  std::vector<Vec3d> positions() const;

  Relaxed relax(const RelaxGoal& goal);
  std::int64_t iterations() const { return iterations_; }  ///< of all searches

 private:
  struct Grain {  // one half of a cache line
    double x, y, z, R;
  };
  struct Motion {
    Vec3d v, F;
    double mass, contacts;
  };
  /// Of a block of grains, in their order; a cache line and a half each.
  struct alignas(64) Sums {
    double power = 0, v2 = 0, F2 = 0;  // F . v, m v^2, F^2 / m
    double F2_plain = 0, energy = 0, growth = 0, virial = 0, overlap = 0, contacts = 0;
    double largest_overlap = 0, largest_way2 = 0;
  };
  static constexpr std::size_t block_size = 256;
  struct Part {  // of the grains: what one thread has
    std::size_t first_block, last_block;
    std::vector<std::uint32_t> first, near;       // near grains of each, first from its first grain on
    std::vector<std::uint32_t> wall_first, wall;  // walls in reach of each
    std::vector<Feel> feels;                      // scratch
  };

  std::size_t blocks() const { return (size() + block_size - 1) / block_size; }
  template <class F>
  void for_blocks(F f);
  void list_near();
  void list_part(Part& part, const class NearGrains& near);
  void place_images(std::size_t first, std::size_t last);
  void add_forces(Part& part, std::size_t block);
  void find_forces();
  void move(double dt, double mix_v, double mix_F, double back);
  void grow(double dt, double mix_v, double mix_F, double back);
  Sums total() const;
  void set_masses();
  Relaxed judge(const Sums& s, const RelaxGoal& goal) const;
  bool is_list_stale(const Sums& s) const;

  const Vessel& vessel_;
  double volume_;
  std::vector<double> radii_;
  std::vector<std::size_t> order_;  // which grain of the caller stands where
  double mean_radius_ = 0, largest_radius_ = 0, small_radius_ = 0;
  double scale_ = 1, listed_scale_ = 0, skin_ = 0;
  double grown_ = 1, growth_ = 0, growth_mass_ = 1,
         growth_v_ = 0;        // in a step; force, mass and velocity of ln scale
  std::vector<Grain> grains_;  // first the grains, then images
  std::vector<std::uint32_t> image_of_;
  std::vector<Vec3d> image_shift_;
  std::vector<Vec3d> listed_at_;
  std::vector<Motion> motion_;
  std::vector<Sums> sums_;
  std::vector<Part> parts_;
  std::unique_ptr<Crew> crew_;
  std::int64_t iterations_ = 0;
};

template <class F>
void SoftSpheres::for_blocks(F f) {
  crew_->for_each([&](std::size_t p) {
    for (std::size_t b = parts_[p].first_block; b < parts_[p].last_block; ++b) f(parts_[p], b);
  });
}

}  // namespace vbond::packing
