#pragma once
#include <cstdint>
#include <optional>

#include "vbond/core/quat.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/stage.hpp"
#include "vbond/model/state.hpp"

namespace vbond {

/// One particle as bond creation sees it.
struct BondSite {
  ParticleId id;
  Vec3d r;  ///< [length]
  Quatd q;
  double radius;                 ///< [length]
  double mass = 0, inertia = 0;  ///< for damping by ratio only
  Image image = {};              ///< of the particle, which r is the place of
  Vec3d offset = {};             ///< from there to what the bond joins, rigid with the particle  [length]
};

/// A particle, or an image of it, as it stands in this state.
inline BondSite bond_site(const Model& model, const State& s, ParticleId p, const Image& image = {}) {
  return {p,    s.r[p] + to_image(s.cell, image), s.q[p], model.radius[p], model.mass[p], model.inertia[p],
          image};
}

/// A bond between two particles as they stand now, unstressed but for the recipe's prestrain, whatever their
/// orientation: its axes are stored in each particle's own basis, [KA12] eq. (5). Nothing if the bonded
/// points would be no apart or crossed over (a <= 0), as for touching particles bonded at their surfaces.
/// A state takes it up by add_bond(), which sees to what it remembers of a prestrain.
std::optional<Bond> make_bond(const BondRecipe& recipe, const BondSite& i, const BondSite& j);

/// Whether a bond has no strength left beside its prestrain: it would break in the step in which it is made.
bool breaks_as_made(const Bond& bond, const BondSite& i, const BondSite& j);
/// The same of a bond of mean strength, made by this recipe between two particles.
bool breaks_by_prestrain(const BondRecipe& recipe, const BondSite& i, const BondSite& j);
/// The same of the longest bond that a rule makes, which its prestrain pulls most.
bool breaks_by_prestrain(const BondingRule& rule, const Model& model);

/// The stiffnesses a recipe gives to a bond of length a > 0 (of its reference length, if it has one) between
/// particles of these radii, which count only where it needs_radii().
BondStiffness<double> stiffness_of(const BondRecipe& recipe, double a, const BondRadii& radii = {});

/// Length and attachment distances of a bond whose particles are so far apart.  [length]
struct BondLengths {
  double a, R_i, R_j;  ///< a: before its prestrain; <= 0, or no number: no length is left
};
BondLengths bond_lengths(const BondRecipe& recipe, double distance, const BondRadii& radii);

/// A number of [0, 1) that depends on the seed and the pair alone, whichever end comes first: for choosing a
/// share of pairs. Independent of the factors of strength of the same seed.
double pair_variate(std::uint64_t seed, ParticleId i, ParticleId j, const Image& image_j = {});

/// The stiffnesses of a bond about rest, from its coefficients.
BondStiffness<double> stiffness_of(const Bond& bond);

/// Weibull's factor of strength for the uniform variate u of [0, 1) and a bond of volume V.
double weibull_factor(const Weibull& weibull, double u, double V);

/// The direction n_2 of a new bond along the unit vector e_ij; see BondRecipe::n_2.
Vec3d bond_n_2(const Vec3d& e_ij, const std::optional<Vec3d>& wanted);

}  // namespace vbond
