#include "vbond/statics/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "vbond/core/error.hpp"
#include "vbond/model/touching.hpp"
#include "vbond/statics/detail/body.hpp"
#include "vbond/statics/detail/followed.hpp"
#include "vbond/statics/detail/kinds.hpp"
#include "vbond/statics/detail/newton.hpp"
#include "vbond/statics/detail/one_blas_thread.hpp"
#include "vbond/statics/detail/unsymmetric_factor.hpp"

namespace vbond {
namespace {

/// How all particles move with a parameter.
struct Motion {
  PerParticle<Vec3d> shift, turn;  ///< [length], [rad], over the unit of the parameter
  bool any() const { return !shift.empty(); }
};

State moved(State s, const Motion& m, double by) {
  for (const ParticleId p : m.shift.ids()) {
    s.r[p] += by * m.shift[p];
    s.q[p] = normalised(rotation_of(by * m.turn[p]) * s.q[p]);
  }
  return s;
}

double largest(const Motion& m, double length) {
  double most = 0.0;
  for (const ParticleId p : m.shift.ids())
    most = std::max({most, norm(m.shift[p]), length * norm(m.turn[p])});
  return most;
}

Vector as_vector(const std::vector<double>& x) {
  return Eigen::Map<const Vector>(x.data(), static_cast<Eigen::Index>(x.size()));
}

bool any_touch(const Model& model, const State& s) {
  bool any = false;
  for_touching_pairs(model, s, [&](ParticleId, ParticleId, const Image&, double) { any = true; });
  return any;
}

/// Makes ready for steps off a path, normal to it, which are regular at limit points; false where another
/// path crosses. The way of the path is where the load direction does work.
bool take_normal_to_path(const StaticBody& body, TangentSolver& solver) {
  const Vector& g = body.load_direction();
  if (!(g.squaredNorm() > 0.0) || !solver.take_bordered(body, {g, g, 0.0})) return false;
  const Vector along = solver.solve_bordered(Vector::Zero(g.size()), 1.0).head(g.size());
  if (!along.allFinite() || !(along.squaredNorm() > 0.0)) return false;
  const Vector n = along.normalized();
  return solver.take_bordered(body, {g, n, 0.0});
}

}  // namespace

struct Sensitivities::Inside {
  Inside(const Model& m, std::vector<BondParameter> p) : model(m), parameters(std::move(p)) {}

  const Model& model;
  std::vector<BondParameter> parameters;
  std::unique_ptr<const StaticStage> stage;  // bodies keep references
  std::vector<Motion> before, now;  // of each parameter, where the stage began, and at the last point
  std::vector<Motion> held;         // that part of `before` which supports hold
  bool first_point = true, after_path = false, any_stage = false;
  std::unique_ptr<TangentSolver> solver;    // at the present point
  std::optional<UnsymmetricFactor> fading;  // the same, where moments fade
  Vector direction;                         // of a path, at a point where the tangent is regular
  Vector relief;                            // of the stage, see StaticBody: as loads; 0 once it is dropped
  std::vector<Vector> reliefs;              // how it changes

  StaticPoint point_of(const StaticBody& body, const StaticPoint& as) const {
    return {body.state(),    body.load_factor(),
            as.kind,         as.unstable,
            body.energies(), [&body](const std::vector<ParticleId>& p) { return body.reaction(p); },
            body.grips(),    as.released,
            as.relieved};
  }

  /// What is out of balance: forces, moments, and energies of the cell. Unknowns count by lengths of the body
  /// they belong to, which change a little with places.
  static Vector scaled(Vector g, const StaticBody& body, bool to_loads) {
    const Unknowns& u = body.unknowns();
    for (int k = 0; k < u.size(); ++k) {
      const double by = u.is_turn(k) ? u.length() : u.is_of_cell(k) ? u.cell_length() : 1.0;
      g[k] *= to_loads ? by : 1.0 / by;
    }
    return g;
  }
  static Vector loads_on(const StaticBody& body) { return scaled(body.unbalanced(), body, true); }
  Vector loads_at(State state, double f) const {
    return loads_on(StaticBody(model, *stage, std::move(state), f));
  }
  static State with_bonds(State state, PerBond<Bond> bonds) {
    state.bonds = std::move(bonds);
    return state;
  }

