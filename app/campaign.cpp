#include "campaign.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "prepare.hpp"
#include "signals.hpp"
#include "vbond/core/printable.hpp"
#include "vbond/dynamics/kernel.hpp"
#include "vbond/model/bond_sums.hpp"
#include "vbond/model/present.hpp"
#include "vbond/observe/bond_look.hpp"
#include "vbond/observe/breaks_observer.hpp"
#include "vbond/observe/dispersion_table.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/fracture_table.hpp"
#include "vbond/observe/quantities.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/run/static_solver.hpp"

namespace vbond::app {
namespace {

void tell_beside(ProgressObserver& progress, const std::string& report) {
  progress.clear();
  say(report + "\n", stderr);
}

RunSummary first_summary(const Case& c, const Model& model, int threads) {
  RunSummary s;
  s.title = c.title;
  s.version = VBOND_VERSION;
  s.units = model.units;
  s.particles = static_cast<std::int64_t>(model.particles());
  s.T_0 = model.T_0;
  s.instruction_set = instruction_set();
  if (any_statics(c)) s.blas_kernel = kernel_of_blas();
  s.threads = threads;
  return s;
}

/// Within a stage of fracture.
void write_if_due(Campaign& campaign) {
  if (campaign.files.checkpoint->is_due_at_rest(campaign.run.clock())) write_within(campaign);
}

}  // namespace

double seconds_since(WallClock::time_point start) {
  return std::chrono::duration<double>(WallClock::now() - start).count();
}

void say(const std::string& text, std::FILE* out) {
  const std::string shown = printable(text);
  std::fwrite(shown.data(), 1, shown.size(), out);
  std::fflush(out);
}

void Campaign::tell(const std::string& report) const {
  tell_beside(*progress, report);
  heartbeat->told(report);
}

void Campaign::clear_progress() const {
  progress->clear();
}

double Campaign::output_seconds() const {
  double sum = table->seconds() + progress->seconds();
  for (const auto& [name, seconds] : files.seconds()) sum += seconds;
  return sum;
}

Campaign open_campaign(const Case& c, Run& run, OutputPlan plan, int threads, const std::string& program,
                       const Checkpoint* resume, WallClock::time_point start) {
  if (plan.writes_all()) catch_signals();  // before there are files: whoever sees one may stop the run
  Campaign campaign{.c = c,
                    .run = run,
                    .plan = std::move(plan),
                    .threads = threads,
                    .program = program,
                    .files = {},
                    .table = {},
                    .progress = {},
                    .heartbeat = {},
                    .summary = first_summary(c, run.model(), threads),
                    .times = {},
                    .ahead = {},
                    .stage_end = {}};
  const bool shows = campaign.plan.writes_all() && isatty(STDERR_FILENO) != 0;
  campaign.progress =
      std::make_shared<ProgressObserver>(shows ? stderr : nullptr, std::vector<std::int64_t>{});
  const auto any = [body = run.body_at_start()](auto&& is_one) {  // bonds keep what the case has lost since
    return count_bonds(body, is_one) > 0;
  };
  campaign.plan.breaks = campaign.plan.breaks || any(can_break);
  campaign.plan.capsules = campaign.plan.capsules || any([](const Bond& b) { return capsule_of(b) > 0.0; });
  campaign.plan.flow = campaign.plan.flow || any([](const Bond& b) {  // not cracks of joints that rub
                         return b.law->has_rules && b.law->remembers() && b.law->crack == nullptr;
                       });
  campaign.heartbeat = std::make_shared<Heartbeat>(
      run, campaign.plan, c.title, start,
      [progress = campaign.progress](const std::string& warning) { tell_beside(*progress, warning); });
  // by pointers: the heartbeat itself holds the observers that tell it
  const auto tell = [progress = campaign.progress,
                     heartbeat = campaign.heartbeat.get()](const std::string& report) {
    tell_beside(*progress, report);
    heartbeat->told(report);
  };
  campaign.files = open_output(campaign.plan, tell, VBOND_VERSION, resume);
  campaign.heartbeat->follow(campaign.files);
  campaign.progress->on_beat(
      [heartbeat = campaign.heartbeat.get()](const Simulation& stage, std::optional<double> left) {
        heartbeat->beat(stage, left);
      });
  campaign.table = std::make_shared<TableObserver>(stdout, campaign.plan.breaks);
  for (const auto& o : campaign.files.all()) run.add_observer(o);
  run.add_observer(campaign.table);
  run.add_observer(campaign.progress);
  campaign.heartbeat->begin_stage();
  return campaign;
}

void write_within(Campaign& campaign) {
  const Run& run = campaign.run;
  const FractureUnderWay& under_way = *run.under_way();
  if (campaign.files.breaks)
    campaign.files.breaks->add_breaks_at_rest(start_of_static_stage(run.clock()), run.current(),
                                              under_way.found.fracture.breaks);
  campaign.files.checkpoint->write_within(run.model(), run.current(), under_way);
}

Clock start_of_static_stage(Clock now) {
  return {.step = now.step - now.stage_step,
          .stage_step = 0,
          .stage = now.stage,
          .stage_start = now.stage_start,
          .dt = 0};
}

void listen(Campaign& campaign) {
  RunHooks hooks;
  hooks.balance = [&campaign](const BodyView& body) { campaign.heartbeat->balance(body); };
  hooks.tell = [&campaign](const std::string& report) { campaign.tell(report); };
  hooks.interrupted = [] { return caught_signal() != 0; };
  hooks.progress = [&campaign](const std::string& line) { say(line + "\n", stderr); };
  hooks.under_way = [&campaign] { write_if_due(campaign); };
  if (campaign.files.breaks)
    hooks.goes_on = [&campaign](const BodyView& body) {
      campaign.files.breaks->observe_balance(body, *body.balance());
      campaign.files.breaks->go_on_at_rest(campaign.run.under_way()->found.fracture.breaks.size());
    };
  hooks.stage_end = [&campaign](const Simulation& stage, StopReason why, const std::string& failure) {
    campaign.stage_end(stage, why, failure);
    campaign.heartbeat->beat(stage, {});
  };
  campaign.run.set_hooks(std::move(hooks));
}

namespace {

/// What this process has of the body as it is now, with the books of the whole.
BodyPart part_of(const Campaign& campaign) {
  const Simulation* const stage = campaign.run.simulation();
  if (stage == nullptr) return campaign.run.current();
  const Model& model = campaign.run.model();
  BodyPart part = stage->part(
      Show::places, campaign.plan.cell && particles_touch(model.contact) ? reach_of_overlaps(model) : 0.0);
  stage->books();
  return part;
}

}  // namespace

void save_summary(Campaign& campaign) {
  RunSummary& s = campaign.summary;
  const BodyPart body = part_of(campaign);
  const State& state = body.state;
  // sums over all processes
  if (campaign.files.breaks) (s.breaks ? *s.breaks : s.breaks.emplace()).broken = count_broken(body);
  if (campaign.plan.cell) s.cell = summarise_cell(campaign.run.model(), body);
  s.dissipated.clear();
  if (!campaign.plan.losses.empty()) {
    const bool at_rest = !s.stages.empty() && s.stages.back().statics;
    Losses lost = at_rest ? Losses{} : state.books.lost;
    lost += losses_by_flow(body);
    for (const Loss cause : campaign.plan.losses) s.dissipated.emplace_back(to_text(cause), lost[cause]);
  }
  const HistoryWriter* const history = campaign.files.history->writer();
  if (history == nullptr) return;
  s.energy_balance_error = history->largest_balance_error();
  if (s.breaks && campaign.files.breaks) {
    BreakSummary& breaks = *s.breaks;
    breaks.first = campaign.files.breaks->record();
    breaks.peak_load = history->largest_load();
    if (const auto load = breaks.first.largest_load)
      breaks.peak_load = std::max(breaks.peak_load.value_or(0.0), *load);
  }
  s.walls.clear();
  const std::vector<WallState>& walls = state.walls;
  for (std::size_t w = 0; w < walls.size(); ++w)
    s.walls.push_back({campaign.plan.walls[w], walls[w].force, walls[w].moment, walls[w].displacement,
                       walls[w].work, history->largest_on_walls()[w]});
  if (campaign.plan.passage) s.passage = summarise_passage(campaign.run.model(), state);
  const WatchRecord& watched = campaign.files.watch->watch().record();
  s.ever_strained = watched.strained;
  s.ever_snapped = watched.snapped;
  s.ever_overlapping = static_cast<std::int64_t>(watched.overlapping.size());
  s.ever_stretched = static_cast<std::int64_t>(watched.stretched.size());
  if (campaign.c.watch.on_unphysical == OnUnphysical::drop)
    s.dropped = static_cast<std::int64_t>(state.dropped.size()) - state.mass.particles_out;
  s.too_fast = watched.fastest > WatchRecord{}.fastest ? watched.fastest : 0.0;
  s.stepping_seconds = std::max(0.0, campaign.stepping);
  s.wall_time = {{"build", campaign.building}};
  if (campaign.plan.statics) s.wall_time.push_back({"statics", std::max(0.0, campaign.balancing)});
  if (campaign.c.any_dynamics())
    for (const PhaseTime& p : split_steps(s.stepping_seconds, campaign.times)) s.wall_time.push_back(p);
  for (const auto& [name, seconds] : campaign.files.seconds()) s.wall_time.push_back({name, seconds});
  s.wall_time.push_back({"terminal", campaign.table->seconds() + campaign.progress->seconds()});
  write_summary(campaign.plan.folder / "run.json", s);
  if (const std::string table = fracture_table(s); !table.empty())
    replace_file(campaign.plan.folder / "fracture.csv", table);
  if (const std::string table = dispersion_table(s); !table.empty())
    replace_file(campaign.plan.folder / "dispersion.csv", table);
}

}  // namespace vbond::app
