#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"
#include "view/control/conversation.hpp"
#include "view/control/status.hpp"

namespace tact::view {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;

class ConversationTest : public ::testing::Test {
 protected:
  ConversationTest()
      : conversation(shared, [this](std::uint64_t client, const std::string& json) {
          said.emplace_back(client, Json::parse(json));
        }) {
    shared.update([](ViewScene& scene) {
      scene.age_s = 0;
      scene.device.X_WH = {Vec3(0.1, 0, 0), Quat::Identity()};
      scene.info.X_TM = {Vec3(0, 0, 0.01), Quat::Identity()};
    });
    conversation.set_home(frame_ball(Vec3::Zero(), 0.2), 1.0);
  }
  void say(std::uint64_t client, const std::string& text, bool control = true) {
    conversation.message(client, control, text, now);
  }
  Json last() const { return said.empty() ? Json() : said.back().second; }

  SharedScene shared;
  std::vector<std::pair<std::uint64_t, Json>> said;
  Conversation conversation;
  Conversation::Clock::time_point now{};
};

TEST_F(ConversationTest, GreetsWithWhatTheClientMayDo) {
  conversation.joined(7, true);
  EXPECT_EQ(said.back().first, 7u);
  EXPECT_EQ(last()["type"], "hello");
  EXPECT_EQ(last()["you"], 7);
  EXPECT_EQ(last()["control"], true);
}

TEST_F(ConversationTest, TakingHoldMovesNothingAndLettingGoIsPublishedOnce) {
  EXPECT_FALSE(conversation.next_hand());
  say(1, R"({"type":"take"})");
  const auto hand = conversation.next_hand();
  ASSERT_TRUE(hand);
  EXPECT_TRUE(hand->hold);
  EXPECT_LT((hand->X_WM.p - Vec3(0.1, 0, 0.01)).norm(), 1e-12);
  EXPECT_TRUE(conversation.next_hand());
  say(1, R"({"type":"drop"})");
  ASSERT_EQ(conversation.next_hand()->hold, false);
  EXPECT_FALSE(conversation.next_hand());
}

TEST_F(ConversationTest, AMoveMovesTheHand) {
  say(1, R"({"type":"take"})");
  say(1, R"({"type":"move","dx":0.1,"rz":0.5})");
  const Pose X_WM = conversation.next_hand()->X_WM;
  EXPECT_GT((X_WM.p - Vec3(0.1, 0, 0.01)).norm(), 1e-3);
  EXPECT_NEAR(log_so3(X_WM.q).norm(), 0.5, 1e-9);
}

TEST_F(ConversationTest, OneClientAtATimeHoldsThePart) {
  say(1, R"({"type":"take"})");
  say(2, R"({"type":"take"})");
  EXPECT_EQ(last()["type"], "error");
  EXPECT_EQ(conversation.holder(), 1u);
  const Pose before = conversation.next_hand()->X_WM;
  say(2, R"({"type":"move","dx":0.1})");
  say(2, R"({"type":"drop"})");
  EXPECT_LT(displacement(before, conversation.next_hand()->X_WM).norm(), 1e-12);
  conversation.left(1);
  EXPECT_EQ(conversation.holder(), 0u);
  say(2, R"({"type":"take"})");
  EXPECT_EQ(conversation.holder(), 2u);
}

TEST_F(ConversationTest, AHolderThatFallsSilentLetsGo) {
  say(1, R"({"type":"take"})");
  now += milliseconds(900);
  say(1, R"({"type":"keep"})");
  now += milliseconds(900);
  conversation.tick(now);
  EXPECT_EQ(conversation.holder(), 1u);
  now += milliseconds(200);
  conversation.tick(now);
  EXPECT_EQ(conversation.holder(), 0u);
  EXPECT_EQ(conversation.next_hand()->hold, false);
}

TEST_F(ConversationTest, NothingCanBeHeldBeforeADeviceIsThere) {
  shared.update([](ViewScene& scene) { scene.age_s = -1; });
  say(1, R"({"type":"take"})");
  EXPECT_EQ(last()["type"], "error");
  EXPECT_FALSE(conversation.next_hand());
}

TEST_F(ConversationTest, WithoutControlNothingChanges) {
  const Camera camera = conversation.camera();
  for (const char* text :
       {R"({"type":"take"})", R"({"type":"orbit","yaw":1})", R"({"type":"set","key":"contact.law","value":"none"})"}) {
    say(1, text, false);
    EXPECT_EQ(last()["type"], "error");
  }
  EXPECT_EQ(conversation.holder(), 0u);
  EXPECT_EQ(conversation.camera().yaw_rad, camera.yaw_rad);
  EXPECT_TRUE(conversation.take_requests().empty());
}

TEST_F(ConversationTest, NonsenseIsAnsweredAndChangesNothing) {
  for (const char* text : {"", "{", "[]", "7", "null", "{}", R"({"type":7})", R"({"type":"fly"})", R"({"type":"set"})",
                           R"({"type":"set","key":7,"value":"x"})", R"({"type":"orbit","yaw":"far"})",
                           R"({"type":"set","key":"machine.force_limit_n","value":"1000"})", "\xff\xfe"}) {
    const std::size_t before = said.size();
    say(1, text);
    ASSERT_EQ(said.size(), before + 1) << text;
    EXPECT_EQ(last()["type"], "error") << text;
  }
  EXPECT_TRUE(conversation.take_requests().empty());
}

TEST_F(ConversationTest, NumbersBeyondReasonLeaveTheCameraAndTheHandSound) {
  say(1, R"({"type":"take"})");
  say(1, R"({"type":"orbit","yaw":1e308,"pitch":1e308,"zoom":1e308})");
  say(1, R"({"type":"orbit","zoom":-1})");
  say(1, R"({"type":"orbit","yaw":1e999})");
  say(1, R"({"type":"move","dx":1e308,"dy":1e308,"rx":1e308})");
  say(1, R"({"type":"move","dx":-1e308,"rz":-1e308})");
  for (int i = 0; i < 100; ++i) say(1, R"({"type":"orbit","zoom":5})");
  EXPECT_TRUE(conversation.camera().X_WE().finite());
  EXPECT_GT(conversation.camera().distance_m, 1e-3);
  EXPECT_TRUE(conversation.next_hand()->X_WM.finite());
  EXPECT_LE(conversation.next_hand()->X_WM.p.norm(), 1.1);
}

TEST_F(ConversationTest, TheCameraTurnsAndGoesHome) {
  const double yaw = conversation.camera().yaw_rad;
  say(1, R"({"type":"orbit","yaw":0.5})");
  EXPECT_NEAR(conversation.camera().yaw_rad, yaw + 0.5, 1e-12);
  say(1, R"({"type":"home"})");
  EXPECT_NEAR(conversation.camera().yaw_rad, yaw, 1e-12);
}

TEST_F(ConversationTest, AChangeIsAskedForAndItsAnswerToldToAll) {
  say(3, R"({"type":"set","key":"contact.law","value":"global"})");
  const auto requests = conversation.take_requests();
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].service, "contact");
  EXPECT_EQ(requests[0].key, "contact.law");
  EXPECT_EQ(requests[0].value, "global");
  EXPECT_TRUE(conversation.take_requests().empty());
  conversation.answered({requests[0].request_id, "contact.law", "global", true, ""});
  EXPECT_EQ(said.back().first, 0u);
  EXPECT_EQ(last()["accepted"], true);
  EXPECT_EQ(last()["value"], "global");
}