  /// A step along a motion: small against the body, and where bodies touch against how deep they do.
  double step_along(double largest_motion, const State& state, double length) const {
    const double reach = (any_touch(model, state) ? 1e-7 : 1e-4) * length;
    return largest_motion > 0.0 ? reach / largest_motion : 0.0;
  }
  Vector along(const State& state, double f, const Motion& m, double length) const {
    const double s = step_along(largest(m, length), state, length);
    if (s == 0.0) return Vector::Zero(loads_at(state, f).size());
    return derivative_of_sixth_order(s, [&](int k) -> Vector { return loads_at(moved(state, m, k * s), f); });
  }

  /// Whether supports that let particles turn about one axis hold turns that change: these turn with them.
  bool holds_turns(const Motion& all, const Motion& part, double length) const {
    constexpr double rounding = 1e-9;
    const double size = rounding * largest(all, length);
    const PerParticle<Turns> turns = turns_in(model, *stage);
    for (const ParticleId p : turns.ids())
      if (turns[p].about_one && length * norm(part.turn[p]) > size) return true;
    return false;
  }

  /// What supports hold of the motions at the start of the stage, and how what fades in it changes. False if
  /// what they hold does not stay as it is.
  bool begin_at(const StaticBody& body, bool relieves) {
    const double f = body.load_factor(), length = body.unknowns().length();
    held.clear(), reliefs.clear();
    relief = Vector::Zero(body.unknowns().size());
    if (relieves) relief = loads_on(body) / (1.0 - f);
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      Motion h = before[j];
      if (h.any()) {
        Vector free = Vector::Zero(body.unknowns().size());
        for (const ParticleId p : h.shift.ids())
          body.unknowns().add_load(p, {h.shift[p], length * h.turn[p]}, free);
        for (const ParticleId p : h.shift.ids()) {
          const Movement m = body.unknowns().along_own(p, free);
          h.shift[p] -= m.shift, h.turn[p] -= m.turn / length;
        }
        if (holds_turns(before[j], h, length)) return false;
      }
      held.push_back(std::move(h));
      Vector change = Vector::Zero(body.unknowns().size());
      if (relieves) {
        const BondParameter& parameter = parameters[j];
        change = derivative_of_sixth_order(parameter.step, [&](int k) -> Vector {
          return loads_at(with_bonds(body.state(), parameter.bonds(k)), f);
        });
        if (before[j].any()) change += along(body.state(), f, before[j], length);
        change /= 1.0 - f;
      }
      reliefs.push_back(std::move(change));
    }
    first_point = false;
    return true;
  }

  /// From now on no balance has a part of what fades.
  void drop_relief() {
    relief.setZero();
    for (Vector& change : reliefs) change.setZero();
  }

  /// Out of balance beyond what a balance may be: the body that was made anew is not the one that was in it.
  bool is_out_of_balance(const StaticBody& body) const {
    constexpr double far = 1e-6, above_rounding = 1e4;
    const Vector left = body.unbalanced() - (1.0 - body.load_factor()) * scaled(relief, body, false);
    const double size = max_norm(body.unbalanced()), part = body.residual();
    if (!(part > 0.0)) return !(max_norm(left) == 0.0);
    const double force = size / part;  // the largest in the body
    return !(max_norm(left) <= std::max(far, above_rounding * body.residual_of_rounding()) * force) &&
           !body.rests_to_rounding();
  }

