// SPDX-License-Identifier: MIT
// A library for LD_PRELOAD that counts the calls of the C library on files below one folder, over all processes of a
// command, and makes the n-th go wrong. crash.py is its user. Environment:
//
// - PALPATE_FAULT_BELOW: a folder, absolute and without links. Other files are left alone, and so are plugins and
//   libraries.
// - PALPATE_FAULT_STATE: a file of 64 bytes or more, outside of that folder, with the counter, zeros at the start. For
//   each call, a line is appended to STATE.trace. With `power`, files that lose their name keep one in STATE.old/.
// - PALPATE_FAULT: MODE N, what happens at call N (from 1; 0: never).
//
// | mode | at call N |
// |---|---|
// | eio, enospc, edquot | fails with that errno (a lock: ENOLCK); a close closes all the same |
// | eio+, enospc+, edquot+ | so do all later ones: with eio+ every call, else those that need room |
// | short, short+ | a write writes one byte; the next on that file, or all that need room, fail with ENOSPC |
// | lossclose | a write succeeds; the next close or sync of that file says EDQUOT, and the data are gone |
// | losssync | a sync fails with EIO, and what was written since the last one is gone; the next succeeds |
// | before, after, torn | the process is killed before, after, or in the half of the call |
// | power | every process is killed before the call; crash.py then takes away what was not synced |
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

constexpr std::size_t kPath = 4096;

/// What all processes of a command share.
struct Shared {
  std::atomic<std::uint32_t> calls;
  std::atomic<std::uint32_t> power_is_cut;
};

/// A file of this process, by what it is and not by its name.
struct File {
  dev_t device = 0;
  ino_t inode = 0;
  off_t bytes = 0;
};

struct Fault {
  char below[kPath] = "";
  char state[kPath] = "";
  Shared* shared = nullptr;  ///< null: nothing is to be counted
  char mode[16] = "";
  std::uint32_t at = 0;
  bool stays = false;  ///< the mode ends in a +

  int ends_short = -1;  ///< descriptor of what was written short, which fails next
  int lost = -1;        ///< own descriptor of the file that loses its data at close
  File lost_file{};
  File synced[256]{};  ///< of each file the length that is on the disk
  int files = 0;
};

Fault fault;  // initialised at compile time: begin() may come before other initialisations

bool is_mode(const char* name) { return std::strcmp(fault.mode, name) == 0; }

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}
// The function that is being replaced.
#define REAL(name) real<decltype(&::name)>(#name)

__attribute__((constructor)) void begin() {
  const char* below = std::getenv("PALPATE_FAULT_BELOW");
  const char* state = std::getenv("PALPATE_FAULT_STATE");
  const char* wish = std::getenv("PALPATE_FAULT");
  if (below == nullptr || state == nullptr || wish == nullptr) return;
  std::snprintf(fault.below, kPath, "%s", below);
  std::snprintf(fault.state, kPath, "%s", state);
  std::sscanf(wish, "%15s %u", fault.mode, &fault.at);
  if (char* plus = std::strchr(fault.mode, '+')) *plus = '\0', fault.stays = true;
  const int number = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, state, O_RDWR | O_CLOEXEC));
  void* mapped = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, number, 0);
  ::syscall(SYS_close, number);
  if (mapped != MAP_FAILED) fault.shared = static_cast<Shared*>(mapped);
}

[[noreturn]] void die() {
  ::syscall(SYS_kill, ::getpid(), SIGKILL);
  for (;;) ::pause();
}

/// `path` below `folder` in full; false where it does not lie below the folder of the faults.
bool full_path(int folder, const char* path, char* out) {
  char link[64];
  char base[kPath] = "";
  if (path[0] != '/') {
    std::snprintf(link, sizeof link, folder == AT_FDCWD ? "/proc/self/cwd" : "/proc/self/fd/%d", folder);
    const ssize_t size = ::syscall(SYS_readlinkat, AT_FDCWD, link, base, kPath - 1);
    base[size < 0 ? 0 : size] = '\0';
  }
  if (path[0] == '/' || path[0] == '\0') {
    std::snprintf(out, kPath, "%.4000s", path[0] == '/' ? path : base);
  } else {
    std::snprintf(out, kPath, "%.2000s/%.2000s", base, path);
  }
  const std::size_t size = std::strlen(fault.below);
  return std::strncmp(out, fault.below, size) == 0 && (out[size] == '/' || out[size] == '\0');
}

bool is_same(const File& file, const struct stat& what) {
  return file.device == what.st_dev && file.inode == what.st_ino;
}

