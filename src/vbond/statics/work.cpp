#include "vbond/statics/detail/work.hpp"
#include "vbond/terms/heat/detail/rest_heat.hpp"
#include "vbond/terms/walls/detail/rest_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace vbond {
namespace {

/// Of the work of a step, as a part of it; and of what rounding may do, as a part of the energy in the books.
constexpr double work_error = 1e-10, rounding_error = 1e-12;

/// The unknowns that lead from one placement to another.
Vector way(const StaticBody& body, const Placement& from, const Placement& to) {
  const Unknowns& unknowns = body.unknowns();
  Vector x(unknowns.size());
  for (int k = 0; k < unknowns.size(); ++k) {
    const auto [p, dof] = unknowns.place(k);
    if (unknowns.is_of_cell(k)) {
      const CellShape& shape = body.model().cell;
      const auto c = static_cast<std::size_t>(dof);
      x[k] = unknowns.cell_length() * (cell_components(cell_gradient(shape, to.cell))[c] -
                                       cell_components(cell_gradient(shape, from.cell))[c]);
      continue;
    }
    const Movement m{body.seat(p, to) - body.seat(p, from),
                     unknowns.length() * rotation_vector(to.q[p] * conjugate(from.q[p]))};
    x[k] = unknowns.along(p, dof, m);
  }
  return x;
}

double middle_of(const std::vector<Acting>& nodes, std::size_t k) {
  return 0.5 * (nodes[k - 1].at.load_factor + nodes[k].at.load_factor);
}

/// At a place beside a balance, where unbalanced forces g are left: to first order power and loads together
/// do rate . g too much there, as what acts along the way changes with the unknowns as g does with the load
/// factor.
Acting acting_on(const StaticBody& body, const Vector& rate) {
  const double beside = rate.size() > 0 ? rate.dot(body.unbalanced()) : 0.0;
  return {body.placement(), body.power_of_supports() + body.terms().of<RestHeat>().power() - beside,
          body.terms().of<RestWalls>().power(), body.forces_on_cell()};
}

}  // namespace

Stand stand_of(const StaticBody& body, Vector rate) {
  return {acting_on(body, rate), body.energies().potential(), body.dissipated(), std::move(rate)};
}

bool WorkOnTheWay::correct_here() {
  const NewtonOutcome outcome = correct(body_, solver_, body_.stage().newton);
  result_.iterations += outcome.iterations();
  result_.residuals = outcome.residuals;
  return outcome.converged;
}

bool WorkOnTheWay::balance_between(const Placement& a, const Placement& b, double load_factor) {
  return balance_from(a, (load_factor - a.load_factor) / (b.load_factor - a.load_factor) * way(body_, a, b),
                      load_factor);
}

/// Half way between nodes k - 1 and k, guessed by the polynomial through those and their neighbours.
bool WorkOnTheWay::balance_between(const std::vector<Acting>& nodes, std::size_t k) {
  const std::size_t first = k > 1 ? k - 2 : 0, last = std::min(k + 1, nodes.size() - 1);
  const Placement& a = nodes[k - 1].at;
  const double f = middle_of(nodes, k);
  Vector x = Vector::Zero(body_.unknowns().size());
  for (std::size_t m = first; m <= last; ++m) {
    if (m == k - 1) continue;
    double share = 1.0;
    for (std::size_t other = first; other <= last; ++other)
      if (other != m)
        share *= (f - nodes[other].at.load_factor) / (nodes[m].at.load_factor - nodes[other].at.load_factor);
    x += share * way(body_, a, nodes[m].at);
  }
  return balance_from(a, x, f);
}

bool WorkOnTheWay::balance_from(const Placement& a, const Vector& x, double load_factor) {
  body_.restore(a);
  body_.move(x, load_factor);
  if (correct_here()) return true;
  body_.restore(a);  // plain steps may go back and forth over a wall that is just touched, or lead too far
  body_.move(x, load_factor);
  return settle(body_, solver_, body_.stage().newton, {}, result_.iterations).converged;
}

