// The real tact-view and a real browser; only the services behind it are made up.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "fake_session.hpp"
#include "web_driver.hpp"

namespace tact::view {
namespace {

using testing::Browser;
using testing::FakeSession;
using Json = nlohmann::json;

class BrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::available()) GTEST_SKIP() << "no /usr/bin/chromium and /usr/bin/chromedriver";
    session.start();
    start_view();
    browser = std::make_unique<Browser>();
  }
  void start_view() {
    view = std::make_unique<test::Process>(std::vector<std::string>{TACT_VIEW, "--session", session.file().string()},
                                           session.scratch.path() / "view.log");
    ASSERT_TRUE(test::eventually([&] { return std::filesystem::exists(url_file()); })) << view->output();
    std::ifstream(url_file()) >> url;
  }
  std::filesystem::path url_file() const { return session.scratch.path() / "view_url"; }
  std::string url_without_token() const { return url.substr(0, url.find('?')); }

  bool becomes(const std::string& expression) {
    return test::eventually([&] { return browser->value(expression) == Json(true); });
  }
  void open_page() {
    browser->open(url);
    ASSERT_TRUE(becomes("document.body.classList.contains('live')")) << view->output();
  }
  /// Pictures to look at, where TACT_SHOTS names a folder.
  void shot(const std::string& name) {
    if (const char* folder = std::getenv("TACT_SHOTS"))
      browser->screenshot(std::filesystem::path(folder) / (name + ".png"));
  }
  Json centre() {
    return browser->value(
        "(() => { const r = document.getElementById('picture').getBoundingClientRect(); return [Math.round(r.x + "
        "r.width / 2), Math.round(r.y + r.height / 2), Math.round(r.height)]; })()");
  }
  /// Presses at the centre of the picture, moves, and stays pressed.
  void press_and_move(int dx, int dy, int button = 0) {
    const Json at = centre();
    const auto move = [](int x, int y) { return Json{{"type", "pointerMove"}, {"duration", 100}, {"x", x}, {"y", y}}; };
    const int x = at[0], y = at[1];
    browser->perform({{{"type", "pointer"},
                       {"id", "mouse"},
                       {"parameters", {{"pointerType", "mouse"}}},
                       {"actions",
                        {move(x, y),
                         {{"type", "pointerDown"}, {"button", button}},
                         move(x + dx / 2, y + dy / 2),
                         move(x + dx, y + dy)}}}});
  }
  void release(int button = 0) {
    browser->perform({{{"type", "pointer"},
                       {"id", "mouse"},
                       {"parameters", {{"pointerType", "mouse"}}},
                       {"actions", {{{"type", "pointerUp"}, {"button", button}}}}}});
  }
  void key(const char* type, const std::string& value) {
    browser->perform({{{"type", "key"}, {"id", "keyboard"}, {"actions", {{{"type", type}, {"value", value}}}}}});
  }
  bool hand_moved(double metres) {
    return test::eventually([&] {
      const auto hands = session.hands();
      return !hands.empty() && hands.back().hold &&
             (from_wire(hands.back().X_WM).p - from_wire(hands.front().X_WM).p).norm() > metres;
    });
  }

  FakeSession session;
  std::unique_ptr<test::Process> view;
  std::unique_ptr<Browser> browser;
  std::string url;
};

TEST_F(BrowserTest, ShowsALivePictureThatChangesAndTheNumbers) {
  open_page();
  ASSERT_TRUE(becomes("Number(document.body.dataset.pictures) > 20"));
  const std::string sum =
      "(() => { const c = document.getElementById('picture'); const d = c.getContext('2d').getImageData(0, 0, c.width, "
      "c.height).data;"
      " let s = 0; for (let i = 0; i < d.length; i += 97) s = (s * 31 + d[i]) % 1000003; return s; })()";
  const Json first = browser->value(sum);
  EXPECT_TRUE(test::eventually([&] { return browser->value(sum) != first; }));
  EXPECT_TRUE(becomes("document.getElementById('contacts').textContent >= '14'"));
  EXPECT_TRUE(becomes("document.getElementById('law').value === 'potential'"));
  EXPECT_TRUE(becomes("Number(document.getElementById('stiffness-number').value) === 20000"));
  EXPECT_TRUE(becomes("document.getElementById('faults').textContent.includes('extrapolating')"));
  // All four pictures are there: none is one plain colour.
  for (const char* id : {"picture", "gauss", "slice", "strips"}) {
    EXPECT_TRUE(becomes(std::string("(() => { const c = document.getElementById('") + id +
                        "'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; for (let i = 0; "
                        "i < d.length; i += 4) if (Math.abs(d[i] - d[0]) > 40) return true; return false; })()"))
        << id;
  }
  EXPECT_EQ(browser->value("document.documentElement.scrollWidth <= window.innerWidth"), Json(true));
  shot("page");
  browser->resize(1920, 1080);
  shot("page-wide");
  browser->resize(520, 1400);
  EXPECT_EQ(browser->value("document.documentElement.scrollWidth <= window.innerWidth"), Json(true));
  shot("page-narrow");
}

