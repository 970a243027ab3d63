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

constexpr int kAttempts = 3;

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

std::string user_name(int user) {
  const passwd* entry = ::getpwuid(user < 0 ? ::geteuid() : static_cast<uid_t>(user));
  if (entry == nullptr) throw std::runtime_error("who runs this has no name, and Slurm wants one");
  return entry->pw_name;
}

/// Waits like eventually(), for longer: a cluster starts its tasks when it sees fit.
template <class Condition>
bool within_a_minute(const Condition& holds) {
  for (int i = 0; i < 6; ++i) {
    if (eventually(holds)) return true;
  }
  return false;
}

}  // namespace

std::string SlurmLab::missing() {
  const std::array<std::pair<const char*, const char*>, 6> wanted{{{"slurmctld", "slurmctld"},
                                                                   {"slurmd", "slurmd"},
                                                                   {"sbatch", "slurm-client"},
                                                                   {"squeue", "slurm-client"},
                                                                   {"munged", "munge"},
                                                                   {"mungekey", "munge"}}};
  for (const auto& [name, package] : wanted) {
    if (program(name).empty()) return std::string(name) + " is not installed, install the package " + package;
  }
  return {};
}

SlurmLab::SlurmLab(const SlurmSettings& settings) : settings_(settings) {
  fs::create_directories(cluster() / "state");
  fs::create_directories(cluster() / "spool");
  fs::create_directories(cluster() / "munge");
  if (settings_.user >= 0) {
    for (const fs::path& one : {folder(), cluster(), cluster() / "state", cluster() / "spool", cluster() / "munge"}) {
      const auto user = static_cast<uid_t>(settings_.user);
      if (::chown(one.c_str(), user, user) != 0) throw std::runtime_error("cannot give away " + one.string());
    }
  }
  // A port may be taken by somebody between the look for it and its use.
  for (int i = 0; i < kAttempts; ++i) {
    if (start()) return;
  }
  const std::string words = text_of(cluster() / "lab.log") + text_of(cluster() / "slurmctld.log") +
                            text_of(cluster() / "slurmd.log") + text_of(cluster() / "munge" / "log");
  keeper_.reset();
  throw std::runtime_error("no cluster comes up: " + words);
}

SlurmLab::~SlurmLab() {
  for (const char* name : {"slurmd.pid", "slurmctld.pid"}) {
    const int pid = std::atoi(text_of(cluster() / name).c_str());
    if (pid > 0) ::kill(pid, SIGTERM);
  }
  const auto daemons = [&] { return fs::exists(cluster() / "slurmd.pid") || fs::exists(cluster() / "slurmctld.pid"); };
  eventually([&] { return !daemons(); });
  const int munged = std::atoi(text_of(cluster() / "munge" / "pid").c_str());
  if (munged > 0) ::kill(munged, SIGTERM);
}

void SlurmLab::write_config() const {
  const std::string user = user_name(settings_.user);
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

std::vector<std::string> SlurmLab::as_user(const std::vector<std::string>& words) const {
  if (settings_.user < 0) return words;
  const std::string user = std::to_string(settings_.user);
  std::vector<std::string> out{"setpriv", "--reuid=" + user, "--regid=" + user, "--clear-groups"};
  out.insert(out.end(), words.begin(), words.end());
  return out;
}

bool SlurmLab::start() {
  keeper_.reset();
  write_config();
  const fs::path munge = cluster() / "munge";
  std::error_code none;
  fs::remove(munge / "key", none);
  keeper_ = std::make_unique<Keeper>(
      std::vector<std::vector<std::string>>{
          as_user({program("mungekey"), "--create", "--keyfile=" + (munge / "key").string()}),
          as_user({program("munged"), "--force", "--socket=" + (munge / "socket").string(),
                   "--key-file=" + (munge / "key").string(), "--pid-file=" + (munge / "pid").string(),
                   "--log-file=" + (munge / "log").string(), "--seed-file=" + (munge / "seed").string()}),
          as_user({program("slurmctld"), "-c"}), as_user({program("slurmd"), "-c", "-N", node_name()})},
      environment(), (cluster() / "lab.log").string());
  return keeper_->ready() && eventually([&] { return run({"sinfo", "--noheader", "--format=%t"}).out == "idle\n"; });
}

std::vector<std::string> SlurmLab::environment() const {
  return {"SLURM_CONF=" + (cluster() / "slurm.conf").string(), "PALPATE_PLUGIN_PATH"};
}

Ended SlurmLab::run(const std::vector<std::string>& words, const std::vector<std::string>& more) const {
  std::vector<std::string> all = environment();
  all.insert(all.end(), more.begin(), more.end());
  return run_program(as_user(words), folder(), all);
}

std::unique_ptr<Child> SlurmLab::start_palpate(const std::vector<std::string>& words) const {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return std::make_unique<Child>(as_user(all), folder(), environment());
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
  return within_a_minute([&] { return run({"squeue", "--noheader"}).out.empty(); });
}

}  // namespace palpate::test
