// SPDX-License-Identifier: MIT
// The only file of this plugin that uses the JSON library.
#include "process/protocol.hpp"

#include "programs/command.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <set>
#include <utility>

namespace palpate::process {
namespace {

using Json = nlohmann::ordered_json;
using programs::shown;

/// Writes options as JSON in SI units from their field list, so that new options of the motion need no code here.
class Written final : public Fields {
 public:
  explicit Written(Json& out) : out_(out) {}

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
    Written inner(out_[field.name] = Json::object());
    options.list(inner);
  }
  void section(bool& present, Options& options, const Field& field) override {
    out_[field.name] = nullptr;
    if (present) section(options, field);
  }
  // A motion has no lists and no plugins.
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

/// Reads the fields of one answer. The first error is kept; values read after it are meaningless.
class Reader {
 public:
  explicit Reader(const Json& answer) : answer_(answer) {
    for (const auto& [key, value] : answer.items()) {
      static const std::set<std::string> known{"tap", "outcome", "height", "force", "seconds", "reason", "ends_run"};
      if (known.count(key) == 0) refuse("has an unknown field " + shown(key));
    }
  }

  /// Returns false for a missing field and for null.
  bool has(const char* field) const { return answer_.contains(field) && !answer_[field].is_null(); }

  double number(const char* field) {
    if (!has(field)) return refuse(lacks(field)), 0.0;
    if (!answer_[field].is_number()) return refuse(bad(field, "that is not a number")), 0.0;
    return answer_[field].get<double>();
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

  /// Returns a text of at least one character for the record.
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

TapResult read_result(Reader& reader, const TapLine& line, const HeightBounds& bounds) {
  const Outcome outcome = reader.outcome();  // first: its fault is told before that of the time
  TapResult out = tap_without_contact(outcome, reader.number("seconds"));
  if (out.outcome == Outcome::contact) {
    out = contact_on(line, reader.number("height"), reader.has("force") ? reader.number("force") : 0.0, out.seconds);
  }
  out.ends_run = reader.flag("ends_run");
  if (out.outcome != Outcome::contact || out.ends_run) out.reason = reader.reason();
  if (const auto fault = find_fault(out, bounds)) reader.refuse("is rejected, " + fault->reason + ", " + fault->remedy);
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

std::string ask_line(const TapRequest& request, const Context& context, tapping::MotionOptions& motion) {
  Json ask;
  ask["palpate"] = kProtocol;
  ask["tap"] = request.number;
  ask["x"] = request.line.start.x();
  ask["y"] = request.line.start.y();
  ask["previous"] = nullptr;
  if (request.previous) ask["previous"] = {{"x", request.previous->start.x()}, {"y", request.previous->start.y()}};
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
  Written fields(ask["motion"] = Json::object());
  motion.list(fields);
  return ask.dump() + "\n";
}

Answer read_answer(const std::string& line, const TapRequest& request, const HeightBounds& bounds) {
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
  Reader reader(json);
  TapResult result = read_result(reader, request.line, bounds);
  if (!reader.trouble.empty()) return refused(line, reader.trouble, true, ends_run);
  return {true, true, std::move(result)};
}

}  // namespace palpate::process
