// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/live_server.h"

#ifndef PROSPECT_WITH_BEAST
#include "adapters/formats/files/not_built_in.h"
#else
// Boost 1.74 uses std::exchange without its header.
#include <utility>
// In this order.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/views/live/access.h"
#include "adapters/views/live/foxglove_protocol.h"
#include "adapters/views/live/foxglove_show.h"
#include "adapters/views/live/live_page.h"
#include "adapters/views/live/page_show.h"
#include "adapters/views/live/viewer.h"
#endif

namespace prospect {

#ifdef PROSPECT_WITH_BEAST

namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = net::ip::tcp;
using ErrorCode = beast::error_code;
using std::chrono::milliseconds;

constexpr milliseconds kLook(50);       // between two looks into the feed
constexpr milliseconds kFarewell(500);  // for what is left at the end
constexpr std::size_t kLongestHeader = 8192;
constexpr std::size_t kRequests = 32;  // that are not answered yet, at a time

milliseconds in_ms(double seconds) { return milliseconds(std::llround(1e3 * seconds)); }

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

std::string machine_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// What all connections share; of the server's thread.
struct Server {
  LiveOptions options;
  std::string page;
  std::string machine;
  std::function<std::unique_ptr<Viewer>(std::string_view protocol, bool may_command)> make_viewer;
  std::vector<std::weak_ptr<class Socket>> sockets;    // the oldest first
  std::vector<std::weak_ptr<class Request>> requests;  // likewise
  std::uint64_t dropped = 0;                           // of viewers that have gone

  std::vector<std::shared_ptr<class Socket>> open_sockets();
  /// A place for one more viewer. Who only watches may find none; who may command takes that of the
  /// oldest who may.
  bool has_room(bool may_command);
  /// For one more request: the address with most of them loses its oldest, one that has not come
  /// whole before one that has. So who opens many connections shuts nobody out but others there.
  void make_room_for_request();
};

/// A viewer's WebSocket.
class Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream&& stream, Server& server, std::unique_ptr<Viewer> viewer,
         bool may_command)
      : stream_(std::move(stream)),
        server_(server),
        viewer_(std::move(viewer)),
        may_command_(may_command) {}
  ~Socket() { server_.dropped += viewer_->dropped(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void run(http::request<http::empty_body> request, std::string_view protocol) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = in_ms(server_.options.request_timeout);
    timeout.idle_timeout = in_ms(server_.options.idle_timeout);
    timeout.keep_alive_pings = true;
    stream_.set_option(timeout);
    stream_.read_message_max(server_.options.longest_message);
    stream_.auto_fragment(false);
    stream_.set_option(websocket::stream_base::decorator(
        [chosen = std::string(protocol)](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, chosen);
        }));
    request_ = std::move(request);
    stream_.async_accept(request_, [self = shared_from_this()](ErrorCode error) {
      if (error) return self->close();
      self->open_ = true;
      self->read();
      self->pump();
    });
  }

  /// Sends what there is to say, unless something is on its way.
  void pump() {
    if (!open_ || writing_) return;
    std::optional<LiveMessage> message = viewer_->next();
    if (!message) return;
    writing_ = true;
    going_ = std::move(*message);
    stream_.binary(going_.binary);
    stream_.async_write(net::buffer(*going_.bytes),
                        [self = shared_from_this()](ErrorCode error, std::size_t) {
                          self->writing_ = false;
                          if (error) return self->close();
                          self->pump();
                        });
  }

  bool idle() const { return !writing_; }
  bool may_command() const { return may_command_; }
  bool closed() const { return closed_; }
  std::uint64_t dropped() const { return viewer_->dropped(); }
  void close() {
    open_ = false;
    closed_ = true;
    beast::get_lowest_layer(stream_).cancel();
    ErrorCode ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
  }

 private:
  void read() {
    stream_.async_read(in_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error || !self->open_) return self->close();
      const std::string bytes = beast::buffers_to_string(self->in_.data());
      self->in_.consume(self->in_.size());
      if (!self->viewer_->message(bytes, self->stream_.got_text())) return self->close();
      self->pump();
      self->read();
    });
  }

  websocket::stream<beast::tcp_stream> stream_;
  Server& server_;
  std::unique_ptr<Viewer> viewer_;
  http::request<http::empty_body> request_;
  beast::flat_buffer in_;
  LiveMessage going_;
  const bool may_command_;
  bool open_ = false, writing_ = false, closed_ = false;
};

