// The control socket: requests, replies, many clients, hostile ones.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/client.hpp"
#include "daemon/control/server.hpp"
#include "daemon/control/status.hpp"
#include "tests/unit/daemon/fakes.hpp"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace scansion::test {
namespace {

/// One device, "table"; whatever is wanted of it is done.
Result<void> sample_order(std::string_view device, Order order) {
  if (device != "table") return fail(Errc::not_found, "there is no device");
  if (order == Order::release) return fail(Errc::unavailable, "cannot release");
  return success();
}

DaemonStatus sample_status() {
  DaemonStatus status;
  status.version = "1.2.3";
  status.pid = 42;
  status.started_ns = 1'700'000'000'123'456'789;
  status.uptime_ns = 1'500'000'000;
  status.config = "c.toml";
  status.directory = "/data";
  status.free_mb = 7;
  DeviceStatus device;
  device.name = "d";
  device.driver = "replay";
  device.state = "streaming";
  device.lines = 5;
  device.recording = std::string("/data/\xFF.mcap"); // a file name need not be UTF-8
  device.recording_bytes = 99;
  device.last_line_ns = 1'700'000'000'000'000'000;
  status.devices.push_back(device);
  return status;
}

class Control : public testing::Test {
protected:
  void SetUp() override {
    path_ = directory_.path() + "/run/control.sock";
    start();
  }
  void start() {
    auto server = ControlServer::listen(path_, clock_);
    ASSERT_TRUE(server) << server.assume_error().context;
    server_ = std::move(server).assume_value();
    server_->serve([](std::string_view request) { return answer(request, {sample_status, sample_order}); });
  }
  [[nodiscard]] UniqueFd raw_connection() const {
    auto address = socket_address(path_);
    UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const timeval patience{20, 0};
    ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address.assume_value()), sizeof(sockaddr_un)), 0);
    return fd;
  }
  static std::string read_to_end(const UniqueFd& fd) {
    std::string out;
    char buffer[1000];
    for (ssize_t got = 0; (got = ::recv(fd.get(), buffer, sizeof buffer, 0)) > 0;)
      out.append(buffer, static_cast<std::size_t>(got));
    return out;
  }

  TemporaryDirectory directory_;
  SystemClock clock_;
  std::string path_;
  std::unique_ptr<ControlServer> server_;
};

TEST_F(Control, StatusHasEveryField) {
  auto reply = request(path_, R"({"command":"status"})");
  ASSERT_TRUE(reply) << reply.assume_error().context;
  const auto json = nlohmann::json::parse(reply.assume_value());
  EXPECT_EQ(json["version"], "1.2.3");
  EXPECT_EQ(json["pid"], 42);
  EXPECT_EQ(json["started"], "2023-11-14T22:13:20.123Z");
  EXPECT_EQ(json["uptime_s"], 1.5);
  EXPECT_EQ(json["recording"]["directory"], "/data");
  EXPECT_EQ(json["recording"]["free_mb"], 7);
  EXPECT_TRUE(json["recording"]["blocked"].is_null());
  const auto& device = json["devices"][0];
  EXPECT_EQ(device["state"], "streaming");
  EXPECT_EQ(device["lines"], 5);
  EXPECT_EQ(device["recording"]["bytes"], 99);
  EXPECT_EQ(device["last_line_at"], "2023-11-14T22:13:20.000Z");
  for (const char* key : {"driver", "error", "points", "invalid", "gaps", "lost_lines", "groups_written", "lines_written",
                          "queue", "pending_groups", "lag_ms", "last_recording", "blocked"}) {
    EXPECT_TRUE(device.contains(key)) << key;
  }
}

TEST_F(Control, SocketModeAndRemoval) {
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
  server_.reset();
  EXPECT_NE(::stat(path_.c_str(), &status), 0);
}

TEST_F(Control, SecondServerIsRefusedWhileTheFirstLives) {
  auto second = ControlServer::listen(path_, clock_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.assume_error().code, Errc::unavailable);
  EXPECT_TRUE(request(path_, R"({"command":"status"})")) << "the first one still serves";
}

