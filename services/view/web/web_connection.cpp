#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "view/web/web_client.hpp"
#include "view/web/web_loop.hpp"

namespace tact::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using Response = http::response<http::string_body>;

constexpr auto kTimeout = std::chrono::seconds(10);
constexpr std::uint32_t kMaxHeader = 8192;
// Little waits in the kernel for a slow client, so that what it gets is recent.
constexpr int kSendBuffer = 96 * 1024;

std::string_view view(beast::string_view s) { return {s.data(), s.size()}; }

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(WebLoop& loop, boost::asio::ip::tcp::socket socket)
      : loop_(loop), seat_(std::make_shared<Seat>(loop.connections)), stream_(std::move(socket)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    stream_.expires_after(kTimeout);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error == http::error::end_of_stream || error == beast::error::timeout) return;
      if (error) return self->refuse(http::status::bad_request, "This is not a request the viewer understands.\n");
      self->answer(self->parser_->release());
    });
  }

 private:
  void answer(HttpRequest request) {
    const std::string_view target = view(request.target());
    const Request asked{target, view(request[http::field::host]), view(request[http::field::origin]),
                        view(request[http::field::cookie])};
    const Access::Verdict verdict = loop_.access.judge(asked);
    if (verdict == Access::Verdict::refused) {
      return refuse(
          http::status::forbidden,
          "Tact: this address needs the token that was printed when the session started: http://.../?token=...\n");
    }
    if (path_of(target) == "/ws") {
      if (!beast::websocket::is_upgrade(request))
        return refuse(http::status::upgrade_required, "This address speaks WebSocket.\n");
      if (loop_.client_count >= loop_.options.max_clients)
        return refuse(http::status::service_unavailable, "Too many viewers; try again later.\n");
      return std::make_shared<WebClient>(loop_, std::move(stream_), seat_, verdict == Access::Verdict::control)
          ->accept(std::move(request));
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return refuse(http::status::method_not_allowed, "GET only.\n");
    }
    const PageFiles::File* file = loop_.files.find(path_of(target));
    if (file == nullptr) return refuse(http::status::not_found, "No such page.\n");
    response_ = Response{http::status::ok, request.version()};
    response_.set(http::field::content_type, file->type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", "default-src 'self'; img-src 'self' blob: data:; frame-ancestors 'none'");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");  // the address may hold the token
    if (loop_.access.token_in_query(target)) {
      response_.set(http::field::set_cookie,
                    loop_.access.cookie_name + "=" + loop_.access.token + "; Path=/; HttpOnly; SameSite=Strict");
    }
    response_.keep_alive(request.keep_alive());
    response_.body() = file->content;
    response_.prepare_payload();
    if (request.method() == http::verb::head) response_.body().clear();
    write();
  }

  void refuse(http::status status, const char* text) {
    response_ = Response{status, 11};
    response_.set(http::field::content_type, "text/plain; charset=utf-8");
    response_.keep_alive(false);
    response_.body() = text;
    response_.prepare_payload();
    write();
  }

  void write() {
    stream_.expires_after(kTimeout);
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return;
      if (self->response_.keep_alive()) return self->read();
      self->stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, error);
    });
  }

  WebLoop& loop_;
  std::shared_ptr<Seat> seat_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMaxHeader + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
};

}  // namespace

void serve_connection(WebLoop& loop, boost::asio::ip::tcp::socket socket) {
  beast::error_code ignored;
  socket.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  socket.set_option(boost::asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  std::make_shared<Connection>(loop, std::move(socket))->read();
}

}  // namespace tact::view
