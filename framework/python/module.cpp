// SPDX-License-Identifier: MIT
// What Python cannot do by itself: to read records, to bring models back, to run, to be asked where to tap. The words
// for people are in palpate/__init__.py, which is all that sees this module.
#include "config/compose.hpp"
#include "config/quantity.hpp"
#include "experiment/experiment.hpp"
#include "experiment/experiment_options.hpp"
#include "experiment/metrics.hpp"
#include "record/build_info.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/recording.hpp"
#include "record/session.hpp"
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <dlfcn.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace py = pybind11;
namespace fs = std::filesystem;

namespace palpate {
namespace {

using Array = py::array_t<double>;

/// What belongs together with this module.
Installation find_own_installation() {
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&find_own_installation), &self) == 0 || self.dli_fname == nullptr)
    throw Error("palpate", "the module does not know where it lies", {}, Error::Kind::run);
  return find_installation(fs::weakly_canonical(self.dli_fname));
}

/// What all runs of this process share. Never destroyed: Python lets go of objects in an order of its own.
struct Home {
  Installation installation = find_own_installation();
  PluginHost host{PluginHost::search_path(installation.plugins)};
  Composer composer{installation.configs, config_keys()};
};
Home& home() {
  static Home* const one = new Home;
  return *one;
}

/// A wish to stop that a run may be given, and all that the run shares with others.
struct Shop {
  std::atomic<bool> interrupted{false};
  Workshop workshop{home().host, home().installation, {"python"}, &interrupted};
};

ResolvedConfig resolve(const std::string& config, const std::vector<std::string>& overrides) {
  std::vector<Override> parsed;
  for (const std::string& text : overrides) parsed.push_back(parse_override(text));
  return resolve_experiment(home().composer.compose(config, parsed), home().host);
}

/// Values that somebody owns, to be read in Python, who keeps the owner alive; no copy is made.
py::array view(const Eigen::VectorXd& values, int rows, int columns, const py::object& owner) {
  py::array_t<double> out({rows, columns}, values.data(), owner);
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return std::move(out);
}

Array copied(const Eigen::VectorXd& values, int rows, int columns) {
  Array out({rows, columns});
  std::copy(values.data(), values.data() + values.size(), out.mutable_data());
  return out;
}

/// What Python has for a value of a config: numbers, truth values, texts, and quantities as texts with their units.
py::object python_of(const Tree& tree) {
  switch (tree.kind) {
    case Tree::Kind::null:
      return py::none();
    case Tree::Kind::list: {
      py::list out;
      for (const Tree& item : tree.items) out.append(python_of(item));
      return std::move(out);
    }
    case Tree::Kind::map: {
      py::dict out;
      for (const Tree::Entry& entry : tree.entries) out[py::str(entry.key)] = python_of(entry.value);
      return std::move(out);
    }
    case Tree::Kind::scalar:
      break;
  }
  const std::string& text = tree.text;
  if (tree.quoted || text.empty()) return py::str(text);
  if (text == "true" || text == "false") return py::bool_(text == "true");
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (*end != '\0') return py::str(text);
  if (text.find_first_not_of("-0123456789") == std::string::npos) return py::int_(py::str(text));
  return py::float_(number);
}

/// A column of a table by its name: numbers with NaN for null, or what Python has for it.
using Column = std::pair<std::string, py::object>;

