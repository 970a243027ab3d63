// SPDX-License-Identifier: MIT
// The Python module palpate._palpate. It reads records, recomputes their models, and runs experiments. Only the package
// `palpate` uses this module; palpate/__init__.py is the documented interface.
#include "ask_tell_run.hpp"
#include "config/quantity.hpp"
#include "module_host.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "records.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"
#include "threads.hpp"
#include "values.hpp"

#include <pybind11/stl.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// Calls a Python function after every tap of a run, in the thread of the run. Interrupts the run after Ctrl-C, and if
/// the function raises an exception.
class ProgressObserver final : public Observer {
 public:
  ProgressObserver(std::atomic<bool>& interrupted, py::object progress)
      : interrupted_(interrupted), progress_(std::move(progress)) {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    if (CallsWithoutGil::all().ended()) {
      interrupted_ = true;
      return;
    }
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) return stop(py::error_already_set());
    if (progress_.is_none()) return;
    try {
      CallsWithoutGil::all().call_back(progress_, tap.number());
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
  InterruptibleEnvironment environment;
  ProgressObserver observer(environment.interrupted, progress);
  RunConclusion report;
  {
    const GilRelease no_gil;
    const ResolvedConfig resolved = resolve(config, overrides);
    report = start_run(environment.run_environment, resolved, directory_of(resolved, runs), {force}, {&observer});
  }
  if (observer.trouble()) throw *observer.trouble();
  return report.directory.string();
}

/// Composes and checks every job of a sweep, and then creates the sweep's directory unless it exists. Returns the
/// directory.
std::string begin_sweep(const std::string& config, const std::vector<std::string>& words, const std::string& runs) {
  const GilRelease no_gil;
  Composer fresh = composer();
  SweepDraft draft(runs);
  const SweepPlan plan =
      plan_sweep(fresh, module_environment().host, config, words, runs, [&](const Job& job, const auto& resolved) {
        draft.add(job, resolved);
        if (job.index % 64 == 0) check_signals();
      });
  draft.publish(plan);
  return plan.sweep.directory.string();
}

std::string found_run(const std::string& words, const std::string& runs) {
  const GilRelease no_gil;
  return find_record(words, RecordKind::run, runs).string();
}

std::vector<std::string> found_sweep(const std::vector<std::string>& words, const std::string& runs) {
  const GilRelease no_gil;
  std::vector<std::string> out;
  for (const std::filesystem::path& one : find_records(words, runs)) out.push_back(one.string());
  return out;
}

std::vector<std::tuple<std::string, std::string, std::string>> tap_fields() {
  std::vector<std::tuple<std::string, std::string, std::string>> out;
  for (const RecordField& one : tap_list().fields(true)) out.emplace_back(one.name, unit_symbol(one.unit), one.meaning);
  return out;
}

/// Returns `text`, a message of the program, with force=True instead of the option --force. Commands in quotes are not
/// changed.
std::string in_python(const std::string& text) {
  std::string out;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\'') quoted = !quoted;
    const std::string_view option("--force");
    const bool is_option = !quoted && text.compare(i, option.size(), option) == 0;
    out += is_option ? "force=True" : std::string(1, text[i]);
    if (is_option) i += option.size() - 1;
  }
  return out;
}

Array vector_of(const Eigen::VectorXd& values) { return Array(values.size(), values.data()); }

/// Defines palpate.Error and palpate.InputError, and translates the C++ exception Error to them.
void bind_errors(py::module_& module) {
  // palpate/_errors.py sets the documentation strings of both classes.
  static PyObject* const error = PyErr_NewException("palpate.Error", PyExc_Exception, nullptr);
  module.attr("Error") = py::handle(error);
  static PyObject* const input_error = PyErr_NewException(
      "palpate.InputError", py::make_tuple(py::handle(error), py::handle(PyExc_ValueError)).ptr(), nullptr);
  module.attr("InputError") = py::handle(input_error);
  // By value, as pybind11 declares it. NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& trouble) {
      PyObject* const type = trouble.kind() == Error::Kind::usage ? input_error : error;
      const py::object one = py::reinterpret_borrow<py::object>(type)(in_python(trouble.what()));
      one.attr("place") = trouble.where();
      one.attr("reason") = trouble.reason();
      one.attr("remedy") = in_python(trouble.hint());
      PyErr_SetObject(type, one.ptr());
    }
  });
}

