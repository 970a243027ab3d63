// SPDX-License-Identifier: MIT
#include "baxter/ros/graph.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <future>
#include <memory>
#include <regex>
#include <utility>

#include <netdb.h>
#include <pthread.h>
#include <xmlrpcpp/XmlRpcException.h>
#include <xmlrpcpp/XmlRpcValue.h>
#include <boost/algorithm/string/find.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/endian/conversion.hpp>

namespace palpate::baxter {
namespace {

namespace asio = boost::asio;
using XmlRpc::XmlRpcValue;
using FailureCause = NetworkError::FailureCause;

constexpr const char* kCaller = "/palpate";
/// Largest number of bytes of an answer; the description of a whole network has about 10'000
constexpr std::size_t kLongest = 4'000'000;
constexpr std::size_t kDeepest = 64;  ///< largest number of nested elements; the description of a whole network has 17

NetworkError not_ros() { return {FailureCause::nonsense, "the program that answers there is not ROS"}; }

/// Returns the first address of a name. With AI_NUMERICHOST no name server is used.
Address first_address(const std::string& host, int flags) {
  addrinfo hints{};
  const char* ipv6 = std::getenv("ROS_IPV6");  // same rule as in roscpp, so that roscpp uses the same addresses
  hints.ai_family = ipv6 != nullptr && std::strcmp(ipv6, "on") == 0 ? AF_UNSPEC : AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  addrinfo* list = nullptr;
  const int error = getaddrinfo(host.c_str(), nullptr, &hints, &list);
  if (error != 0) throw NetworkError(FailureCause::name, gai_strerror(error));
  Address out;
  std::memcpy(out.data(), list->ai_addr, std::min<std::size_t>(list->ai_addrlen, out.capacity()));
  freeaddrinfo(list);
  return out;
}

// ---- XML-RPC: one query and one answer per connection ----

/// Reads the body of an HTTP answer.
std::string http_body(TcpConnection& wire, Deadline deadline) {
  constexpr const char* kLength = "\r\ncontent-length:";
  std::string text;
  std::size_t head = std::string::npos;
  while ((head = text.find("\r\n\r\n")) == std::string::npos) {
    const std::string some = wire.receive_some(4096, deadline);
    text += some;
    if (some.empty() || std::string("HTTP/").compare(0, text.size(), text, 0, 5) != 0 || text.size() > kLongest)
      throw not_ros();
  }
  std::string body = text.substr(head + 4);
  text.resize(head + 2);
  const auto field = boost::algorithm::ifind_first(text, kLength);
  const std::size_t length = field ? std::strtoul(&*field.begin() + std::strlen(kLength), nullptr, 10) : kLongest + 1;
  if (length > kLongest) throw not_ros();
  if (body.size() < length) body += wire.receive(length - body.size(), deadline);
  return body;
}

/// Returns whether elements are closed correctly and not nested too deeply. The library parses recursively, one step
/// per nested value, and searches for the name of a member in all of the following text. So the name must be the first
/// element of its member.
bool is_well_formed(std::string_view xml) {
  std::vector<std::string_view> open;
  bool in_member = false;  // whether the position is in a member, before its name
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at)) {
    const std::size_t end = xml.find_first_of("<>", ++at);
    if (end == std::string_view::npos || end == at || xml[end] == '<' || xml[at] == '!') return false;
    const std::string_view tag = xml.substr(at, end - at);
    if (std::exchange(in_member, tag == "member") && tag != "name") return false;
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (tag.front() != '?' && tag.back() != '/') {
      open.push_back(tag);
      if (open.size() > kDeepest) return false;
    }
  }
  return open.empty();
}

/// Returns the unparsed answer to a query.
std::string call_method(const Address& address, const std::string& method, const std::vector<XmlRpcValue>& arguments,
                        Deadline deadline) {
  std::string body = "<?xml version=\"1.0\"?>\r\n<methodCall><methodName>" + method + "</methodName>\r\n<params>";
  for (const XmlRpcValue& argument : arguments) body += "<param>" + argument.toXml() + "</param>";
  body += "</params></methodCall>\r\n";
  TcpConnection wire(address, deadline);
  wire.send("POST /RPC2 HTTP/1.1\r\nUser-Agent: palpate\r\nHost: ros\r\nContent-Type: text/xml\r\nContent-length: " +
                std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" + body,
            deadline);
  return http_body(wire, deadline);
}