TEST_F(BrowserTest, DraggingMovesTheHandAndReleasingLetsGo) {
  open_page();
  press_and_move(120, -60);
  EXPECT_TRUE(hand_moved(0.005));
  EXPECT_TRUE(becomes("document.getElementById('grip').textContent === 'you hold the part'"));
  shot("holding");
  release();
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(BrowserTest, ShiftDraggingTurnsAndTheWheelMovesAlongTheView) {
  open_page();
  key("keyDown", "\uE008");
  press_and_move(120, 0);
  EXPECT_TRUE(test::eventually([&] {
    const auto hands = session.hands();
    return !hands.empty() && from_wire(hands.back().X_WM).q.angularDistance(from_wire(hands.front().X_WM).q) > 0.3;
  }));
  release();
  key("keyUp", "\uE008");
  ASSERT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
  const Json at = centre();
  const Vec3 before = from_wire(session.hands().back().X_WM).p;
  browser->perform({{{"type", "wheel"},
                     {"id", "wheel"},
                     {"actions", {{{"type", "scroll"}, {"x", at[0]}, {"y", at[1]}, {"deltaX", 0}, {"deltaY", 300}}}}}});
  EXPECT_TRUE(test::eventually([&] { return (from_wire(session.hands().back().X_WM).p - before).norm() > 0.003; }));
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));  // by itself
}

TEST_F(BrowserTest, WithoutLettingGoThePartStaysHeldUntilTheButton) {
  open_page();
  browser->run("document.getElementById('let-go').click()");
  press_and_move(60, 0);
  release();
  ASSERT_TRUE(becomes("document.getElementById('grip').textContent === 'you hold the part'"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // longer than a silent holder keeps it
  EXPECT_TRUE(session.hands().back().hold);
  browser->run("document.getElementById('drop').click()");
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(BrowserTest, RightDraggingTurnsTheCameraAndMovesNoHand) {
  open_page();
  press_and_move(150, 0, 2);
  release(2);
  EXPECT_TRUE(becomes("Number(document.body.dataset.pictures) > 10"));
  EXPECT_TRUE(session.hands().empty());
  shot("turned");
}

TEST_F(BrowserTest, KeysMoveTheHand) {
  open_page();
  browser->run("document.getElementById('picture').focus()");
  for (int i = 0; i < 5; ++i) {
    key("keyDown", "\uE014");
    key("keyUp", "\uE014");
  }
  EXPECT_TRUE(hand_moved(0.005));
  key("keyDown", "\uE00C");
  EXPECT_TRUE(test::eventually([&] { return !session.hands().back().hold; }));
}

TEST_F(BrowserTest, LawStiffnessAndSaturationAreAskedForAndTheAnswerShown) {
  open_page();
  browser->run("const l = document.getElementById('law'); l.value = 'global'; l.dispatchEvent(new Event('change'))");
  EXPECT_TRUE(test::eventually([&] {
    return session.parameters() == std::vector<std::pair<std::string, std::string>>{{"contact.law", "global"}};
  }));
  EXPECT_TRUE(becomes("document.getElementById('notice').textContent === 'Law is now global'"));
  browser->run(
      "const n = document.getElementById('stiffness-number'); n.value = 5000; n.dispatchEvent(new Event('change'))");
  EXPECT_TRUE(test::eventually([&] {
    return session.parameters().size() == 2 &&
           session.parameters()[1] == std::pair<std::string, std::string>("contact.stiffness_n_per_m", "5000");
  }));
  browser->run("document.getElementById('saturation').click()");
  EXPECT_TRUE(test::eventually([&] {
    return session.parameters().size() == 3 &&
           session.parameters()[2] == std::pair<std::string, std::string>("coupling.saturation", "false");
  }));
  browser->run("const l = document.getElementById('law'); l.value = 'none'; l.dispatchEvent(new Event('change'))");
  EXPECT_TRUE(becomes("document.getElementById('notice').textContent.includes('refused for the test')"));
  EXPECT_TRUE(becomes("document.getElementById('law').value === 'global'"));  // what is in force comes back
  shot("refused");
}

TEST_F(BrowserTest, WithoutTheTokenItOnlyWatches) {
  browser->open(url_without_token());
  ASSERT_TRUE(becomes("document.body.classList.contains('live')"));
  EXPECT_EQ(browser->value("document.getElementById('law').disabled"), Json(true));
  EXPECT_EQ(browser->value("document.getElementById('watching').hidden"), Json(false));
  press_and_move(100, 0);
  release();
  browser->run("socket.send(JSON.stringify({type: 'take'}))");
  browser->run("socket.send(JSON.stringify({type: 'set', key: 'contact.law', value: 'none'}))");
  EXPECT_TRUE(becomes("document.getElementById('notice').textContent.startsWith('Only watching')"));
  EXPECT_TRUE(session.hands().empty());
  EXPECT_TRUE(session.parameters().empty());
  shot("watching");
}

TEST_F(BrowserTest, ComesBackByItselfAfterTheViewWasKilled) {
  open_page();
  session.session.machine.port = browser->value("Number(location.port)");
  save_session(session.session, session.file());
  view->signal(SIGKILL);
  view->wait(std::chrono::seconds(10));
  EXPECT_TRUE(becomes("document.getElementById('connection').textContent === 'disconnected, retrying'"));
  shot("disconnected");
  std::filesystem::remove(url_file());
  start_view();
  EXPECT_TRUE(becomes("document.getElementById('connection').textContent === 'connected'"));
}

}  // namespace
}  // namespace tact::view
