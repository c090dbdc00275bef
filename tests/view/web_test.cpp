#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <condition_variable>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "fault/fault.hpp"
#include "view/web/access.hpp"
#include "view/web/outbox.hpp"
#include "view/web/web_server.hpp"

namespace tact::view {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;
using Verdict = Access::Verdict;

const char* const kToken = "0123456789abcdef";

TEST(Access, TokensAreCompared) {
  EXPECT_TRUE(same_token("abc", "abc"));
  EXPECT_FALSE(same_token("abd", "abc"));
  EXPECT_FALSE(same_token("ab", "abc"));
  EXPECT_FALSE(same_token("", ""));
  EXPECT_NE(make_token(), make_token());
  EXPECT_EQ(make_token().size(), 32u);
}

TEST(Access, OnLoopbackEverybodyMayWatchAndTheTokenControls) {
  const Access access{kToken, "c", true};
  EXPECT_EQ(access.judge({"/ws", "127.0.0.1:8080", "", ""}), Verdict::watch);
  EXPECT_EQ(access.judge({"/ws?token=wrong", "localhost:8080", "", ""}), Verdict::watch);
  EXPECT_EQ(access.judge({"/ws?a=b&token=0123456789abcdef", "localhost:8080", "", ""}), Verdict::control);
  EXPECT_EQ(access.judge({"/ws", "[::1]:8080", "", "x=y; c=0123456789abcdef"}), Verdict::control);
  EXPECT_EQ(access.judge({"/ws", "localhost", "", "d=0123456789abcdef"}), Verdict::watch);
}

TEST(Access, ElsewhereEverythingNeedsTheToken) {
  const Access access{kToken, "c", false};
  EXPECT_EQ(access.judge({"/", "10.0.0.1:8080", "", ""}), Verdict::refused);
  EXPECT_EQ(access.judge({"/", "127.0.0.1:8080", "", ""}), Verdict::refused);
  EXPECT_EQ(access.judge({"/?token=0123456789abcdef", "10.0.0.1:8080", "", ""}), Verdict::control);
}

TEST(Access, PagesOfOtherSitesAreRefused) {
  const Access access{kToken, "c", true};
  EXPECT_EQ(access.judge({"/ws", "127.0.0.1:8080", "http://evil.example", "c=0123456789abcdef"}), Verdict::refused);
  EXPECT_EQ(access.judge({"/ws", "127.0.0.1:8080", "null", ""}), Verdict::refused);
  EXPECT_EQ(access.judge({"/ws", "127.0.0.1:8080", "http://127.0.0.1:8080", ""}), Verdict::watch);
  // A foreign name that was pointed at this machine.
  EXPECT_EQ(access.judge({"/ws", "evil.example:8080", "http://evil.example:8080", ""}), Verdict::refused);
}

Payload payload(const std::string& text) { return std::make_shared<const std::string>(text); }

TEST(Outbox, EventsComeFirstInOrderAndOfEachSlotTheNewest) {
  Outbox box(8);
  box.put(Slot::picture, payload("old"));
  box.put(Slot::picture, payload("new"));
  box.put(Slot::status, payload("status"));
  EXPECT_TRUE(box.push_event(payload("one")));
  EXPECT_TRUE(box.push_event(payload("two")));
  std::vector<std::string> seen;
  while (auto item = box.next()) seen.push_back(*item->payload + (item->binary ? "!" : ""));
  EXPECT_EQ(seen, (std::vector<std::string>{"one", "two", "status", "new!"}));
}

TEST(Outbox, ABusySlotDoesNotStarveTheOthers) {
  Outbox box(8);
  std::map<std::string, int> seen;
  box.put(Slot::strips, payload("strips"));
  for (int i = 0; i < 5; ++i) {
    box.put(Slot::picture, payload("picture"));
    ++seen[*box.next()->payload];
  }
  EXPECT_EQ(seen["strips"], 1);
}

TEST(Outbox, SaysWhenTooManyEventsWait) {
  Outbox box(2);
  EXPECT_TRUE(box.push_event(payload("1")));
  EXPECT_TRUE(box.push_event(payload("2")));
  EXPECT_FALSE(box.push_event(payload("3")));
}

/// A server with a page of two files and a record of what its clients did.
class WebServerTest : public ::testing::Test {
 protected:
  WebServerTest() {
    options.page = std::filesystem::temp_directory_path() / ("tact_page_" + std::to_string(getpid()));
    std::filesystem::create_directories(options.page / "sub");
    std::ofstream(options.page / "index.html") << "<p>hello</p>";
    std::ofstream(options.page / "app.js") << "let a;";
    std::ofstream(options.page / "sub" / "secret") << "secret";
    options.port = 0;
    options.token = kToken;
  }
  ~WebServerTest() override {
    server.reset();
    std::filesystem::remove_all(options.page);
  }

