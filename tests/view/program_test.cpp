// The real tact-view as a process, with a made-up session behind it and WebSocket clients before it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <csignal>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "fake_session.hpp"
#include "support/other_network.hpp"
#include "support/watcher.hpp"

namespace tact::view {
namespace {

namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::asio::ip::tcp;
using Json = nlohmann::json;
using std::chrono::seconds;
using test::OtherNetwork;
using test::Watcher;
using testing::FakeSession;

class ViewProgramTest : public ::testing::Test {
 protected:
  void start() {
    session.start();
    start_view({});
    ASSERT_TRUE(test::eventually([&] { return std::filesystem::exists(session.scratch.path() / "view_url"); }))
        << view->output();
    std::string url;
    std::ifstream(session.scratch.path() / "view_url") >> url;
    port = static_cast<unsigned short>(std::stoi(url.substr(url.rfind(':') + 1)));
  }
  void start_view(std::vector<std::string> more) {
    std::vector<std::string> command{TACT_VIEW, "--session", session.file().string()};
    command.insert(command.end(), more.begin(), more.end());
    view = std::make_unique<test::Process>(command, session.scratch.path() / "view.log");
  }

  FakeSession session;
  std::unique_ptr<test::Process> view;
  unsigned short port = 0;
};

TEST_F(ViewProgramTest, CheckOpensEverythingAndLeaves) {
  save_session(session.session, session.file());
  start_view({"--check"});
  EXPECT_EQ(view->wait(seconds(30)), 0) << view->output();
  EXPECT_FALSE(std::filesystem::exists(session.scratch.path() / "view_url"));
}

TEST_F(ViewProgramTest, APortThatIsTakenIsOneClearError) {
  boost::asio::io_context io;
  tcp::acceptor other(io, {boost::asio::ip::make_address("127.0.0.1"), 0});
  session.session.machine.port = other.local_endpoint().port();
  save_session(session.session, session.file());
  start_view({});
  EXPECT_EQ(view->wait(seconds(30)), 2);
  EXPECT_NE(
      view->output().find("machine.port: found " + std::to_string(other.local_endpoint().port()) + ", already in use"),
      std::string::npos)
      << view->output();
}

TEST_F(ViewProgramTest, AShotIsOnePictureInAFile) {
  session.start();
  const auto file = session.scratch.path() / "shot.png";
  start_view({"--shot", file.string()});
  EXPECT_EQ(view->wait(seconds(60)), 0) << view->output();
  EXPECT_GT(std::filesystem::file_size(file), 50000u);
}

TEST_F(ViewProgramTest, NothingIsLoadedUntilSomebodyLooks) {
  start();
  std::this_thread::sleep_for(seconds(1));
  EXPECT_EQ(view->output().find("trees built"), std::string::npos);
  Watcher client("127.0.0.1", port, "");
  client.frame('p');
  EXPECT_TRUE(test::eventually([&] { return view->output().find("trees built") != std::string::npos; }));
}

TEST_F(ViewProgramTest, ALateJoinerGetsEverythingAndControlsWithTheToken) {
  start();
  Watcher first("127.0.0.1", port, "");
  first.frame('s');
  Watcher late("127.0.0.1", port, "secret-token");
  EXPECT_EQ(late.event("hello")["control"], true);
  EXPECT_EQ(late.event("status")["scene"], "ring-and-peg");
  for (const char letter : {'p', 'g', 's', 't'}) EXPECT_EQ(late.frame(letter).substr(0, 2), "\xff\xd8");
  late.take();
  EXPECT_EQ(first.event("hand")["holder"], late.event("hand")["holder"]);
  EXPECT_TRUE(test::eventually([&] { return !session.hands().empty() && session.hands().back().hold; }));
  late.say(R"({"type":"drop"})");
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(ViewProgramTest, AHolderWhoseProcessDiesLetsGo) {
  start();
  {
    Watcher client("127.0.0.1", port, "secret-token");
    client.take();
    ASSERT_TRUE(test::eventually([&] { return !session.hands().empty() && session.hands().back().hold; }));
  }
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(ViewProgramTest, EndsWhenAskedAndLetsGoFirst) {
  start();
  Watcher client("127.0.0.1", port, "secret-token");
  client.take();
  ASSERT_TRUE(test::eventually([&] { return !session.hands().empty() && session.hands().back().hold; }));
  view->signal(SIGTERM);
  EXPECT_EQ(view->wait(seconds(20)), 0) << view->output();
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(ViewProgramTest, FromAnotherNetworkTheTokenOpensAndACutLinkLetsGo) {
  OtherNetwork network;
  if (!network.ready()) GTEST_SKIP() << "needs root and iproute2 to make a network namespace";
  session.session.machine.bind = "0.0.0.0";
  start();
  const auto status = [&](const std::string& target) {
    return network
        .inside([&, target] {
          boost::asio::io_context io;
          tcp::socket socket(io);
          socket.connect({boost::asio::ip::make_address("10.213.77.1"), port});
          http::request<http::empty_body> request{http::verb::get, target, 11};
          request.set(http::field::host, "10.213.77.1:" + std::to_string(port));
          http::write(socket, request);
          boost::beast::flat_buffer buffer;
          http::response<http::string_body> response;
          http::read(socket, buffer, response);
          return response.result_int();
        })
        .get();
  };
  EXPECT_EQ(status("/"), 403u);
  EXPECT_EQ(status("/app.js"), 403u);
  EXPECT_EQ(status("/?token=secret-tokem"), 403u);
  EXPECT_EQ(status("/?token=secret-token"), 200u);
  EXPECT_THROW(network.inside([&] { Watcher refused("10.213.77.1", port, ""); }).get(), boost::system::system_error);
  auto remote = network.inside([&] { return std::make_unique<Watcher>("10.213.77.1", port, "secret-token"); }).get();
  remote->frame('p');
  remote->take();
  ASSERT_TRUE(test::eventually([&] { return !session.hands().empty() && session.hands().back().hold; }));
  Watcher local("127.0.0.1", port, "secret-token");
  local.event("hello");
  network.cut();
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));  // silent: it holds nothing any more
  for (int i = 0; i < 20; ++i) local.frame('p');                                // and nobody else noticed
}

}  // namespace
}  // namespace tact::view
