// SPDX-License-Identifier: MIT
// This is the only file that uses Boost.Beast and Boost.Asio.
#include "watch/server.hpp"

#include "record/build_info.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <locale>
#include <optional>
#include <random>
#include <set>
#include <string_view>
#include <utility>

namespace palpate {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

/// pause between two readings of a record, so that pages show a tap within half a second
constexpr std::chrono::milliseconds kLookEvery(100);
constexpr double kLookFor = 0.05;     ///< seconds per reading of a record, during which requests wait
constexpr double kFirstLook = 1.0;    ///< seconds of reading before a page is made; most runs need less
constexpr seconds kAnswerWithin(25);  ///< longest wait of a request for news
/// longest time without data on a connection that sends a request or reads a response
constexpr seconds kMostSilence(10);
constexpr seconds kTokenWithin(5);  ///< time for a connection to present the token
constexpr std::size_t kMaxConnections = 64;
/// largest number of connections that have not presented the token; a new one then replaces the oldest
constexpr std::size_t kMaxUnauthenticated = 16;
constexpr std::uint32_t kMostHeader = 16 * 1024;

/// Returns 128 random bits as hex digits.
std::string random_token() {
  try {
    std::random_device random("/dev/urandom");
    return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
  } catch (const std::exception& trouble) {
    throw Error("watch", std::string("no random numbers: ") + trouble.what());
  }
}

/// Compares in constant time, so that the time reveals no digit of the token.
bool same_in_constant_time(std::string_view said, std::string_view token) {
  if (said.size() != token.size()) return false;
  volatile unsigned char differ = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    differ = static_cast<unsigned char>(differ | static_cast<unsigned char>(said[i] ^ token[i]));
  return differ == 0;
}

/// Returns a Host field without its port, because the port differs behind a tunnel.
std::string host_of(std::string_view text) {
  const auto end = text.rfind(':');
  const bool bare = end == std::string_view::npos || text.find(']', end) != std::string_view::npos;
  std::string_view host = bare ? text : text.substr(0, end);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return boost::algorithm::to_lower_copy(std::string(host), std::locale::classic());
}

struct PageRequest {
  std::string place;              ///< place of the record: see Site::find()
  std::optional<std::string> at;  ///< position of a page that asks for news
  bool now = false;
};

/// Parses the part of an address after the token.
PageRequest parse_request(std::string_view rest) {
  PageRequest out;
  std::string_view query;
  if (const auto mark = rest.find('?'); mark != std::string_view::npos) {
    query = rest.substr(mark + 1);
    rest = rest.substr(0, mark);
  }
  constexpr std::string_view kNews = "news";
  const auto name = rest.rfind('/') + 1;
  if (rest.substr(name) == kNews) {
    out.at.emplace();
    while (!query.empty()) {
      const std::string_view part = query.substr(0, query.find('&'));
      if (part.substr(0, 3) == "at=") out.at = std::string(part.substr(3));
      out.now = out.now || part == "now";
      query.remove_prefix(std::min(query.size(), part.size() + 1));
    }
    rest = rest.substr(0, name);
  }
  out.place = std::string(rest);
  return out;
}

}  // namespace

/// State of the server.
struct Server::Impl {
  class Connection;

  Impl(Site& pages, const ServerOptions& wishes) : site(pages), options(wishes) {}

  void accept();
  void drop_oldest_unauthenticated();
  bool is_own_name(const std::string& host) const;
  void look();
  void look_again_after(Clock::duration wait);
  void check_patience();

  Site& site;
  ServerOptions options;
  std::string token = random_token();
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::signal_set signals{context};
  asio::steady_timer opening{context};
  asio::steady_timer looking{context};
  asio::steady_timer leaving{context};
  std::set<std::shared_ptr<Connection>> connections;
  Clock::time_point last_asked = Clock::now();
};

