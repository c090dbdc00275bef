#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "support/process.hpp"

namespace tact::view::testing {

/// A headless Chromium, driven through chromedriver by the W3C WebDriver protocol; as much of it as the tests need.
class Browser {
 public:
  using Json = nlohmann::json;

  static bool available() {
    return std::filesystem::exists("/usr/bin/chromedriver") && std::filesystem::exists("/usr/bin/chromium");
  }

  Browser() {
    driver_ = std::make_unique<test::Process>(std::vector<std::string>{"/usr/bin/chromedriver", "--port=0"},
                                              scratch_.path() / "driver.log",
                                              std::map<std::string, std::string>{{"HOME", scratch_.path().string()}});
    const std::string started = "started successfully on port ";
    if (!test::eventually([&] { return driver_->output().find(started) != std::string::npos; }))
      throw std::runtime_error("chromedriver did not start: " + driver_->output());
    const std::string log = driver_->output();
    port_ = static_cast<unsigned short>(std::stoi(log.substr(log.find(started) + started.size())));
    const Json arguments{"--headless",
                         "--no-sandbox",
                         "--disable-gpu",
                         "--disable-quic",
                         "--no-first-run",
                         "--disable-background-networking",
                         "--disable-component-update",
                         "--disable-sync",
                         "--disable-dev-shm-usage",
                         "--window-size=1440,1000",
                         "--user-data-dir=" + (scratch_.path() / "profile").string()};
    const Json answer =
        call("POST", "/session",
             {{"capabilities",
               {{"alwaysMatch", {{"goog:chromeOptions", {{"binary", "/usr/bin/chromium"}, {"args", arguments}}}}}}}});
    session_ = "/session/" + answer["sessionId"].get<std::string>();
  }
  ~Browser() {
    try {
      call("DELETE", session_, {});
    } catch (const std::exception&) {
    }
  }

  void open(const std::string& url) { call("POST", session_ + "/url", {{"url", url}}); }
  /// Value of a JavaScript expression in the page.
  Json value(const std::string& expression) { return run("return " + expression); }
  Json run(const std::string& script) {
    return call("POST", session_ + "/execute/sync", {{"script", script}, {"args", Json::array()}});
  }
  void perform(const Json& actions) { call("POST", session_ + "/actions", {{"actions", actions}}); }
  void screenshot(const std::filesystem::path& file) {
    const std::string text = call("GET", session_ + "/screenshot", {});
    std::ofstream(file, std::ios::binary) << decode(text);
  }
  void resize(int width, int height) {
    call("POST", session_ + "/window/rect", {{"width", width}, {"height", height}});
  }

 private:
  Json call(const std::string& verb, const std::string& path, const Json& body) {
    namespace http = boost::beast::http;
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket socket(io);
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), port_});
    http::request<http::string_body> request{http::string_to_verb(verb), path, 11};
    request.set(http::field::host, "127.0.0.1");
    request.set(http::field::content_type, "application/json");
    if (verb == "POST") request.body() = body.dump();
    request.prepare_payload();
    http::write(socket, request);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(64 << 20);
    http::read(socket, buffer, parser);
    Json answer = Json::parse(parser.get().body());
    if (parser.get().result_int() != 200) throw std::runtime_error(path + ": " + answer.dump());
    return answer["value"];
  }

  static std::string decode(const std::string& base64) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : base64) {
      const std::size_t v = letters.find(c);
      if (v == std::string::npos) continue;
      bits = (bits << 6) | static_cast<unsigned>(v);
      if ((count += 6) >= 8) bytes += static_cast<char>((bits >> (count -= 8)) & 0xff);
    }
    return bytes;
  }

  test::ScratchDir scratch_;
  std::unique_ptr<test::Process> driver_;
  unsigned short port_ = 0;
  std::string session_;
};

}  // namespace tact::view::testing
