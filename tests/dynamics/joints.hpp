#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

#include "campaigns/dice.hpp"
#include "rods.hpp"
#include "vbond/model/joint_cells.hpp"

/// Flat joints for tests, and a joint by formulas of the tests' own.
namespace vbond::testing {

struct Rock {
  double k_n = 3.0, k_s = 1.3, radius = 0.8;
  double tension = 1e-3, cohesion = 2e-3, tan_phi = 0.5, friction = 0.6;
  FlatJoint joint{2, 6};
};

inline BondRecipe recipe_of(const Rock& rock, bool rubs = true) {
  BondRecipe recipe;
  TheoryParameters theory;
  theory.theory = BondTheory::parallel;
  theory.section = circle(2.0 * rock.radius);
  theory.per_area.k_n = rock.k_n, theory.per_area.k_s = rock.k_s;
  recipe.parameters = theory;
  recipe.flat_joint = rock.joint;
  recipe.n_2 = Vec3d{0, 1, 0};
  recipe.rules.strength = mohr_coulomb_strength(unit_section, rock.cohesion, rock.tan_phi, rock.tension, 0.0);
  recipe.rules.strength.own_section = true;
  if (rubs) recipe.rules.rubbing = {rock.friction, 1.0};
  return recipe;
}

/// A bond for each cell between particles i and j.
inline void join(Specimen& s, std::size_t i, std::size_t j, const BondRecipe& recipe) {
  for (const BondRecipe& cell : recipes_of(recipe)) bond(s, i, j, cell);
}

/// Two grains of radius 1 that just touch, joined, along x.
inline Specimen two_grains(const Rock& rock, bool rubs = true) {
  Specimen s = particles_at({{0, 0, 0}, {2, 0, 0}}, 1.0, 0.4);
  join(s, 0, 1, recipe_of(rock, rubs));
  return s;
}

inline std::size_t cracked(const State& s) {
  std::size_t n = 0;
  for (const Bond& b : s.bonds) n += is_cracked(b);
  return n;
}
inline Vec3d force_on_first(const State& s) {
  Vec3d F;
  for (const BondId k : s.bonds.ids()) F += bond_loads(s, k).F;
  return F;
}
inline Vec3d moment_on_second(const State& s) {
  Vec3d M;
  for (const BondId k : s.bonds.ids()) M += bond_loads(s, k).M_ji;
  return M;
}
/// All cells of all joints crack as they stand.
inline void crack_all(Specimen& s) {
  s.state.bond_history.resize(s.state.bonds.size());
  for (const BondId k : s.state.bonds.ids()) {
    Bond& b = s.state.bonds[k];
    b.mode = BreakMode::tension;
    s.state.bond_history[k] = b.law->crack(b, bond_pose(b, s.state), no_history);
  }
}

/// Strains of random joints: small, as PlainJoint is linear.
inline constexpr double small_strain = 1e-4;
inline Rock random_rock(Dice& dice) {
  Rock rock;
  rock.joint = {static_cast<int>(dice(1, 4)), static_cast<int>(dice(3, 9))};
  rock.k_n = dice(1, 5), rock.k_s = dice(0.5, 3), rock.radius = dice(0.3, 1);
  rock.tension = rock.k_n * small_strain * dice(0.2, 1.5);
  rock.cohesion = rock.k_s * small_strain * dice(0.2, 1.5);
  rock.tan_phi = dice(0, 1), rock.friction = dice(0, 1);
  return rock;
}
/// Where the second grain of a random joint goes, from where it is.
struct Way {
  Vec3d shift, turn;
};
inline Way random_way(Dice& dice) {
  const Vec3d pressed{dice(0, 2) * small_strain, 0, 0};
  return {dice.vector(small_strain) - pressed, dice.vector(small_strain)};
}

/// A joint along x by linear formulas of its own: springs per area at the middles of cells, grains that move
/// little. Forces on the first grain.
class PlainJoint {
 public:
  explicit PlainJoint(const Rock& rock) : rock_(rock) {
    const int n = rock.joint.around;
    for (int ring = 0; ring < rock.joint.radial; ++ring)
      for (int k = 0; k < n; ++k) {
        const double r_1 = rock.radius * ring / rock.joint.radial,
                     r_2 = rock.radius * (ring + 1) / rock.joint.radial, half = M_PI / n,
                     A = half * (r_2 * r_2 - r_1 * r_1),
                     middle = 2.0 / 3.0 * std::sin(half) * (std::pow(r_2, 3) - std::pow(r_1, 3)) / A;
        cells_.push_back({A, middle * std::cos((2 * k + 1) * half), middle * std::sin((2 * k + 1) * half)});
      }
  }
  /// Grain 2 has moved by u and turned by w, about its centre, one away from the joint.
  void go_to(const Vec3d& u, const Vec3d& w) {
    for (Cell& c : cells_) {
      const Vec3d arm{-1.0, c.y, c.z};  // from the centre of grain 2 to the cell
      // of the half way up to the middle plane, which turns by half of w: grain 1 is held
      const Vec3d at{u.x + w.y * arm.z - w.z * arm.y, u.y + w.z * arm.x - w.x * arm.z,
                     u.z + w.x * arm.y - w.y * arm.x};
      double sigma = rock_.k_n * at.x, s_y = rock_.k_s * (at.y - c.slip_y),
             s_z = rock_.k_s * (at.z - c.slip_z);
      if (!c.cracked) {
        const double tau = std::hypot(s_y, s_z);
        c.cracked = sigma >= rock_.tension || tau >= rock_.cohesion - sigma * rock_.tan_phi;
      }
      if (c.cracked) {
        sigma = std::min(sigma, 0.0);
        const double tau = std::hypot(s_y, s_z), most = -rock_.friction * sigma;
        if (tau > most) {
          const double part = most / tau;
          c.slip_y += (1.0 - part) * s_y / rock_.k_s, c.slip_z += (1.0 - part) * s_z / rock_.k_s;
          s_y *= part, s_z *= part;
        }
      }
      c.force = {c.A * sigma, c.A * s_y, c.A * s_z};
    }
  }
  Vec3d force() const {
    Vec3d F;
    for (const Cell& c : cells_) F += c.force;
    return F;
  }
  std::vector<bool> cracked() const {
    std::vector<bool> all;
    for (const Cell& c : cells_) all.push_back(c.cracked);
    return all;
  }

 private:
  struct Cell {
    double A, y, z;
    bool cracked = false;
    double slip_y = 0, slip_z = 0;
    Vec3d force{};
  };
  Rock rock_;
  std::vector<Cell> cells_;
};

}  // namespace vbond::testing
