#include "vbond/run/run.hpp"

#include <pthread.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "bindings.hpp"
#include "interpreter.hpp"
#include "recorder.hpp"
#include "vbond/model/energies.hpp"
#include "vbond/model/periodic_cell.hpp"
#include "vbond/observe/observers.hpp"
#include "vbond/run/memory_needed.hpp"
#include "vbond/run/plan_output.hpp"
#include "vbond/setup/build.hpp"

namespace vbond::python {
namespace {

/// How many forks there are between this process and the first: the threads of a run stay behind in its own.
std::atomic<int> forks = 0;

/// A run of a case in memory. The lock of the interpreter is let go while it computes; nobody else may use it
/// then.
class PyRun {
 public:
  PyRun() = default;
  PyRun(const PyRun&) = delete;
  PyRun& operator=(const PyRun&) = delete;
  ~PyRun() {
    if (is_from_before_fork()) static_cast<void>(run_.release());  // to end it is to wait for its threads
  }
  /// Builds the body and checks all stages. Of a run for which that fails nothing can be asked: an object of
  /// Python exists before it is made, and a traceback may hold it.
  void make(SharedCase c, int threads, bool places) {
    const Work work(*this, "__init__");
    if (case_) throw py::value_error("this run was made before");
    const WithoutLock others;
    try {
      make(std::move(c), threads);
    } catch (const CaseError& e) {
      if (places) throw;
      throw without_places(e);
    }
  }
  std::int64_t step(std::int64_t n) {
    const Work work(*this, "step");
    if (!callbacks_.empty() && n > 0) return step_with_callbacks(n);
    return steps(n);
  }
  StageResult run_stage() {
    const Work work(*this, "run_stage");
    return stage();
  }
  std::vector<StageResult> run() {
    const Work work(*this, "run");
    do stage();
    while (!inner().complete());
    return inner().results();
  }
  void end_stage() {
    const Work work(*this, "end_stage");
    inner().end_stage();
  }
  void on_step(std::int64_t every, py::function f) {
    if (every < 1) throw py::value_error("on_step: every must be >= 1, not " + std::to_string(every));
    require_idle("on_step");
    callbacks_.push_back({every, std::move(f)});
  }
  int visit_callbacks(visitproc visit, void* arg) const {
    for (const Callback& c : callbacks_) Py_VISIT(c.call.ptr());
    return 0;
  }
  void forget_callbacks() { std::exchange(callbacks_, {}); }
  void set_velocities(const py::object& v, const py::object& omega) {
    const Work work(*this, "set_velocities");
    const std::size_t n = inner().model().particles();
    auto velocities = vectors(v, n, "velocities");
    inner().set_velocities(
        velocities, omega.is_none() ? inner().current().omega : vectors(omega, n, "angular_velocities"));
    moves_anew_ = true;
  }
  void add_load(const std::variant<std::string, std::vector<std::int64_t>>& particles,
                const py::object& force, const py::object& moment) {
    const Work work(*this, "add_load");
    const Vec3d F = vector(force, "force"), M = vector(moment, "moment");
    std::vector<ParticleId> ids = particles_of(particles);
    inner().add_load(
        {.group = "of Python", .particles = std::move(ids), .force = F, .moment = M, .factor = {}});
  }

