#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "balance.hpp"
#include "fit.hpp"
#include "vbond/model/bond.hpp"

namespace vbond::campaign {
namespace {

// Parts of one: how well the middle of a step agrees with the cubic, how far the path turns in a step [rad],
// how far bonds turn, how far the load factor goes.
constexpr double largest_bend = 0.01, largest_turn = 0.35, largest_bond_change = 0.1, largest_growth = 0.2;
constexpr double good_fit = 1e-8;                    // of the load factor
constexpr double far_span = 0.02, near_span = 1e-5;  // of a fit, in steps
constexpr int spans_tried = 6;                       // each a fifth of the one before
constexpr int most_passings = 40;
constexpr double eps = std::numeric_limits<double>::epsilon();

struct Event {
  double p, f, error;
  bool limit, regained, beyond_range;
};

class Walk {
 public:
  Walk(const Model& model, const StaticStage& stage, const State& state, const ReferenceSettings& settings)
      : settings_(settings), body_(model, stage, state), balances_(body_) {}
  Reference run();

 private:
  bool start();
  void step();
  void arrive(const Node& node, double turned);
  bool ended();
  int critical_loads() const;
  Control best_control(const Node& a) const;
  Node in_terms_of(const Node& a, Control c) const;
  double largest_step(const Node& a) const;
  double rate(const Node& a) const;
  double turn(const Node& a, const Node& b) const;
  bool smooth(const Node& a, const Node& mid, const Node& end, double dp) const;
  static bool differs(const Node& a, const Node& b) {
    return a.negative != b.negative || std::signbit(a.f_rate) != std::signbit(b.f_rate);
  }
  std::optional<Node> along(const Node& a, double dp);
  std::optional<Node> between(const Node& a, const Node& end, double p);
  void locate(const Node& a, const Node& end);
  std::optional<std::vector<Event>> fit(const Node& a, const Node& end, double p, double h, Node& beyond);
  bool accept(std::vector<Event> events, double sense);
  bool snapped() const;
  bool strained() const;
  double largest_movement(const Vector& x) const;

