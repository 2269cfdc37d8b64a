// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/web_server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <deque>
#include <optional>

#include "capstan/tools/console_server/backlog.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using Request = http::request<http::string_body>;

constexpr std::chrono::seconds kRequestWithin{10};
constexpr std::string_view kFoxglove = "foxglove";
constexpr std::string_view kFoxglovePage = "https://app.foxglove.dev";
constexpr std::string_view kDiagnose = "diagnose/";  // and the axis, and perhaps the column to explain
constexpr std::string_view kIdentify = "identify/";  // and the axis and the model
constexpr std::string_view kTune = "tune/";          // and the axis, and perhaps a bandwidth

auto view(beast::string_view text) -> std::string_view {
  return {text.data(), text.size()};
}
auto view(const beast::flat_buffer& buffer) -> std::string_view {
  return {static_cast<const char*>(buffer.data().data()), buffer.size()};
}

/// What the page may do: its own files, its own worker, this server; nothing inline, and in nobody's frame.
auto content_policy(std::string_view host) -> std::string {
  return "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src blob:; style-src 'self'; img-src "
         "'self'; "
         "connect-src 'self' ws://" +
         std::string(host) + "; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}
auto is_job(std::string_view place) -> bool {
  return place.starts_with(kDiagnose) || place.starts_with(kIdentify) || place.starts_with(kTune);
}

/// A report has its style within itself, and runs nothing.
constexpr const char* kReportPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'; sandbox";
constexpr const char* kPlain = "text/plain; charset=utf-8";

/// Bytes of the board that a page has worked through, by its word; nothing where it is another word.
auto taken(std::string_view word) -> std::optional<std::size_t> {
  constexpr std::string_view kTook = "took ";
  std::size_t count = 0;
  const char* const end = word.data() + word.size();
  return word.starts_with(kTook) && std::from_chars(word.data() + kTook.size(), end, count).ptr == end
             ? std::optional(count)
             : std::nullopt;
}

auto caller_of(const Request& request) -> Caller {
  const auto origin = request.find(http::field::origin);
  return {view(request[http::field::host]),
          origin == request.end() ? std::nullopt : std::optional(view(origin->value())), view(request.target())};
}

}  // namespace

/// What every visitor needs; lives as long as the last of them.
struct WebServer::Shop : std::enable_shared_from_this<Shop> {
  Shop(asio::io_context& io, PageFiles page, Talk& board_talk, LogJob& log_job, WebServer::Reports left)
      : acceptor(io), files(std::move(page)), board(board_talk), job(log_job), reports(std::move(left)) {}
  void accept();

  tcp::acceptor acceptor;
  PageFiles files;
  Talk& board;
  LogJob& job;
  WebServer::Reports reports;
  FoxgloveFeed* foxglove = nullptr;
  std::optional<Door> door;
};

namespace {

/// One page's WebSocket.
template <class Shop>
class PageSocket final : public Guest, public std::enable_shared_from_this<PageSocket<Shop>> {
 public:
  /// @param stream_of_bytes  the other side does not mind where a message ends, and says "took BYTES" of what it has
  /// worked through; of others, what was sent counts as taken
  PageSocket(beast::tcp_stream&& stream, std::shared_ptr<Shop> shop, Talk& talk, bool stream_of_bytes)
      : socket_(std::move(stream)), shop_(std::move(shop)), talk_(talk), stream_of_bytes_(stream_of_bytes) {}