  /// Half the moment that fades on the turns of a particle, as a part of the tangent.  [force/length]
  Vec3d fading_moment(const StaticBody& body, ParticleId p) const {
    const Unknowns& u = body.unknowns();
    Vec3d m;
    for (int k = 0; k < 3 && u.carrier(p) == p; ++k)
      if (const int n = u.of(p, 3 + k); n != Unknowns::held)
        component(m, k) = -0.5 * (1.0 - body.load_factor()) * relief[n] / sq(u.length());
    return m;
  }
  /// Whether moments fade here, beyond what rounding leaves of none.
  bool moments_fade(const StaticBody& body) const {
    constexpr double rounding = 1e-12;  // of the tangent
    double largest = 0.0;
    for (const ParticleId p : body.state().r.ids()) largest = std::max(largest, norm(fading_moment(body, p)));
    return largest > 0.0 && largest > rounding * max_norm(body.tangent().diagonal());
  }
  /// full_tangent() with what these moments make of turns: a body that was made anew has none.
  SparseMatrix tangent_with_fading(const StaticBody& body) const {
    const Unknowns& u = body.unknowns();
    SparseMatrix K = body.full_tangent();
    for (const ParticleId p : body.state().r.ids()) {
      const Vec3d m = fading_moment(body, p);
      if (m == Vec3d{}) continue;
      const double S[3][3] = {{0, m.z, -m.y}, {-m.z, 0, m.x}, {m.y, -m.x, 0}};
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const int row = u.of(p, 3 + a), column = u.of(p, 3 + b);
          if (a != b && row != Unknowns::held && column != Unknowns::held) K.coeffRef(row, column) += S[a][b];
        }
    }
    return K;
  }

  /// Makes ready to solve here; false if the tangent is singular.
  bool factor(const StaticBody& body, PointKind kind) {
    fading.reset(), direction.resize(0);
    solver = std::make_unique<TangentSolver>(stage->newton.solver);
    if (body.unknowns().size() == 0) return true;
    if (stage->kind == StageKind::path) {
      const bool special = kind == PointKind::limit_point || kind == PointKind::bifurcation;
      if (!special && solver->take_full(body)) direction = solver->solve_full(body, body.load_direction());
      return direction.size() > 0 || take_normal_to_path(body, *solver);
    }
    if (!moments_fade(body)) return solver->take_full(body);
    fading.emplace();
    return fading->factor(tangent_with_fading(body));
  }
  /// u' and how the load factor goes with it; empty if it is not found.
  std::pair<Vector, double> solution(const StaticBody& body, const Vector& b) {
    if (direction.size() > 0) {  // of the path, to which u' is normal
      Vector x = solver->solve_full(body, b);
      if (x.size() == 0 || !(direction.squaredNorm() > 0.0)) return {};
      const double df = -direction.dot(x) / direction.squaredNorm();
      return {x + df * direction, df};
    }
    if (stage->kind == StageKind::path) {
      const Vector both = solver->solve_bordered(b, 0.0);
      return {both.head(b.size()), both[b.size()]};
    }
    return {fading ? fading->solve(b) : solver->solve_full(body, b), 0.0};
  }

  /// One parameter at this point.
  std::optional<std::vector<double>> change(std::size_t j, const StaticBody& body, const StaticPoint& point,
                                            const NumbersOfBalance& numbers) {
    const BondParameter& parameter = parameters[j];
    const State& state = body.state();
    const double f = body.load_factor(), length = body.unknowns().length();
    const Eigen::Index n = body.unknowns().size();
    // what is out of balance, and the numbers, at fixed places
    const Vector fixed = derivative_of_sixth_order(parameter.step, [&](int k) -> Vector {
      const StaticBody beside(model, *stage, with_bonds(state, parameter.bonds(k)), f);
      const std::vector<double> of_body = numbers(point_of(beside, point));
      Vector both(n + static_cast<Eigen::Index>(of_body.size()));
      both << loads_on(beside), as_vector(of_body);
      return both;
    });
    Vector b = fixed.head(n) - (1.0 - f) * reliefs[j], x = Vector::Zero(n);
    if (held[j].any()) b += along(state, f, held[j], length);
    double df = 0.0;
    if (n > 0) {
      std::tie(x, df) = solution(body, scaled(b, body, false));
      if (x.size() != n || !x.allFinite() || !std::isfinite(df)) return std::nullopt;
    }
    Motion total{PerParticle<Vec3d>(model.particles()), PerParticle<Vec3d>(model.particles())};
    for (const ParticleId p : state.r.ids()) {
      const Movement m = body.movement(p, x, df);
      total.shift[p] = m.shift, total.turn[p] = m.turn / length;
      if (held[j].any()) total.shift[p] += held[j].shift[p], total.turn[p] += held[j].turn[p];
    }
    Vector h = fixed.tail(fixed.size() - n);
    const double most = std::max({largest(total, length), n > 0 ? max_norm(x) : 0.0, std::abs(df) * length});
    if (const double s = step_along(most, state, length); s > 0.0)
      h += derivative_of_sixth_order(s, [&](int k) -> Vector {
        StaticBody beside(model, *stage, held[j].any() ? moved(state, held[j], k * s) : state, f);
        beside.move(k * s * x, f + k * s * df);
        return as_vector(numbers(point_of(beside, point)));
      });
    now[j] = std::move(total);
    return std::vector<double>(h.begin(), h.end());
  }
};