  void start() {
    WebHandlers handlers;
    handlers.joined = [this](ClientId id, bool control) { note([&] { joined.emplace_back(id, control); }); };
    handlers.left = [this](ClientId id) { note([&] { left.push_back(id); }); };
    handlers.message = [this](ClientId, bool control, std::string_view text) {
      note([&] { messages.push_back((control ? "control:" : "watch:") + std::string(text)); });
    };
    server = std::make_unique<WebServer>(options);
    server->start(handlers);
  }

  template <class Change>
  void note(const Change& change) {
    const std::lock_guard lock(mutex);
    change();
    changed.notify_all();
  }
  /// Waits until `ready` holds of the record.
  template <class Ready>
  bool until(const Ready& ready) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(60), ready);
  }

  tcp::socket connect() {
    tcp::socket socket(io);
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), server->port()});
    return socket;
  }

  http::response<http::string_body> request(const std::string& target, http::verb verb = http::verb::get) {
    tcp::socket socket = connect();
    http::request<http::empty_body> ask{verb, target, 11};
    ask.set(http::field::host, "127.0.0.1:" + std::to_string(server->port()));
    http::write(socket, ask);
    beast::flat_buffer buffer;
    http::response<http::string_body> answer;
    beast::error_code error;
    if (verb != http::verb::head) http::read(socket, buffer, answer, error);
    return answer;
  }

  std::string raw(const std::string& text) {
    tcp::socket socket = connect();
    boost::system::error_code error;
    boost::asio::write(socket, boost::asio::buffer(text), error);
    std::string answer;
    boost::asio::read(socket, boost::asio::dynamic_buffer(answer), error);
    return answer;
  }

  using Socket = websocket::stream<tcp::socket>;
  Socket open(const std::string& target = "/ws") {
    Socket socket(connect());
    socket.handshake("127.0.0.1:" + std::to_string(server->port()), target);
    return socket;
  }
  static std::string receive(Socket& socket) {
    beast::flat_buffer buffer;
    socket.read(buffer);
    return beast::buffers_to_string(buffer.data());
  }
  /// Reads until the server closes.
  static websocket::close_code closed_with(Socket& socket) {
    beast::error_code error;
    while (!error) {
      beast::flat_buffer buffer;
      socket.read(buffer, error);
    }
    return static_cast<websocket::close_code>(socket.reason().code);
  }
  static int number(const std::string& picture) { return std::stoi(picture.substr(1)); }
  static void say(Socket& socket, const std::string& text) { socket.write(boost::asio::buffer(text)); }

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::pair<ClientId, bool>> joined;
  std::vector<ClientId> left;
  std::vector<std::string> messages;

  boost::asio::io_context io;
  WebOptions options;
  std::unique_ptr<WebServer> server;
};

TEST_F(WebServerTest, ServesThePage) {
  start();
  const auto page = request("/");
  EXPECT_EQ(page.result_int(), 200u);
  EXPECT_EQ(page.body(), "<p>hello</p>");
  EXPECT_EQ(page[http::field::content_type], "text/html; charset=utf-8");
  EXPECT_EQ(request("/app.js?v=1").body(), "let a;");
}

TEST_F(WebServerTest, NoPathLeadsOutOfThePage) {
  start();
  for (const char* path : {"/../../etc/passwd", "/%2e%2e/etc/passwd", "/sub/secret", "/sub", "//index.html",
                           "/./index.html", "/nothing", "*"}) {
    EXPECT_EQ(request(path).result_int(), 404u) << path;
  }
}

TEST_F(WebServerTest, RefusesWhatItDoesNotUnderstand) {
  start();
  EXPECT_EQ(request("/", http::verb::post).result_int(), 405u);
  EXPECT_EQ(request("/ws").result_int(), 426u);
  EXPECT_NE(raw("\x16\x03\x01 nonsense\r\n\r\n").find("400"), std::string::npos);
  EXPECT_EQ(raw("GET / HTTP/1.1\r\nX: " + std::string(20000, 'a') + "\r\n\r\n").find("200"), std::string::npos);
  EXPECT_EQ(request("/").result_int(), 200u);
}

TEST_F(WebServerTest, TheTokenInTheAddressBecomesACookieOfThisPort) {
  start();
  EXPECT_EQ(request("/").count(http::field::set_cookie), 0u);
  const auto page = request(std::string("/?token=") + kToken);
  EXPECT_EQ(page[http::field::set_cookie],
            "tact_token_" + std::to_string(server->port()) + "=" + kToken + "; Path=/; HttpOnly; SameSite=Strict");
}

