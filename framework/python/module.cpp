// SPDX-License-Identifier: MIT
// What Python cannot do by itself: to read records, to bring models back, to run, to be asked where to tap. The words
// for people are in palpate/__init__.py, which is all that sees this module.
#include "asked.hpp"
#include "config/quantity.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/tap_row.hpp"
#include "records.hpp"
#include "shop.hpp"
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

/// Hears of every tap of a run, on the thread that runs it: Ctrl-C ends the run as it does in a terminal.
class Listener final : public Journal {
 public:
  Listener(std::atomic<bool>& interrupted, py::object progress)
      : interrupted_(interrupted), progress_(std::move(progress)) {}
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    if (Calls::all().ended()) {
      interrupted_ = true;
      return;
    }
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0) return stop(py::error_already_set());
    if (progress_.is_none()) return;
    try {
      Calls::all().call_back(progress_, tap.number);
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
  Listener listener(shop.interrupted, progress);
  RunReport report;
  {
    const Unlocked others_go_on;
    const ResolvedConfig resolved = resolve(config, overrides);
    report = start_run(shop.workshop, resolved, directory_of(resolved, runs), force, &listener);
  }
  if (listener.trouble()) throw *listener.trouble();
  return report.directory.string();
}

/// Makes the directory of a sweep, with every job of it composed and checked, unless it is there. Returns where it is.
std::string begin_sweep(const std::string& config, const std::vector<std::string>& words, const std::string& runs) {
  const Unlocked others_go_on;
  Composer fresh = composer();
  SweepDraft draft(runs);
  const SweepPlan plan = plan_sweep(fresh, home().host, config, words, runs, [&](const Job& job, const auto& resolved) {
    draft.add(job, resolved);
    if (job.index % 64 == 0) check_signals();
  });
  draft.publish(plan);
  return plan.sweep.directory.string();
}

std::string found(const std::string& words, const std::string& runs) {
  const Unlocked others_go_on;
  return find_record(words, Wanted::run, runs).string();
}

std::vector<std::string> found_sweep(const std::vector<std::string>& words, const std::string& runs) {
  const Unlocked others_go_on;
  std::vector<std::string> out;
  for (const std::filesystem::path& one : find_records(words, runs)) out.push_back(one.string());
  return out;
}

std::vector<std::tuple<std::string, std::string, std::string>> tap_fields() {
  std::vector<std::tuple<std::string, std::string, std::string>> out;
  for (const RecordField& one : tap_list().fields(true)) out.emplace_back(one.name, unit_symbol(one.unit), one.meaning);
  return out;
}

/// A text of the program with the arguments of Python for its options: force=True for --force, but for those of a
/// command in quotes.
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

Array line(const Eigen::VectorXd& values) { return Array(values.size(), values.data()); }

}  // namespace
}  // namespace palpate

PYBIND11_MODULE(_palpate, module) {
  using namespace palpate;
  // Made by palpate/__init__.py, which gives it its words.
  static PyObject* const error = PyErr_NewException("palpate.Error", PyExc_Exception, nullptr);
  module.attr("Error") = py::handle(error);
  static PyObject* const input_error = PyErr_NewException(
      "palpate.InputError", py::make_tuple(py::handle(error), py::handle(PyExc_ValueError)).ptr(), nullptr);
  module.attr("InputError") = py::handle(input_error);
  // NOLINTNEXTLINE(performance-unnecessary-value-param): so pybind11 wants it
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
  py::class_<Record>(module, "Record")
      .def(py::init([](const std::string& directory) {
        const Unlocked others_go_on;
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
        return std::pair(line(xs), line(ys));
      });
  py::class_<SweepRecord>(module, "SweepRecord")
      .def(py::init([](const std::vector<std::string>& directories) {
        const Unlocked others_go_on;
        return std::make_unique<SweepRecord>(directories);
      }))
      .def("directory", &SweepRecord::directory)
      .def("keys", &SweepRecord::keys)
      .def("notes", &SweepRecord::notes)
      .def("size", &SweepRecord::size)
      .def("job", &SweepRecord::job)
      .def("table", &SweepRecord::table)
      .def("write_table", &SweepRecord::write_table);
  py::class_<TapRecord>(module, "Tap")
      .def_readonly("number", &TapRecord::number)
      .def_property_readonly("x", [](const TapRecord& tap) { return tap.target.x; })
      .def_property_readonly("y", [](const TapRecord& tap) { return tap.target.y; })
      .def_readonly("candidate", &TapRecord::candidate)
      .def_readonly("score", &TapRecord::score)
      .def_property_readonly("source", [](const TapRecord& tap) { return source_name(tap.source); })
      .def_readonly("why", &TapRecord::why);
  // To change one would change nothing.
  const auto map = [](const Eigen::VectorXd& (TapBelief::*quantity)() const, Quantity wanted) {
    return [quantity, wanted](Asked& self) {
      Array out = array_of(self.map(quantity, wanted));
      out.attr("setflags")(py::arg("write") = false);
      return out;
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
      .def("label", &Asked::label)
      .def("taps", &Asked::taps)
      .def("xs", [](Asked& self) { return line(self.xs()); })
      .def("ys", [](Asked& self) { return line(self.ys()); })
      .def("uncertainty", map(&TapBelief::uncertainty, Quantity::uncertainty))
      .def("weight", map(&TapBelief::weight, Quantity::weight))
      .def("probability", map(&TapBelief::probability, Quantity::probability))
      .def("height_mean", map(&TapBelief::height_mean, Quantity::height))
      .def("height_variance", map(&TapBelief::height_variance, Quantity::height));
  module.def("run", &run);
  module.def("begin_sweep", &begin_sweep);
  module.def("found", &found);
  module.def("found_sweep", &found_sweep);
  module.def("tap_fields", &tap_fields);
  module.def("end_calls", [] { Calls::all().end(); });
  module.attr("version") = kVersion;
  module.attr("program") = home().installation.program.string();
}
