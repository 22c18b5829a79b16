#include "raw_listeners.h"

#include <netdb.h>
#include <poll.h>
#include <ros/master.h>
#include <ros/network.h>
#include <sys/socket.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace haptic_cloth {
namespace {

/// Small, so that a listener that hangs has an effect at once [bytes].
constexpr int kReceiveBuffer = 16384;

/// Asks the publisher for the address of its topic.
void requestTopic(const std::string& node, const std::string& topic, std::string& host, int& port) {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = "/raw_listener";
  request[1] = node;
  std::string api_host;
  std::uint32_t api_port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, false) ||
      !ros::network::splitURI(static_cast<std::string>(uri), api_host, api_port)) {
    throw std::runtime_error(node + " is not known");
  }
  XmlRpc::XmlRpcClient client(api_host.c_str(), static_cast<int>(api_port), "/");
  XmlRpc::XmlRpcValue question, answer;
  question[0] = "/raw_listener";
  question[1] = topic;
  question[2][0][0] = "TCPROS";
  if (!client.execute("requestTopic", question, answer) || static_cast<int>(answer[0]) != 1) {
    throw std::runtime_error(topic + " is not published by " + node);
  }
  host = static_cast<std::string>(answer[2][1]);
  port = static_cast<int>(answer[2][2]);
}

void append(std::string& text, std::uint32_t number) {
  // Little-endian, as in TCPROS.
  text.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string header(const std::vector<std::string>& fields) {
  std::string text;
  for (const std::string& field : fields) {
    append(text, static_cast<std::uint32_t>(field.size()));
    text += field;
  }
  std::string block;
  append(block, static_cast<std::uint32_t>(text.size()));
  return block + text;
}

}  // namespace

RawListeners::RawListeners(const std::string& node, const std::string& topic, int count) {
  std::string host;
  int port = 0;
  requestTopic(node, topic, host, port);
  for (int k = 0; k < count; ++k) open(host, port, topic, k);
  thread_ = std::thread([this] { run(); });
}

RawListeners::~RawListeners() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  for (const Connection& connection : connections_) close(connection.socket);
}

long RawListeners::fewest() const { return fewest_; }

void RawListeners::open(const std::string& host, int port, const std::string& topic, int number) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* address = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &address) != 0) {
    throw std::runtime_error(host + " has no address");
  }
  Connection connection;
  connection.socket = socket(AF_INET, SOCK_STREAM, 0);
  setsockopt(connection.socket, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  const int refused = connect(connection.socket, address->ai_addr, address->ai_addrlen);
  freeaddrinfo(address);
  const std::string hello = header({"callerid=/raw_listener_" + std::to_string(number), "topic=" + topic,
                                    "type=*", "md5sum=*", "tcp_nodelay=1"});
  if (refused != 0 ||
      write(connection.socket, hello.data(), hello.size()) != static_cast<ssize_t>(hello.size())) {
    close(connection.socket);
    throw std::runtime_error(host + " refuses the connection");
  }
  connections_.push_back(connection);
}

void RawListeners::run() {
  std::vector<pollfd> sockets;
  for (const Connection& connection : connections_) sockets.push_back({connection.socket, POLLIN, 0});
  while (!stop_) {
    if (stalled_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    poll(sockets.data(), sockets.size(), 50);
    long fewest = LONG_MAX;
    for (std::size_t k = 0; k < sockets.size(); ++k) {
      if (sockets[k].revents != 0) read(connections_[k]);
      if (connections_[k].socket < 0) sockets[k].fd = -1;
      fewest = std::min(fewest, connections_[k].messages);
    }
    fewest_ = fewest;
  }
}

void RawListeners::read(Connection& connection) {
  char chunk[65536];
  const ssize_t size = recv(connection.socket, chunk, sizeof chunk, MSG_DONTWAIT);
  if (size <= 0) {
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    close(connection.socket);
    connection.socket = -1;
    ++closed_;
    return;
  }
  connection.bytes.insert(connection.bytes.end(), chunk, chunk + size);
  std::size_t at = 0;
  for (std::uint32_t length = 0; connection.bytes.size() - at >= sizeof length;
       at += sizeof length + length) {
    std::memcpy(&length, connection.bytes.data() + at, sizeof length);
    if (connection.bytes.size() - at - sizeof length < length) break;
    ++connection.messages;
  }
  connection.bytes.erase(connection.bytes.begin(),
                         connection.bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace haptic_cloth