TEST_F(Control, StaleSocketIsReplaced) {
  server_.reset();
  {
    auto address = socket_address(path_);
    const UniqueFd dead(::socket(AF_UNIX, SOCK_STREAM, 0));
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&address.assume_value()), sizeof(sockaddr_un)), 0);
  }
  start();
  EXPECT_TRUE(request(path_, R"({"command":"status"})"));
}

TEST_F(Control, OtherFilesAreNotReplaced) {
  server_.reset();
  const UniqueFd file(::open(path_.c_str(), O_CREAT | O_WRONLY, 0600));
  auto server = ControlServer::listen(path_, clock_);
  ASSERT_FALSE(server);
  EXPECT_EQ(server.assume_error().code, Errc::exists);
}

TEST_F(Control, BadRequestsGetAnErrorAndTheConnectionGoesOn) {
  const std::string nested(4000, '[');
  for (const std::string& bad : {std::string("{"), std::string("[]"), std::string("{}"), std::string(R"({"command":1})"),
                                 std::string(R"({"command":"halt"})"), std::string("\xFF\x00\x01", 3), nested, std::string()}) {
    auto reply = request(path_, bad);
    ASSERT_TRUE(reply) << bad;
    EXPECT_TRUE(nlohmann::json::parse(reply.assume_value()).contains("error")) << reply.assume_value();
  }
}

TEST_F(Control, SeveralRequestsOnOneConnection) {
  const UniqueFd fd = raw_connection();
  const std::string three = "{\"command\":\"status\"}\n{}\n{\"command\":\"status\"}\n";
  ASSERT_EQ(::send(fd.get(), three.data(), three.size(), 0), static_cast<ssize_t>(three.size()));
  ::shutdown(fd.get(), SHUT_WR);
  const std::string replies = read_to_end(fd);
  EXPECT_EQ(std::count(replies.begin(), replies.end(), '\n'), 3);
}

TEST_F(Control, EndlessRequestIsCutOff) {
  const UniqueFd fd = raw_connection();
  const std::string block(1000, 'a');
  while (::send(fd.get(), block.data(), block.size(), MSG_NOSIGNAL) > 0) {
  }
  // Hung up on: the reply may be lost with the connection, but the server serves on.
  EXPECT_TRUE(request(path_, R"({"command":"status"})"));
}

TEST_F(Control, SilentClientsDoNotHoldUpOthers) {
  std::vector<UniqueFd> silent;
  for (int i = 0; i < 20; ++i) silent.push_back(raw_connection());
  EXPECT_TRUE(request(path_, R"({"command":"status"})"));
}

/// Asks and asks and never reads: its replies are not piled up, others are served.
TEST_F(Control, ClientThatNeverReadsIsBounded) {
  const UniqueFd fd = raw_connection();
  ::fcntl(fd.get(), F_SETFL, O_NONBLOCK);
  const std::string ask = "{\"command\":\"status\"}\n";
  std::size_t sent = 0;
  for (ssize_t part = 0; (part = ::send(fd.get(), ask.data(), ask.size(), MSG_NOSIGNAL)) > 0;)
    sent += static_cast<std::size_t>(part);
  EXPECT_LT(sent, 16U << 20U);
  EXPECT_TRUE(request(path_, R"({"command":"status"})"));
}

class Tail : public Control {
protected:
  void SetUp() override {
    hub_ = std::move(TailHub::make()).assume_value();
    path_ = directory_.path() + "/run/control.sock";
    server_ = std::move(ControlServer::listen(path_, clock_)).assume_value();
    server_->serve([](std::string_view request) { return answer(request, {sample_status, sample_order}); }, hub_.get());
  }
  void TearDown() override { server_.reset(); }
  /// A connection that listens; the answer to its request has come.
  [[nodiscard]] UniqueFd listen_to(std::string_view topic) const {
    UniqueFd fd = raw_connection();
    const std::string ask = "{\"command\":\"tail\",\"topic\":\"" + std::string(topic) + "\"}\n";
    EXPECT_EQ(::send(fd.get(), ask.data(), ask.size(), 0), static_cast<ssize_t>(ask.size()));
    EXPECT_EQ(read_line(fd), "{\"tail\":\"" + std::string(topic) + "\"}");
    return fd;
  }
  static std::string read_line(const UniqueFd& fd) {
    std::string line;
    for (char c = 0; ::recv(fd.get(), &c, 1, 0) == 1 && c != '\n';) line += c;
    return line;
  }
  std::unique_ptr<TailHub> hub_;
};

