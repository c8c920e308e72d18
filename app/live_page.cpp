#include "live_page.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "failure.hpp"
#include "report.hpp"
#include "seen.hpp"
#include "vbond/core/error.hpp"

namespace vbond::app {
namespace {

namespace fs = std::filesystem;

struct Answer {
  unsigned status = MHD_HTTP_OK;
  const char* type = "text/plain; charset=utf-8";
  std::string text;
};

/// What nobody guesses: 128 random bits as hexadecimal digits.
std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw IoError(std::string("no random numbers from the system: ") + std::strerror(errno));
  std::string text;
  for (const unsigned byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// Another text whenever one of the files that a page is made of has changed.
std::string version_of(const fs::path& folder) {
  std::string text;
  for (const char* name : {"history.csv", "particles.pvd", "breaks.csv", "run.json"}) {
    std::error_code none;
    const auto size = fs::file_size(folder / name, none);
    const auto time = fs::last_write_time(folder / name, none);
    text += none ? "-" : fmt::format("{:x}.{:x}", size, time.time_since_epoch().count());
    text += ' ';
  }
  return text;
}

Answer page_of(const fs::path& folder) {
  const std::string version = version_of(folder);  // before it is read: a page is rather too old than too new
  return {.type = "text/html; charset=utf-8", .text = live_report(folder, version)};
}

Answer state_of(const fs::path& folder) {
  const Seen seen = see(folder);
  nlohmann::ordered_json j;
  j["goes_on"] = seen.goes_on();
  j["lines"] = lines_of(seen);
  j["data"] = version_of(folder);
  return {.type = "application/json",
          .text = j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace

struct LivePage::Server {
  fs::path folder;
  std::string token, address;
  MHD_Daemon* daemon = nullptr;

  Answer answer(std::string_view path, std::string_view method) const {
    const std::string ours = "/" + token + "/";
    if (!path.starts_with(ours))
      return {.status = MHD_HTTP_FORBIDDEN, .text = "the address lacks the token\n"};
    if (method != MHD_HTTP_METHOD_GET && method != MHD_HTTP_METHOD_HEAD)
      return {.status = MHD_HTTP_METHOD_NOT_ALLOWED, .text = "this page is only read\n"};
    try {
      if (path == ours) return page_of(folder);
      if (path == ours + "state") return state_of(folder);
    } catch (...) {
      return {.status = MHD_HTTP_INTERNAL_SERVER_ERROR, .text = failure_under_way().text};
    }
    return {.status = MHD_HTTP_NOT_FOUND, .text = "there is nothing of this name\n"};
  }

  static MHD_Result handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char* /*version*/, const char* /*upload*/, std::size_t* upload_size,
                           void** /*request*/) {
    *upload_size = 0;  // nobody has anything to tell us
    const Answer a = static_cast<const Server*>(self)->answer(url, method);
    MHD_Response* response = MHD_create_response_from_buffer(a.text.size(), const_cast<char*>(a.text.data()),
                                                             MHD_RESPMEM_MUST_COPY);
    if (response == nullptr) return MHD_NO;
    for (const auto& [name, value] : {std::pair{"Content-Type", a.type},
                                      {"Cache-Control", "no-store"},
                                      {"Referrer-Policy", "no-referrer"},
                                      {"X-Content-Type-Options", "nosniff"}})
      MHD_add_response_header(response, name, value);
    const MHD_Result result = MHD_queue_response(connection, a.status, response);
    MHD_destroy_response(response);
    return result;
  }
};

LivePage::LivePage(fs::path folder, std::uint16_t port) : server_(std::make_unique<Server>()) {
  require_page();
  server_->folder = std::move(folder);
  server_->token = random_token();
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(port);
  where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  server_->daemon = MHD_start_daemon(MHD_USE_INTERNAL_POLLING_THREAD, port, nullptr, nullptr, &Server::handle,
                                     server_.get(), MHD_OPTION_SOCK_ADDR, &where, MHD_OPTION_CONNECTION_LIMIT,
                                     16U, MHD_OPTION_CONNECTION_TIMEOUT, 60U, MHD_OPTION_END);
  if (server_->daemon == nullptr)
    throw IoError(fmt::format("no server at 127.0.0.1:{}: {}\n  give another --port, or none", port,
                              std::strerror(errno)));
  const auto* bound = MHD_get_daemon_info(server_->daemon, MHD_DAEMON_INFO_BIND_PORT);
  server_->address = fmt::format("http://127.0.0.1:{}/{}/", bound->port, server_->token);
}

LivePage::~LivePage() {
  if (server_->daemon != nullptr) MHD_stop_daemon(server_->daemon);
}

const std::string& LivePage::address() const {
  return server_->address;
}

}  // namespace vbond::app
