// SPDX-License-Identifier: MIT
// This is the only file of the plugin that uses the JSON library.
#include "process/protocol.hpp"

#include "programs/command.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

namespace palpate::process {
namespace {

using Json = nlohmann::ordered_json;
using programs::shown;

/// Writes options as JSON in SI units. It uses the list of fields, so that new options of a motion need no code here.
class OptionsWriter final : public Fields {
 public:
  explicit OptionsWriter(Json& out) : out_(out) {}

  void real(double& value, const Field& field) override { out_[field.name] = value; }
  void real(std::optional<double>& value, const Field& field) override { maybe(value, field); }
  void integer(std::int64_t& value, const Field& field) override { out_[field.name] = value; }
  void integer(std::optional<std::int64_t>& value, const Field& field) override { maybe(value, field); }
  void flag(bool& value, const Field& field) override { out_[field.name] = value; }
  void text(std::string& value, const Field& field) override { out_[field.name] = value; }
  void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) override {
    out_[field.name] = cases[index].name;
    if (cases[index].list) cases[index].list(*this);
  }
  void section(Options& options, const Field& field) override {
    OptionsWriter inner(out_[field.name] = Json::object());
    options.list(inner);
  }
  void section(bool& present, Options& options, const Field& field) override {
    out_[field.name] = nullptr;
    if (present) section(options, field);
  }
  // The options of a motion contain neither lists nor plugins.
  void reals(double*, std::size_t, const Field&) override {}
  void table(std::vector<double>&, std::size_t, const Field&) override {}
  void sections(const ListAccess&, const Field&) override {}
  void plugin(PluginChoice&, const Field&) override {}
  void plugin(std::optional<PluginChoice>&, const char*, const Field&) override {}
  void plugins(std::vector<PluginChoice>&, const char*, const Field&) override {}
  void adopt(PluginChoice&, const Field&) override {}
  void require(bool, const char*, const std::string&) override {}

 private:
  template <class Value>
  void maybe(const std::optional<Value>& value, const Field& field) {
    out_[field.name] = value ? Json(*value) : Json(nullptr);
  }

  Json& out_;
};

/// Reads the fields of one answer. The first error is stored. Values that are read after it are meaningless.
class AnswerReader {
 public:
  AnswerReader(const Json& answer, const TapLine& line, ProtocolVersion protocol) : answer_(answer) {
    std::set<std::string> known{"tap", "outcome", "force", "seconds", "reason", "ends_run"};
    if (line.from_above) known.insert("height");
    if (protocol == ProtocolVersion::any_line) known.insert({"distance", "contacts"});
    for (const auto& [key, value] : answer.items()) {
      if (known.count(key) == 0) refuse("has an unknown field " + shown(key));
    }
  }

  /// Returns whether the field is present and not null.
  bool has(const char* field) const { return answer_.contains(field) && !answer_[field].is_null(); }

  double number(const char* field) {
    if (!has(field)) return refuse(lacks(field)), 0.0;
    if (!answer_[field].is_number()) return refuse(bad(field, "that is not a number")), 0.0;
    return answer_[field].get<double>();
  }

  /// Returns the position of the first contact.
  std::optional<Eigen::Vector3d> position() {
    if (!has("contacts")) return std::nullopt;
    const Json& contacts = answer_["contacts"];
    const bool has_first = contacts.is_array() && !contacts.empty() && contacts[0].is_object();
    const Json position = has_first ? contacts[0].value("position", Json()) : Json();
    bool is_point = position.is_array() && position.size() == 3;
    for (const Json& one : position) is_point = is_point && one.is_number();
    if (!is_point) return refuse(bad("contacts", "whose first item has no 'position' of three numbers")), std::nullopt;
    return Eigen::Vector3d(position[0].get<double>(), position[1].get<double>(), position[2].get<double>());
  }

  std::string text(const char* field) {
    if (!has(field)) return refuse(lacks(field)), "";
    if (!answer_[field].is_string()) return refuse(bad(field, "that is not a text")), "";
    return answer_[field].get<std::string>();
  }

  bool flag(const char* field) {
    if (!has(field)) return false;
    if (!answer_[field].is_boolean()) return refuse(bad(field, "that is neither true nor false")), false;
    return answer_[field].get<bool>();
  }

  /// Returns the reason of a failed tap for the record. The text has at least one character.
  std::string reason() {
    std::string words = plain_line(text("reason"));
    if (words.find_first_not_of(' ') == std::string::npos) refuse("has no text in 'reason'");
    return words;
  }

  Outcome outcome() {
    const std::optional<Outcome> known = answered_outcome(text("outcome"));
    if (!known) refuse("has an unknown outcome");
    return known.value_or(Outcome::aborted);
  }

  void refuse(const std::string& why) {
    if (trouble.empty()) trouble = why;
  }

  std::string trouble;

 private:
  static std::string bad(const char* field, const char* how) { return std::string("has a '") + field + "' " + how; }
  static std::string lacks(const char* field) { return std::string("lacks '") + field + "'"; }