/// Rows as columns.
std::vector<Column> columns_of(const std::vector<Row>& rows) {
  const std::vector<std::string> names = names_of(rows);
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < names.size(); ++k) known.emplace(names[k], k);
  std::vector<std::vector<const Scalar*>> cells(names.size(), std::vector<const Scalar*>(rows.size(), nullptr));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [name, value] : rows[i].fields) cells[known.at(name)][i] = &value;
  }
  std::vector<Column> out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    bool numbers = true;
    bool whole = true;
    bool flags = true;
    for (const Scalar* cell : cells[k]) {
      const bool null = cell == nullptr || std::holds_alternative<std::monostate>(*cell);
      const bool is_whole = !null && std::holds_alternative<std::int64_t>(*cell);
      whole = whole && is_whole;
      numbers = numbers && (null || is_whole || std::holds_alternative<double>(*cell));
      flags = flags && !null && std::holds_alternative<bool>(*cell);
    }
    const auto fill = [&](auto array, const auto& value_of) {
      auto* to = array.mutable_data();
      for (const Scalar* cell : cells[k]) *to++ = value_of(cell);
      out.emplace_back(names[k], std::move(array));
    };
    const auto n = static_cast<py::ssize_t>(rows.size());
    if (flags) {
      fill(py::array_t<bool>(n), [](const Scalar* cell) { return std::get<bool>(*cell); });
    } else if (whole) {
      fill(py::array_t<std::int64_t>(n), [](const Scalar* cell) { return std::get<std::int64_t>(*cell); });
    } else if (numbers) {
      fill(Array(n), [](const Scalar* cell) {
        if (cell == nullptr || std::holds_alternative<std::monostate>(*cell))
          return std::numeric_limits<double>::quiet_NaN();
        const auto* integer = std::get_if<std::int64_t>(cell);
        return integer != nullptr ? static_cast<double>(*integer) : std::get<double>(*cell);
      });
    } else {
      py::list all;
      for (const Scalar* cell : cells[k]) {
        if (cell == nullptr || std::holds_alternative<std::monostate>(*cell)) {
          all.append(py::none());
        } else {
          std::visit(
              [&](const auto& value) {
                if constexpr (!std::is_same_v<std::decay_t<decltype(value)>, std::monostate>) all.append(value);
              },
              *cell);
        }
      }
      out.emplace_back(names[k], std::move(all));
    }
  }
  return out;
}

/// What is believed as of now, in arrays of the caller's.
py::dict maps_of(Experiment& experiment) {
  experiment.build(Quantity::uncertainty | Quantity::weight | Quantity::probability | Quantity::height);
  const TapBelief& belief = experiment.belief();
  const int rows = experiment.candidates().rows;
  const int columns = experiment.candidates().columns;
  py::dict out;
  out["height_mean"] = copied(belief.height_mean(), rows, columns);
  out["height_standard_deviation"] = copied(belief.height_variance().cwiseMax(0.0).cwiseSqrt(), rows, columns);
  out["uncertainty"] = copied(belief.uncertainty(), rows, columns);
  out["weight"] = copied(belief.weight(), rows, columns);
  out["probability"] = copied(belief.probability(), rows, columns);
  out["surface"] = copied(reconstruction(belief), rows, columns);
  return out;
}

/// A run directory and its models.
class Record {
 public:
  explicit Record(const std::string& directory) : recording_(read_recording(shop_.workshop, directory)) {}

  py::object config() const { return python_of(recording_.config.tree); }
  std::string id() const { return recording_.config.id; }
  std::vector<Column> taps() const { return columns_of(recording_.rows); }
  int size() const { return static_cast<int>(recording_.rows.size()); }

  /// The models after so many taps.
  py::dict after(int taps) {
    if (taps < 0 || taps > size())
      throw Error("after", "there are " + std::to_string(size()) + " taps, not " + std::to_string(taps), "take fewer");
    if (!playback_ || playback_->taps() > taps) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    {
      const py::gil_scoped_release free;
      playback_->advance_to(taps);
    }
    return maps_of(playback_->experiment());
  }

  /// The heights of the scene that was tapped; None where another world was.
  py::object truth() {
    if (!playback_) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    Experiment& experiment = playback_->experiment();
    const Truth* truth = experiment.truth();
    if (truth == nullptr) return py::none();
    return copied(truth->height, experiment.candidates().rows, experiment.candidates().columns);
  }

  std::pair<Array, Array> axes() {
    if (!playback_) playback_ = std::make_unique<Playback>(shop_.workshop, recording_);
    const Candidates& candidates = playback_->experiment().candidates();
    return {Array(candidates.xs.size(), candidates.xs.data()), Array(candidates.ys.size(), candidates.ys.data())};
  }

 private:
  Shop shop_;
  Recording recording_;
  std::unique_ptr<Playback> playback_;
};