Sensitivities::Sensitivities(const Model& model, std::vector<BondParameter> parameters)
    : in_(std::make_unique<Inside>(model, std::move(parameters))) {}
Sensitivities::~Sensitivities() = default;

std::optional<std::string> Sensitivities::begin(const StaticStage& stage, const State& state) {
  std::string why = cannot_follow(in_->model, stage, state);
  if (why.empty() && in_->any_stage) why = cannot_follow_after(in_->model, stage, in_->after_path);
  if (!why.empty()) return fmt::format("stage \"{}\": {}", stage.name, why);
  const OneBlasThread alone;
  in_->stage = std::make_unique<const StaticStage>(
      in_->model.cell.any() ? with_floating_held(in_->model, stage, state, {}) : stage);
  in_->before = std::exchange(in_->now, std::vector<Motion>(in_->parameters.size()));
  in_->before.resize(in_->parameters.size());
  in_->first_point = in_->any_stage = true;
  in_->after_path = stage.kind == StageKind::path;
  return std::nullopt;
}

std::optional<std::vector<std::vector<double>>> Sensitivities::at(const StaticPoint& point,
                                                                  const NumbersOfBalance& numbers,
                                                                  std::string& why) {
  Inside& in = *in_;
  const OneBlasThread alone;
  const StaticBody body(in.model, *in.stage, point.state, point.load_factor);
  const auto refuse = [&](const char* reason) {
    why = fmt::format("stage \"{}\", load factor {:.6g}: {}", in.stage->name, point.load_factor, reason);
    return std::nullopt;
  };
  if (in.first_point && !in.begin_at(body, point.relieved))
    return refuse("a support holds a part of a rotation that an earlier stage has changed");
  if (!point.relieved) in.drop_relief();  // gone at load factor 1, or the body was let go without it
  if (in.is_out_of_balance(body)) return refuse("its balance depends on more than where the particles are");
  try {
    if (!in.factor(body, point.kind)) return refuse("its tangent is singular");
    std::vector<std::vector<double>> changes;
    for (std::size_t j = 0; j < in.parameters.size(); ++j) {
      auto change = in.change(j, body, point, numbers);
      if (!change) return refuse("its tangent is singular");
      changes.push_back(std::move(*change));
    }
    return changes;
  } catch (const NoConvergence&) {
    return refuse("the solver does not converge");
  } catch (const NoEquilibrium&) {
    return refuse("there is no solver for its tangent");
  }
}

}  // namespace vbond