/// Supports and walls by the mean of their powers, loads and the relief by that of their sizes, all that
/// moves the cell, what is left of a relief of it too, by that of what the cell meets.
Vector WorkOnTheWay::trapezium(const Acting& a, const Acting& b) const {
  const double f_a = a.at.load_factor, f_b = b.at.load_factor;
  Vector work(1 + a.power_of_walls.size());
  work.tail(a.power_of_walls.size()) = 0.5 * (f_b - f_a) * (a.power_of_walls + b.power_of_walls);
  work[0] = body_.work_of_loads(a.at, b.at, 0.5 * (f_a + f_b)) +
            body_.work_of_relief(a.at, b.at, 0.5 * (f_a + f_b)) + 0.5 * (a.power + b.power) * (f_b - f_a) +
            work.tail(a.power_of_walls.size()).sum();
  if (!body_.moves_cell()) return work;
  const CellShape& shape = body_.model().cell;
  const std::array<double, 6> from = cell_components(cell_gradient(shape, a.at.cell)),
                              to = cell_components(cell_gradient(shape, b.at.cell));
  for (std::size_t k = 0; k < 6; ++k)
    work[0] += 0.5 * (a.forces_on_cell[k] + b.forces_on_cell[k]) * (to[k] - from[k]);
  return work;
}

/// Where bonds begin to flow, or to unload, and where walls begin to be touched, the reaction has a kink, at
/// which sums of higher order are no better: the part of the way that closes worst is halved, until all do
/// together.
Vector WorkOnTheWay::between_kinks(const Stand& a, const Stand& b, double within) {
  constexpr std::size_t most_balances = 100, at_least = 12;  // what has not fallen by then no sum will mend
  struct Part {
    Stand from, to;
    Vector trapezium, work;
    double open() const { return std::abs(work[0] - (to.spent() - from.spent())); }
  };
  const auto part = [this](const Stand& from, const Stand& to) {
    const Vector sum = trapezium(from, to);
    return Part{from, to, sum, sum};
  };
  std::vector<Part> parts{part(a, b)};
  double open_before = std::numeric_limits<double>::infinity();
  std::size_t look = 0;
  for (std::size_t k = 0; k < most_balances; ++k) {
    double open = 0.0;
    for (const Part& p : parts) open += p.open();
    if (open <= within) break;
    if (k == look) {  // after as many halvings as there are parts, each of which may need one
      if (open > 0.5 * std::exchange(open_before, open)) break;
      look += std::max(at_least, parts.size());
    }
    const auto worst = std::max_element(parts.begin(), parts.end(),
                                        [](const Part& x, const Part& y) { return x.open() < y.open(); });
    if (!balance_between(worst->from.at, worst->to.at,
                         0.5 * (worst->from.at.load_factor + worst->to.at.load_factor)))
      break;
    Part first = part(worst->from, stand_of(body_)), second = part(first.to, worst->to);
    const Vector better = (first.trapezium + second.trapezium - worst->trapezium) / 3.0;
    first.work += 0.5 * better, second.work += 0.5 * better;
    *worst = std::move(first);
    parts.push_back(std::move(second));
  }
  Vector work = Vector::Zero(parts.front().work.size());
  for (const Part& p : parts) work += p.work;
  body_.restore(b.at);
  return work;
}

double WorkOnTheWay::missing(const Stand& a, const Stand& b, double part) {
  const double spent = b.spent() - a.spent();
  const double turned_over = std::abs(trapezium(a, b)[0]) + std::abs(spent);
  const double rounding = 10.0 * body_.rounding_of_potential();
  const double open = std::abs(between_kinks(a, b, 0.5 * part * turned_over + rounding)[0] - spent);
  return open > part * turned_over + rounding ? open / turned_over : 0.0;
}

/// A place where the body is nearly in balance: by how it stands and goes on at both ends (Hermite's cubic).
Acting WorkOnTheWay::near_balance(const Stand& a, const Stand& b, const Vector& from_a_to_b,
                                  double load_factor) {
  const double h = b.at.load_factor - a.at.load_factor, s = (load_factor - a.at.load_factor) / h, r = 1.0 - s;
  body_.restore(a.at);
  body_.move(s * s * (3.0 - 2.0 * s) * from_a_to_b + h * s * r * (r * a.rate - s * b.rate), load_factor);
  return acting_on(body_, r * a.rate + s * b.rate);
}