  const Json& answer_;
};

TapResult read_result(AnswerReader& reader, const TapLine& line, const HeightBounds& bounds) {
  // The outcome is read first, so that an invalid outcome is reported before an invalid time.
  const Outcome outcome = reader.outcome();
  TapResult out = tap_without_contact(outcome, reader.number("seconds"));
  if (reader.has("distance")) out.distance = reader.number("distance");
  if (out.outcome == Outcome::contact) {
    out.contact = reader.position();
    const bool is_height = line.from_above && !out.distance && !out.contact;
    if (is_height) out.contact.emplace(line.start.x(), line.start.y(), reader.number("height"));
    out.force = reader.has("force") ? reader.number("force") : 0.0;
  }
  out.ends_run = reader.flag("ends_run");
  const bool is_free_line = !line.from_above && outcome == Outcome::no_contact;
  const bool needs_reason = out.ends_run || (!is_free_line && outcome != Outcome::contact);
  if (needs_reason || (is_free_line && reader.has("reason"))) out.reason = reader.reason();
  complete_contact(line, out);
  if (const auto fault = find_fault(out, line, bounds))
    reader.refuse("is rejected, " + fault->reason + ", " + fault->remedy);
  return out;
}

Json json_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }
Json json_of(const TapLine& line) {
  return {{"start", json_of(line.start)}, {"direction", json_of(line.direction)}, {"length", line.length}};
}
Json position_of(const TapLine& line) { return {{"x", line.start.x()}, {"y", line.start.y()}}; }

/// Returns the first fields of a request. The folder of the record has the run's id as its name.
Json header(const Context& context, ProtocolVersion protocol) {
  Json out{{"palpate", static_cast<int>(protocol)}};
  if (protocol == ProtocolVersion::any_line) out["run"] = std::filesystem::path(context.directory).filename().string();
  return out;
}

/// Returns whether an answer requests the end of the run. The request counts even if the rest of the answer is invalid.
bool wants_end(const Json& answer) {
  const auto end = answer.find("ends_run");
  return end != answer.end() && !end->is_null() && *end != Json(false);
}

Answer refused(const std::string& line, const std::string& why, bool in_step, bool ends_run) {
  return {in_step, false,
          tap_without_contact(Outcome::aborted, 0.0, "the answer " + why + ": " + shown(line), ends_run)};
}

}  // namespace

std::string ask_line(const TapRequest& request, const Context& context, tapping::MotionOptions& motion,
                     ProtocolVersion protocol) {
  Json ask = header(context, protocol);
  ask["tap"] = request.number;
  if (request.line.from_above) ask.update(position_of(request.line));
  if (protocol == ProtocolVersion::any_line) {
    ask["line"] = json_of(request.line);
    ask["lowest_height"] = context.scene.desk();
  }
  ask["previous"] = nullptr;
  if (request.previous) {
    Json& previous = ask["previous"] = Json::object();
    if (request.previous->from_above) previous = position_of(*request.previous);
    if (protocol == ProtocolVersion::any_line) previous.update(json_of(*request.previous));
  }
  ask["predicted"] = nullptr;
  if (request.predicted) {
    ask["predicted"] = {{"height", request.predicted->height},
                        {"standard_deviation", request.predicted->standard_deviation}};
    if (request.predicted->probability) ask["predicted"]["probability"] = *request.predicted->probability;
  }
  const Area area = context.scene.area();
  ask["area"] = {{"width", area.width}, {"depth", area.depth}};
  ask["desk"] = context.scene.desk();
  ask["seed"] = context.seed;
  OptionsWriter fields(ask["motion"] = Json::object());
  motion.list(fields);
  return ask.dump() + "\n";
}

Answer read_answer(const std::string& line, const TapRequest& request, const HeightBounds& bounds,
                   ProtocolVersion protocol) {
  const Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) {
    const bool python = line.find("NaN") != std::string::npos || line.find("Infinity") != std::string::npos;
    return refused(line, python ? "is not JSON, which has no NaN and no Infinity" : "is not JSON", false, false);
  }
  if (!json.is_object()) return refused(line, "is not a JSON object", false, false);
  const bool ends_run = wants_end(json);
  if (!json.contains("tap")) return refused(line, "lacks 'tap'", false, ends_run);
  if (json["tap"] != Json(request.number))
    return refused(line, "does not belong to tap " + std::to_string(request.number), false, ends_run);
  AnswerReader reader(json, request.line, protocol);
  TapResult result = read_result(reader, request.line, bounds);
  if (!reader.trouble.empty()) return refused(line, reader.trouble, true, ends_run);
  return {true, true, std::move(result)};
}

std::string reaches_line(const Candidates& lines, Eigen::Index first, Eigen::Index count, const Context& context) {
  Json ask = header(context, ProtocolVersion::any_line);
  Json& all = ask["reaches"] = Json::array();
  for (Eigen::Index i = first; i < std::min(first + count, lines.size()); ++i) {
    const TapLine line = lines.line(i);
    all.push_back({line.start.x(), line.start.y(), line.start.z(), line.direction.x(), line.direction.y(),
                   line.direction.z(), line.length});
  }
  return ask.dump() + "\n";
}

std::optional<std::vector<bool>> read_reaches(const std::string& line, Eigen::Index count) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || json.size() != 1 || !json.contains("reaches")) return std::nullopt;
  if (json["reaches"].is_null()) return std::vector<bool>();
  if (!json["reaches"].is_string()) return std::nullopt;
  std::vector<bool> out;
  for (const char one : json["reaches"].get<std::string>()) {
    if (one != '0' && one != '1') return std::nullopt;
    out.push_back(one == '1');
  }
  return static_cast<Eigen::Index>(out.size()) == count ? std::optional(out) : std::nullopt;
}

}  // namespace palpate::process
