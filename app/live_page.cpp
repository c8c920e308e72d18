#include "live_page.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <list>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "failure.hpp"
#include "report_command.hpp"
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

/// Names by which a browser of this machine, or one behind a tunnel to it, calls it; any port. A page of
/// another name that leads here is not ours to answer.
bool is_this_machine(std::string_view host) {
  for (const std::string_view name : {"127.0.0.1", "localhost", "[::1]"}) {
    if (!host.starts_with(name)) continue;
    const std::string_view port = host.substr(name.size());
    if (port.empty() || (port.size() > 1 && port[0] == ':' &&
                         port.find_first_not_of("0123456789", 1) == std::string_view::npos))
      return true;
  }
  return false;
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

/// The connections of a server, in the order in which they came. All is called in the server's thread.
class LiveConnections {
 public:
  /// A new one. Where there are too many the oldest of those that have not shown the token is cut off, else
  /// the oldest: whoever sends a byte now and then keeps nobody else out.
  void came(MHD_Connection* connection) {
    all_.push_back({connection, false, false});
    const auto open = std::count_if(all_.begin(), all_.end(), [](const One& c) { return !c.cut; });
    if (open <= static_cast<std::ptrdiff_t>(most)) return;
    auto oldest = std::find_if(all_.begin(), all_.end(), [](const One& c) { return !c.cut && !c.known; });
    if (oldest->connection == connection)  // all others have the token
      oldest = std::find_if(all_.begin(), all_.end(), [](const One& c) { return !c.cut; });
    const auto* socket = MHD_get_connection_info(oldest->connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    if (socket != nullptr) shutdown(socket->connect_fd, SHUT_RDWR);
    oldest->cut = true;
  }
  void has_token(MHD_Connection* connection) {
    for (One& c : all_) c.known = c.known || c.connection == connection;
  }
  void went(MHD_Connection* connection) {
    all_.remove_if([&](const One& c) { return c.connection == connection; });
  }

  static constexpr std::size_t most = 16;

 private:
  struct One {
    MHD_Connection* connection;
    bool known;  ///< it has shown the token
    bool cut;    ///< it is closed as soon as the server looks at it
  };
  std::list<One> all_;
};

struct LivePage::Server {
  fs::path folder;
  std::string token, address;
  MHD_Daemon* daemon = nullptr;
  LiveConnections connections;

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

  /// Paths stay as they were sent: ours have nothing to decode, and %00 would end one.
  static std::size_t as_sent(void* /*self*/, MHD_Connection* /*connection*/, char* text) {
    return std::strlen(text);
  }

  static void notify(void* self, MHD_Connection* connection, void** /*context*/,
                     MHD_ConnectionNotificationCode what) {
    LiveConnections& all = static_cast<Server*>(self)->connections;
    if (what == MHD_CONNECTION_NOTIFY_STARTED) all.came(connection);
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) all.went(connection);
  }

  static MHD_Result handle(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char* /*version*/, const char* /*upload*/, std::size_t* upload_size,
                           void** /*request*/) {
    *upload_size = 0;  // nobody has anything to tell us
    auto& server = *static_cast<Server*>(self);
    const char* host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
    const Answer a =
        host != nullptr && is_this_machine(host)
            ? server.answer(url, method)
            : Answer{.status = MHD_HTTP_FORBIDDEN, .text = "ask for 127.0.0.1, localhost or [::1]\n"};
    if (a.status != MHD_HTTP_FORBIDDEN) server.connections.has_token(connection);
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
  server_->daemon =
      MHD_start_daemon(MHD_USE_INTERNAL_POLLING_THREAD, port, nullptr, nullptr, &Server::handle,
                       server_.get(), MHD_OPTION_SOCK_ADDR, &where, MHD_OPTION_CONNECTION_LIMIT,
                       static_cast<unsigned>(4 * LiveConnections::most), MHD_OPTION_NOTIFY_CONNECTION,
                       &Server::notify, server_.get(), MHD_OPTION_UNESCAPE_CALLBACK, &Server::as_sent,
                       nullptr, MHD_OPTION_CONNECTION_TIMEOUT, 60U, MHD_OPTION_END);
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