/// Romberg's sums: more nodes half way between those at hand, node(those, k) between k - 1 and k, until
/// known(the best sum, halvings), or there is no node.
template <class Node, class Known>
double WorkOnTheWay::by_halving(const Stand& a, const Stand& b, Node&& node, Known&& known) const {
  constexpr int most_halvings = 5;
  std::vector<Acting> nodes{a, b};
  std::vector<double> sums{trapezium(a, b)[0]};  // a row of Romberg's scheme, its best last
  for (int halvings = 0; !known(sums.back(), halvings) && halvings < most_halvings; ++halvings) {
    std::vector<Acting> finer{nodes.front()};
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      std::optional<Acting> middle = node(nodes, k);
      if (!middle) return sums.back();
      finer.push_back(std::move(*middle));
      finer.push_back(nodes[k]);
    }
    nodes = std::move(finer);
    std::vector<double> row{0.0};
    for (std::size_t k = 1; k < nodes.size(); ++k) row[0] += trapezium(nodes[k - 1], nodes[k])[0];
    for (double power = 4.0; row.size() <= sums.size(); power *= 4.0)
      row.push_back(row.back() + (row.back() - sums[row.size() - 1]) / (power - 1.0));
    sums = std::move(row);
  }
  return sums.back();
}

Vector WorkOnTheWay::between(const Stand& a, const Stand& b, double scale, int splits) {
  const double within = work_error * std::abs(b.spent() - a.spent()) + rounding_error * scale,
               with_rounding = within + body_.rounding_of_potential();
  if (body_.flows() || b.power_of_walls.size() > 0) return between_kinks(a, b, with_rounding);
  const double stored = b.stored - a.stored;
  // The bound of rounding is far above what rounding does. So a tenth of it ends the sums, but for the first,
  // whose errors have the same sign in all steps; and they end where one more halving has changed nothing.
  const double noise = within + 0.1 * body_.rounding_of_potential();
  int halvings = 0;
  double before = std::numeric_limits<double>::infinity();
  const auto closes = [&](double work) { return std::abs(work - stored) <= (halvings > 0 ? noise : within); };
  const auto known = [&](double sum, int made) {
    halvings = made;
    return closes(sum) || std::abs(sum - std::exchange(before, sum)) <= within;
  };
  double work = std::numeric_limits<double>::infinity();
  if (a.rate.size() > 0 && b.rate.size() > 0) {
    const Vector x = way(body_, a.at, b.at);
    const auto near = [&](const std::vector<Acting>& nodes, std::size_t k) -> std::optional<Acting> {
      return near_balance(a, b, x, middle_of(nodes, k));
    };
    work = by_halving(a, b, near, known);
  }
  if (!closes(work)) {
    before = std::numeric_limits<double>::infinity();
    const auto balance = [&](const std::vector<Acting>& nodes, std::size_t k) -> std::optional<Acting> {
      if (!balance_between(nodes, k)) return {};
      return acting_on(body_, {});
    };
    work = by_halving(a, b, balance, known);
  }
  const auto take_if_better = [&](double other) {
    if (std::abs(other - stored) < std::abs(work - stored)) work = other;
  };
  if (std::abs(work - stored) > with_rounding)
    take_if_better(between_kinks(a, b, with_rounding)[0]);  // a way that is curved in a small part
  if (std::abs(work - stored) > with_rounding && splits > 0 &&
      balance_between(a.at, b.at, 0.5 * (a.at.load_factor + b.at.load_factor))) {
    const Stand middle = stand_of(body_);
    take_if_better(between(a, middle, scale, splits - 1)[0] + between(middle, b, scale, splits - 1)[0]);
  }
  body_.restore(b.at);
  return Vector::Constant(1, work);
}

}  // namespace vbond