struct stat look(int number) {
  struct stat what {};
  ::syscall(SYS_newfstatat, number, "", &what, AT_EMPTY_PATH);
  return what;
}

/// The length of a file that is on the disk; one that is seen for the first time is there as it is.
off_t& synced_length(int number) {
  const struct stat what = look(number);
  for (int i = 0; i < fault.files; ++i) {
    if (is_same(fault.synced[i], what)) return fault.synced[i].bytes;
  }
  File& file = fault.synced[fault.files < 255 ? fault.files++ : 255];
  file = {what.st_dev, what.st_ino, what.st_size};
  return file.bytes;
}

/// The data that a close or a sync is to lose.
void lose() {
  ::syscall(SYS_ftruncate, fault.lost, fault.lost_file.bytes);
  ::syscall(SYS_close, fault.lost);
  fault.lost = -1;
}
__attribute__((destructor)) void end() {
  if (fault.lost >= 0) lose();
}

enum Need { none, room };

/// A call on a file: counted, and perhaps at fault.
class Call {
 public:
  Call(const char* name, Need need, int folder, const char* path, const char* to = "") : name_(name), to_(to) {
    const int before = errno;
    counted_ = fault.shared != nullptr && full_path(folder, path, path_);
    if (counted_) count(need);
    errno = before;
  }
  Call(const char* name, Need need, int number) : Call(name, need, number, "") {}

  bool is_at_fault(const char* mode) const { return hit_ && is_mode(mode); }
  /// errno of the call where it is to fail, else 0.
  int failure() const { return failure_; }
  void fail(int number) { failure_ = number; }
  bool counted() const { return counted_; }
  char* path() { return path_; }

