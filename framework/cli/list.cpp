// SPDX-License-Identifier: MIT
#include "cli/list.hpp"

#include "analysis/runs_table.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "config/catch_error.hpp"
#include "reading/read_file.hpp"
#include "record/catalogue.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "report/words/words.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

void print_json(const std::vector<Row>& rows) {
  std::vector<std::string> lines;
  for (const Row& row : rows) lines.push_back("  " + to_json_line(row));
  print_data(fmt::format("[{}{}{}]\n", lines.empty() ? "" : "\n", fmt::join(lines, ",\n"), lines.empty() ? "" : "\n"));
}

/// Warns about folders that are not in the list, with their numbers.
void warn_others(const Catalogue& all, const fs::path& folder) {
  std::vector<std::string> others;
  if (all.strangers > 0) others.push_back(counted(all.strangers, "folder") + " without a run");
  if (all.moved_aside > 0) others.push_back(counted(all.moved_aside, "run") + " that --force moved aside");
  if (!others.empty()) print_message(fmt::format("{}: not listed: {}\n", folder.string(), fmt::join(others, ", ")));
}

}  // namespace

int list_runs(CommandEnvironment&, const ListArguments& arguments) {
  const fs::path folder = arguments.folder;
  if (!is_there(folder))
    throw Error(folder.string(), "is not a folder", "start a run, which creates runs/, or name another folder");
  std::error_code trouble_there;
  list_folder(folder, trouble_there);
  if (trouble_there) throw Error(folder.string(), trouble_there.message(), "name a folder with runs");
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  const Catalogue all = read_catalogue(folder);
  std::vector<ListedRecord> records;
  for (const fs::path& directory : all.records) {
    const auto trouble = catch_error([&] { records.push_back(list_record(directory)); });
    // A damaged record causes a message, and the other records are still listed.
    if (trouble) print_message(fmt::format("{}\n", trouble->what()));
  }
  add_differences(records);
  std::vector<Row> rows;
  if (where) {
    rows = rows_where(records, *where);
  } else {
    for (ListedRecord& one : records) rows.push_back(std::move(one.row));
  }
  arguments.json ? print_json(rows) : print_text(runs_table(rows));
  if (all.records.empty()) print_message(fmt::format("{}: contains no runs and no sweeps\n", folder.string()));
  if (where && rows.empty() && !records.empty()) {
    const auto sweep = std::find_if(all.records.begin(), all.records.end(), is_sweep);
    print_message(fmt::format("command line: --where: matches none of {}{}\n", records.size(),
                              sweep == all.records.end()
                                  ? ""
                                  : fmt::format("; to filter the jobs of a sweep, use 'palpate list {} --where ...'",
                                                (*sweep / "jobs").string())));
  }
  warn_others(all, folder);
  return kDone;
}

}  // namespace palpate::cli