/// A run whose taps the caller makes.
class Asked {
 public:
  Asked(const std::string& config, const std::vector<std::string>& overrides, const std::string& runs, bool force) {
    const ResolvedConfig resolved = resolve(config, overrides);
    run_ = CallersRun::start(shop_.workshop, resolved, directory_of(resolved, runs), force);
  }
  Asked(const std::string& directory, bool retry_failed, bool force) {
    run_ = CallersRun::resume(shop_.workshop, directory, {retry_failed, force});
  }

  std::optional<TapRecord> ask(const std::optional<Array>& scores) {
    std::optional<Eigen::VectorXd> values;
    if (scores) values = checked(*scores);
    const py::gil_scoped_release free;
    const TapRecord* tap = open().begin(values ? &*values : nullptr);
    return tap != nullptr ? std::optional(*tap) : std::nullopt;
  }

  void tell(Contact contact) {
    const py::gil_scoped_release free;
    open().end(std::move(contact));
  }

  std::string finish() {
    const py::gil_scoped_release free;
    return to_json_text(open().finish().summary);
  }
  /// Lets go of the directory; what is not finished can be carried on.
  void close() { run_.reset(); }

  bool finished() { return open().finished(); }
  std::string directory() { return open().directory().string(); }
  int taps() { return open().experiment().counts().taps; }
  std::pair<int, int> shape() {
    const Candidates& candidates = open().experiment().candidates();
    return {candidates.rows, candidates.columns};
  }
  Experiment& experiment() { return open().experiment(); }

 private:
  CallersRun& open() {
    if (!run_) throw Error("experiment", "is closed", "palpate.Experiment.resume(DIR) carries it on");
    return *run_;
  }
  Eigen::VectorXd checked(const Array& scores) {
    const auto wanted = static_cast<py::ssize_t>(open().experiment().candidates().size());
    if (scores.size() != wanted) {
      throw Error("scores", "has " + std::to_string(scores.size()) + " values",
                  "give one a candidate, " + std::to_string(wanted));
    }
    const py::array_t<double, py::array::c_style | py::array::forcecast> dense(scores);
    const Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(dense.data(), wanted);
    if (!out.allFinite()) throw Error("scores", "has a value that is not a finite number", "0 is worth nothing");
    return out;
  }

  Shop shop_;
  std::unique_ptr<CallersRun> run_;
};

/// Hears of every tap of a run, on the thread that runs it: Ctrl-C ends the run as it does in a terminal.
class Listener final : public Journal {
 public:
  Listener(std::atomic<bool>& interrupted, py::object progress)
      : interrupted_(interrupted), progress_(std::move(progress)) {}
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) return stop(py::error_already_set());
    if (progress_.is_none()) return;
    try {
      progress_(tap.number);
    } catch (const py::error_already_set& trouble) {
      stop(trouble);
    }
  }
  const std::optional<py::error_already_set>& trouble() const { return trouble_; }

 private:
  void stop(const py::error_already_set& trouble) {
    trouble_ = trouble;
    interrupted_ = true;
  }

  std::atomic<bool>& interrupted_;
  py::object progress_;
  std::optional<py::error_already_set> trouble_;
};

std::string run(const std::string& config, const std::vector<std::string>& overrides, const std::string& runs,
                bool force, const py::object& progress) {
  Shop shop;
  const ResolvedConfig resolved = resolve(config, overrides);
  Listener listener(shop.interrupted, progress);
  RunReport report;
  {
    const py::gil_scoped_release free;
    report = start_run(shop.workshop, resolved, directory_of(resolved, runs), force, &listener);
  }
  if (listener.trouble()) throw *listener.trouble();
  return report.directory.string();
}

std::vector<std::tuple<std::string, std::string, std::string>> tap_fields() {
  std::vector<std::tuple<std::string, std::string, std::string>> out;
  for (const RecordField& one : tap_list().fields(true)) out.emplace_back(one.name, unit_symbol(one.unit), one.meaning);
  return out;
}

