#include "ros/node/state_services.h"

#include <ros/console.h>

#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "haptic_cloth/state_file.h"
#include "ros/node/file_work.h"
#include "ros/node/solver_loop.h"
#include "ros/node/topics.h"

namespace haptic_cloth {
namespace {

/// Fills the response of a service with the result of `work` or with the exception it throws.
template <class Response, class Work>
bool answer(Response& response, const Work& work) {
  try {
    response.message = work();
    response.success = true;
    ROS_INFO_STREAM(response.message);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_WARN_STREAM(response.message);
  }
  return true;
}

std::string at(const std::string& what, const std::string& file, double time) {
  std::ostringstream text;
  text << what << ' ' << std::filesystem::absolute(file).string() << ", " << time << " s since reset";
  return text.str();
}

}  // namespace

StateServices::StateServices(ros::NodeHandle for_save, ros::NodeHandle for_load, const Scene& scene,
                             SharedState& shared)
    : shared_(shared),
      largest_(largestState(scene)),
      save_service_(for_save.advertiseService(topics::kSaveState, &StateServices::save, this)),
      load_service_(for_load.advertiseService(topics::kLoadState, &StateServices::load, this)) {}

bool StateServices::save(SaveState::Request& request, SaveState::Response& response) {
  return answer(response, [&] {
    const std::string file = request.file;
    runFiles([file] { checkStateFile(file); });
    std::string state;
    double time = 0.0;
    run([&](SolverLoop& loop) {
      state = loop.saveState();
      time = loop.simulation().time();
    });
    runFiles([file, state = std::move(state)] { writeStateFile(file, state); });
    return at("saved", file, time);
  });
}

bool StateServices::load(LoadState::Request& request, LoadState::Response& response) {
  return answer(response, [&] {
    const auto state = std::make_shared<std::string>();
    runFiles([state, file = request.file, most = largest_] { *state = readStateFile(file, most); });
    double time = 0.0;
    run([&](SolverLoop& loop) {
      loop.loadState(*state, request.file);
      time = loop.simulation().time();
    });
    return at("loaded", request.file, time);
  });
}

void StateServices::runFiles(const std::function<void()>& work) const {
  if (!runFileWork(work, [this] { return shared_.stop.load(); }))
    throw std::runtime_error("the node ends, and the file system has not answered");
}

void StateServices::run(const SolverTasks::Work& work) const {
  if (!shared_.tasks.run(work, shared_.stop)) throw std::runtime_error("the solver does not answer");
}

}  // namespace haptic_cloth