TEST_F(WebServerTest, OnLoopbackAWatcherComesInWithoutControl) {
  start();
  auto watcher = open();
  auto controller = open(std::string("/ws?token=") + kToken);
  say(watcher, "w");
  ASSERT_TRUE(until([&] { return messages.size() == 1; }));
  say(controller, "c");
  ASSERT_TRUE(until([&] { return messages.size() == 2; }));
  EXPECT_EQ(messages, (std::vector<std::string>{"watch:w", "control:c"}));
}

TEST_F(WebServerTest, BoundElsewhereNothingComesInWithoutTheToken) {
  options.bind = "0.0.0.0";
  start();
  EXPECT_EQ(request("/").result_int(), 403u);
  EXPECT_EQ(request("/app.js").result_int(), 403u);
  EXPECT_THROW(open(), boost::system::system_error);
  EXPECT_THROW(open("/ws?token=0123456789abcdee"), boost::system::system_error);
  EXPECT_EQ(request(std::string("/?token=") + kToken).result_int(), 200u);
  auto socket = open(std::string("/ws?token=") + kToken);
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  EXPECT_TRUE(joined[0].second);
}

TEST_F(WebServerTest, ALateJoinerGetsTheCurrentSceneAtOnceAndNoHistory) {
  start();
  auto first = open();
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  for (int i = 0; i < 100; ++i) server->send_newest(Slot::picture, "picture " + std::to_string(i));
  server->send_newest(Slot::status, "status");
  while (receive(first) != "ppicture 99") {
  }
  auto late = open();
  EXPECT_EQ(receive(late), "status");
  EXPECT_EQ(receive(late), "ppicture 99");
}

TEST_F(WebServerTest, EventsArriveInOrderBetweenManyFrames) {
  start();
  auto client = open();
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  for (int i = 0; i < 100; ++i) {
    server->send_newest(Slot::picture, std::string(20000, 'p'));
    server->send_event_to_all("event " + std::to_string(i));
  }
  for (int expected = 0; expected < 100;) {
    const std::string got = receive(client);
    if (got[0] == 'p') continue;
    EXPECT_EQ(got, "event " + std::to_string(expected++));
  }
}

TEST_F(WebServerTest, AClientThatDoesNotReadHurtsNobodyAndGetsTheNewestLater) {
  start();
  auto asleep = open();
  auto awake = open();
  ASSERT_TRUE(until([&] { return joined.size() == 2; }));
  const int last = 400;
  for (int i = 1; i <= last; ++i) {
    server->send_newest(Slot::picture, std::to_string(i) + std::string(100000, ' '));
    if (i % 20 == 0) {  // the awake one keeps up
      while (number(receive(awake)) < i) {
      }
    }
  }
  int received = 0;
  while (number(receive(asleep)) < last) ++received;
  EXPECT_LT(received, 100);  // what the kernel held, not 400
}

TEST_F(WebServerTest, AClientThatTakesNoEventsIsDroppedAndTheOthersStay) {
  options.max_events = 50;
  start();
  auto asleep = open();
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  auto awake = open();
  ASSERT_TRUE(until([&] { return joined.size() == 2; }));
  bool dropped = false;
  for (int i = 0; i < 2000 && !dropped; ++i) {
    server->send_event_to_all(std::to_string(i) + std::string(50000, ' '));
    EXPECT_EQ(std::stoi(receive(awake)), i);
    const std::lock_guard lock(mutex);
    dropped = !left.empty();
  }
  const std::lock_guard lock(mutex);
  EXPECT_EQ(left, std::vector<ClientId>{joined[0].first});
}

TEST_F(WebServerTest, AClientThatTakesNothingForTooLongIsDropped) {
  options.max_silence = std::chrono::milliseconds(500);
  start();
  auto asleep = open();
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  bool dropped = false;
  for (int i = 0; i < 2000 && !dropped; ++i) {
    server->send_newest(Slot::picture, std::string(100000, ' '));
    std::unique_lock lock(mutex);
    dropped = changed.wait_for(lock, std::chrono::milliseconds(20), [&] { return !left.empty(); });
  }
  const std::lock_guard lock(mutex);
  EXPECT_EQ(left, std::vector<ClientId>{joined[0].first});
}