  const ReferenceSettings& settings_;
  StaticBody body_;
  Balances balances_;
  Reference result_;
  Node here_;
  Control control_;
  double length_ = 1, load_scale_ = 0,
         reach_ = std::numeric_limits<double>::infinity();  // reach_: of a step, scaled
};

double Walk::largest_movement(const Vector& x) const {
  double most = 0.0;
  for (int k = 0; k < x.size(); ++k)
    if (!body_.unknowns().is_turn(k)) most = std::max(most, std::abs(x[k]));
  return most;
}

/// Of the scaled path, per unit of the control.
double Walk::rate(const Node& a) const {
  return std::max(largest_movement(a.u_rate) / length_, std::abs(a.f_rate) / load_scale_);
}

/// Angle between two tangents.
double Walk::turn(const Node& a, const Node& b) const {
  double ab = 0, aa = 0, bb = 0;
  for (int k = 0; k < a.u_rate.size(); ++k) {
    if (body_.unknowns().is_turn(k)) continue;
    ab += a.u_rate[k] * b.u_rate[k], aa += sq(a.u_rate[k]), bb += sq(b.u_rate[k]);
  }
  const double f2 = sq(length_ / load_scale_);
  ab += f2 * a.f_rate * b.f_rate, aa += f2 * sq(a.f_rate), bb += f2 * sq(b.f_rate);
  return std::acos(std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0));
}

Control Walk::best_control(const Node& a) const {
  Control best;
  double most = std::abs(a.f_rate) / load_scale_;
  for (int k = 0; k < a.u_rate.size(); ++k)
    if (!body_.unknowns().is_turn(k) && std::abs(a.u_rate[k]) / length_ > most) {
      most = std::abs(a.u_rate[k]) / length_;
      best.unknown = k;
    }
  return best;
}

/// The same node, its rates per unit of another control. They keep their direction where the path goes.
Node Walk::in_terms_of(const Node& a, Control c) const {
  Node b = a;
  const double per = c.unknown == Control::load_factor ? a.f_rate : a.u_rate[c.unknown];
  b.u_rate /= per, b.f_rate /= per;
  const auto place =
      c.unknown == Control::load_factor ? Unknowns::Place{} : body_.unknowns().place(c.unknown);
  b.p = c.unknown == Control::load_factor ? a.at.load_factor : component(a.at.r[place.particle], place.dof);
  return b;
}

bool Walk::start() {
  length_ = body_.unknowns().length();
  const Placement at_rest = body_.placement();
  const Vector nothing = Vector::Zero(body_.unknowns().size());
  const auto first = balances_.find(at_rest, nothing, 0.0, {}, 0.0);
  if (!first) return false;
  here_ = *first;
  result_.unstable_at_start = here_.negative;
  // a thousandth of a turn or strain in the bonds, or less: so little that no eigenvalue changes its sign
  load_scale_ = 1e-3 / std::max(body_.largest_bond_change(here_.u_rate), 1e-300);
  for (const Support& s : body_.stage().supports) {
    const double most = std::max(norm(s.velocity) / length_, norm(s.angular_velocity));
    if (most > 0.0) load_scale_ = std::min(load_scale_, 1e-2 / most);
  }
  for (int k = 0; k < 200; ++k, load_scale_ *= 0.5) {
    const auto there = balances_.find(here_.at, load_scale_ * here_.u_rate, load_scale_, {}, load_scale_);
    if (there && there->negative == here_.negative) return true;
  }
  return false;
}

/// In the control, from this node.
double Walk::largest_step(const Node& a) const {
  const double load = std::max(std::abs(a.f()), load_scale_);
  double dp = reach_ / rate(a);
  dp = std::min(dp, largest_bond_change / std::max(body_.largest_bond_change(a.u_rate), 1e-300));
  if (a.f_rate != 0.0) dp = std::min(dp, largest_growth * load / std::abs(a.f_rate));
  return dp;
}

std::optional<Node> Walk::along(const Node& a, double dp) {
  return balances_.find(a.at, dp * a.u_rate, dp * a.f_rate, control_, a.p + dp);
}

/// On the path between two nodes, of which the first is here and the other may be on the far side of a
/// critical point.
std::optional<Node> Walk::between(const Node& a, const Node& end, double p) {
  const double dp = p - a.p, bend = 0.5 * dp * dp / (end.p - a.p);
  const Vector x = dp * a.u_rate + bend * (end.u_rate - a.u_rate);
  return balances_.find(a.at, x, dp * a.f_rate + bend * (end.f_rate - a.f_rate), control_, p);
}

/// The middle lies where the cubic through the ends has it, and the tangents agree.
bool Walk::smooth(const Node& a, const Node& mid, const Node& end, double dp) const {
  double bend = 0.0, way = 0.0;
  for (const ParticleId p : a.at.r.ids()) way = std::max(way, norm(end.at.r[p] - a.at.r[p]));
  for (int k = 0; k < a.u_rate.size(); ++k) {
    if (body_.unknowns().is_turn(k)) continue;
    const auto [p, dof] = body_.unknowns().place(k);
    const double cubic = 0.5 * (component(a.at.r[p], dof) + component(end.at.r[p], dof)) +
                         0.125 * dp * (a.u_rate[k] - end.u_rate[k]);
    bend = std::max(bend, std::abs(component(mid.at.r[p], dof) - cubic));
  }
  const double f = 0.5 * (a.f() + end.f()) + 0.125 * dp * (a.f_rate - end.f_rate);
  const double f_way = std::abs(end.f() - a.f()) + 1e-3 * load_scale_;
  return bend <= largest_bend * way + 1e-9 * length_ && std::abs(mid.f() - f) <= largest_bend * f_way &&
         turn(a, mid) < largest_turn && turn(mid, end) < largest_turn;
}

bool Walk::snapped() const {
  for (const Bond& b : body_.state().bonds) {
    const BondShape shape = bond_shape(bond_pose(b, body_.state()), b.R_i, b.R_j);
    if (bond_range(b, shape) == BondRange::snapped || shape.length < 0.05 * b.a || shape.length > 5 * b.a)
      return true;
  }
  return false;
}

bool Walk::strained() const {
  for (const Bond& b : body_.state().bonds) {
    const BondShape shape = bond_shape(bond_pose(b, body_.state()), b.R_i, b.R_j);
    if (bond_range(b, shape) != BondRange::good || std::abs(shape.length - b.a) > 0.5 * b.a) return true;
  }
  return false;
}

int Walk::critical_loads() const {
  return static_cast<int>(std::count_if(result_.points.begin(), result_.points.end(),
                                        [](const ReferencePoint& p) { return !p.regained; }));
}

bool Walk::ended() {
  body_.restore(here_.at);
  if (critical_loads() >= settings_.count)
    result_.ended = "count";
  else if (!result_.points.empty() && result_.points.back().kind == PointKind::limit_point)
    result_.ended = "limit point";
  else if (settings_.reach > 0.0 && here_.f() >= settings_.reach)
    result_.ended = "load factor";
  else if (snapped())
    result_.ended = "range";
  else if (balances_.nodes() > settings_.most_nodes)
    result_.ended = "too many balances", result_.undecided = true;
  else if (static_cast<int>(result_.passings.size()) > most_passings)
    result_.ended = "too many branches that pass by", result_.undecided = true;
  return !result_.ended.empty();
}

Reference Walk::run() {
  if (!start()) {
    result_.ended = "no balance at load factor 0", result_.undecided = true;
    return result_;
  }
  while (!ended()) step();
  result_.nodes = balances_.nodes();
  return result_;
}

void Walk::arrive(const Node& node, double turned) {
  here_ = node;
  const double before = result_.turning.empty() ? 0.0 : result_.turning.back().turned;
  result_.turning.push_back({node.f(), before + turned});
}

void Walk::step() {
  Control c = best_control(here_);
  Node a = in_terms_of(here_, c);
  control_ = c;
  // the control may run backwards: rates are per unit of it, and the path goes on as before
  const double sense = turn(a, here_) > 0.5 * M_PI ? -1.0 : 1.0;
  double dp = largest_step(a);
  body_.restore(a.at);
  for (int halvings = 0; halvings < 40; ++halvings, dp *= 0.5) {
    const auto mid = along(a, 0.5 * sense * dp);
    if (!mid) continue;
    const auto end = along(*mid, 0.5 * sense * dp);
    if (!end || !smooth(a, *mid, *end, sense * dp)) continue;
    reach_ = (halvings == 0 ? 1.6 : 1.0) * dp * rate(a);
    if (differs(a, *mid) || differs(*mid, *end)) return locate(a, *end);
    arrive(*end, turn(a, *mid) + turn(*mid, *end));
    if (sense < 0.0) here_.u_rate *= -1.0, here_.f_rate *= -1.0;
    load_scale_ = std::max(load_scale_, std::abs(here_.f()));
    result_.searched_to = std::max(result_.searched_to, here_.f());
    return;
  }
  result_.ended = "no balance beyond", result_.undecided = true;
}

/// Narrows down to the first place between a and end that differs from a, and fits what passes zero there.
void Walk::locate(const Node& a, const Node& end) {
  const double sense = end.p < a.p ? -1.0 : 1.0, width = std::abs(end.p - a.p);
  double lo = a.p, hi = end.p, h = width * (settings_.near_by ? near_span : far_span);
  Node before = a;
  for (int tries = 0; tries < spans_tried; ++tries, h *= 0.2) {
    while (std::abs(hi - lo) > 0.2 * h) {
      const double p = 0.5 * (lo + hi);
      if (p == lo || p == hi) break;
      const auto mid = between(a, end, p);
      if (mid && !differs(a, *mid))
        lo = p, before = *mid;
      else
        hi = p;
    }
    Node beyond = end;
    auto events = fit(a, end, 0.5 * (lo + hi), sense * h, beyond);
    if (!events || !accept(*events, sense)) continue;
    arrive(beyond, turn(a, beyond));
    if (sense < 0.0) here_.u_rate *= -1.0, here_.f_rate *= -1.0;
    return;
  }
  result_.passings.push_back(before.f());
  here_ = turn(a, before) < largest_turn ? before : a;
  reach_ = std::max(0.25 * std::abs(hi - here_.p), 1e-12 * std::abs(hi)) * rate(here_);
  if (sense < 0.0) here_.u_rate *= -1.0, here_.f_rate *= -1.0;
}

/// What passes zero within 2.5 h of p. Nothing if a balance is missing there, or differs from a before it.
std::optional<std::vector<Event>> Walk::fit(const Node& a, const Node& end, double p, double h,
                                            Node& beyond) {
  if ((p - 2.5 * h - a.p) * h <= 0.0) return {};
  std::vector<Node> nodes;
  for (int k = 0; k < 6; ++k) {
    auto node = between(a, end, p + (k - 2.5) * h);
    if (!node) return {};
    nodes.push_back(std::move(*node));
  }
  if (differs(a, nodes.front()) || turn(nodes.front(), a) > largest_turn) return {};
  for (std::size_t k = 0; k < 5; ++k)
    if (turn(nodes[k], nodes[k + 1]) > largest_turn) return {};
  beyond = nodes.back();
  Six f{}, v{};
  for (std::size_t k = 0; k < 6; ++k) f[k] = nodes[k].f();
  std::vector<Event> events;
  body_.restore(nodes.back().at);
  const bool beyond_range = strained();
  const auto add = [&](bool limit, bool regained, double rounding_of_v) {
    const auto x6 = zero_of(v), x4 = zero_of(v, 1, 4);
    if (!x6 || !x4) return false;
    const double at = polynomial(f, *x6), scale = std::max(std::abs(at), 1e-300);
    const double of_fit = std::abs(at - polynomial(f, *x4)) / scale;
    const double of_rounding = std::abs(rounding_of_v / slope(v, *x6) * slope(f, *x6)) / scale;
    events.push_back({p + *x6 * h, at, of_fit + of_rounding, limit, regained, beyond_range});
    return of_fit < std::max(good_fit, of_rounding);
  };
  const double rounding = 8 * eps * balances_.largest_stiffness();
  const int n0 = nodes.front().negative, n1 = nodes.back().negative;
  for (int j = std::min(n0, n1) + 1; j <= std::max(n0, n1); ++j) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto value = balances_.eigenvalue(nodes[k], j);
      if (!value) return {};
      v[k] = *value;
    }
    if (!add(false, n1 < n0, rounding)) return {};
  }
  if (std::signbit(nodes.front().f_rate) != std::signbit(nodes.back().f_rate)) {
    for (std::size_t k = 0; k < 6; ++k) v[k] = nodes[k].f_rate;
    if (!add(true, false, 0.0)) return {};
  }
  return events;
}