void bind_record(py::module_& module) {
  py::class_<Record>(module, "Record")
      .def(py::init([](const std::string& directory) {
        const GilRelease no_gil;
        return std::make_unique<Record>(directory);
      }))
      .def("is_here", &Record::is_here)
      .def("config", &Record::config)
      .def("id", &Record::id)
      .def("taps", &Record::taps)
      .def("manifest", &Record::manifest)
      .def("summary", &Record::summary)
      .def("size", &Record::size)
      .def("after",
           [](Record& self, int taps) {
             py::dict out;
             for (auto& [name, map] : self.after(taps)) out[name] = array_of(std::move(map));
             return out;
           })
      .def("truth",
           [](Record& self) -> py::object {
             std::optional<Map> truth = self.truth();
             return truth ? array_of(std::move(*truth)) : py::object(py::none());
           })
      .def("axes", [](Record& self) {
        const auto [xs, ys] = self.axes();
        return std::pair(vector_of(xs), vector_of(ys));
      });
}

void bind_sweep_record(py::module_& module) {
  py::class_<SweepRecord>(module, "SweepRecord")
      .def(py::init([](const std::vector<std::string>& directories) {
        const GilRelease no_gil;
        return std::make_unique<SweepRecord>(directories);
      }))
      .def("directory", &SweepRecord::directory)
      .def("keys", &SweepRecord::keys)
      .def("notes", &SweepRecord::notes)
      .def("size", &SweepRecord::size)
      .def("job", &SweepRecord::job)
      .def("table", &SweepRecord::table)
      .def("write_table", &SweepRecord::write_table);
}

void bind_tap(py::module_& module) {
  py::class_<TapRecord>(module, "Tap")
      .def_property_readonly("number", &TapRecord::number)
      .def_property_readonly("x", [](const TapRecord& tap) { return tap.target().x; })
      .def_property_readonly("y", [](const TapRecord& tap) { return tap.target().y; })
      .def_property_readonly("start", [](const TapRecord& tap) { return vector_of(tap.request.line.start); })
      .def_property_readonly("direction", [](const TapRecord& tap) { return vector_of(tap.request.line.direction); })
      .def_property_readonly("length", [](const TapRecord& tap) { return tap.request.line.length; })
      .def_readonly("candidate", &TapRecord::candidate)
      .def_readonly("score", &TapRecord::score)
      .def_property_readonly("source", [](const TapRecord& tap) { return source_name(tap.request.source); })
      .def_readonly("why", &TapRecord::why);
}

void bind_ask_tell_run(py::module_& module) {
  // Arrays are read-only, because changing an array would have no effect on the belief.
  const auto fixed = [](Array out) {
    out.attr("setflags")(py::arg("write") = false);
    return out;
  };
  const auto values = [fixed](AskTellRun& self, const std::string& quantity) {
    const Map map = self.map(quantity);
    return fixed(self.has_grid() ? array_of(map) : vector_of(map.values));
  };
  const auto map = [values](const char* quantity) {
    return [values, quantity](AskTellRun& self) { return values(self, quantity); };
  };
  py::class_<AskTellRun>(module, "AskTellRun")
      .def(py::init<const std::string&, const std::vector<std::string>&, const std::string&, bool>())
      .def(py::init<const std::string&, bool, bool>())
      .def("ask", &AskTellRun::ask)
      .def("tell",
           [](AskTellRun& self, const std::string& outcome, std::optional<double> height,
              std::optional<double> distance, const std::optional<std::array<double, 3>>& contact, double force,
              double seconds, const std::string& reason, bool ends_run) {
             self.tell(result_of(outcome, height, distance, contact, force, seconds, reason, ends_run));
           })
      .def("finish", &AskTellRun::finish)
      .def("close", &AskTellRun::close)
      .def("finished", &AskTellRun::finished)
      .def("directory", &AskTellRun::directory)
      .def("label", &AskTellRun::label)
      .def("taps", &AskTellRun::taps)
      .def("xs", [](AskTellRun& self) { return vector_of(self.xs()); })
      .def("ys", [](AskTellRun& self) { return vector_of(self.ys()); })
      .def("uncertainty", map(quantity::kUncertainty))
      .def("weight", map(quantity::kLabelMean))
      .def("probability", map(quantity::kObjectProbability))
      .def("height_mean", map(quantity::kHeightMean))
      .def("height_std", map(quantity::kHeightStd))
      .def("values", values)
      .def("lines", [fixed](AskTellRun& self) { return fixed(array_of(self.lines())); });
}

}  // namespace
}  // namespace palpate

PYBIND11_MODULE(_palpate, module) {
  using namespace palpate;
  bind_errors(module);
  bind_record(module);
  bind_sweep_record(module);
  bind_tap(module);
  bind_ask_tell_run(module);
  module.def("run", &run);
  module.def("begin_sweep", &begin_sweep);
  module.def("found", &found_run);
  module.def("found_sweep", &found_sweep);
  module.def("tap_fields", &tap_fields);
  module.def("end_calls", [] { CallsWithoutGil::all().end(); });
  module.attr("version") = kVersion;
  module.attr("program") = module_environment().installation.program.string();
}