/// A client takes the only seat and, with a picture on its way that no buffer holds, reads no more.
class FullWindow : public WebServerTest {
 protected:
  FullWindow() {
    options.max_connections = 1;
    options.max_events = 1;
    options.max_silence = std::chrono::hours(1);  // must not be what helps
    start();
    client.emplace(open());
    client->next_layer().set_option(boost::asio::socket_base::receive_buffer_size(4096));
    EXPECT_TRUE(until([&] { return joined.size() == 1; }));
    server->send_newest(Slot::picture, std::string(32'000'000, ' '));
    client->next_layer().wait(tcp::socket::wait_read);
    EXPECT_EQ(get_page(), "") << "the seat is taken";
  }
  /// Empty: turned away.
  std::string get_page() { return raw("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"); }
  bool seat_gets_free() {
    for (int i = 0; i < 500; ++i) {
      if (get_page().find("<p>hello</p>") != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  std::optional<Socket> client;
};

TEST_F(FullWindow, HalfClosingFreesTheSeat) {
  client->next_layer().shutdown(tcp::socket::shutdown_send);
  EXPECT_TRUE(until([&] { return left.size() == 1; }));
  EXPECT_TRUE(seat_gets_free());
}

TEST_F(FullWindow, HalfClosingFreesTheSeatAlsoWhenTheGoodbyeCannotGoOut) {
  for (int i = 0; i < 2; ++i) server->send_event_to_all("one too many");
  EXPECT_TRUE(until([&] { return left.size() == 1; }));
  EXPECT_EQ(get_page(), "") << "the goodbye waits behind the picture";
  client->next_layer().shutdown(tcp::socket::shutdown_send);
  EXPECT_TRUE(seat_gets_free());
}

TEST_F(WebServerTest, AFloodOfMessagesIsReadSlowlyAndHurtsNobody) {
  options.messages_per_s = 1000;
  start();
  auto flooder = open();
  auto other = open();
  ASSERT_TRUE(until([&] { return joined.size() == 2; }));
  for (int i = 0; i < 1500; ++i) say(flooder, "flood");
  server->send_event_to_all("still here");
  EXPECT_EQ(receive(other), "still here");
  EXPECT_TRUE(until([&] { return messages.size() == 1500; }));
}

TEST_F(WebServerTest, AMessageTooLargeOrNotTextEndsTheConnection) {
  start();
  auto large = open();
  say(large, std::string(5000, 'x'));
  EXPECT_EQ(closed_with(large), websocket::close_code::too_big);
  auto binary = open();
  binary.binary(true);
  say(binary, "x");
  EXPECT_EQ(closed_with(binary), websocket::close_code::unknown_data);
  EXPECT_TRUE(until([&] { return left.size() == 2; }));
  EXPECT_TRUE(messages.empty());
}

TEST_F(WebServerTest, NumbersOfClientsAndConnectionsAreBounded) {
  options.max_clients = 2;
  options.max_connections = 6;
  start();
  auto a = open();
  auto b = open();
  ASSERT_TRUE(until([&] { return joined.size() == 2; }));
  EXPECT_THROW(open(), boost::system::system_error);
  EXPECT_EQ(request("/").result_int(), 200u);  // the page still comes, to say why
  std::vector<tcp::socket> idle;
  for (int i = 0; i < 30; ++i) idle.push_back(connect());
  server->send_event_to_all("still here");
  EXPECT_EQ(receive(a), "still here");
  EXPECT_EQ(receive(b), "still here");
}

TEST_F(WebServerTest, SaysGoodbyeAndLeavesThePortFree) {
  start();
  const auto port = server->port();
  auto client = open();
  ASSERT_TRUE(until([&] { return joined.size() == 1; }));
  std::thread ending([&] { server.reset(); });
  EXPECT_EQ(closed_with(client), websocket::close_code::going_away);
  ending.join();
  options.port = port;
  start();
  EXPECT_EQ(request("/").result_int(), 200u);
}

TEST_F(WebServerTest, AnAddressThatCannotBeHadIsNamed) {
  start();
  const auto message = [&](const std::string& bind, std::uint16_t port) -> std::string {
    WebOptions other = options;
    other.bind = bind;
    other.port = port;
    try {
      WebServer second(other);
    } catch (const SetupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("127.0.0.1", server->port()).find("already in use"), std::string::npos);
  EXPECT_NE(message("localhorst", 0).find("machine.bind: found \"localhorst\""), std::string::npos);
  EXPECT_NE(message("192.0.2.1", 0).find("not an address of this machine"), std::string::npos);
  WebOptions other = options;
  other.page = "/nowhere";
  EXPECT_THROW(WebServer{other}, SetupError);
}

}  // namespace
}  // namespace tact::view
