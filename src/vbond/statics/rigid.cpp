#include "vbond/statics/detail/rigid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/dense.hpp"

namespace vbond {
namespace {

using Motion = Eigen::Matrix<double, 6, 1>;  // translation of the centroid, turn about it times the radius
using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic>;
using Row = Eigen::Matrix<double, 1, 6>;  // what moves with each of them

// What is held at a lever d of the size of a part resists turning with d^2 of the stiffness. That is lost in
// the rounding of the tangent once d is below the root of eps.
constexpr double smallest_lever = 1.5e-8;

/// A bond, contact or rigid support between two particles, or a particle and an image.
struct Link {
  ParticleId to;
  Image of_to;
};

/// What hangs together, its particles in increasing order.
struct Part {
  std::vector<ParticleId> particles;
  /// Orthonormal directions that span the ways to images of itself that it hangs together with.
  std::vector<Vec3d> across;
  std::vector<Image> loops;  // to those images
};

/// The parts, in the order of their first particles, and where particles are, or those images of them that
/// hang together with the first particle of a part.
struct Parts {
  std::vector<Part> all;
  PerParticle<Vec3d> r;
  PerParticle<Image> image;
};

/// Another way to an image, if it leads in a new direction.
void add_way(Vec3d way, std::vector<Vec3d>& across) {
  constexpr double rounding = 1e-9;
  const double length = norm(way);
  for (const Vec3d& u : across) way -= dot(u, way) * u;
  if (norm(way) > rounding * length) across.push_back(way / norm(way));
}

PerParticle<std::vector<Link>> links(const Model& model, const State& state, const Unknowns& unknowns) {
  PerParticle<std::vector<Link>> from(model.particles());
  const auto join = [&](ParticleId i, ParticleId j, const Image& n) {
    from[i].push_back({j, n}), from[j].push_back({i, -n});
  };
  for (const BondId k : state.bonds.ids())
    if (const Bond& b = state.bonds[k]; !b.broken && !stands_open(state, k)) join(b.i, b.j, image_of_j(b));
  for_touching_pairs(model, state,
                     [&](ParticleId i, ParticleId j, const Image& n, double) { join(i, j, n); });
  for (const ParticleId p : model.mass.ids())
    if (const ParticleId c = unknowns.carrier(p); c != p) join(p, c, {});
  return from;
}

Parts connected_parts(const Model& model, const State& state, const Unknowns& unknowns) {
  const PerParticle<std::vector<Link>> linked = links(model, state, unknowns);
  Parts parts{{}, state.r, PerParticle<Image>(model.particles())};
  PerParticle<char> found(model.particles(), false);
  PerParticle<Image>& image = parts.image;
  for (const ParticleId first : model.mass.ids()) {
    if (found[first]) continue;
    Part part{{first}, {}, {}};
    found[first] = true;
    for (std::size_t k = 0; k < part.particles.size(); ++k) {
      const ParticleId p = part.particles[k];
      for (const Link& link : linked[p]) {
        const Image n = image[p] + link.of_to;
        if (!found[link.to]) {
          found[link.to] = true;
          image[link.to] = n;
          part.particles.push_back(link.to);
        } else if (n != image[link.to]) {
          add_way(to_image(state.cell, n - image[link.to]), part.across);
          part.loops.push_back(n - image[link.to]);
        }
      }
    }
    std::sort(part.particles.begin(), part.particles.end());
    std::sort(part.loops.begin(), part.loops.end());
    part.loops.erase(std::unique(part.loops.begin(), part.loops.end()), part.loops.end());
    for (const ParticleId p : part.particles) parts.r[p] += to_image(state.cell, image[p]);
    parts.all.push_back(std::move(part));
  }
  return parts;
}

/// Whether particles turn with the part that they are of: contacts alone turn none.
PerParticle<char> turning_along(const Model& model, const State& state, const Unknowns& unknowns) {
  PerParticle<char> along(model.particles(), false);
  for (const Bond& b : state.bonds)
    if (!b.broken) along[b.i] = along[b.j] = true;
  for (const ParticleId p : along.ids())
    if (unknowns.arm(p) != nullptr) along[p] = true;
  return along;
}

/// A part as a rigid body: where it is, and the six motions of its degrees of freedom.
class RigidPart {
 public:
  RigidPart(const Part& part, const PerParticle<Vec3d>& r, const PerParticle<char>& turn_along,
            double turn_length)
      : part_(part), r_(r), turn_along_(turn_along), turn_length_(turn_length), radius_(turn_length) {
    const std::vector<ParticleId>& all = part.particles;
    for (const ParticleId p : all) centroid_ += r[p] / static_cast<double>(all.size());
    for (const ParticleId p : all) radius_ = std::max(radius_, norm(r[p] - centroid_));
  }