  /// @param subprotocol  that both speak, or nothing
  void begin(const Request& request, std::string_view subprotocol) {
    socket_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      if (!subprotocol.empty()) {
        response.set(http::field::sec_websocket_protocol, beast::string_view(subprotocol.data(), subprotocol.size()));
      }
    }));
    beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has timeouts of its own
    socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    constexpr std::size_t kMostAtOnce = std::size_t{64} * 1024;
    socket_.read_message_max(kMostAtOnce);
    // A read ends only once the peer has closed its side of the line too, which one that is stuck never does.
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind == websocket::frame_type::close) {
        leave();
      }
    });
    socket_.async_accept(request, [self = this->shared_from_this()](const error_code& error) {
      if (!error) {
        self->there_ = true;
        self->talk_.join(*self, Hub::Clock::now());
        self->read();
      }
    });
  }
  void bytes(std::string_view bytes) override { queue(std::string(bytes), false); }
  void say(std::string_view words) override { queue(std::string(words), true); }
  [[nodiscard]] auto behind() const -> bool override { return backlog_.behind(Hub::Clock::now()); }

 private:
  static constexpr std::size_t kMostInMessage = std::size_t{64} * 1024;
  struct Message {
    std::string body;
    bool text = false;
  };

  void read() {
    socket_.async_read(in_, [self = this->shared_from_this()](const error_code& error, std::size_t) {
      if (error) {
        self->leave();
        return;
      }
      if (!self->socket_.got_text()) {
        self->talk_.bytes(*self, view(self->in_));
      } else if (const auto took = taken(view(self->in_)); took && self->stream_of_bytes_) {
        self->backlog_.take(*took, Hub::Clock::now());
      } else {
        self->talk_.word(*self, view(self->in_), Hub::Clock::now());
      }
      self->in_.consume(self->in_.size());
      self->read();
    });
  }
  void queue(std::string body, bool text) {
    if (!backlog_.has_room_for(body.size())) {
      beast::get_lowest_layer(socket_).cancel();  // a page that takes nothing any more; read() ends with it
      return;
    }
    if (!stream_of_bytes_ || !text) {
      backlog_.add(body.size(), Hub::Clock::now());
    }
    if (stream_of_bytes_ && waiting_.size() > 1 && !text && !waiting_.back().text &&
        waiting_.back().body.size() < kMostInMessage) {
      waiting_.back().body += body;  // a browser takes a few large messages more easily than many small ones
      return;
    }
    waiting_.push_back({std::move(body), text});
    if (waiting_.size() == 1) {
      write();
    }
  }
  void write() {
    socket_.text(waiting_.front().text);
    socket_.async_write(asio::buffer(waiting_.front().body),
                        [self = this->shared_from_this()](const error_code& error, std::size_t count) {
                          if (error) {
                            self->leave();
                            return;
                          }
                          if (!self->stream_of_bytes_) {
                            self->backlog_.take(count, Hub::Clock::now());
                          }
                          self->waiting_.pop_front();
                          if (!self->waiting_.empty()) {
                            self->write();
                          }
                        });
  }
  void leave() {
    if (there_) {
      there_ = false;
      talk_.leave(*this);
    }
  }

  websocket::stream<beast::tcp_stream> socket_;
  std::shared_ptr<Shop> shop_;
  Talk& talk_;
  bool stream_of_bytes_;
  beast::flat_buffer in_;
  std::deque<Message> waiting_;
  Backlog backlog_;
  bool there_ = false;
};

/// One request, answered or handed on to a WebSocket.
template <class Shop>
class Visitor : public std::enable_shared_from_this<Visitor<Shop>> {
 public:
  Visitor(tcp::socket&& socket, std::shared_ptr<Shop> shop) : stream_(std::move(socket)), shop_(std::move(shop)) {}

  void begin() {
    stream_.expires_after(kRequestWithin);
    constexpr std::uint64_t kMostLog = std::uint64_t{64} * 1024 * 1024;
    parser_.body_limit(kMostLog);
    http::async_read_header(stream_, in_, parser_,
                            [self = this->shared_from_this()](const error_code& error, std::size_t) {
                              if (error == http::error::body_limit) {
                                self->too_large();
                              } else if (!error) {
                                self->judge();
                              }
                            });
  }

 private:
  void judge() {
    const Request& request = parser_.get();
    const Caller caller = caller_of(request);
    const bool talks = websocket::is_upgrade(request);
    const bool acts = talks || request.method() != http::verb::get;
    if (talks && shop_->foxglove != nullptr && shop_->door->behind_token(caller.target) == kFoxglove) {
      show_signals(request, caller);
      return;
    }
    const Entry entry = acts ? shop_->door->for_acting(caller) : shop_->door->for_reading(caller);
    if (entry != Entry::kComeIn) {
      answer(http::status::forbidden, {kPlain, std::string(sentence(entry))});
      return;
    }
    const std::string_view place = *shop_->door->behind_token(caller.target);
    if (talks && place == "board") {
      std::make_shared<PageSocket<Shop>>(std::move(stream_), shop_, shop_->board, true)->begin(request, {});
    } else if (request.method() == http::verb::post && is_job(place)) {
      read_log(std::string(place));
    } else if (talks || request.method() != http::verb::get) {
      answer(http::status::method_not_allowed, {kPlain, "the page's files can only be read\n"});
    } else {
      give(place);
    }
  }