Contact contact_of(const std::string& outcome, double height, double force, double seconds, const std::string& reason,
                   bool ends_run) {
  for (const Outcome one : {Outcome::contact, Outcome::no_contact, Outcome::unreachable, Outcome::timeout,
                            Outcome::aborted, Outcome::unknown}) {
    if (outcome != outcome_name(one)) continue;
    if (one == Outcome::contact && !std::isfinite(height))
      throw Error("tell", "the height of a contact is not a finite number",
                  "tell outcome=\"no_contact\" if there was none");
    return {one, height, force, seconds, reason, ends_run};
  }
  throw Error("tell", "there is no outcome '" + outcome + "'",
              "it is contact, no_contact, unreachable, timeout, aborted or unknown");
}

}  // namespace
}  // namespace palpate

PYBIND11_MODULE(_palpate, module) {
  using namespace palpate;
  // Made by palpate/__init__.py, which gives it its words.
  static PyObject* const error = PyErr_NewException("palpate.Error", PyExc_Exception, nullptr);
  module.attr("Error") = py::handle(error);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& trouble) {
      const py::object one = py::reinterpret_borrow<py::object>(error)(trouble.what());
      one.attr("place") = trouble.where();
      one.attr("reason") = trouble.reason();
      one.attr("remedy") = trouble.hint();
      PyErr_SetObject(error, one.ptr());
    }
  });
  py::class_<Record>(module, "Record")
      .def(py::init<const std::string&>())
      .def("config", &Record::config)
      .def("id", &Record::id)
      .def("taps", &Record::taps)
      .def("size", &Record::size)
      .def("after", &Record::after)
      .def("truth", &Record::truth)
      .def("axes", &Record::axes);
  py::class_<TapRecord>(module, "Tap")
      .def_readonly("number", &TapRecord::number)
      .def_property_readonly("x", [](const TapRecord& tap) { return tap.target.x; })
      .def_property_readonly("y", [](const TapRecord& tap) { return tap.target.y; })
      .def_readonly("candidate", &TapRecord::candidate)
      .def_readonly("score", &TapRecord::score)
      .def_property_readonly("source", [](const TapRecord& tap) { return source_name(tap.source); })
      .def_readonly("why", &TapRecord::why);
  const auto map = [](const Eigen::VectorXd& (TapBelief::*quantity)() const, Quantity wanted) {
    return [quantity, wanted](const py::object& self) {
      Asked& asked = self.cast<Asked&>();
      asked.experiment().build(wanted);
      const Candidates& candidates = asked.experiment().candidates();
      return view((asked.experiment().belief().*quantity)(), candidates.rows, candidates.columns, self);
    };
  };
  py::class_<Asked>(module, "Asked")
      .def(py::init<const std::string&, const std::vector<std::string>&, const std::string&, bool>())
      .def(py::init<const std::string&, bool, bool>())
      .def("ask", &Asked::ask)
      .def("tell", [](Asked& self, const std::string& outcome, double height, double force, double seconds,
                      const std::string& reason,
                      bool ends_run) { self.tell(contact_of(outcome, height, force, seconds, reason, ends_run)); })
      .def("finish", &Asked::finish)
      .def("close", &Asked::close)
      .def("finished", &Asked::finished)
      .def("directory", &Asked::directory)
      .def("taps", &Asked::taps)
      .def("shape", &Asked::shape)
      .def("xs",
           [](Asked& self) {
             const Eigen::VectorXd& v = self.experiment().candidates().xs;
             return Array(v.size(), v.data());
           })
      .def("ys",
           [](Asked& self) {
             const Eigen::VectorXd& v = self.experiment().candidates().ys;
             return Array(v.size(), v.data());
           })
      .def("uncertainty", map(&TapBelief::uncertainty, Quantity::uncertainty))
      .def("weight", map(&TapBelief::weight, Quantity::weight))
      .def("probability", map(&TapBelief::probability, Quantity::probability))
      .def("height_mean", map(&TapBelief::height_mean, Quantity::height))
      .def("height_variance", map(&TapBelief::height_variance, Quantity::height));
  module.def("run", &run);
  module.def("tap_fields", &tap_fields);
  module.attr("version") = kVersion;
}
