#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/statics/detail/fundamental_path.hpp"

namespace vbond {
namespace {

/// The path is looked at no nearer to a critical load than this, relative, or than rounding lets it be known:
/// there the tangent is singular, and rounding moves the body along the mode. Seen from within three times
/// that the load is known: what is left is of the order of the square.
constexpr double stay_away = 1e-6;
constexpr int most_looks = 40;       // at one critical load
constexpr int more_than_wanted = 4;  // crossings at each look: some may be of modes that stiffen
/// A critical load that runs away to this times its first guess is taken as none.
constexpr double out_of_sight = 10.0;

/// Looks at the path nearer and nearer to one critical load after the other.
class Search {
 public:
  Search(FundamentalPath& path, int count) : path_(path), count_(count) {
    samples_.push_back(path.begin(count));
  }

  struct View {
    const PathSample* from;
    const Crossing* crossing;
    double load_factor() const { return from->at.load_factor + crossing->change; }
    double distance_to_keep() const {
      return std::max(stay_away * std::abs(load_factor()), crossing->known_to);
    }
    bool is_near() const { return std::abs(crossing->change) < 3 * distance_to_keep(); }
  };
  enum class End { found, none, interrupted, lost };

  const PathSample& start() const { return samples_.front(); }
  /// Critical load number k, from 0, as it is seen from the samples next to it, or if they do not see it from
  /// elsewhere.
  std::optional<View> view(int k) const;
  End find(int k);

 private:
  struct Bracket {
    const PathSample* low;   // the last before critical load k
    const PathSample* high;  // the first beyond, or nullptr
  };
  Bracket bracket(int k) const;

  FundamentalPath& path_;
  int count_;
  std::vector<PathSample> samples_;
};

Search::Bracket Search::bracket(int k) const {
  Bracket b{nullptr, nullptr};
  for (const PathSample& s : samples_)
    if (s.unstable > k && (!b.high || s.at.load_factor < b.high->at.load_factor)) b.high = &s;
  for (const PathSample& s : samples_)
    if (s.unstable <= k && (!b.high || s.at.load_factor < b.high->at.load_factor) &&
        (!b.low || s.at.load_factor > b.low->at.load_factor))
      b.low = &s;
  return b;
}

std::optional<Search::View> Search::view(int k) const {
  const Bracket b = bracket(k);
  std::optional<View> nearest;
  const auto consider = [&](const PathSample& s) {
    const Crossing* c = s.crossing(k);
    if (c && (!nearest || std::abs(c->change) < std::abs(nearest->crossing->change))) nearest = View{&s, c};
  };
  consider(*b.low);
  if (b.high) consider(*b.high);
  if (nearest) return nearest;
  for (const PathSample& s : samples_) consider(s);
  if (nearest && nearest->load_factor() <= b.low->at.load_factor) nearest.reset();  // it was not there
  return nearest;
}

Search::End Search::find(int k) {
  double first_guess = 0.0;
  for (int look = 0; look < most_looks; ++look) {
    const std::optional<View> seen = view(k);
    if (look == 0 && seen) first_guess = seen->load_factor();
    if (!seen || seen->load_factor() > out_of_sight * first_guess) return End::none;
    if (seen->is_near()) return End::found;
    const Bracket b = bracket(k);
    double to = seen->load_factor() - seen->distance_to_keep();
    const double low = b.low->at.load_factor;
    if (b.high && !(to > low && to < b.high->at.load_factor)) to = 0.5 * (low + b.high->at.load_factor);
    if (!b.high && !(to > low)) to = 1.1 * low;
    const bool from_high = b.high && b.high->at.load_factor - to < to - low;
    std::optional<PathSample> s = path_.look(from_high ? *b.high : *b.low, to, count_ + more_than_wanted);
    if (!s) return End::interrupted;
    samples_.push_back(std::move(*s));
  }
  return End::lost;
}

double largest_proportional_force(const StaticStage& stage) {
  double largest = 0.0;
  for (const StaticLoad& l : stage.loads)
    if (!l.constant) largest = std::max(largest, static_cast<double>(l.particles.size()) * norm(l.force));
  return largest;
}

}  // namespace

StaticOutcome find_critical_loads(const Model& model, const StaticStage& stage, State state,
                                  const StaticHooks& hooks) {
  StaticResult result;
  std::optional<State> balanced = balance_of_constant_loads(model, stage, state, hooks, result);
  if (!balanced) return interrupted_outcome(std::move(result), std::move(state));
  StaticBody body(model, stage, std::move(*balanced));
  refuse_rigid_motions(body);
  FundamentalPath path(body, hooks, result);
  Search search(path, stage.count);
  report_point(body, PointKind::regular, 0, hooks, result);

  Search::End end = Search::End::found;
  for (int k = 0; k < stage.count; ++k) {
    end = search.find(k);
    if (end != Search::End::found) break;
    const Search::View view = *search.view(k);
    const Crossing* linear = search.start().crossing(k);
    result.critical_loads.push_back({PointKind::bifurcation, view.load_factor(),
                                     linear ? std::optional<double>(linear->change) : std::nullopt,
                                     view.load_factor() * largest_proportional_force(stage),
                                     body.unknowns().shape(view.crossing->mode)});
    if (view.crossing->known_to > stay_away * view.load_factor() && hooks.tell)
      hooks.tell(fmt::format("stage \"{}\": rounding leaves critical load {} known to {:.1g} of itself",
                             stage.name, k + 1, view.crossing->known_to / view.load_factor()));
    body.restore(view.from->at);
    report_point(body, PointKind::bifurcation, view.from->unstable, hooks, result);
  }
  if (end == Search::End::lost)
    throw NoEquilibrium(
        stage.name, fmt::format("critical load {} could not be located", result.critical_loads.size() + 1),
        "use kind = \"path\" to see how stability changes");
  if (end == Search::End::none && hooks.tell)
    hooks.tell(fmt::format("stage \"{}\": no more than {} critical loads are in sight", stage.name,
                           result.critical_loads.size()));
  result.ended = end == Search::End::interrupted ? "interrupted" : "converged";
  result.solver = "direct";
  result.unstable = 0;
  body.restore(search.start().at);
  return {std::move(result), std::move(body).take_state()};
}

}  // namespace vbond