/// Applies `read` to the third part of a ROS answer, or to an invalid value if the first part is not 1 (success).
/// Throws NetworkError if the answer has another form.
template <class Read>
auto parse_answer(const std::string& xml, const Read& read) {
  const std::size_t start = xml.find("<value>");
  int offset = static_cast<int>(start);
  try {
    XmlRpcValue parts;
    if (start == std::string::npos || xml.find("<fault>") != std::string::npos || !is_well_formed(xml) ||
        !parts.fromXml(xml, &offset) || parts.getType() != XmlRpcValue::TypeArray || parts.size() < 3) {
      throw not_ros();
    }
    XmlRpcValue failure;
    return read(static_cast<int>(parts[0]) == 1 ? parts[2] : failure);
  } catch (const XmlRpc::XmlRpcException& exception) {
    throw NetworkError(FailureCause::nonsense, "its answer is invalid: " + exception.getMessage());
  }
}

Graph::Nodes nodes_of(XmlRpcValue& list) {
  Graph::Nodes nodes;
  for (int i = 0; i < list.size(); ++i) {
    auto& names = nodes[static_cast<std::string&>(list[i][0])];
    for (int j = 0; j < list[i][1].size(); ++j) names.push_back(static_cast<std::string&>(list[i][1][j]));
  }
  return nodes;
}

// ---- TCPROS: one header in each direction, then messages ----

std::string number(std::size_t value) {
  const std::uint32_t bits = boost::endian::native_to_little(static_cast<std::uint32_t>(value));
  return {reinterpret_cast<const char*>(&bits), sizeof bits};
}

std::size_t number_at(const std::string& bytes, std::size_t at) {
  return boost::endian::load_little_u32(reinterpret_cast<const unsigned char*>(bytes.data() + at));
}

/// Receives a length and that many bytes.
std::string receive_block(TcpConnection& wire, Deadline deadline) {
  const std::size_t length = number_at(wire.receive(4, deadline), 0);
  if (length > kLongest) throw not_ros();
  return wire.receive(length, deadline);
}

using Header = std::map<std::string, std::string>;

Header exchange_headers(TcpConnection& wire, const Header& ours, Deadline deadline) {
  std::string fields;
  for (const auto& [key, value] : ours) fields += number(key.size() + 1 + value.size()) + key + "=" + value;
  wire.send(number(fields.size()) + fields, deadline);
  const std::string answer = receive_block(wire, deadline);
  Header theirs;
  for (std::size_t at = 0; at + 4 <= answer.size();) {
    const std::size_t length = number_at(answer, at);
    if (length > answer.size() - at - 4) throw not_ros();
    const std::string field = answer.substr(at + 4, length);
    const std::size_t equals = field.find('=');
    if (equals != std::string::npos) theirs[field.substr(0, equals)] = field.substr(equals + 1);
    at += 4 + length;
  }
  if (theirs.count("error") != 0) throw NetworkError(FailureCause::nonsense, "it refuses: " + theirs["error"]);
  return theirs;
}

}  // namespace

Deadline within(std::chrono::milliseconds longest, Deadline deadline) {
  return std::min(deadline, Steady::now() + longest);
}

std::thread thread_without_signals(const std::function<void()>& run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread out(run);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return out;
}

Address look_up(const std::string& host, int port, Deadline deadline) {
  Address out;
  try {
    out = first_address(host, AI_NUMERICHOST);
  } catch (const NetworkError&) {
    // A started look-up cannot be cancelled; its thread ends by itself.
    const auto task = std::make_shared<std::packaged_task<Address()>>([host] { return first_address(host, 0); });
    std::future<Address> found = task->get_future();
    thread_without_signals([task] { (*task)(); }).detach();
    if (found.wait_until(deadline) != std::future_status::ready)
      throw NetworkError(FailureCause::name, "looking up its host takes too long");
    out = found.get();
  }
  out.port(static_cast<unsigned short>(port));
  return out;
}

/// Runs the operation that `begin` starts, until `deadline`. Returns the number of bytes; 0 if the other side closed
/// the connection.
template <class Begin>
std::size_t TcpConnection::finish(Deadline deadline, const Begin& begin) {
  boost::system::error_code error;
  std::size_t bytes = 0;
  begin([&](const boost::system::error_code& outcome, std::size_t count = 0) {
    error = outcome;
    bytes = count;
  });
  io_.restart();
  io_.run_until(deadline);
  if (!io_.stopped()) {
    socket_.close(error);
    io_.run();
    throw NetworkError(FailureCause::silent, "no answer in time");
  }
  if (error == asio::error::eof) return 0;
  if (error) throw NetworkError(FailureCause::refused, error.message());
  return bytes;
}

