#include "vbond/labtest/test_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "vbond/case/node.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/printable.hpp"

namespace vbond::labtest {
namespace {

std::string number(double x) {
  return keys::number_text(x + 0.0);  // no -0
}
std::string vector(const Vec3d& a) {
  return fmt::format("[{}, {}, {}]", number(a.x), number(a.y), number(a.z));
}
std::string header(const std::string& group) {
  return "\n[groups." + group + "]\n";
}
std::string stage(const char* words, const char* name, const char* kind) {
  return fmt::format("\n# {}\n[[stage]]\nname = \"{}\"\nkind = \"{}\"\n", words, name, kind);
}
constexpr const char* comes_on =
    "the pressure comes on all round, on a skin through outer centres; the upper end moves along the axis as "
    "one body";
constexpr const char* settles = "from here on the ends slide sideways";
std::string fix(const Hold& h) {
  if (h.fix.empty()) return ", rigid = true";
  std::string names;
  for (const int k : h.fix) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", name_of_axis(k));
  return ", fix = [" + names + "]";
}

}  // namespace

void TestText::side(const Side& s) {
  groups_ += header(s.group) + fmt::format("half_space = {{point = {}, normal = {}}}\n",
                                           vector(along(s.direction, s.plane)),
                                           vector(along(s.direction, s.upper ? -1.0 : 1.0)));
}

void TestText::middle(const std::string& group, int direction, double within) {
  groups_ += header(group) + fmt::format("plane = {{point = {}, normal = {}, within = {}}}\n",
                                         vector(along(direction, body_.middle(direction))),
                                         vector(along(direction)), number(within));
}

void TestText::box(const std::string& group, const Vec3d& low, const Vec3d& high) {
  groups_ += header(group) + fmt::format("box = {{min = {}, max = {}}}\n", vector(low), vector(high));
}

void TestText::both(const std::string& group, const std::string& one, const std::string& other) {
  groups_ += header(group) + fmt::format("union = [\"{}\", \"{}\"]\n", one, other);
}

void TestText::point_holds(const std::vector<PointHold>& all, Confining confining) {
  std::vector<std::pair<ParticleId, std::vector<int>>> particles;
  for (const PointHold& h : all) {
    const auto at = std::find_if(particles.begin(), particles.end(),
                                 [&h](const auto& p) { return p.first == h.particle; });
    if (at == particles.end())
      particles.push_back({h.particle, {h.direction}});
    else
      at->second.push_back(h.direction);
  }
  if (!particles.empty())
    comment("single particles, held so that the body as a whole neither moves nor turns; they bear no load");
  int k = 0;
  for (auto& [particle, directions] : particles) {
    const std::string group = fmt::format("test_hold_{}", ++k);
    groups_ += header(group) + fmt::format("sphere = {{centre = {}, radius = {}}}\n",
                                           vector(body_.state.r[particle]), number(1e-3 * body_.spacing));
    std::sort(directions.begin(), directions.end());
    hold({group, directions, {}, confining});
  }
}

std::string TestText::supports(const MadeTest& test, double strain, bool moves, bool confining) const {
  std::string text = "supports = [\n";
  for (const Hold& h : holds_) {
    if (confining && h.confining == Confining::left_out) continue;
    const bool guided = confining && h.confining == Confining::guided;
    text += "  {group = \"" + h.group + "\"";
    if (guided)
      text += fmt::format(R"(, rigid = true, fix = ["{}", "{}", "rx", "ry", "rz"])",
                          name_of_axis(body_.across), name_of_axis(body_.third));
    else
      text += fix(h);
    if (moves && norm2(h.way) > 0.0)
      text +=
          fmt::format(", velocity = {}, ramp = {}", vector(test.rate * h.way), number(0.02 * test.duration));
    else if (strain > 0.0 && norm2(h.way) > 0.0)
      text += ", displacement = " + vector(strain * h.way);
    text += "},\n";
  }
  return text + "]\n";
}

/// Waves along the body lose half of their amplitude in the time that they take for it: near critical for the
/// longest of them. Local damping does not know rigid bodies that are free in part.
std::string TestText::drag() const {
  const double rate = body_.wave_speed / body_.box.diagonal();
  double mass = 0, inertia = 0;
  for (const ParticleId p : body_.model.mass.ids())
    mass += body_.model.mass[p], inertia += body_.model.inertia[p];
  const double share = rate / static_cast<double>(body_.model.particles());
  return fmt::format("damping = {{translation = {}, rotation = {}}}\n", number(share * mass),
                     number(share * inertia));
}

std::string TestText::pressure(const MadeTest& test, const std::string& how) const {
  if (!test.confinement) return "";
  return fmt::format("pressures = [{{surface = \"skin\", pressure = {}, longest = {}{}}}]\n",
                     number(test.confinement->applied), number(test.confinement->longest), how);
}

std::string TestText::stages_in_motion(const MadeTest& test) const {
  const Request& r = test.request;
  const double damping = r.damping.value_or(0.7);
  const bool damps = damping > 0.0;
  const std::string damped = damps ? fmt::format("damping = {{local = {}}}\n", number(damping)) : "";
  const auto lasts = [](double duration) { return fmt::format("duration = {}\n", number(duration)); };
  std::string text;
  if (test.confinement)
    text += stage(comes_on, "confine", "dynamics") + lasts(test.confining) +
            supports(test, 0.0, false, true) + (damps ? drag() : "") +
            pressure(test, fmt::format(", ramp = {}", number(0.5 * test.confining))) +
            stage(settles, "settle", "dynamics") + lasts(test.settling) + supports(test, 0.0, false) +
            damped + pressure(test);
  text += stage("the platens move at a rate", "test", "dynamics") + lasts(test.duration) +
          supports(test, 0.0, true) + damped + pressure(test);
  const double window = std::max(0.002 * test.duration, 0.05 * body_.model.T_0);  // more than a step
  if (test.breaks)
    text += fmt::format(
        "stop = {{peak = {{quantity = \"reaction\", group = \"{}\", direction = {}, drop = {}, "
        "average_over = {}}}}}\n",
        test.upper, vector(along(test.direction, test.sign)), number(r.drop), number(window));
  return text;
}

std::string TestText::stages_at_rest(const MadeTest& test) const {
  const Request& r = test.request;
  const std::string on = pressure(test, ", constant = true");
  std::string text;
  if (test.confinement)
    text = stage(comes_on, "confine", "equilibrium") + supports(test, 0.0, false, true) + pressure(test) +
           stage(settles, "settle", "equilibrium") + supports(test, 0.0, false) + on;
  else
    text = stage("the body as it is made comes to rest: what it bears now is its stress before the test",
                 "settle", "equilibrium") +
           supports(test, 0.0, false);
  text += stage("a strain so small that moduli are those before any bond breaks", "elastic", "equilibrium") +
          supports(test, elastic_strain, false) + on;
  if (test.breaks)
    text += stage("bonds break one by one; each point is a balance", "break", "fracture") + "steps = 20\n" +
            supports(test, test.end_strain, false) + on +
            fmt::format("stop = {{load_drop = {}}}\n", number(r.drop));
  else if (r.strain)
    text += stage("on to the strain that is asked for", "load", "equilibrium") + "steps = 20\n" +
            supports(test, test.end_strain, false) + on;
  return text;
}

std::string TestText::text(const MadeTest& test, const std::vector<std::string>& displacements,
                           double gauge_volume) const {
  std::string text = groups_ + (test.request.at_rest ? stages_at_rest(test) : stages_in_motion(test)) +
                     "\n[output]\nhistory = {";
  if (!test.request.at_rest) text += fmt::format("every = {}, ", number(0.002 * test.duration));
  text += fmt::format("reactions = [\"{}\", \"{}\"], displacements = [", test.lower, test.upper);
  for (const std::string& name : displacements)
    text += fmt::format("{}\"{}\"", &name == displacements.data() ? "" : ", ", name);
  text += "]";
  if (gauge_volume > 0.0)
    text +=
        fmt::format(", stress = [{{group = \"{}\", volume = {}}}]", test.gauge->group, number(gauge_volume));
  text += "}\n";
  if (test.request.frames)
    text += test.request.at_rest ? "frames = {}\n"
                                 : fmt::format("frames = {{every = {}}}\n", number(0.02 * test.duration));
  return text;
}

std::optional<std::string> left_out(const Case& c) {
  std::vector<std::string> names;
  const auto add = [&names](bool there, const char* name) {
    if (there && std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
  };
  const auto any = [&c](const auto& has) { return std::any_of(c.stages.begin(), c.stages.end(), has); };
  add(!c.walls.empty(), "walls");
  add(!c.velocities.empty(), "velocities");
  add(any([](const StageSpec& s) { return norm2(s.gravity) > 0.0; }), "gravity");
  add(any([](const StageSpec& s) { return !s.supports.empty(); }), "supports");
  add(any([](const StageSpec& s) { return !s.loads.empty(); }), "loads");
  Terms::for_each([&]<class T>(T) { add(any([](const SpecPart<T>& s) { return s.any(); }), T::key); });
  if (names.empty()) return std::nullopt;
  return fmt::format("of the case are left out: {}; the test has stages of its own", fmt::join(names, ", "));
}

std::string case_text(const Case& c, const MadeTest& test, const std::string& title,
                      const std::string& command) {
  Case body = c;
  body.title = title;
  body.stages.clear(), body.walls.clear(), body.velocities.clear();
  body.output = {};
  if (test.notch) leave_out(*test.notch, body);
  std::string text = to_toml(body);
  // the writer gives every section, output as well: it is that of the test
  const std::string output = "\n[output]\n";
  if (const std::size_t begin = text.find(output); begin != std::string::npos) {
    const std::size_t end = text.find("\n\n", begin + output.size());
    text.erase(begin, end == std::string::npos ? std::string::npos : end + 1 - begin);
  }
  return "# Made by " + printable(command) + "\n" +
         "# Body and bonds are those of the case, with all keys written out. Groups, stages and output at "
         "the end\n"
         "# are those of the test.\n" +
         text + test.text;
}

}  // namespace vbond::labtest