TEST_F(Tail, ListenersGetTheirTopicInOrder) {
  EXPECT_FALSE(hub_->wanted(TailTopic::lines));
  const UniqueFd lines = listen_to("lines");
  const UniqueFd events = listen_to("events");
  EXPECT_TRUE(hub_->wanted(TailTopic::lines));
  EXPECT_FALSE(hub_->wanted(TailTopic::features));
  for (int i = 0; i < 100; ++i) hub_->publish(TailTopic::lines, std::to_string(i));
  hub_->publish(TailTopic::events, "\"e\"");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(read_line(lines), std::to_string(i));
  EXPECT_EQ(read_line(events), "\"e\"");
  EXPECT_TRUE(request(path_, R"({"command":"status"})")) << "others are served as well";
}

TEST_F(Tail, SlowListenerLosesAndIsToldHowMuch) {
  const UniqueFd fd = listen_to("lines");
  const std::string message = "\"" + std::string(998, 'x') + "\"";
  constexpr std::uint64_t kSent = 20'000; // far more than socket and bound hold; comes back at once all the same
  for (std::uint64_t i = 0; i < kSent; ++i) hub_->publish(TailTopic::lines, message);
  std::uint64_t got = 0;
  std::uint64_t lost = 0;
  while (got + lost < kSent) {
    const auto json = nlohmann::json::parse(read_line(fd), nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << "after " << got << " messages and " << lost << " lost";
    if (json.is_object())
      lost += json["lost"].get<std::uint64_t>();
    else
      ++got;
  }
  EXPECT_EQ(got + lost, kSent);
  EXPECT_GT(lost, 0U);
  hub_->publish(TailTopic::lines, "1");
  EXPECT_EQ(read_line(fd), "1") << "after the loss it goes on";
}

TEST_F(Tail, UnknownTopicIsAnError) {
  auto reply = request(path_, R"({"command":"tail","topic":"weather"})");
  ASSERT_TRUE(reply);
  EXPECT_TRUE(nlohmann::json::parse(reply.assume_value()).contains("error"));
}

TEST(ControlClient, NobodyListens) {
  auto reply = request("/nonexistent/control.sock", "{}");
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.assume_error().code, Errc::unavailable);
  EXPECT_EQ(exit_code(reply.assume_error().code), 69);
}

TEST(ControlClient, LongPathIsAConfigurationError) {
  auto reply = request("/" + std::string(200, 'a'), "{}");
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.assume_error().code, Errc::config);
}

/// A server that accepts and says nothing.
TEST(ControlClient, SilenceEndsAtTheTimeout) {
  TemporaryDirectory directory;
  const std::string path = directory.path() + "/s";
  auto address = socket_address(path);
  const UniqueFd listener(::socket(AF_UNIX, SOCK_STREAM, 0));
  ASSERT_EQ(::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address.assume_value()), sizeof(sockaddr_un)), 0);
  ASSERT_EQ(::listen(listener.get(), 4), 0);
  auto reply = request(path, "{}", std::chrono::milliseconds(50));
  ASSERT_FALSE(reply);
  EXPECT_EQ(reply.assume_error().code, Errc::unavailable);
}

TEST(IsoTime, RoundsDownAlsoBeforeTheEpoch) {
  EXPECT_EQ(iso_time(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(iso_time(-1), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(iso_time(1'999'999), "1970-01-01T00:00:00.001Z");
}

} // namespace
} // namespace scansion::test