TEST_F(ConversationTest, ARefusalIsToldToWhoAsked) {
  say(3, R"({"type":"set","key":"contact.law","value":"magic"})");
  conversation.answered(
      {conversation.take_requests().at(0).request_id, "contact.law", "potential", false, "no such law"});
  EXPECT_EQ(said.back().first, 3u);
  EXPECT_EQ(last()["message"], "no such law");
}

TEST_F(ConversationTest, SilenceOfAServiceIsTold) {
  say(3, R"({"type":"set","key":"coupling.saturation","value":"off"})");
  conversation.tick(now + milliseconds(1900));
  EXPECT_TRUE(said.empty());
  conversation.tick(now + milliseconds(2100));
  EXPECT_EQ(last()["accepted"], false);
  conversation.tick(now + milliseconds(9000));
  EXPECT_EQ(said.size(), 1u);
}

TEST_F(ConversationTest, UnansweredChangesAreBounded) {
  for (int i = 0; i < 1000; ++i) say(3, R"({"type":"set","key":"contact.law","value":"none"})");
  EXPECT_LE(conversation.take_requests().size(), 64u);
  EXPECT_EQ(last()["type"], "error");
}

TEST(Status, TellsThePenetrationInMillimetresAndVoxels) {
  ViewScene scene;
  scene.info.voxel_m = 0.002;
  scene.device.max_depth_m = 0.001;
  scene.device.F_contact_W.force = Vec3(3, 0, 4);
  const Json json = Json::parse(status_json(scene, {}));
  EXPECT_DOUBLE_EQ(json["penetration_mm"], 1.0);
  EXPECT_DOUBLE_EQ(json["penetration_voxels"], 0.5);
  EXPECT_DOUBLE_EQ(json["force_n"], 5.0);
}

TEST(Status, IsJsonWhateverTheWireSays) {
  ViewScene scene;
  scene.info.name = "\xff\xfe<script>";
  scene.device.max_depth_m = NAN;
  EXPECT_TRUE(Json::accept(status_json(scene, {})));
}

TEST(Status, EveryFaultHasWords) {
  for (std::uint32_t b = 0; b < 15; ++b) EXPECT_EQ(fault_words(1u << b).size(), 1u) << b;
  EXPECT_TRUE(fault_words(0).empty());
}

TEST(Status, ChangesBecomeEvents) {
  ViewScene before, now;
  before.health = {{"contact", "active", "", -1, 0}, {"coupling", "active", "", -1, 0}};
  now.health = {{"contact", "degraded", "RouDi is gone", -1, 0}};
  before.device.faults = bit(Fault::wrench_late);
  now.device.faults = bit(Fault::wrench_stale);
  const auto events = change_events(before, now);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(Json::parse(events[0])["detail"], "RouDi is gone");
  EXPECT_EQ(Json::parse(events[1])["phase"], "gone");
  EXPECT_EQ(Json::parse(events[2])["on"], true);
  EXPECT_EQ(Json::parse(events[3])["on"], false);
  EXPECT_TRUE(change_events(now, now).empty());
}

}  // namespace
}  // namespace tact::view