  /// Degrees of freedom that move with the part.
  int dofs(ParticleId p) const { return turn_along_[p] ? 6 : 3; }
  /// How one of them moves with each of the motions: no entry is above 1 in size. Turns of particles count
  /// times the length scale, as in Unknowns.
  Row row(ParticleId p, int dof, const Unknowns& unknowns) const {
    const Vec3d& a = unknowns.axis(p, dof);
    const Vec3d* arm = unknowns.arm(p);
    if (dof < 3) return row(arm == nullptr ? r_[p] : r_[p] - *arm, a);
    Row h = Row::Zero();
    for (int k = 0; k < 3; ++k) h[3 + k] = turn_length_ / radius_ * component(a, k);
    return h;
  }
  /// The same of a translation of what is at r along a direction.
  Row row(const Vec3d& r, const Vec3d& n) const {
    const Vec3d lever = cross((r - centroid_) / radius_, n);
    Row h;
    h << n.x, n.y, n.z, lever.x, lever.y, lever.z;
    return h;
  }

  /// Combinations that move no held degree of freedom, and no particle along the normal of a wall, and turn
  /// no way to an image, which the cell holds.
  Motions free_motions(const Unknowns& unknowns, const PerParticle<std::vector<Vec3d>>& normals) const {
    std::vector<Row> held;
    for (const ParticleId p : part_.particles) {
      for (int dof = 0; dof < 6 && unknowns.carrier(p) == p; ++dof)
        if (unknowns.of(p, dof) == Unknowns::held && !unknowns.is_free_turn(p, dof))
          held.push_back(row(p, dof, unknowns));
      for (const Vec3d& n : normals[p]) held.push_back(row(r_[p], n));
    }
    for (const Vec3d& u : part_.across)
      for (const Vec3d& along : world_axes) {
        const Vec3d turned = cross(u, along);
        held.emplace_back() << 0.0, 0.0, 0.0, turned.x, turned.y, turned.z;
      }
    if (held.empty()) return Motions::Identity(6, 6);
    const auto [V, holding] = directions(held);
    return V.rightCols(6 - holding);
  }
  /// Of these motions those that move anything: grains that touch along a line, or one alone, turn about it
  /// without moving their centres.
  Motions moving(const Motions& free, const Unknowns& unknowns) const {
    if (free.cols() == 0 || std::any_of(part_.particles.begin(), part_.particles.end(),
                                        [this](ParticleId p) { return turn_along_[p] != 0; }))
      return free;
    std::vector<Row> moved;
    for (const ParticleId p : part_.particles)
      for (int dof = 0; dof < 3; ++dof) moved.push_back(row(p, dof, unknowns) * free * free.transpose());
    const auto [V, moving] = directions(moved);
    return V.leftCols(moving);
  }

 private:
  /// Orthonormal directions, first as many as the rows have parts along.
  static std::pair<DenseMatrix, Eigen::Index> directions(const std::vector<Row>& rows) {
    DenseMatrix H = DenseMatrix::Zero(std::max<Eigen::Index>(6, static_cast<Eigen::Index>(rows.size())), 6);
    for (std::size_t k = 0; k < rows.size(); ++k) H.row(static_cast<Eigen::Index>(k)) = rows[k];
    const DenseSingular svd = singular_values(upper_factor(H));
    return {svd.V, (svd.values.array() > smallest_lever).count()};
  }

