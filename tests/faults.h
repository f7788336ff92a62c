// Runs a command while the system fails it: see faults/preload.cpp.
#pragma once

#include "tests/paths.h"
#include "tests/support.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace pcm::test {

struct Faulty {
    bool killed = false;  // whether the fault killed it
    int code = -1;        // exit code otherwise
    std::string err;      // what it wrote to stderr
};

// Runs `command` (program and arguments). The `at`-th file-changing call below `under` meets the fault `kind` (of those
// in faults/preload.cpp); with "count" none does. `calls`, if given, receives how many there were, when the command
// ends by itself.
inline Faulty run_with_fault(const std::vector<std::string>& command, const std::filesystem::path& under,
                             const std::string& kind, long at = 0, long* calls = nullptr)
{
    TemporaryFolder notes;
    const std::string err = (notes / "stderr").string(), count = (notes / "count").string();
    const std::string folder = std::filesystem::weakly_canonical(under).string();
    const pid_t child = fork();
    if (child == 0) {
        setenv("LD_PRELOAD", paths::faults, 1);
        // The sanitizers' libraries need not be the first then.
        const char* asan = std::getenv("ASAN_OPTIONS");
        setenv("ASAN_OPTIONS", (std::string(asan ? asan : "") + ":verify_asan_link_order=0:detect_leaks=0").c_str(), 1);
        setenv("PCM_FAULT", kind.c_str(), 1);
        setenv("PCM_FAULT_AT", std::to_string(at).c_str(), 1);
        setenv("PCM_FAULT_UNDER", folder.c_str(), 1);
        if (calls) setenv("PCM_FAULT_COUNT", count.c_str(), 1);
        if (!std::freopen(err.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) _exit(126);
        std::vector<char*> arguments;
        for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    Faulty result;
    result.killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
    std::ifstream file(err);
    result.err.assign(std::istreambuf_iterator<char>(file), {});
    if (calls) {
        *calls = -1;
        std::ifstream(count) >> *calls;
    }
    return result;
}

// How many file-changing calls the command makes below `under`; with "count_opens" or "count_closes" how many of those.
inline long count_calls(const std::vector<std::string>& command, const std::filesystem::path& under,
                        const std::string& kind = "count")
{
    long calls = 0;
    const Faulty result = run_with_fault(command, under, kind, 0, &calls);
    EXPECT_EQ(result.code, 0) << result.err;
    return calls;
}

// `most` numbers spread over 1..calls, first and last among them; all of them when there are fewer.
inline std::vector<long> spread(long calls, long most)
{
    std::vector<long> instants;
    const long count = std::min(calls, most);
    for (long i = 0; i < count; ++i) instants.push_back(count == 1 ? 1 : 1 + i * (calls - 1) / (count - 1));
    return instants;
}

}  // namespace pcm::test