/// A connection with one request and one response.
class Server::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl& impl, tcp::socket socket) : impl_(impl), stream_(std::move(socket)) {}

  void begin() {
    parser_.header_limit(kMostHeader);
    stream_.expires_after(kTokenWithin);
    // Only the header is read, because no request needs a body.
    http::async_read_header(stream_, buffer_, parser_, [self = shared_from_this()](beast::error_code trouble, auto) {
      if (trouble) return self->close();
      self->answer(self->parser_.get());
    });
  }

  /// Returns whether the connection has not presented the token.
  bool is_unauthenticated() const { return !has_token_; }
  Clock::time_point begun() const { return begun_; }

  /// Returns the record whose news the connection waits for; null if it does not wait.
  const std::shared_ptr<LiveRecord>& waits_for() const { return waits_for_; }

  /// Sends the news. If there were none for kAnswerWithin, sends 204.
  void send_news() {
    if (std::optional<std::string> news = waits_for_->news(at_)) {
      reply(http::status::ok, "application/json", std::move(*news));
    } else if (Clock::now() >= until_) {
      reply(http::status::no_content, "", "");
    }
  }

  void close() {
    waits_for_.reset();
    stream_.close();
    impl_.connections.erase(shared_from_this());
  }

 private:
  void answer(const http::request<http::empty_body>& request) {
    const auto text = [](auto view) { return std::string_view(view.data(), view.size()); };
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed);
    if (request.count(http::field::host) != 1 || !impl_.is_own_name(host_of(text(request[http::field::host]))))
      return refuse(http::status::forbidden);
    std::string_view target = text(request.target());
    target.remove_prefix(!target.empty() && target.front() == '/' ? 1 : 0);
    const std::string_view said = target.substr(0, target.find_first_of("/?"));
    if (!same_in_constant_time(said, impl_.token)) return refuse(http::status::forbidden);
    has_token_ = true;
    target.remove_prefix(said.size());
    if (target.empty() || target.front() != '/') return refuse(http::status::not_found);
    const PageRequest page_request = parse_request(target.substr(1));
    const std::shared_ptr<LiveRecord> watched = impl_.site.find(page_request.place);
    if (!watched) return refuse(http::status::not_found);
    impl_.last_asked = Clock::now();
    if (!page_request.at) {
      watched->look(kFirstLook);
      return reply(http::status::ok, "text/html; charset=utf-8", watched->page());
    }
    at_ = *page_request.at;
    waits_for_ = watched;
    until_ = page_request.now ? Clock::time_point() : Clock::now() + kAnswerWithin;
    stream_.expires_never();
    await_close();
    impl_.look_again_after({});
  }

  void refuse(http::status status) { reply(status, "", ""); }

  void reply(http::status status, const char* type, std::string body) {
    waits_for_.reset();
    response_ = http::response<http::string_body>(status, 11);
    response_.keep_alive(false);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    response_.set("Content-Security-Policy", "frame-ancestors 'none'");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET");
    if (*type != '\0') response_.set(http::field::content_type, type);
    response_.body() = std::move(body);
    if (status != http::status::no_content) response_.prepare_payload();
    stream_.expires_after(kMostSilence);
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code trouble, auto) {
      if (trouble || self->awaits_close_) return self->close();
      // Without this shutdown, unread data, such as the body of a POST, would reset the connection before the client
      // reads the response.
      beast::error_code none;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, none);
      self->stream_.expires_after(kMostSilence);
      self->await_close();
    });
  }

  /// Reads and ignores data until the client closes the connection, then closes it here, too, even if a request still
  /// waits for news.
  void await_close() {
    if (awaits_close_) return;
    awaits_close_ = true;
    stream_.async_read_some(asio::buffer(ignored_), [self = shared_from_this()](beast::error_code trouble, auto) {
      self->awaits_close_ = false;
      if (trouble) return self->close();
      self->await_close();
    });
  }

  Impl& impl_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMostHeader};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  std::array<char, 1024> ignored_{};
  bool awaits_close_ = false;
  bool has_token_ = false;
  Clock::time_point begun_ = Clock::now();
  std::string at_;
  std::shared_ptr<LiveRecord> waits_for_;
  Clock::time_point until_;
};

void Server::Impl::accept() {
  acceptor.async_accept([this](beast::error_code trouble, tcp::socket socket) {
    if (trouble) {  // the most frequent cause is too many open files, which is temporary
      opening.expires_after(kLookEvery);
      opening.async_wait([this](beast::error_code ended) {
        if (!ended) accept();
      });
      return;
    }
    drop_oldest_unauthenticated();
    if (connections.size() < kMaxConnections) {
      const auto connection = std::make_shared<Connection>(*this, std::move(socket));
      connections.insert(connection);
      connection->begin();
    }
    accept();
  });
}