TcpConnection::TcpConnection(const Address& address, Deadline deadline) {
  // The socket is created here with SOCK_CLOEXEC, so that child processes do not inherit it. Asio would omit the flag.
  const int opened = ::socket(address.data()->sa_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (opened < 0) throw NetworkError(FailureCause::refused, std::strerror(errno));
  socket_.assign(address.protocol(), opened);
  finish(deadline, [&](const auto& done) { socket_.async_connect(address, done); });
}

void TcpConnection::send(const std::string& bytes, Deadline deadline) {
  finish(deadline, [&](const auto& done) { asio::async_write(socket_, asio::buffer(bytes), done); });
}

std::string TcpConnection::receive_some(std::size_t most, Deadline deadline) {
  std::string bytes(most, '\0');
  bytes.resize(finish(deadline, [&](const auto& done) { socket_.async_read_some(asio::buffer(bytes), done); }));
  return bytes;
}

std::string TcpConnection::receive(std::size_t bytes, Deadline deadline) {
  std::string all(bytes, '\0');
  if (finish(deadline, [&](const auto& done) { asio::async_read(socket_, asio::buffer(all), done); }) < bytes)
    throw NetworkError(FailureCause::nonsense, "the connection was ended");
  return all;
}

std::optional<HostPort> parse_uri(const std::string& uri, const std::string& scheme) {
  static const std::regex form("([a-z]+)://([^:/ \t]+):([0-9]{1,5})/?");
  constexpr std::size_t kLongestUri = 1000;  // std::regex matches recursively, one step per character
  std::smatch parts;
  if (uri.size() > kLongestUri || !std::regex_match(uri, parts, form) || parts[1] != scheme) return {};
  const int port = std::stoi(parts[3]);
  if (port < 1 || port > 65535) return {};
  return HostPort{parts[2], port};
}

const std::vector<std::string>& Graph::of(const Nodes& nodes, std::string_view name) {
  static const std::vector<std::string> nobody;
  const auto found = nodes.find(name);
  return found == nodes.end() ? nobody : found->second;
}

int Master::process_id(Deadline deadline) const {
  return parse_answer(call_method(address_, "getPid", {XmlRpcValue(kCaller)}, deadline),
                      [](XmlRpcValue& pid) { return static_cast<int>(pid); });
}

Graph read_graph(const std::string& xml) {
  return parse_answer(xml, [](XmlRpcValue& state) {
    return Graph{nodes_of(state[0]), nodes_of(state[1]), nodes_of(state[2])};
  });
}

Graph Master::graph(Deadline deadline) const {
  return read_graph(call_method(address_, "getSystemState", {XmlRpcValue(kCaller)}, deadline));
}

std::optional<std::string> Master::query(const char* method, const std::string& name, Deadline deadline) const {
  return parse_answer(call_method(address_, method, {XmlRpcValue(kCaller), XmlRpcValue(name)}, deadline),
                      [](XmlRpcValue& value) -> std::optional<std::string> {
                        if (value.getType() != XmlRpcValue::TypeString) return {};
                        return static_cast<std::string&>(value);
                      });
}

MessageType query_publisher(const HostPort& node, const std::string& topic, Deadline deadline) {
  XmlRpcValue protocols;
  protocols[0][0] = std::string("TCPROS");
  const std::string xml = call_method(look_up(node.host, node.port, deadline), "requestTopic",
                                      {XmlRpcValue(kCaller), XmlRpcValue(topic), protocols}, deadline);
  return parse_answer(xml, [&](XmlRpcValue& way) {
    if (way.getType() != XmlRpcValue::TypeArray || way.size() < 3)
      throw NetworkError(FailureCause::nonsense, "the node denies that it publishes the topic");
    TcpConnection wire(look_up(static_cast<std::string&>(way[1]), static_cast<int>(way[2]), deadline), deadline);
    Header answer = exchange_headers(
        wire, {{"callerid", kCaller}, {"topic", topic}, {"md5sum", "*"}, {"type", "*"}, {"message_definition", ""}},
        deadline);
    return MessageType{answer["type"], answer["md5sum"]};
  });
}

std::string call_service(const Address& address, const std::string& name, const std::string& md5,
                         const std::string& request, Deadline deadline) {
  TcpConnection wire(address, deadline);
  exchange_headers(wire, {{"callerid", kCaller}, {"service", name}, {"md5sum", md5}, {"persistent", "0"}}, deadline);
  wire.send(request, deadline);
  const bool served = wire.receive(1, deadline)[0] != 0;
  std::string answer = receive_block(wire, deadline);
  if (!served)
    throw NetworkError(FailureCause::nonsense, "the service failed" + (answer.empty() ? answer : ": " + answer));
  return answer;
}

}  // namespace palpate::baxter