std::vector<std::shared_ptr<Socket>> Server::open_sockets() {
  std::vector<std::shared_ptr<Socket>> open;
  std::erase_if(sockets, [](const std::weak_ptr<Socket>& socket) { return socket.expired(); });
  for (const std::weak_ptr<Socket>& socket : sockets) {
    if (auto there = socket.lock(); there && !there->closed()) open.push_back(std::move(there));
  }
  return open;
}

bool Server::has_room(bool may_command) {
  std::vector<std::shared_ptr<Socket>> alike = open_sockets();
  std::erase_if(alike, [&](const auto& socket) { return socket->may_command() != may_command; });
  if (alike.size() < (may_command ? options.commanders : options.viewers)) return true;
  if (may_command) alike.front()->close();
  return may_command;
}

/// One request: answered, or made a WebSocket.
class Request : public std::enable_shared_from_this<Request> {
 public:
  Request(Tcp::socket&& socket, Server& server) : stream_(std::move(socket)), server_(server) {
    parser_.header_limit(kLongestHeader);
    parser_.body_limit(0);
    ErrorCode gone;
    address_ = stream_.socket().remote_endpoint(gone).address();
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

  const net::ip::address& address() const { return address_; }
  /// It has come, and is being answered.
  bool whole() const { return whole_; }
  void close() {
    closed_ = true;
    stream_.close();
  }

  void run() {
    stream_.expires_after(in_ms(server_.options.request_timeout));
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](ErrorCode error, std::size_t) {
                       if (self->closed_) return;
                       self->whole_ = true;
                       if (!error) return self->take();
                       // Who sends what is no request is told so; who has gone is not.
                       if (error == http::error::end_of_stream || error == net::error::eof ||
                           error == beast::error::timeout) {
                         return;
                       }
                       self->answer(http::status::bad_request, "this is no request");
                     });
  }

 private:
  void take() {
    const auto& request = parser_.get();
    const std::string_view host = view_of(request[http::field::host]);
    const std::string_view target = view_of(request.target());
    const std::string_view path = target.substr(0, target.find('?'));
    if (!is_own_host(host, server_.machine)) {
      return answer(http::status::forbidden,
                    "Host: not this machine's; expected an address, localhost or its own name");
    }
    if (websocket::is_upgrade(request)) return upgrade(host, target);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return answer(http::status::method_not_allowed, "expected GET");
    }
    if (path != "/") return answer(http::status::not_found, "there is nothing but /");
    respond(http::status::ok, "text/html; charset=utf-8", server_.page);
  }

  void upgrade(std::string_view host, std::string_view target) {
    const auto& request = parser_.get();
    const std::string_view token = query_value(target, "token");
    const bool may_command = same_token(token, server_.options.token);
    if (!token.empty() && !may_command) {
      return answer(http::status::forbidden,
                    "token: wrong; expected the one that was printed at the start, or none");
    }
    const std::string_view origin = view_of(request[http::field::origin]);
    if (!origin.empty() && !may_command && !is_same_origin(origin, host)) {
      return answer(http::status::forbidden,
                    "Origin: another page's; expected this server's own, or the token");
    }
    const std::string_view offered = view_of(request[http::field::sec_websocket_protocol]);
    const std::optional<std::string_view> protocol = chosen(offered);
    if (!protocol) {
      return answer(http::status::bad_request,
                    "Sec-WebSocket-Protocol: none that is spoken here; expected " +
                        std::string(kPageProtocol) + ", " + std::string(foxglove::kProtocols[0]) +
                        " or " + std::string(foxglove::kProtocols[1]));
    }
    if (!server_.has_room(may_command)) {
      return answer(http::status::service_unavailable,
                    "there are as many viewers as there may be without the token, " +
                        std::to_string(server_.options.viewers));
    }
    stream_.expires_never();
    http::request<http::empty_body> upgraded = parser_.release();
    auto socket = std::make_shared<Socket>(
        std::move(stream_), server_, server_.make_viewer(*protocol, may_command), may_command);
    server_.sockets.push_back(socket);
    socket->run(std::move(upgraded), *protocol);
  }

  static std::optional<std::string_view> chosen(std::string_view offered) {
    for (const std::string_view known :
         {kPageProtocol, foxglove::kProtocols[0], foxglove::kProtocols[1]}) {
      for (std::string_view rest = offered; !rest.empty();) {
        const std::size_t comma = rest.find(',');
        std::string_view name = rest.substr(0, comma);
        while (name.starts_with(' ')) name.remove_prefix(1);
        while (name.ends_with(' ')) name.remove_suffix(1);
        if (name == known) return known;
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
      }
    }
    return std::nullopt;
  }

  void answer(http::status status, const std::string& line) {
    respond(status, "text/plain; charset=utf-8", line + '\n');
  }

  void respond(http::status status, std::string_view type, const std::string& body) {
    response_.result(status);
    response_.version(11);
    response_.keep_alive(false);
    const auto set = [this](auto name, std::string_view value) {
      response_.set(name, beast::string_view(value.data(), value.size()));
    };
    set(http::field::content_type, type);
    set(http::field::cache_control, "no-store");
    set(http::field::x_frame_options, "DENY");
    set("X-Content-Type-Options", "nosniff");
    set("Referrer-Policy", "no-referrer");
    set("Content-Security-Policy", "frame-ancestors 'none'");
    response_.body() = body;
    response_.prepare_payload();
    if (parser_.get().method() == http::verb::head) response_.body().clear();
    stream_.expires_after(in_ms(server_.options.request_timeout));
    http::async_write(stream_, response_, [self = shared_from_this()](ErrorCode, std::size_t) {
      ErrorCode ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  Server& server_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  net::ip::address address_;
  bool whole_ = false, closed_ = false;
};

void Server::make_room_for_request() {
  std::erase_if(requests, [](const std::weak_ptr<Request>& request) { return request.expired(); });
  if (requests.size() < kRequests) return;
  std::vector<std::shared_ptr<Request>> waiting;
  std::map<net::ip::address, int> of_address;
  for (const std::weak_ptr<Request>& request : requests) {
    if (auto there = request.lock()) waiting.push_back(std::move(there));
  }
  for (const auto& request : waiting) ++of_address[request->address()];
  const auto most = std::max_element(of_address.begin(), of_address.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  std::erase_if(waiting, [&](const auto& r) { return r->address() != most->first; });
  const auto half =
      std::find_if(waiting.begin(), waiting.end(), [](auto& r) { return !r->whole(); });
  const std::shared_ptr<Request> leaves = half != waiting.end() ? *half : waiting.front();
  leaves->close();
  std::erase_if(requests, [&](const std::weak_ptr<Request>& r) { return r.lock() == leaves; });
}

[[noreturn]] void refuse_host(const std::string& host) {
  throw InputError("--live-host: '" + host +
                   "'; expected the address of an interface of this machine, such as 127.0.0.1, "
                   "or 0.0.0.0 for all");
}

net::ip::address address_of(const std::string& host) {
  ErrorCode error;
  const net::ip::address address =
      host == "localhost" ? net::ip::make_address("127.0.0.1") : net::ip::make_address(host, error);
  if (error) refuse_host(host);
  return address;
}

}  // namespace

struct LiveServer::Impl {
  Impl(const LiveOptions& options, const LiveMission& mission, LiveFeed& its_feed,
       DriveRequests& requests)
      : commands(requests),
        page(mission.start.resolution, mission.real_time, commands),
        messages(mission.messages, commands),
        feed(its_feed),
        acceptor(context),
        timer(context) {
    server.options = options;
    if (server.options.token.empty()) {
      server.options.token = make_token();
    } else if (const std::string fault = token_fault(options.token); !fault.empty()) {
      throw InputError("--live-token: " + fault);
    }
    server.machine = machine_name();
    server.page = live_page(mission.start);
    server.make_viewer = [this](std::string_view protocol, bool may_command) {
      return protocol == kPageProtocol ? page.viewer(may_command) : messages.viewer(may_command);
    };
    listen();
    accept();
    look();
    thread = std::thread([this] { run(); });
  }

  void listen() {
    const net::ip::address address = address_of(server.options.host);
    const Tcp::endpoint endpoint(address, static_cast<unsigned short>(server.options.port));
    ErrorCode error;
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
    if (error == boost::system::errc::address_not_available) refuse_host(server.options.host);
    if (error) {
      throw InputError("--live " + std::to_string(server.options.port) + ": " +
                       server.options.host + " cannot be listened on (" + error.message() +
                       "); expected a free port of this machine");
    }
    port = acceptor.local_endpoint().port();
  }

  void accept() {
    acceptor.async_accept([this](ErrorCode error, Tcp::socket socket) {
      if (ending) return;
      if (error) {
        // Out of descriptors, such as: the next look accepts again.
        accept_again = true;
        return;
      }
      server.make_room_for_request();
      const auto request = std::make_shared<Request>(std::move(socket), server);
      server.requests.push_back(request);
      request->run();
      accept();
    });
  }

  /// Shows what has come, again and again.
  void look() {
    if (std::exchange(accept_again, false)) accept();
    show_news();
    timer.expires_after(kLook);
    timer.async_wait([this](ErrorCode error) {
      if (!error && !ending) look();
    });
  }

  void show_news() {
    const auto sockets = server.open_sockets();
    const LiveFeed::News news = feed.take(!sockets.empty());
    page.add(news);
    messages.add(news);
    ViewerCounts counts{sockets.size(), server.dropped};
    for (const auto& socket : sockets) counts.dropped += socket->dropped();
    page.count(counts);
    for (const auto& socket : sockets) socket->pump();
  }

  void run() {
    for (;;) {
      try {
        context.run();
        return;
      } catch (const std::exception&) {
        // Of one connection, whose handler ends with it: out of memory. The others go on.
      }
    }
  }

  /// Once the thread is asked to: what is left goes out, then all is closed.
  void farewell(std::chrono::steady_clock::time_point end) {
    show_news();
    const auto sockets = server.open_sockets();
    const bool all_idle =
        std::all_of(sockets.begin(), sockets.end(), [](const auto& s) { return s->idle(); });
    if (all_idle || std::chrono::steady_clock::now() >= end) {
      for (const auto& socket : sockets) socket->close();
      context.stop();
      return;
    }
    timer.expires_after(milliseconds(10));
    timer.async_wait([this, end](ErrorCode) { farewell(end); });
  }

  ~Impl() {
    net::post(context, [this] {
      ending = true;
      ErrorCode ignored;
      acceptor.close(ignored);
      timer.cancel();
      farewell(std::chrono::steady_clock::now() + kFarewell);
    });
    thread.join();
  }

  DriveCommands commands;
  PageShow page;
  FoxgloveShow messages;
  LiveFeed& feed;
  Server server;
  net::io_context context{1};
  Tcp::acceptor acceptor;
  net::steady_timer timer;
  int port = 0;
  bool ending = false, accept_again = false;
  std::thread thread;
};

LiveServer::LiveServer(const LiveOptions& options, const LiveMission& mission, LiveFeed& feed,
                       DriveRequests& requests)
    : impl_(std::make_unique<Impl>(options, mission, feed, requests)) {}
LiveServer::~LiveServer() = default;

int LiveServer::port() const { return impl_->port; }
std::string LiveServer::url() const {
  const std::string& host = impl_->server.options.host;
  const bool all = host == "0.0.0.0" || host == "::";
  const std::string name = all                                   ? "127.0.0.1"
                           : host.find(':') == std::string::npos ? host
                                                                 : "[" + host + "]";
  return "http://" + name + ":" + std::to_string(impl_->port) +
         "/?token=" + impl_->server.options.token;
}

#else

struct LiveServer::Impl {};
LiveServer::LiveServer(const LiveOptions&, const LiveMission&, LiveFeed&, DriveRequests&) {
  throw NotBuiltIn("the live view", "Boost.Beast (libboost-dev)");
}
LiveServer::~LiveServer() = default;
int LiveServer::port() const { return 0; }
std::string LiveServer::url() const { return ""; }

#endif

}  // namespace prospect
