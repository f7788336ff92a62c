// Loaded before a program (LD_PRELOAD), it lets one of the program's file-changing system calls fail, or kills it
// there.
//
//   PCM_FAULT_UNDER   only calls on paths below this folder count (an absolute path)
//   PCM_FAULT         count | kill | torn | full | eio | late
//                     count_opens | emfile | emfiles
//                     count_closes | close
//   PCM_FAULT_AT      the number of the call, from 1
//   PCM_FAULT_COUNT   a file that gets the number of calls made, when the program ends by itself
//   PCM_FAULT_WITHOUT tmpfile: the file system has no files without names; linkat: they cannot be given names; flock:
//                     it has no locks; holes: space cannot be released within files; exchange: two names cannot be
//                     exchanged
//
// kill ends the process instead of the call; torn does so after half of what a write was to write. full: from that call
// on, what needs space fails with ENOSPC, as on a disk that stays full. eio: that one call fails with EIO. late: that
// call is made, and then reported as failed with EIO, as network file systems may. emfile counts all calls that open
// something: that one fails with EMFILE; with emfiles all later ones too. close counts the calls of close(): that one
// closes, and fails with EIO.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

enum class Kind { none, count, kill, torn, full, eio, late, emfile, emfiles, close };
enum class Counted { changes, opens, closes };
enum class Needs { space, nothing };
enum class Verdict { make, fail, make_and_fail };

struct Plan {
    Kind kind = Kind::none;
    Counted counted = Counted::changes;
    bool tmpfile = true, linkat = true, flock = true, holes = true, exchange = true;
    long at = 0;
    char under[PATH_MAX] = "";
    std::size_t under_length = 0;
    char count_file[PATH_MAX] = "";

    Plan()
    {
        const char* what = std::getenv("PCM_FAULT");
        const char* folder = std::getenv("PCM_FAULT_UNDER");
        if (!what || !folder) return;
        const struct {
            const char* name;
            Kind kind;
            Counted counted;
        } kinds[] = {{"count", Kind::count, Counted::changes},     {"kill", Kind::kill, Counted::changes},
                     {"torn", Kind::torn, Counted::changes},       {"full", Kind::full, Counted::changes},
                     {"eio", Kind::eio, Counted::changes},         {"late", Kind::late, Counted::changes},
                     {"count_opens", Kind::count, Counted::opens}, {"emfile", Kind::emfile, Counted::opens},
                     {"emfiles", Kind::emfiles, Counted::opens},   {"count_closes", Kind::count, Counted::closes},
                     {"close", Kind::close, Counted::closes}};
        for (const auto& k : kinds)
            if (std::strcmp(what, k.name) == 0) {
                kind = k.kind;
                counted = k.counted;
            }
        if (const char* without = std::getenv("PCM_FAULT_WITHOUT")) {
            tmpfile = !std::strstr(without, "tmpfile");
            linkat = !std::strstr(without, "linkat");
            flock = !std::strstr(without, "flock");
            holes = !std::strstr(without, "holes");
            exchange = !std::strstr(without, "exchange");
        }
        if (kind == Kind::none) std::abort();
        std::snprintf(under, sizeof under, "%s", folder);
        under_length = std::strlen(under);
        if (const char* number = std::getenv("PCM_FAULT_AT")) at = std::atol(number);
        if (const char* file = std::getenv("PCM_FAULT_COUNT")) std::snprintf(count_file, sizeof count_file, "%s", file);
    }
};

const Plan& plan()
{
    static const Plan p;
    return p;
}

std::atomic<long> calls{0};

template <class Function>
Function next(const char* name)
{
    void* found = dlsym(RTLD_NEXT, name);
    if (!found) std::abort();
    Function function;
    std::memcpy(&function, &found, sizeof function);
    return function;
}

bool counts(const char* path)
{
    if (plan().kind == Kind::none || !path) return false;
    char absolute[PATH_MAX];
    if (path[0] != '/') {
        char here[PATH_MAX];
        if (!getcwd(here, sizeof here)) return false;
        if (std::snprintf(absolute, sizeof absolute, "%s/%s", here, path) >= static_cast<int>(sizeof absolute))
            return false;
        path = absolute;
    }
    return std::strncmp(path, plan().under, plan().under_length) == 0;
}

bool counts(int descriptor)
{
    if (plan().kind == Kind::none || descriptor < 0) return false;
    char link[64], path[PATH_MAX];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length <= 0) return false;
    path[length] = 0;
    return counts(path);
}

