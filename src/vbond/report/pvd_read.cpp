#include <algorithm>
#include <cmath>
#include <string_view>

#include "vbond/observe/frames.hpp"
#include "vbond/report/detail/scanner.hpp"
#include "vbond/report/vtp_read.hpp"

namespace vbond {

std::vector<ListedFrame> read_pvd(const std::filesystem::path& path) {
  const std::string content = read_all(path), empty = pvd_list({});
  const std::size_t head = empty.find("  </Collection>");
  Scanner s(content, path);
  s.expect(std::string_view(empty).substr(0, head));
  std::vector<ListedFrame> frames;
  while (s.take("    <DataSet timestep=\"")) {
    ListedFrame frame;
    frame.time = s.number<double>();
    if (!std::isfinite(frame.time)) s.refuse();
    s.expect("\" part=\"0\" file=\"");
    const std::filesystem::path file = s.until('"');
    if (file.is_absolute() || std::find(file.begin(), file.end(), "..") != file.end()) s.refuse();
    frame.file = path.parent_path() / file;
    s.expect("/>\n");
    frames.push_back(std::move(frame));
  }
  s.expect(std::string_view(empty).substr(head));
  if (!s.at_end()) s.refuse();
  return frames;
}

}  // namespace vbond
