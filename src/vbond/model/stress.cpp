#include "vbond/model/stress.hpp"

#include <cmath>
#include <numbers>

#include "vbond/model/capsules.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/terms/walls/resting_walls.hpp"

namespace vbond {
namespace {

/// Adds the force on i of a pair, which acts at this point, seen from i.
void add_force(ParticleId i, ParticleId j, const Vec3d& F, const Vec3d& at, const Vec3d& r_ij,
               PerParticle<Tensor>& sum) {
  sum[i] += dyad(at, F);
  sum[j] += dyad(at - r_ij, -F);
}

/// The force of friction that a contact remembers.
Vec3d friction_in(const PairHistory& memory) {
  return {memory[0], memory[1], memory[2]};
}
Vec3d friction_on(const State& s, ParticleId i, ParticleId j, const Image& of_j) {
  const PairMemory* memory = memory_of(s, i, j, of_j);
  return memory == nullptr ? Vec3d{} : friction_in(memory->history);
}

/// Adds the forces of walls, which act where these are touched.
void add_walls(const Model& model, const BodyPart& body, PerParticle<Tensor>& sum) {
  if (model.walls.empty()) return;
  const State& s = body.state;
  for (const RestingTouch& t : RestingWalls(model).touches(s))
    if (t.overlap > 0.0 && body.has(t.p))
      sum[t.p] += dyad(-t.distance * t.normal, t.force * t.normal + friction_in(memory_of(s, t)));
}

/// The inverse of a symmetric tensor; not a number if that is singular but for rounding.
Tensor inverse(const Tensor& t) {
  const auto& [x, y, z] = t.row;
  const double det = dot(x, cross(y, z)), mean = (x.x + y.y + z.z) / 3.0;
  const double per_det = det > 1e-12 * mean * mean * mean ? 1.0 / det : std::nan("");
  return {{per_det * cross(y, z), per_det * cross(z, x), per_det * cross(x, y)}};
}

}  // namespace

PerParticle<Tensor> stress_between_particles(const Model& model, const BodyPart& body) {
  const State& s = body.state;
  PerParticle<Tensor> sum(model.particles());
  for (const BondId k : s.bonds.ids()) {
    const Bond& b = s.bonds[k];
    if (b.broken || !body.has(b.i)) continue;
    const BondPose<double> pose = bond_pose(b, s);
    const Vec3d D_ij = bonded_points(b, pose);
    add_force(b.i, b.j, bond_loads(s, k).F, arm_of_i(b, pose) + 0.5 * D_ij, pose.r_ij, sum);
  }
  for_touching_pairs(model, body, [&](ParticleId i, ParticleId j, const Image& n, double overlap) {
    const double R_i = model.radius[i], R_j = model.radius[j];
    const Vec3d r_ij = between(s, i, j, n);
    const double distance = norm(r_ij);
    const Vec3d along = r_ij / distance;
    const double F_n = normal_force(touch_forms(model.contact), touch_numbers(model, i, j),
                                    reduced_radius(R_i, R_j), overlap)
                           .F;
    add_force(i, j, friction_on(s, i, j, n) - F_n * along, 0.5 * (R_i - R_j + distance) * along, r_ij, sum);
  });
  if (!body.all.leads()) return sum;  // all parts know all capsules
  for (const auto& [c, p, history] : fibre_touches(model, s)) {
    const double F_n = normal_force(fibre_forms(model.contact),
                                    touch_numbers(model, c.a.i.particle, c.b.i.particle), p.R, p.overlap)
                           .F;
    const Vec3d F = friction_in(history) - (c.weight * F_n) * p.n;
    const auto place = [&s](const FibrePlace& f) {
      return on_segment(place_of(s.r, s.cell, f.i), place_of(s.r, s.cell, f.j), f.s);
    };
    const Vec3d at = place(c.a) + p.l_i * p.n;
    share_loads(c, p, F, [&](const ImageOf& q, const Vec3d& force, const Vec3d&) {
      sum[q.particle] += dyad(at - place_of(s.r, s.cell, q), force);
    });
  }
  return sum;
}

PerParticle<Tensor> stress_times_volume(const Model& model, const BodyPart& body) {
  PerParticle<Tensor> sum = stress_between_particles(model, body);
  add_walls(model, body, sum);
  return sum;
}

double sphere_volume(const Model& model, ParticleId p) {
  const double R = model.radius[p];
  return 4.0 / 3.0 * std::numbers::pi * R * R * R;
}

Tensor mean_stress(const BodyPart& body, const PerParticle<Tensor>& of_particles,
                   const IdList<ParticleId>& group, double volume) {
  Tensor sum;
  for (const ParticleId p : group) sum += of_particles[p];  // of others', too, what is made of it here
  return (1.0 / volume) * body.summed(sum);
}

Tensor mean_strain(const Model& model, const BodyPart& body, const std::vector<ParticleId>& group) {
  const State& s = body.state;
  Vec3d before, now;
  for (const ParticleId p : group)
    if (body.has(p)) before += model.r_0[p], now += s.r[p];
  before = body.summed(before) / static_cast<double>(group.size()),
  now = body.summed(now) / static_cast<double>(group.size());
  Tensor of_start, across;
  for (const ParticleId p : group) {
    if (!body.has(p)) continue;
    const Vec3d X = model.r_0[p] - before;
    of_start += dyad(X, X);
    across += dyad(X, s.r[p] - now);
  }
  of_start = body.summed(of_start);
  across = body.summed(across);
  // across = of_start F^T; rows of F^T are those of inverse(of_start) across
  const Tensor columns = transposed(across), inverted = inverse(of_start);
  Tensor F;  // row a: F_ab
  for (std::size_t a = 0; a < 3; ++a) F.row[a] = times(inverted, columns.row[a]);
  const Tensor of = transposed(F);  // row b: column b of F
  Tensor E;
  for (std::size_t a = 0; a < 3; ++a)
    E.row[a] = 0.5 * Vec3d{dot(of.row[a], of.row[0]), dot(of.row[a], of.row[1]), dot(of.row[a], of.row[2])};
  E.row[0].x -= 0.5, E.row[1].y -= 0.5, E.row[2].z -= 0.5;
  return E;
}

}  // namespace vbond