// A path relative to an open folder.
bool counts(int folder, const char* path)
{
    if (folder == AT_FDCWD || (path && path[0] == '/')) return counts(path);
    return counts(folder);
}

// What is to happen to a call; errno is set where it fails. `torn_write` writes half of what is to be written.
template <class TornWrite>
Verdict judge(bool counted, Counted what, Needs needs, TornWrite torn_write)
{
    const Plan& p = plan();
    if (!counted || what != p.counted) return Verdict::make;
    const long number = ++calls;
    switch (p.kind) {
        case Kind::kill:
        case Kind::torn:
            if (number != p.at) return Verdict::make;
            if (p.kind == Kind::torn) torn_write();
            raise(SIGKILL);
            return Verdict::fail;
        case Kind::full:
            if (number < p.at || needs != Needs::space) return Verdict::make;
            errno = ENOSPC;
            return Verdict::fail;
        case Kind::eio:
            errno = number == p.at ? EIO : errno;
            return number == p.at ? Verdict::fail : Verdict::make;
        case Kind::late:
        case Kind::close:
            return number == p.at ? Verdict::make_and_fail : Verdict::make;
        case Kind::emfile:
        case Kind::emfiles:
            if (number < p.at || (p.kind == Kind::emfile && number > p.at)) return Verdict::make;
            errno = EMFILE;
            return Verdict::fail;
        default:
            return Verdict::make;
    }
}

template <class Call, class TornWrite>
auto run(bool counted, Counted what, Needs needs, Call call, TornWrite torn_write) -> decltype(call())
{
    const Verdict verdict = judge(counted, what, needs, torn_write);
    if (verdict == Verdict::fail) return -1;
    const auto result = call();
    if (verdict == Verdict::make || result < 0) return result;
    errno = EIO;
    return -1;
}

template <class Call>
auto run(bool counted, Counted what, Needs needs, Call call) -> decltype(call())
{
    return run(counted, what, needs, call, [] {});
}

