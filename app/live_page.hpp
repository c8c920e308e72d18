#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace vbond::app {

/// Shows a run that goes on in a browser of this machine: a server of the report page and of how the run
/// stands. It listens at the loopback address alone, answers only whoever knows its random token, and writes
/// nothing. Its answers are made in a thread of its own.
class LivePage {
 public:
  /// port: 0 for any that is free. Throws IoError, also if the page was not built with the program.
  LivePage(std::filesystem::path folder, std::uint16_t port);
  ~LivePage();
  /// Where the browser finds it, with the token.
  const std::string& address() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace vbond::app
