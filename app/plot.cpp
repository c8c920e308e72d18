#include <fmt/format.h>

#include "braille.hpp"
#include "campaign.hpp"
#include "commands.hpp"
#include "lock.hpp"
#include "report_command.hpp"
#include "still.hpp"
#include "terminal.hpp"
#include "vbond/case/read.hpp"
#include "vbond/core/error.hpp"
#include "vbond/report/history_read.hpp"

namespace vbond::app {
namespace {

const page::HistoryColumn& column(const page::History& history, const std::string& name) {
  if (const page::HistoryColumn* c = history.find(name)) return *c;
  std::string known;
  for (const page::HistoryColumn& c : history.columns) known += (known.empty() ? "" : ", ") + c.name;
  throw CaseError({{},
                   name.empty() ? "no column is given" : "column " + name,
                   "must be one of history.csv",
                   "it has " + (known.empty() ? "none yet" : known)});
}

std::string with_unit(const std::string& name, bool si) {
  const std::string unit = page::unit_of_column(name);
  return si && !unit.empty() ? name + " [" + unit + ']' : name;
}

void plot_columns(const PlotOptions& o) {
  constexpr int height = 10;
  const page::History history = page::read_history(o.folder / "history.csv");
  if (o.columns.empty()) column(history, {});
  const bool si = read_case(o.folder / "resolved.toml").units == UnitSystem::si;
  const page::HistoryColumn& x = column(history, o.x.value_or(page::axis_of(history)));
  std::vector<const page::HistoryColumn*> wanted;  // all are looked up before any is drawn
  for (const std::string& name : o.columns) wanted.push_back(&column(history, name));
  for (const page::HistoryColumn* y : wanted)
    say(braille_panel({with_unit(y->name, si), with_unit(x.name, si), x.values, y->values}, terminal_width(),
                      height));
}

}  // namespace

int plot(const PlotOptions& o) {
  if (!o.columns.empty() || !o.still) plot_columns(o);
  if (o.still) {
    const std::filesystem::path picture = o.folder / "report.png";
    const Written report = write_report(o.folder);
    if (!report.no_frames.empty())
      throw IoError(report.page.string() + " is written, but there is no picture to take of it\n  " +
                    report.no_frames);
    const FolderLock lock(o.folder, report_lock);
    take_still(report.page, picture);
    say("picture in " + picture.string() + "\n");
  }
  return done;
}

}  // namespace vbond::app