struct AtEnd {
    ~AtEnd()
    {
        if (!plan().count_file[0]) return;
        const int file =
            next<int (*)(const char*, int, ...)>("open")(plan().count_file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (file < 0) return;
        dprintf(file, "%ld\n", calls.load());
        close(file);
    }
} at_end;

bool has_mode(int flags) { return (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE; }
bool creates(int flags) { return has_mode(flags) || (flags & O_TRUNC); }

template <class Open>
int run_open(bool counted, int flags, Open open)
{
    if ((flags & O_TMPFILE) == O_TMPFILE && !plan().tmpfile) {
        errno = EOPNOTSUPP;
        return -1;
    }
    const bool opens = plan().counted == Counted::opens;
    const int file =
        run(counted && (opens || creates(flags)), opens ? Counted::opens : Counted::changes, Needs::space, open);
    return file;
}

}  // namespace

extern "C" {

#define PCM_OPEN(name)                                                                                   \
    int name(const char* path, int flags, ...)                                                           \
    {                                                                                                    \
        va_list list;                                                                                    \
        va_start(list, flags);                                                                           \
        const mode_t mode = has_mode(flags) ? static_cast<mode_t>(va_arg(list, unsigned)) : 0;           \
        va_end(list);                                                                                    \
        return run_open(counts(path), flags,                                                             \
                        [&] { return next<int (*)(const char*, int, ...)>(#name)(path, flags, mode); }); \
    }
#define PCM_OPENAT(name)                                                                                              \
    int name(int folder, const char* path, int flags, ...)                                                            \
    {                                                                                                                 \
        va_list list;                                                                                                 \
        va_start(list, flags);                                                                                        \
        const mode_t mode = has_mode(flags) ? static_cast<mode_t>(va_arg(list, unsigned)) : 0;                        \
        va_end(list);                                                                                                 \
        return run_open(counts(folder, path), flags,                                                                  \
                        [&] { return next<int (*)(int, const char*, int, ...)>(#name)(folder, path, flags, mode); }); \
    }
#define PCM_PWRITE(name)                                                                                   \
    ssize_t name(int file, const void* from, size_t bytes, off_t offset)                                   \
    {                                                                                                      \
        const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>(#name);                       \
        return run(                                                                                        \
            counts(file), Counted::changes, Needs::space, [&] { return real(file, from, bytes, offset); }, \
            [&] { real(file, from, bytes / 2, offset); });                                                 \
    }
#define PCM_CALL(result, name, needs, counted, parameters, arguments)            \
    result name parameters                                                       \
    {                                                                            \
        return run(counted, Counted::changes, Needs::needs,                      \
                   [&] { return next<result(*) parameters>(#name) arguments; }); \
    }

PCM_OPEN(open)
PCM_OPEN(open64)
PCM_OPENAT(openat)
PCM_OPENAT(openat64)
PCM_PWRITE(pwrite)
PCM_PWRITE(pwrite64)

ssize_t write(int file, const void* from, size_t bytes)
{
    const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
    return run(
        counts(file), Counted::changes, Needs::space, [&] { return real(file, from, bytes); },
        [&] { real(file, from, bytes / 2); });
}

DIR* opendir(const char* path)
{
    if (judge(counts(path), Counted::opens, Needs::nothing, [] {}) == Verdict::fail) return nullptr;
    return next<DIR* (*)(const char*)>("opendir")(path);
}

int close(int file)
{
    return run(plan().counted == Counted::closes && counts(file), Counted::closes, Needs::nothing,
               [&] { return next<int (*)(int)>("close")(file); });
}

int flock(int file, int operation) noexcept
{
    if (!plan().flock && counts(file)) {
        errno = ENOLCK;
        return -1;
    }
    return next<int (*)(int, int)>("flock")(file, operation);
}

int linkat(int f, const char* from, int t, const char* to, int flags) noexcept
{
    if (!plan().linkat && counts(t, to)) {
        errno = EXDEV;
        return -1;
    }
    return run(counts(t, to), Counted::changes, Needs::space,
               [&] { return next<int (*)(int, const char*, int, const char*, int)>("linkat")(f, from, t, to, flags); });
}

PCM_CALL(ssize_t, writev, space, counts(file), (int file, const iovec* parts, int count), (file, parts, count))
PCM_CALL(int, fsync, nothing, counts(file), (int file), (file))
PCM_CALL(int, fdatasync, nothing, counts(file), (int file), (file))
PCM_CALL(int, ftruncate, nothing, counts(file), (int file, off_t length) noexcept, (file, length))
PCM_CALL(int, ftruncate64, nothing, counts(file), (int file, off_t length) noexcept, (file, length))
PCM_CALL(int, mkdir, space, counts(path), (const char* path, mode_t mode) noexcept, (path, mode))
PCM_CALL(int, mkdirat, space, counts(folder, path), (int folder, const char* path, mode_t mode) noexcept,
         (folder, path, mode))
PCM_CALL(int, rename, nothing, counts(from) || counts(to), (const char* from, const char* to) noexcept, (from, to))
PCM_CALL(int, renameat, nothing, counts(f, from) || counts(t, to),
         (int f, const char* from, int t, const char* to) noexcept, (f, from, t, to))
PCM_CALL(int, link, space, counts(to), (const char* from, const char* to) noexcept, (from, to))
PCM_CALL(int, unlink, nothing, counts(path), (const char* path) noexcept, (path))
PCM_CALL(int, unlinkat, nothing, counts(folder, path), (int folder, const char* path, int flags) noexcept,
         (folder, path, flags))
PCM_CALL(int, remove, nothing, counts(path), (const char* path) noexcept, (path))
PCM_CALL(int, rmdir, nothing, counts(path), (const char* path) noexcept, (path))

int renameat2(int f, const char* from, int t, const char* to, unsigned flags) noexcept
{
    const bool counted = counts(f, from) || counts(t, to);
    if (counted && !plan().exchange && flags != 0) {
        errno = EINVAL;
        return -1;
    }
    return run(counted, Counted::changes, Needs::nothing, [&] {
        return next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(f, from, t, to, flags);
    });
}

// Freeing space needs none; a program must do without either.
#define PCM_FALLOCATE(name)                                                                                   \
    int name(int file, int mode, off_t offset, off_t length)                                                  \
    {                                                                                                         \
        if (!plan().holes && counts(file)) {                                                                  \
            errno = EOPNOTSUPP;                                                                               \
            return -1;                                                                                        \
        }                                                                                                     \
        return run(counts(file), Counted::changes, Needs::nothing,                                            \
                   [&] { return next<int (*)(int, int, off_t, off_t)>(#name)(file, mode, offset, length); }); \
    }
PCM_FALLOCATE(fallocate)
PCM_FALLOCATE(fallocate64)

}  // extern "C"