  /// After the call: its result, and a number that the trace keeps.
  template <class Result>
  Result done(Result result, long detail = 0) {
    if (!counted_) return result;
    const int reason = errno;
    char line[3 * kPath];
    const int size = std::snprintf(line, sizeof line, "%u\t%s\t%ld\t%s\t%s\t%ld\n", number_, name_,
                                   static_cast<long>(result), path_, to_, detail);
    char trace[kPath + 8];
    std::snprintf(trace, sizeof trace, "%s.trace", fault.state);
    const int to =
        static_cast<int>(::syscall(SYS_openat, AT_FDCWD, trace, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
    if (::syscall(SYS_write, to, line, size) < 0) std::abort();
    ::syscall(SYS_close, to);
    if (is_at_fault("after")) die();
    errno = reason;
    return result;
  }

  /// A link that keeps what loses its name.
  void keep(int folder, const char* path) const {
    if (!counted_ || !is_mode("power")) return;
    char kept[kPath + 32];
    std::snprintf(kept, sizeof kept, "%s.old/%u", fault.state, number_);
    const int before = errno;
    ::syscall(SYS_linkat, folder, path, AT_FDCWD, kept, 0);
    errno = before;
  }

 private:
  void count(Need need) {
    if (fault.shared->power_is_cut.load() != 0) die();
    number_ = ++fault.shared->calls;
    hit_ = number_ == fault.at;
    const bool later = fault.stays && fault.at != 0 && number_ > fault.at;
    if (hit_ && is_mode("before")) die();
    if (hit_ && is_mode("power")) {
      fault.shared->power_is_cut = 1;
      die();
    }
    const int full = is_mode("enospc") || is_mode("short") ? ENOSPC : is_mode("edquot") ? EDQUOT : 0;
    if (is_mode("eio") && (hit_ || later)) failure_ = std::strcmp(name_, "lock") == 0 ? ENOLCK : EIO;
    if (full != 0 && ((hit_ && !is_mode("short")) || (later && need == room))) failure_ = full;
  }

  const char* name_;
  const char* to_;
  char path_[kPath] = "";
  bool counted_ = false;
  std::uint32_t number_ = 0;
  bool hit_ = false;
  int failure_ = 0;
};

/// Does `act` unless the call is to fail.
template <class Act>
auto unless_failed(Call& call, const Act& act) -> decltype(act()) {
  if (call.failure() == 0) return call.done(act());
  errno = call.failure();
  return call.done(static_cast<decltype(act())>(-1));
}

template <class Act>
int opened(int folder, const char* path, int flags, const Act& act) {
  const bool makes = (flags & O_CREAT) != 0;
  struct stat what {};
  const bool is_new = makes && ::syscall(SYS_newfstatat, folder, path, &what, AT_SYMLINK_NOFOLLOW) != 0;
  Call call(is_new                                     ? "create"
            : makes || (flags & O_ACCMODE) != O_RDONLY ? "open"
                                                       : "look",
            is_new ? room : none, folder, path);
  const int number = unless_failed(call, act);
  if (call.counted() && number >= 0) {
    const int before = errno;
    off_t& length = synced_length(number);
    if (is_new) length = 0;
    errno = before;
  }
  return number;
}

/// A write of `size` bytes by `act`, which takes how many of them.
template <class Act>
ssize_t written(int number, std::size_t size, const Act& act) {
  Call call("write", room, number);
  if (!call.counted()) return act(size);
  if (fault.ends_short == number && call.failure() == 0) call.fail(ENOSPC);
  if (fault.ends_short == number) fault.ends_short = -1;
  if (call.is_at_fault("short") && size > 1) {
    fault.ends_short = fault.stays ? -1 : number;
    return call.done(act(1), look(number).st_size);
  }
  if (call.is_at_fault("torn")) {
    if (act(size / 2) < 0) std::abort();
    die();
  }
  if (call.is_at_fault("lossclose")) {
    const struct stat what = look(number);
    fault.lost_file = {what.st_dev, what.st_ino, what.st_size};
    fault.lost = static_cast<int>(::syscall(SYS_fcntl, number, F_DUPFD_CLOEXEC, 500));
  }
  if (call.failure() != 0) {
    errno = call.failure();
    return call.done(ssize_t{-1}, look(number).st_size);
  }
  const ssize_t out = act(size);
  return call.done(out, look(number).st_size);
}

/// A close or a sync, which may be the one that tells of a loss: of a file that is open to be written.
bool tells_loss(int number) {
  if (fault.lost < 0 || !is_same(fault.lost_file, look(number))) return false;
  if ((::syscall(SYS_fcntl, number, F_GETFL) & O_ACCMODE) == O_RDONLY) return false;
  lose();
  return true;
}

template <class Act>
int synced(int number, const Act& act) {
  Call call("sync", room, number);
  if (!call.counted()) return act();
  if (tells_loss(number)) call.fail(EDQUOT);
  if (call.is_at_fault("losssync")) {
    const off_t length = synced_length(number);
    if ((look(number).st_mode & S_IFMT) == S_IFREG) ::syscall(SYS_ftruncate, number, length);
    call.fail(EIO);
  }
  const int out = unless_failed(call, act);
  if (out == 0) synced_length(number) = look(number).st_size;
  return out;
}

}  // namespace

extern "C" {

#define OPENS(name)                                                                                  \
  int name(const char* path, int flags, ...) {                                                       \
    va_list rest;                                                                                    \
    va_start(rest, flags);                                                                           \
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;                           \
    va_end(rest);                                                                                    \
    return opened(AT_FDCWD, path, flags, [&] { return REAL(openat)(AT_FDCWD, path, flags, mode); }); \
  }
OPENS(open)
OPENS(open64)
#define OPENS_AT(name)                                                                                          \
  int name(int folder, const char* path, int flags, ...) {                                                      \
    va_list rest;                                                                                               \
    va_start(rest, flags);                                                                                      \
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;                                      \
    va_end(rest);                                                                                               \
    return opened(folder, path, flags,                                                                          \
                  [&] { return real<int (*)(int, const char*, int, ...)>(#name)(folder, path, flags, mode); }); \
  }
OPENS_AT(openat)
OPENS_AT(openat64)

ssize_t write(int number, const void* data, size_t size) {
  return written(number, size, [&](size_t some) { return REAL(write)(number, data, some); });
}
ssize_t pwrite(int number, const void* data, size_t size, off_t at) {
  return written(number, size, [&](size_t some) { return REAL(pwrite)(number, data, some, at); });
}
ssize_t writev(int number, const struct iovec* parts, int count) {
  Call call("write", room, number);
  return unless_failed(call, [&] { return REAL(writev)(number, parts, count); });
}
ssize_t read(int number, void* data, size_t size) {
  Call call("read", none, number);
  return unless_failed(call, [&] { return REAL(read)(number, data, size); });
}
ssize_t pread(int number, void* data, size_t size, off_t at) {
  Call call("read", none, number);
  return unless_failed(call, [&] { return REAL(pread)(number, data, size, at); });
}

int close(int number) {
  Call call("close", none, number);
  if (!call.counted()) return REAL(close)(number);
  if (tells_loss(number)) call.fail(EDQUOT);
  if (fault.ends_short == number) fault.ends_short = -1;
  const int out = REAL(close)(number);
  if (call.failure() == 0) return call.done(out);
  errno = call.failure();
  return call.done(-1);
}
int fsync(int number) {
  return synced(number, [&] { return REAL(fsync)(number); });
}
int fdatasync(int number) {
  return synced(number, [&] { return REAL(fdatasync)(number); });
}

int renameat2(int from, const char* path, int to, const char* target, unsigned flags) {
  char full[kPath];
  full_path(to, target, full);
  Call call("rename", room, from, path, full);
  call.keep(to, target);
  return unless_failed(call, [&] { return static_cast<int>(::syscall(SYS_renameat2, from, path, to, target, flags)); });
}
int renameat(int from, const char* path, int to, const char* target) { return renameat2(from, path, to, target, 0); }
int rename(const char* path, const char* target) { return renameat2(AT_FDCWD, path, AT_FDCWD, target, 0); }

int ftruncate(int number, off_t size) {
  Call call("cut", none, number);
  return unless_failed(call, [&] { return REAL(ftruncate)(number, size); });
}

int mkdirat(int folder, const char* path, mode_t mode) {
  Call call("mkdir", room, folder, path);
  return unless_failed(call, [&] { return REAL(mkdirat)(folder, path, mode); });
}
int mkdir(const char* path, mode_t mode) { return mkdirat(AT_FDCWD, path, mode); }
char* mkdtemp(char* path) {
  Call call("mkdir", room, AT_FDCWD, path);
  errno = call.failure();
  char* out = call.failure() == 0 ? REAL(mkdtemp)(path) : nullptr;
  if (out != nullptr) full_path(AT_FDCWD, out, call.path());
  return call.done(out != nullptr ? 0 : -1), out;
}

int unlinkat(int folder, const char* path, int flags) {
  Call call("unlink", none, folder, path);
  call.keep(folder, path);
  return unless_failed(call, [&] { return REAL(unlinkat)(folder, path, flags); });
}
int unlink(const char* path) { return unlinkat(AT_FDCWD, path, 0); }
int rmdir(const char* path) { return unlinkat(AT_FDCWD, path, AT_REMOVEDIR); }
int remove(const char* path) {
  const int out = unlink(path);
  return out != 0 && errno == EISDIR ? rmdir(path) : out;
}

int linkat(int from, const char* path, int to, const char* target, int flags) {
  Call call("link", room, to, target);
  return unless_failed(call, [&] { return REAL(linkat)(from, path, to, target, flags); });
}

int fstatat(int folder, const char* path, struct stat* what, int flags) {
  Call call("stat", none, folder, path);
  return unless_failed(call, [&] { return static_cast<int>(::syscall(SYS_newfstatat, folder, path, what, flags)); });
}
int stat(const char* path, struct stat* what) { return fstatat(AT_FDCWD, path, what, 0); }
int lstat(const char* path, struct stat* what) { return fstatat(AT_FDCWD, path, what, AT_SYMLINK_NOFOLLOW); }

int fcntl(int number, int command, ...) {
  va_list rest;
  va_start(rest, command);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  const auto act = [&] { return static_cast<int>(::syscall(SYS_fcntl, number, command, argument)); };
  if (command != F_OFD_SETLK && command != F_OFD_SETLKW && command != F_OFD_GETLK && command != F_SETLK) return act();
  Call call("lock", none, number);
  return unless_failed(call, act);
}
int access(const char* path, int mode) {
  Call call("stat", none, AT_FDCWD, path);
  return unless_failed(call, [&] { return static_cast<int>(::syscall(SYS_faccessat, AT_FDCWD, path, mode)); });
}

// Under the names that programs with large files use; here they are the same.
int stat64(const char* path, struct stat64* what) { return stat(path, reinterpret_cast<struct stat*>(what)); }
int lstat64(const char* path, struct stat64* what) { return lstat(path, reinterpret_cast<struct stat*>(what)); }
int fstatat64(int folder, const char* path, struct stat64* what, int flags) {
  return fstatat(folder, path, reinterpret_cast<struct stat*>(what), flags);
}
ssize_t pread64(int number, void* data, size_t size, off64_t at) { return pread(number, data, size, at); }
ssize_t pwrite64(int number, const void* data, size_t size, off64_t at) { return pwrite(number, data, size, at); }
int ftruncate64(int number, off64_t size) { return ftruncate(number, size); }
int creat(const char* path, mode_t mode) { return open(path, O_CREAT | O_WRONLY | O_TRUNC, mode); }
int creat64(const char* path, mode_t mode) { return creat(path, mode); }
int fcntl64(int number, int command, ...) {
  va_list rest;
  va_start(rest, command);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return fcntl(number, command, argument);
}

}  // extern "C"