  // ---- looking ----
  Snapshot state() {
    require_idle("state");
    if (!state_) state_ = std::make_shared<const State>(inner().state());
    return {model_, state_};
  }
  py::dict energies() {
    require_idle("energies");
    const Simulation* dynamics = inner().simulation();
    const Energies e = dynamics != nullptr ? dynamics->energies() : between_stages();
    const EnergyBooks& books = dynamics != nullptr ? dynamics->books() : inner().current().books;
    using namespace py::literals;
    return py::dict(
        "kinetic_translation"_a = e.kinetic_translation, "kinetic_rotation"_a = e.kinetic_rotation,
        "U_L"_a = e.U_L, "U_B"_a = e.U_B, "U_T"_a = e.U_T, "contact"_a = e.contact,
        "dissipated"_a = books.dissipated, "released"_a = books.released, "work_loads"_a = books.work_loads,
        "work_supports"_a = books.work_supports, "inserted"_a = books.inserted, "removed"_a = books.removed);
  }
  py::tuple loads() {
    require_idle("loads");
    if (inner().simulation() == nullptr)
      throw py::value_error(
          "loads: no stage of dynamics is under way; make a step(0) first, or use the results of "
          "the static stage");
    const Loads l = inner().simulation()->loads();
    return py::make_tuple(copy(l.F.values()), copy(l.M.values()));
  }
  py::dict history() {
    require_idle("history");
    return recorder_->columns();
  }
  bool complete() const { return idle("complete").complete(); }
  double time() const { return idle("time").clock().time(); }
  std::int64_t steps_made() const { return idle("steps").clock().step; }
  std::optional<std::string> stage_name() const {
    const Run& run = idle("stage");
    return run.complete() ? std::nullopt : std::optional(run.stages().name(stage_now()));
  }
  double time_step() const {
    const Simulation* dynamics = idle("time_step").simulation();
    return dynamics != nullptr ? dynamics->stage().dt : 0.0;
  }
  std::vector<StageResult> results() {
    require_idle("results");
    return inner().results();
  }
  std::vector<std::string> notes() const {
    require_idle("notes");
    return notes_;
  }
  std::vector<std::string> reports() {
    require_idle("reports");
    return reports_;
  }

 private:
  void make(SharedCase c, int threads) {
    require_statics(*c);
    require_memory(*c);
    Built built = build(*c, threads);
    require_memory(*c, built.model, built.state);
    auto run = std::make_unique<Run>(std::move(built.model), std::move(built.state), stages_of(*c, threads),
                                     threads);
    run->check();
    model_ = std::make_shared<const Model>(run->model());
    const OutputPlan plan = plan_output(*c, run->model(), {});
    const auto tell = [this](const std::string& report) { reports_.push_back(report); };
    const auto watch = std::make_shared<WatchObserver>(plan, tell);
    recorder_ = std::make_shared<Recorder>(plan);
    run->add_observer(watch);  // first: what is recorded is sound
    run->add_observer(recorder_);
    RunHooks hooks;
    hooks.tell = tell;
    hooks.interrupted = [this] { return interruption_.asked(); };
    hooks.stage_end = [this](const Simulation& ended, StopReason, const std::string&) {
      at_end_ = ended.energies(), moves_anew_ = false;
    };
    run->set_hooks(std::move(hooks));
    notes_ = std::move(built.notes);
    case_ = std::move(c);
    run_ = std::move(run);
    threads_ = threads;
  }
  struct Callback {
    std::int64_t every;
    py::function call;
  };
  /// Holds the run while it is at work: calls from other threads and from its own callbacks are refused.
  class Work {
   public:
    Work(PyRun& run, const char* what) : run_(run) {
      run.require_idle(what);
      if (run.is_from_before_fork())
        throw py::value_error(std::string(what) +
                              ": this run has its threads in the process that made it; make it here, or "
                              "with threads = 1");
      if (run.in_callback_)
        throw py::value_error(std::string(what) +
                              ": a callback of this run may look at it, but not take it further");
      run.busy_ = true;
      run.state_.reset();
    }
    ~Work() {
      run_.busy_ = false;
      run_.state_.reset();
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

   private:
    PyRun& run_;
  };

  bool is_from_before_fork() const { return threads_ > 1 && forks != made_after_forks_; }
  void require_idle(const char* what) const {
    if (busy_) throw py::value_error(std::string(what) + ": this run is at work in another thread");
  }
  /// The run, which no other thread takes further meanwhile: without its lock it may be between two stages.
  const Run& idle(const char* what) const {
    require_idle(what);
    return inner();
  }
  Run& inner() const {
    if (!run_) throw py::value_error("this run could not be made: its case was refused");
    return *run_;
  }
  std::size_t stage_now() const { return inner().stage_index(); }

  /// Those of the end of the stage before, if it was one of motion, with the velocities of now.
  Energies between_stages() const {
    if (at_end_ && !moves_anew_) return *at_end_;
    const Model& model = inner().model();
    State moving = inner().state(), turning = moving;
    Energies e = at_end_ ? *at_end_ : potential_energies(model, moving);
    for (Vec3d& omega : moving.omega) omega = {};
    for (Vec3d& v : turning.v) v = {};
    e.kinetic_translation = kinetic_energy_beside_flow(model, moving);
    e.kinetic_rotation = kinetic_energy(model, turning);
    return e;
  }