/// In the order of the path; the eigenvalue that vanishes at a limit point is the limit point itself.
bool Walk::accept(std::vector<Event> events, double sense) {
  const auto limit = std::find_if(events.begin(), events.end(), [](const Event& e) { return e.limit; });
  if (limit != events.end()) {
    auto same = events.end();
    for (auto e = events.begin(); e != events.end(); ++e)
      if (!e->limit && (same == events.end() || std::abs(e->p - limit->p) < std::abs(same->p - limit->p)))
        same = e;
    if (same == events.end()) return false;
    same->limit = true, same->f = limit->f, same->error = limit->error;
    events.erase(limit);
  }
  std::sort(events.begin(), events.end(),
            [sense](const Event& x, const Event& y) { return sense * (x.p - y.p) < 0; });
  for (const Event& e : events) {
    if (critical_loads() >= settings_.count) break;
    result_.points.push_back({e.limit ? PointKind::limit_point : PointKind::bifurcation, e.f, e.error,
                              e.regained, e.beyond_range});
    result_.searched_to = std::max(result_.searched_to, e.f);
    if (e.limit) break;
  }
  return !events.empty();
}

}  // namespace

Reference find_reference(const Model& model, const StaticStage& stage, const State& state,
                         const ReferenceSettings& settings) {
  return Walk(model, stage, state, settings).run();
}

}  // namespace vbond::campaign
