/// Others at the node's outputs: a hundred subscribers, subscribers that hang, thousands of service calls.
/// Criterion: as in pose_faults_test; nobody who listens is left out by those who do not; memory and open
/// files of the node do not grow. HAPTIC_CLOTH_SERVICE_CALLS=100000 is the long form (2000 otherwise).
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

#include <cstdlib>

#include "fault_support.h"
#include "raw_listeners.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr const char* kNode = "/haptic_cloth";
/// Glibc's arenas breathe by a few MB; a queue that grows takes 10 listeners x 2 s x 30 Hz x 0.1 MB = 60 MB
/// of markers [MB].
constexpr double kMemory = 20.0;

class ListenerFaultTest : public FaultTest {
 protected:
  double rate() const { return diagnostics_.number("haptic thread", "rate [Hz]"); }
};

TEST_F(ListenerFaultTest, AHundredSubscribers) {
  press();
  const pid_t pid = pidOf(kNode);
  const int files = openFiles(pid);
  ASSERT_GT(files, 0);
  reaction_.clear();
  {
    const RawListeners listeners(kNode, "/probe/reaction", 100);
    ASSERT_TRUE(waitFor([&] { return listeners.fewest() > 300; }));
    EXPECT_GT(reaction_.force().z(), 0.1);
    freshDiagnostics();
    EXPECT_EQ(listeners.closed(), 0);
    RecordProperty("rate_Hz", std::to_string(rate()));
    RecordProperty("late_p99_us", diagnostics_.value("haptic thread", "late p99 [us]"));
  }
  EXPECT_TRUE(waitFor([&] { return openFiles(pid) <= files; })) << "connections stay open";
  EXPECT_TRUE(recovers());
}

TEST_F(ListenerFaultTest, ListenersThatHang) {
  press();
  const pid_t pid = pidOf(kNode);
  RawListeners reaction(kNode, "/probe/reaction", 10), markers(kNode, "/cloth/markers", 10),
      state(kNode, "/cloth/state", 10);
  ASSERT_TRUE(waitFor([&] { return markers.fewest() > 10 && state.fewest() > 10; }));
  const double before = residentMemory(pid);
  ASSERT_GT(before, 0.0);
  for (RawListeners* listeners : {&reaction, &markers, &state}) listeners->stall();
  reaction_.clear();
  const long seen = reaction_.count();
  const double frames = diagnostics_.number("display", "marker frames");
  ASSERT_TRUE(waitFor([&] { return reaction_.count() > seen + 3000; }));
  EXPECT_TRUE(waitFor([&] { return diagnostics_.number("display", "marker frames") > frames + 60; }));
  EXPECT_GT(reaction_.force().z(), 0.1);
  EXPECT_LT(residentMemory(pid), before + kMemory);
  RecordProperty("memory_MB", std::to_string(residentMemory(pid) - before));

  const long old = markers.fewest();
  for (RawListeners* listeners : {&reaction, &markers, &state}) listeners->resume();
  EXPECT_TRUE(waitFor([&] { return markers.fewest() > old + 10; }));
  EXPECT_EQ(reaction.closed() + markers.closed() + state.closed(), 0);
  EXPECT_TRUE(recovers());
}

TEST_F(ListenerFaultTest, ThousandsOfServiceCalls) {
  const char* wanted = std::getenv("HAPTIC_CLOTH_SERVICE_CALLS");
  const int calls = wanted != nullptr ? std::atoi(wanted) : 2000;
  press();
  const pid_t pid = pidOf(kNode);
  const int files = openFiles(pid);
  ASSERT_GT(files, 0);
  const double before = residentMemory(pid), start = steadyNow();
  auto pause = node_.serviceClient<std_srvs::SetBool>("/haptic_cloth/pause", true);
  auto grasp = node_.serviceClient<std_srvs::SetBool>("/probe/set_grasp", true);
  auto reset = node_.serviceClient<std_srvs::Empty>("/haptic_cloth/reset", true);
  int answered = 0;
  for (int k = 0; k < calls; ++k) {
    std_srvs::SetBool request;
    std_srvs::Empty empty;
    request.request.data = k % 2 == 0;
    switch (k % 10) {
      case 0:  // a connection of its own
        answered += ros::service::call("/probe/set_grasp", request);
        break;
      case 1:
        answered += reset.call(empty);
        break;
      case 2:
      case 3:
        answered += pause.call(request);
        break;
      default:
        answered += grasp.call(request);
    }
  }
  EXPECT_EQ(answered, calls);
  RecordProperty("calls_per_second", std::to_string(calls / (steadyNow() - start)));
  RecordProperty("memory_MB", std::to_string(residentMemory(pid) - before));
  for (ros::ServiceClient* client : {&pause, &grasp, &reset}) client->shutdown();
  EXPECT_LT(residentMemory(pid), before + kMemory);
  EXPECT_TRUE(waitFor([&] { return openFiles(pid) <= files; })) << "connections stay open";
  EXPECT_TRUE(recovers());
}

}  // namespace
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_listener_faults_test");
  return RUN_ALL_TESTS();
}