  void show_signals(const Request& request, const Caller& caller) {
    const Entry entry = shop_->door->for_looking(caller, kFoxglovePage);
    if (entry != Entry::kComeIn) {
      answer(http::status::forbidden, {kPlain, std::string(sentence(entry))});
    } else if (!http::token_list(request[http::field::sec_websocket_protocol])
                    .exists(FoxgloveFeed::kSubprotocol.data())) {
      answer(http::status::bad_request,
             {kPlain, "only foxglove.websocket.v1 is spoken here; use a Foxglove that knows it\n"});
    } else {
      std::make_shared<PageSocket<Shop>>(std::move(stream_), shop_, *shop_->foxglove, false)
          ->begin(request, FoxgloveFeed::kSubprotocol);
    }
  }

  void give(std::string_view place) {
    const auto file = shop_->files.find(place);
    const auto report = shop_->reports(place);
    if (report) {
      answer(http::status::ok, {"text/html; charset=utf-8", *report}, kReportPolicy);
    } else if (file == shop_->files.end()) {
      answer(http::status::not_found, {kPlain, "the console has nothing of that name\n"});
    } else {
      answer(http::status::ok, file->second);
    }
  }

  /// @param place  what is to be done with it
  void read_log(const std::string& place) {
    http::async_read(stream_, in_, parser_,
                     [self = this->shared_from_this(), place](const error_code& error, std::size_t) {
                       if (error == http::error::body_limit) {
                         self->too_large();
                       } else if (!error) {
                         self->look_at_log(place);
                       }
                     });
  }
  void too_large() {
    answer(http::status::payload_too_large,
           {kPlain, "the log is larger than 64 MB; use 'capstan diagnose', 'identify' or 'tune'\n"});
  }
  void look_at_log(const std::string& place) {
    stream_.expires_never();
    const auto done = [self = this->shared_from_this()](std::string found) {
      self->answer(http::status::ok, {"application/json", std::move(found)});
    };
    const std::string& log = parser_.get().body();
    const auto behind = [&place](std::string_view job) { return std::string_view(place).substr(job.size()); };
    const bool begun = place.starts_with(kTune)       ? shop_->job.tune(log, behind(kTune), done)
                       : place.starts_with(kIdentify) ? shop_->job.identify(log, behind(kIdentify), done)
                                                      : shop_->job.diagnose(log, behind(kDiagnose), done);
    if (!begun) {
      answer(http::status::conflict, {kPlain, "the host program is busy with another log; wait for it\n"});
    }
  }

  void answer(http::status status, const PageFile& what, const char* policy = nullptr) {
    const Request& request = parser_.get();
    response_.result(status);
    response_.version(request.version());
    response_.keep_alive(false);
    response_.set(http::field::content_type, what.type);
    response_.set("Content-Security-Policy",
                  policy != nullptr ? policy : content_policy(view(request[http::field::host])));
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set(http::field::cache_control, "no-store");
    response_.body() = what.body;
    response_.prepare_payload();
    stream_.expires_after(kRequestWithin);
    http::async_write(stream_, response_, [self = this->shared_from_this()](const error_code&, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  std::shared_ptr<Shop> shop_;
  beast::flat_buffer in_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

void WebServer::Shop::accept() {
  acceptor.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) {
      return;
    }
    if (!error) {
      std::make_shared<Visitor<Shop>>(std::move(socket), self)->begin();
    }
    self->accept();
  });
}

WebServer::WebServer(asio::io_context& io, std::uint16_t port, PageFiles files, Talk& board, LogJob& job,
                     Reports reports)
    : shop_(std::make_shared<Shop>(io, std::move(files), board, job, std::move(reports))) {
  const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
  error_code error;
  shop_->acceptor.open(endpoint.protocol());
  shop_->acceptor.set_option(asio::socket_base::reuse_address(true));
  shop_->acceptor.bind(endpoint, error);
  if (error) {
    throw BadInput("--listen " + std::to_string(port) + ": the port cannot be opened (" + error.message() +
                   "); give another one, or leave it out for any that is free");
  }
  shop_->acceptor.listen();
  shop_->door.emplace(shop_->acceptor.local_endpoint().port(), random_token());
  shop_->accept();
}

WebServer::~WebServer() {
  error_code ignored;
  shop_->acceptor.close(ignored);
}

auto WebServer::show_signals(FoxgloveFeed& feed) -> std::string {
  shop_->foxglove = &feed;
  return "ws" + address().substr(std::string_view("http").size()) + std::string(kFoxglove);
}

auto WebServer::address() const -> std::string {
  return shop_->door->address();
}

}  // namespace capstan::tools