  const Part& part_;
  const PerParticle<Vec3d>& r_;
  const PerParticle<char>& turn_along_;
  double turn_length_, radius_;
  Vec3d centroid_;
};

/// The same space, spanned by motions that are easier to name: pure translations first, and each along as
/// few axes as can be (reduced echelon form, turns before translations).
Motions along_axes(Motions m) {
  Eigen::Index next = m.cols();  // columns from here on are done
  for (const int k : {5, 4, 3, 2, 1, 0}) {
    if (next == 0) break;
    Eigen::Index best = 0;
    const double pivot = m.row(k).head(next).cwiseAbs().maxCoeff(&best);
    if (pivot < 1e-6) continue;  // rounding, or a part too small for a name: columns have length 1
    --next;
    m.col(best).swap(m.col(next));
    m.col(next) /= m(k, next);
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      if (j != next) m.col(j) -= m(k, j) * m.col(next);
    for (Eigen::Index j = 0; j < next; ++j)
      if (m.col(j).norm() > 0.0) m.col(j).normalize();
  }
  return m;
}

/// "x", or "(0.6, 0.8, 0)".
std::string axis_name(Eigen::Vector3d a) {
  a.normalize();
  const double small = 1e-6;
  for (int k = 0; k < 3; ++k)
    if (std::abs(a[k]) > 1.0 - small) return std::string(1, "xyz"[k]);
  for (double& c : a)
    if (std::abs(c) < small) c = 0.0;
  if (a[0] < 0.0 || (a[0] == 0.0 && a[1] < 0.0)) a = -a;
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", a[0] + 0.0, a[1] + 0.0, a[2] + 0.0);
}

std::string particles_name(const std::vector<ParticleId>& part) {
  const auto first = part.front().value, last = part.back().value;
  if (part.size() == 1) return fmt::format("particle {}", first);
  if (last - first + 1 == part.size()) return fmt::format("particles {} to {}", first, last);
  if (part.size() == 2) return fmt::format("particles {} and {}", first, last);
  return fmt::format("the {} particles from {} to {} that hang together", part.size(), first, last);
}

std::string motion_name(const Motion& m, const Part& part) {
  const Eigen::Vector3d move = m.head<3>(), turn = m.tail<3>();
  const double small = 1e-6 * m.norm();
  const std::string who = particles_name(part.particles);
  if (turn.norm() <= small) return fmt::format("translation along {} of {}", axis_name(move), who);
  const bool screw = std::abs(move.dot(turn)) > small * turn.norm();
  return fmt::format("{} about {} of {}", screw ? "screw motion" : "rotation", axis_name(turn), who);
}

std::string turn_name(const Vec3d& axis, ParticleId p) {
  return fmt::format("rotation about {} of particle {}", axis_name({axis.x, axis.y, axis.z}), p.value);
}

}  // namespace

RigidMotions free_rigid_motions(const Model& model, const State& state, const Unknowns& unknowns,
                                const std::vector<TermHold>& holds) {
  RigidMotions result;
  PerParticle<std::vector<Vec3d>> normals(model.particles());
  for (const TermHold& h : holds) normals[h.p].push_back(h.along);
  std::vector<Eigen::Triplet<double>> entries;
  const Parts parts = connected_parts(model, state, unknowns);
  const PerParticle<char> turn_along = turning_along(model, state, unknowns);
  for (const Part& part : parts.all) {
    const RigidPart body(part, parts.r, turn_along, unknowns.length());
    const Motions free = along_axes(body.moving(body.free_motions(unknowns, normals), unknowns));
    const int first = static_cast<int>(result.names.size());
    for (Eigen::Index k = 0; k < free.cols(); ++k) result.names.push_back(motion_name(free.col(k), part));
    for (const ParticleId p : part.particles)
      for (int dof = 0; dof < 6; ++dof) {
        const int unknown = unknowns.of(p, dof);
        if (unknown == Unknowns::held) continue;
        if (dof >= body.dofs(p)) {
          entries.emplace_back(unknown, static_cast<int>(result.names.size()), 1.0);
          result.names.push_back(turn_name(unknowns.axis(p, dof), p));
          continue;
        }
        const Eigen::RowVectorXd moves = body.row(p, dof, unknowns) * free;
        for (int k = 0; k < static_cast<int>(free.cols()); ++k)
          if (moves[k] != 0.0) entries.emplace_back(unknown, first + k, moves[k]);
      }
  }
  SparseMatrix columns(unknowns.size(), static_cast<Eigen::Index>(result.names.size()));
  columns.setFromTriplets(entries.begin(), entries.end());
  result.basis = orthonormalised(columns);
  return result;
}

PartImages images_of_parts(const Model& model, const State& state, const Unknowns& unknowns) {
  Parts parts = connected_parts(model, state, unknowns);
  PartImages found{PerParticle<std::size_t>(model.particles()), std::move(parts.image), {}};
  for (Part& part : parts.all) {
    for (const ParticleId p : part.particles) found.part[p] = found.loops.size();
    found.loops.push_back(std::move(part.loops));
  }
  return found;
}

std::vector<int> holding_unknowns(const SparseMatrix& columns) {
  std::vector<int> chosen;
  std::vector<Eigen::SparseVector<double>> done;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    Eigen::SparseVector<double> v = columns.col(k);
    for (std::size_t j = 0; j < done.size(); ++j)
      if (const double c = v.coeff(chosen[j]); c != 0.0) v -= c * done[j];
    int pivot = -1;
    double largest = 0.0;
    for (Eigen::SparseVector<double>::InnerIterator it(v); it; ++it)
      if (std::abs(it.value()) > largest)
        largest = std::abs(it.value()), pivot = static_cast<int>(it.index());
    chosen.push_back(pivot);
    done.push_back(v / v.coeff(pivot));
  }
  return chosen;
}

SparseMatrix orthonormalised(const SparseMatrix& columns) {
  using SparseVector = Eigen::SparseVector<double>;
  std::vector<SparseVector> done;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    SparseVector v = columns.col(k);
    const double before = v.norm();
    for (int pass = 0; pass < 2; ++pass)  // twice is enough: Parlett, The Symmetric Eigenvalue Problem, 6.9
      for (const SparseVector& u : done)
        if (const double c = u.dot(v); c != 0.0) v -= c * u;
    if (!(v.norm() > 1e-10 * before)) throw std::invalid_argument("columns depend on each other");
    v /= v.norm();
    for (SparseVector::InnerIterator it(v); it; ++it)
      entries.emplace_back(static_cast<int>(it.index()), static_cast<int>(k), it.value());
    if (done.size() == 5) done.erase(done.begin());
    done.push_back(v);
  }
  SparseMatrix result(columns.rows(), columns.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace vbond