  std::int64_t steps(std::int64_t n) {
    std::int64_t made = 0;
    {
      const WithoutLock others;
      made = inner().step(n);
    }
    interruption_.raise();
    warn();
    return made;
  }
  /// What was reported since the last time, as warnings of Python, which may be made errors.
  void warn() {
    while (warned_ < reports_.size()) warn_of_run(reports_[warned_++]);
  }
  /// Up to the next steps at which callbacks are to be called, again and again. They may end the stage.
  std::int64_t step_with_callbacks(std::int64_t n) {
    const std::size_t before = stage_now();
    std::int64_t made = 0;
    while (made < n && !inner().complete() && stage_now() == before) {
      const std::int64_t now = inner().clock().stage_step;
      std::int64_t next = n - made;
      for (const Callback& c : callbacks_) next = std::min(next, c.every - now % c.every);
      const std::int64_t some = steps(next);
      made += some;
      if (inner().simulation() == nullptr || stage_now() != before) break;
      if (call_back()) {
        inner().end_stage();
        break;
      }
    }
    return made;
  }
  /// Whether one of them wants the stage to end.
  bool call_back() {
    bool ends = false;
    const auto step = inner().clock().stage_step;
    busy_ = false, in_callback_ = true;
    state_.reset();
    struct Leave {
      PyRun& run;
      ~Leave() { run.busy_ = true, run.in_callback_ = false, run.state_.reset(); }
    } const leave{*this};
    const py::object self = py::cast(this, py::return_value_policy::reference);
    const std::size_t called = callbacks_.size();  // those that they add come later
    for (std::size_t k = 0; k < called; ++k)
      if (step % callbacks_[k].every == 0) {
        const py::object answer = callbacks_[k].call(self);
        py::detail::make_caster<bool> ends_here;  // numpy's, too
        if (answer.is_none()) continue;
        if (!ends_here.load(answer, false))
          throw py::type_error("a callback of on_step returns None, True (ends the stage) or False, not " +
                               std::string(py::repr(answer)));
        ends = ends || py::detail::cast_op<bool>(ends_here);
      }
    return ends;
  }
  StageResult stage() {
    if (!inner().complete() && !callbacks_.empty() && !is_static(inner().stages().kind(stage_now()))) {
      const std::size_t before = stage_now();
      while (!inner().complete() && stage_now() == before)
        step_with_callbacks(std::numeric_limits<std::int64_t>::max());
      return inner().results().back();
    }
    StageResult result;
    interruption_.begin_anew();
    if (!inner().complete() && is_static(inner().stages().kind(stage_now()))) at_end_.reset();
    {
      const WithoutLock others;
      result = inner().run_stage();
    }
    interruption_.raise();
    warn();
    return result;
  }
  std::vector<ParticleId> particles_of(
      const std::variant<std::string, std::vector<std::int64_t>>& named) const {
    const Model& model = inner().model();
    if (const auto* name = std::get_if<std::string>(&named)) {
      if (const Group* g = model.find_group(*name)) return g->particles;
      std::string all;
      for (const Group& g : model.groups) all += " " + g.name;
      throw py::value_error("there is no group \"" + *name + "\"; the groups are" + all);
    }
    std::vector<ParticleId> ids;
    for (const std::int64_t p : std::get<std::vector<std::int64_t>>(named)) {
      if (p < 0 || p >= static_cast<std::int64_t>(model.particles()))
        throw py::index_error("particle " + std::to_string(p) + " of " + std::to_string(model.particles()) +
                              ", counted from 0");
      ids.emplace_back(static_cast<std::size_t>(p));
    }
    std::sort(ids.begin(), ids.end());
    if (ids.empty() || std::adjacent_find(ids.begin(), ids.end()) != ids.end())
      throw py::value_error("add_load: particles must be given, each once");
    return ids;
  }