/// Limits the number of connections that have not presented the token, so that they cannot block clients with the
/// token.
void Server::Impl::drop_oldest_unauthenticated() {
  std::shared_ptr<Connection> oldest;
  std::size_t unauthenticated = 0;
  for (const auto& connection : connections) {
    if (!connection->is_unauthenticated()) continue;
    ++unauthenticated;
    if (!oldest || connection->begun() < oldest->begun()) oldest = connection;
  }
  if (oldest && (unauthenticated >= kMaxUnauthenticated || connections.size() >= kMaxConnections)) oldest->close();
}

bool Server::Impl::is_own_name(const std::string& host) const {
  beast::error_code none;
  const auto number = asio::ip::make_address(host, none);
  if (none) return host == "localhost" || (!acceptor.local_endpoint().address().is_loopback() && host == host_name());
  // `host` is the name in the Host header of a request. A numeric address is safe: if a foreign website sends its
  // visitors' browsers here (DNS rebinding), the header contains the name of that website. A server that only listens
  // on a loopback address accepts only loopback addresses.
  return number.is_loopback() || !acceptor.local_endpoint().address().is_loopback();
}

void Server::Impl::look() {
  std::set<std::shared_ptr<LiveRecord>> watched;
  for (const auto& connection : connections) {
    if (connection->waits_for()) watched.insert(connection->waits_for());
  }
  if (watched.empty()) return;
  last_asked = Clock::now();
  bool more = false;
  for (const auto& one : watched) more = one->look(kLookFor) || more;
  for (const auto& connection : std::set<std::shared_ptr<Connection>>(connections)) {
    if (connection->waits_for()) connection->send_news();
  }
  look_again_after(more ? Clock::duration() : kLookEvery);
}

void Server::Impl::look_again_after(Clock::duration wait) {
  looking.expires_after(wait);
  looking.async_wait([this](beast::error_code trouble) {
    if (!trouble) look();
  });
}

void Server::Impl::check_patience() {
  leaving.expires_after(std::min(seconds(5), seconds(options.patience)));
  leaving.async_wait([this](beast::error_code trouble) {
    if (trouble) return;
    if (site.goes_on()) last_asked = Clock::now();
    if (Clock::now() - last_asked >= seconds(options.patience)) return context.stop();
    check_patience();
  });
}

Server::Server(Site& site, const ServerOptions& options) : impl_(std::make_unique<Impl>(site, options)) {
  beast::error_code trouble;
  const auto address = asio::ip::make_address(options.address, trouble);
  if (trouble)
    throw Error("--bind", fmt::format("'{}' is not an address", options.address),
                "write a numeric address, such as 127.0.0.1 or ::1");
  const tcp::endpoint place(address, static_cast<std::uint16_t>(options.port));
  impl_->acceptor.open(place.protocol(), trouble);
  if (!trouble) impl_->acceptor.set_option(tcp::acceptor::reuse_address(true), trouble);
  if (!trouble) impl_->acceptor.bind(place, trouble);
  if (!trouble) impl_->acceptor.listen(tcp::acceptor::max_listen_connections, trouble);
  if (trouble)
    throw Error(fmt::format("{} port {}", options.address, options.port),
                "cannot be opened for listening: " + trouble.message(),
                "choose another --port, or omit it for any free port", Error::Kind::run);
}

Server::~Server() = default;

std::string Server::url() const {
  const tcp::endpoint place = impl_->acceptor.local_endpoint();
  const std::string name = place.address().is_unspecified() && !host_name().empty() ? host_name()
                           : place.address().is_v6() ? "[" + place.address().to_string() + "]"
                                                     : place.address().to_string();
  return fmt::format("http://{}:{}/{}/", name, place.port(), impl_->token);
}

bool Server::is_open_to_others() const { return !impl_->acceptor.local_endpoint().address().is_loopback(); }

void Server::run() {
  Impl& impl = *impl_;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (signal == SIGHUP && std::signal(SIGHUP, SIG_DFL) == SIG_IGN) {
      std::signal(SIGHUP, SIG_IGN);  // nohup has set this
    } else {
      impl.signals.add(signal);
    }
  }
  impl.signals.async_wait([&impl](beast::error_code trouble, int) {
    if (!trouble) impl.context.stop();
  });
  impl.accept();
  if (impl.options.patience > 0) impl.check_patience();
  impl.context.run();
}

}  // namespace palpate
