// SPDX-License-Identifier: MIT
#include "slurm_lab.hpp"

#include "support/ports.hpp"
#include "support/programs.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <pwd.h>
#include <unistd.h>

namespace palpate::test {

namespace fs = std::filesystem;

namespace {

/// Daemons lie where users' PATH does not look.
std::string program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders((path != nullptr ? path : "") + std::string(":/usr/sbin:/sbin"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / name;
    if (!folder.empty() && ::access(file.c_str(), X_OK) == 0) return file.string();
  }
  return {};
}

std::string node_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  const std::string text = name.data();
  return text.substr(0, text.find('.'));
}

std::string user_name() {
  const passwd* entry = ::getpwuid(::geteuid());
  if (entry == nullptr) throw std::runtime_error("who runs this has no name, and Slurm wants one");
  return entry->pw_name;
}

}  // namespace

std::string SlurmLab::missing() {
  for (const char* name : {"slurmctld", "slurmd", "sbatch", "squeue", "munged", "mungekey"}) {
    if (program(name).empty()) return std::string(name) + " is not installed: see packages.txt";
  }
  return {};
}

SlurmLab::SlurmLab(const SlurmSettings& settings) : settings_(settings) {
  const fs::path munge = cluster() / "munge";
  for (const fs::path& one : {cluster() / "state", cluster() / "spool", munge}) fs::create_directories(one);
  write_config();
  run({program("mungekey"), "--create", "--keyfile=" + (munge / "key").string()});
  begin({program("munged"), "--foreground", "--force", "--socket=" + (munge / "socket").string(),
         "--key-file=" + (munge / "key").string(), "--pid-file=" + (munge / "pid").string(),
         "--log-file=" + (munge / "log").string(), "--seed-file=" + (munge / "seed").string()},
        [&] { return fs::exists(munge / "socket"); });
  begin({program("slurmctld"), "-D", "-c"}, [&] { return run({"sinfo"}).status == 0; });
  begin({program("slurmd"), "-D", "-c", "-N", node_name()}, [&] {
    return run({"sinfo", "--noheader", "--format=%t"}).out == "idle\n";
  });
}

void SlurmLab::begin(const std::vector<std::string>& daemon, const std::function<bool()>& is_up) {
  daemons_.push_back(std::make_unique<Child>(daemon, folder(), environment()));
  const Child& own = *daemons_.back();
  if (!eventually([&] { return is_up() || !own.running(); }) || !own.running())
    throw std::runtime_error("no cluster comes up: " + own.err() + text_of(cluster() / "munge" / "log"));
}

SlurmLab::~SlurmLab() {
  run({"scancel", "--user=" + user_name()});
  becomes_idle();
  while (!daemons_.empty()) daemons_.pop_back();
}

void SlurmLab::write_config() const {
  const std::string user = user_name();
  const std::string at = cluster().string();
  const std::string node = node_name();
  std::ofstream out(cluster() / "slurm.conf");
  out << "ClusterName=lab\nSlurmctldHost=" << node << "(127.0.0.1)\n"
      << "SlurmUser=" << user << "\nSlurmdUser=" << user << "\n"
      << "SlurmctldPort=" << free_port() << "\nSlurmdPort=" << free_port() << "\n"
      << "AuthType=auth/munge\nAuthInfo=socket=" << at << "/munge/socket\nCredType=cred/munge\n"
      << "StateSaveLocation=" << at << "/state\nSlurmdSpoolDir=" << at << "/spool\n"
      << "SlurmctldPidFile=" << at << "/slurmctld.pid\nSlurmdPidFile=" << at << "/slurmd.pid\n"
      << "SlurmctldLogFile=" << at << "/slurmctld.log\nSlurmdLogFile=" << at
      << "/slurmd.log\n"
      // No control groups, no accounting, no mail: nothing of the machine's.
      << "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nJobAcctGatherType=jobacct_gather/none\n"
      << "MpiDefault=none\nJobCompType=jobcomp/none\nAccountingStorageType=accounting_storage/none\n"
      << "MailProg=/bin/true\n"
      << "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nSlurmdParameters=config_overrides\n"
      // Tasks start at once, and ended ones stay known to the end of the test.
      << "SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1\nMinJobAge=3600\n"
      << "MaxArraySize=" << settings_.max_array_size << "\nKillWait=10\n"
      << "NodeName=" << node << " NodeAddr=127.0.0.1 CPUs=" << settings_.cpus << " State=UNKNOWN\n"
      << "PartitionName=lab Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n";
}

std::vector<std::string> SlurmLab::environment() const {
  return {"SLURM_CONF=" + (cluster() / "slurm.conf").string(), "PALPATE_PLUGIN_PATH"};
}

Ended SlurmLab::run(const std::vector<std::string>& words, const std::vector<std::string>& more) const {
  std::vector<std::string> all = environment();
  all.insert(all.end(), more.begin(), more.end());
  return run_program(words, folder(), all);
}

std::unique_ptr<Child> SlurmLab::start_palpate(const std::vector<std::string>& words) const {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return std::make_unique<Child>(all, folder(), environment());
}

Ended SlurmLab::palpate(const std::vector<std::string>& words, const std::vector<std::string>& more) const {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return run(all, more);
}

std::vector<SlurmLab::Task> SlurmLab::tasks() const {
  std::vector<Task> out;
  std::istringstream lines(run({"squeue", "--noheader", "--array", "--states=all", "--format=%F %K %T"}).out);
  for (Task task; lines >> task.array >> task.index >> task.state;) out.push_back(task);
  std::sort(out.begin(), out.end(),
            [](const Task& a, const Task& b) { return a.array != b.array ? a.array < b.array : a.index < b.index; });
  return out;
}

std::vector<int> SlurmLab::indices(int array) const {
  std::vector<int> out;
  for (const Task& task : tasks()) {
    if (task.array == array) out.push_back(task.index);
  }
  return out;
}

bool SlurmLab::becomes_idle() const {
  return eventually([&] { return run({"squeue", "--noheader"}).out.empty(); });
}

}  // namespace palpate::test