  SharedCase case_;
  std::vector<std::string> notes_, reports_;
  std::size_t warned_ = 0;  // so many of the reports
  std::unique_ptr<Run> run_;
  std::shared_ptr<const Model> model_;
  std::shared_ptr<const State> state_;  // of state(), until the run goes on
  std::shared_ptr<Recorder> recorder_;
  std::vector<Callback> callbacks_;
  Interruption interruption_;
  std::optional<Energies> at_end_;  // of the stage before, if it was one of motion
  bool moves_anew_ = false;         // velocities were set since
  std::atomic<bool> busy_ = false;
  bool in_callback_ = false;
  int threads_ = 1;
  const int made_after_forks_ = forks;
};

/// The run of an object of Python, or nullptr before it has one.
PyRun* run_in(PyObject* self) {
  auto* instance = reinterpret_cast<py::detail::instance*>(self);
  return static_cast<PyRun*>(instance->get_value_and_holder().value_ptr());
}

/// Callbacks mostly refer to the run that has them: such circles are found by the garbage collector.
void collect_callbacks(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const PyRun* run = run_in(self);
    return run != nullptr ? run->visit_callbacks(visit, arg) : 0;
  };
  type.tp_clear = [](PyObject* self) {
    if (PyRun* run = run_in(self)) run->forget_callbacks();
    return 0;
  };
}

}  // namespace

void bind_run(py::module_& m) {
  using namespace py::literals;
  pthread_atfork(nullptr, nullptr, [] { ++forks; });
  py::class_<PyRun>(m, "CheckedRun", py::custom_type_setup(&collect_callbacks))
      .def(py::init<>())
      .def(
          "_make",
          [](PyRun& run, const std::shared_ptr<Case>& c, int threads, bool places) {
            run.make(c, threads, places);
          },
          "case"_a, "threads"_a, "places"_a)
      .def("step", &PyRun::step, "n"_a = 1,
           "Makes at most n steps of the stage under way, or of the next one; fewer if it ends. Returns how "
           "many. ValueError in a static stage, which run_stage makes as a whole.")
      .def("run_stage", &PyRun::run_stage, "The stage under way, or the next one, to its end.")
      .def("run", &PyRun::run, "All stages to come. Returns the results of all.")
      .def("end_stage", &PyRun::end_stage,
           "Ends the stage of dynamics under way here, as if its duration were over.")
      .def("on_step", &PyRun::on_step, "every"_a, "call"_a,
           "From now on `call(run)` after every so many steps of a stage of dynamics. If it returns True the "
           "stage ends there. It may look at the run, not take it further; what it raises comes out of step "
           "or run.")
      .def("set_velocities", &PyRun::set_velocities, "velocities"_a, "angular_velocities"_a = py::none(),
           "New velocities (n, 3) [length/time] and angular velocities (n, 3) [rad/time], which stay if "
           "None. Held degrees of freedom keep theirs; the energy that comes in is booked as work of loads.")
      .def("add_load", &PyRun::add_load, "particles"_a, "force"_a = py::make_tuple(0, 0, 0),
           "moment"_a = py::make_tuple(0, 0, 0),
           "A force [force] and a moment [force*length] on each of these particles, or of the group of this "
           "name, from now to the end of the stage under way or next to come; in a static stage in "
           "proportion to the load factor.")
      .def_property_readonly("state", &PyRun::state,
                             "The body as it stands: a State, which stays as it is when the run goes on. A "
                             "copy, made once per step.")
      .def_property_readonly(
          "energies", &PyRun::energies,
          "Where the energy is, and what has come in and gone, as a dict [energy]; between "
          "two stages as the last one ended.")
      .def_property_readonly("loads", &PyRun::loads,
                             "Forces (n, 3) and moments (n, 3) on the particles now, as a pair; of a stage "
                             "of dynamics under way.")
      .def_property_readonly(
          "history", &PyRun::history,
          "The rows of history.csv so far, as a dict of arrays: by output.history.every of the case.")
      .def_property_readonly("complete", &PyRun::complete, "Whether all stages are behind it.")
      .def_property_readonly("time", &PyRun::time, "Of the run [time].")
      .def_property_readonly("steps", &PyRun::steps_made, "Made since the start of the run.")
      .def_property_readonly("stage", &PyRun::stage_name,
                             "Name of the stage under way, or of the next one; None at the end.")
      .def_property_readonly("time_step", &PyRun::time_step,
                             "Of the stage of dynamics under way; else 0 [time].")
      .def_property_readonly("results", &PyRun::results,
                             "StageResult of each stage that has ended or failed, in order.")
      .def_property_readonly("notes", &PyRun::notes,
                             "What building has left aside or done otherwise, a line each.")
      .def_property_readonly(
          "reports", &PyRun::reports,
          "What the run has reported so far, a line or more each; each was a RunWarning, too.");
}

}  // namespace vbond::python
