// SPDX-License-Identifier: Apache-2.0
// The Python module `capstan`: what the commands of the host program do, over files and arrays. docs/python.md is its
// manual.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/next_experiment.hpp"
#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/jobs/diagnose_job.hpp"
#include "capstan/tools/python/column.hpp"
#include "capstan/tools/python/law.hpp"
#include "capstan/tools/python/logs.hpp"
#include "capstan/tools/python/words.hpp"
#include "capstan/tools/report/report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/named_files.hpp"
#include "capstan/tools/support/text.hpp"

namespace py = pybind11;

namespace capstan::python {
namespace {

using namespace tools;
using std::filesystem::path;

auto all_in_python(std::vector<std::string> sentences) -> std::vector<std::string> {
  for (auto& sentence : sentences) {
    sentence = in_python(sentence);
  }
  return sentences;
}

/// Sentences that came up while Python was not looking, for its warnings.
class Warnings {
 public:
  auto say() -> Say {
    return [this](const std::string& text) { texts_.push_back(text); };
  }
  void pass_on() const {
    for (const auto& text : texts_) {
      if (PyErr_WarnEx(PyExc_UserWarning, in_python(text).c_str(), 1) != 0) {
        throw py::error_already_set();
      }
    }
  }

 private:
  std::vector<std::string> texts_;
};

auto arithmetic_of(const std::string& name) -> Arithmetic {
  if (name != "fixed" && name != "double") {
    throw BadInput("arithmetic is '" + name + "'; give 'fixed', the firmware's, or 'double'");
  }
  return name == "fixed" ? Arithmetic::kFixed : Arithmetic::kDouble;
}

auto numbers_of(const std::optional<Column>& column) -> std::optional<Eigen::VectorXd> {
  return column ? std::optional(column->values) : std::nullopt;
}

auto identify_law(const Logs& logs, const std::string& model, const std::string& target, int axis, const Maps& map,
                  const std::vector<int>& coupled_to) -> Law {
  JobLogs read{read_some(logs, map), axis, coupled_to};
  Warnings warnings;
  const Law law = [&] {
    const py::gil_scoped_release others_may_run;
    if (is_force_law(model)) {
      const IdentifiedForce done = identify_force(read, model, warnings.say());
      if (!done.fit.undetermined.empty()) {
        throw Refusal(undetermined_sentence(done.fit));
      }
      return Law::from(done, model);
    }
    const Identified done = identify({std::move(read), model, target}, warnings.say());
    if (!done.result.undetermined.empty()) {
      throw Refusal(undetermined_sentence(done.result.undetermined));
    }
    return Law::from(done);
  }();
  warnings.pass_on();
  return law;
}

struct Outputs {
  std::optional<path> law, report, next;
};

void expect_sound_outputs(const Outputs& outputs, const Logs& logs, const Logs& test, const std::string& base) {
  std::vector<NamedFile> read;
  if (!base.empty()) {
    read.push_back({"base", base});
  }
  for (const auto& [argument, files] : {std::pair("logs", files_of(logs)), std::pair("test", files_of(test))}) {
    for (const std::string& file : files) {
      read.push_back({argument, file});
    }
  }
  std::vector<NamedFile> written;
  for (const auto& [argument, file] :
       {std::pair("law", outputs.law), std::pair("report", outputs.report), std::pair("next", outputs.next)}) {
    if (file) {
      written.push_back({argument, file->string(), argument == std::string_view("report")});
    }
  }
  expect_sound_files(read, written);
}

/// Tells the caller how far it is, and lets Ctrl-C through.
auto progress_to(const py::object& callback) -> Say {
  return [&callback](const std::string& what) {
    const py::gil_scoped_acquire python;
    if (PyErr_CheckSignals() != 0) {
      throw py::error_already_set();
    }
    if (!callback.is_none()) {
      callback(what);
    }
  };
}

auto diagnose_logs(const Logs& logs, const std::string& base, const std::string& target, const Logs& test, int axis,
                   const Maps& map, const std::vector<int>& coupled_to, const Outputs& outputs,
                   const py::object& progress) -> py::object {
  expect_sound_outputs(outputs, logs, test, base);
  auto tests = read_tests(test, logs, map);
  DiagnoseJob job{.logs = {read_some(logs, map), axis, coupled_to},
                  .tests = std::move(tests),
                  .base = base,
                  .target = target,
                  .progress = progress_to(progress)};
  Warnings warnings;
  std::string json;
  {
    const py::gil_scoped_release others_may_run;
    Diagnosis diagnosis = diagnose(job, warnings.say());
    if (outputs.law) {
      write_law(diagnosis, outputs.law->string());
    }
    if (outputs.report) {
      write_report(outputs.report->string(), diagnosis);
    }
    if (const std::string next = next_scenario(diagnosis); outputs.next && !next.empty()) {
      write_text_file(outputs.next->string(), next);
    }
    json = diagnosis_json(diagnosis);
  }
  warnings.pass_on();
  return py::module_::import("json").attr("loads")(json);
}

auto parameters_of(const Law& law) -> py::dict {
  py::dict all;
  for (const Parameter& p : law.parameters()) {
    py::dict one;
    one["value"] = p.value;
    one["unit"] = p.unit;
    one["ci95"] = p.ci95 ? py::cast(*p.ci95) : py::none();
    all[py::str(p.name)] = one;
  }
  return all;
}

auto fit_of(const Law& law) -> py::object {
  const auto fit = law.fit();
  if (!fit) {
    return py::none();
  }
  py::dict summary;
  summary["rmse"] = fit->rmse;
  const bool has_gof = law.kind() != "force" && std::isfinite(fit->gof_percent);
  summary["gof_percent"] = has_gof ? py::object(py::float_(fit->gof_percent)) : py::none();
  summary["samples"] = fit->samples;
  return summary;
}

/// Objects come from the module's functions only: without a value behind it one would be read from nowhere.
template <typename T>
auto made_by_functions(py::class_<T> type, const char* functions) -> py::class_<T> {
  type.def_static("__new__", [functions](const py::args&, const py::kwargs&) {
    throw py::type_error(std::string("it is made by ") + functions);
  });
  return type;
}

void add_logs(py::module_& module) {
  const char* contract = "A log: columns of numbers, by the names of the contract (docs/logs.md).";
  made_by_functions(py::class_<CsvLog>(module, "Log", contract), "read_log() and log()")
      .def_property_readonly("name", &CsvLog::name)
      .def_property_readonly("columns", &CsvLog::column_names, "names in the file")
      .def_property_readonly(
          "warnings", [](const CsvLog& log) { return all_in_python(log.warnings()); },
          "what was done with the file to read it")
      .def("__len__", &CsvLog::rows)
      .def("__contains__", &CsvLog::has)
      .def(
          "__getitem__",
          [](const CsvLog& log, const std::string& name) -> Eigen::VectorXd {
            return name == "time_s" ? log.time() : log.column(name);
          },
          "Every cell of a column as a number, mapped if a mapping names it.")
      .def("with_gaps", &CsvLog::column_with_gaps, py::arg("name"), "The same with NaN where a cell is empty.")
      .def("__repr__", [](const CsvLog& log) {
        return "<capstan.Log " + log.name() + ", " + std::to_string(log.rows()) +
               " rows: " + joined(log.column_names()) + ">";
      });
  module.def(
      "read_log", [](const path& file, const Maps& map) { return CsvLog::read(file.string(), mappings_of(map)); },
      py::arg("path"), py::arg("map") = std::vector<std::string>{},
      "Reads a log: CSV or MCAP, packed or not. `map` as --map: {'axis0/tau_Nm': 'current_A*0.0369'}.");
  module.def(
      "log", &log_of_columns, py::arg("columns"), py::arg("map") = std::vector<std::string>{},
      "A log of arrays: {'time_s': t, 'axis0/q1_rad': q1, ...}, or a DataFrame. NaN and what is masked are gaps.");
}

void add_laws(py::module_& module) {
  made_by_functions(py::class_<Replayed>(module, "Estimate", "What a law says of the joint's angle."), "Law.run()")
      .def_readonly("q2", &Replayed::q2, "what the firmware acts on, rad")
      .def_readonly("q2_reported", &Replayed::reported, "what the joint's sensor would report under the law, rad");
  made_by_functions(py::class_<Law>(module, "Law", "A law with its numbers; the text is that of its file."),
                    "load_law() and identify()")
      .def_property_readonly("kind", &Law::kind, "'angle', 'effort' or 'force'")
      .def_property_readonly("status", &Law::status, "'confirmed', 'provisional' or 'base'")
      .def_property_readonly("terms", &Law::terms)
      .def_property_readonly("parameters", &parameters_of, "name: {'value', 'unit', 'ci95'}")
      .def_property_readonly("fit", &fit_of, "{'rmse', 'gof_percent', 'samples'}, or None")
      .def_property_readonly("notes", [](const Law& law) { return all_in_python(law.notes()); })
      .def_property_readonly("text", &Law::text)
      .def("save", &Law::save, py::arg("path"), "Writes the law's file, for instance joint.toml.")
      .def(
          "run",
          [](const Law& law, const Column& q1, const std::optional<Column>& tau, double rate_hz,
             const std::string& arithmetic, const std::optional<Column>& temperature,
             const std::vector<std::pair<Column, Column>>& others) {
            Inputs inputs{q1.values, numbers_of(tau), numbers_of(temperature), {}, rate_hz};
            for (const auto& [other_q1, other_tau] : others) {
              inputs.others.emplace_back(other_q1.values, other_tau.values);
            }
            return law.run(inputs, arithmetic_of(arithmetic));
          },
          py::arg("q1"), py::arg("tau") = py::none(), py::kw_only(), py::arg("rate_hz") = 1000.0,
          py::arg("arithmetic") = "double", py::arg("temperature") = py::none(), py::arg("others") = py::tuple(),
          "Runs a law of a joint angle over arrays: motor angle in rad, motor torque in N m, evenly sampled.\n"
          "arithmetic='fixed' is the board's, bit for bit, at 1000 Hz only.")
      .def(
          "replay",
          [](const Law& law, const LogLike& log, const std::string& arithmetic, int axis, const Maps& map) {
            Warnings warnings;
            CsvLog with = law.replay(read_one(log, map), axis, arithmetic_of(arithmetic), warnings.say());
            warnings.pass_on();
            return with;
          },
          py::arg("log"), py::kw_only(), py::arg("arithmetic") = "fixed", py::arg("axis") = 0,
          py::arg("map") = std::vector<std::string>{}, "The log with the law's estimates as further columns.")
      .def("__repr__", [](const Law& law) {
        return "<capstan.Law of " + law.kind() + ", " + law.status() + ": " + joined(law.terms()) + ">";
      });
  module.def(
      "load_law", [](const path& file) { return Law::read(file.string()); }, py::arg("path"),
      "Reads a law's file, joint.toml.");
}

void add_commands(py::module_& module) {
  const std::vector<std::string> no_maps;
  const std::vector<int> nobody;
  module.def("identify", &identify_law, py::arg("logs"), py::arg("model") = kDefaultModel, py::kw_only(),
             py::arg("target") = "", py::arg("axis") = 0, py::arg("map") = no_maps, py::arg("coupled_to") = nobody,
             "Fits a law to logs of one joint, as `capstan identify` does. Raises Refusal where the logs can not\n"
             "determine a parameter.");
  module.def(
      "diagnose",
      [](const Logs& logs, const std::string& base, const std::string& target, const std::optional<Logs>& test,
         int axis, const Maps& map, const std::vector<int>& coupled_to, const std::optional<path>& law,
         const std::optional<path>& report, const std::optional<path>& next, const py::object& progress) {
        return diagnose_logs(logs, base, target, test.value_or(Logs{}), axis, map, coupled_to, {law, report, next},
                             progress);
      },
      py::arg("logs"), py::kw_only(), py::arg("base") = "", py::arg("target") = "", py::arg("test") = py::none(),
      py::arg("axis") = 0, py::arg("map") = no_maps, py::arg("coupled_to") = nobody, py::arg("law") = py::none(),
      py::arg("report") = py::none(), py::arg("next") = py::none(), py::arg("progress") = py::none(),
      "What the law of these logs lacks, as `capstan diagnose` finds it: the contract's JSON as a dict. `law`,\n"
      "`report` and `next` are files and a folder to write; `progress` is called with a sentence now and then.");
}

/// Sentences come from the command line's side of the program.
template <typename Error>
void add_exception(py::module_& module, const char* name, PyObject* base, const char* doc) {
  static PyObject* type = nullptr;  // for the translator, which can not capture it; the interpreter's till its end
  type = py::exception<Error>(module, name, base).release().ptr();
  py::setattr(type, "__doc__", py::str(doc));
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      PyErr_SetString(type, in_python(error.what()).c_str());
    }
  });
}

}  // namespace
}  // namespace capstan::python

PYBIND11_MODULE(capstan, module) {
  module.doc() = "Identify and diagnose joints driven through tendons, and run their laws as the firmware does.";
  module.attr("__version__") = CAPSTAN_VERSION;
  capstan::python::add_exception<capstan::tools::BadInput>(
      module, "BadInput", PyExc_ValueError,
      "What was given can not be used; the message says what is wrong, where, and the cure.");
  capstan::python::add_exception<capstan::tools::Refusal>(
      module, "Refusal", PyExc_RuntimeError,
      "The input is sound, but the answer is no; the message says why and what would change it.");
  capstan::python::add_logs(module);
  capstan::python::add_laws(module);
  capstan::python::add_commands(module);
}
