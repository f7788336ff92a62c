// pcmlab-mpi: operations by several processes, of one machine or many, that share a folder.
#include "pcm/cli/mpi/mpi_team.h"
#include "pcm/cli/operation_command.h"
#include "pcm/system/peak_memory.h"

#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace {

using pcm::cli::MpiTeam;

constexpr const char* help =
    "Point clouds larger than memory, by several processes: 'mpirun -n 4 pcmlab-mpi build SCAN.laz -o SCAN.pct'. "
    "All machines share the folders of the input and of the result. What is interrupted is resumed by the same "
    "command, with any number of processes. --memory and --threads are each process's";

// The operations that several processes can do together.
constexpr std::array operations{"build", "verify", "normals", "radii", "outliers", "convert"};

// Whether the command line names an operation of pcmlab's that is not among these, which is then reported.
bool is_refused(int argc, char** argv)
{
    if (argc < 2 || !pcm::ops::find_operation(argv[1])) return false;
    if (std::find(operations.begin(), operations.end(), std::string(argv[1])) != operations.end()) return false;
    std::fprintf(stderr, "pcmlab-mpi: several processes do not do '%s' together; use 'pcmlab %s'\n", argv[1], argv[1]);
    return true;
}

// The command of an operation. `answered` becomes true where it ends by itself, whatever its exit code.
pcm::cli::Command command_of(const char* name, const pcm::cli::OpenGLSetup& set_up, bool& answered)
{
    pcm::cli::Command command = pcm::cli::operation_command(*pcm::ops::find_operation(name), set_up);
    command.add = [add = command.add, &answered](pcm::cli::Options& options) -> pcm::cli::Run {
        return [run = add(options), &answered] {
            const int code = run();
            answered = true;
            return code;
        };
    };
    return command;
}

// Output that all ranks would write is rank 0's.
class Silence {
public:
    Silence() : errors_(::dup(STDERR_FILENO))
    {
        if (!std::freopen("/dev/null", "w", stdout)) std::abort();
        std::fflush(stderr);
        const int nowhere = ::fileno(stdout);
        ::dup2(nowhere, STDERR_FILENO);
    }
    void end_for_errors() { ::dup2(errors_, STDERR_FILENO); }

private:
    int errors_;
};

// The output of mpirun may be a terminal or a log: a line now and then.
pcm::ProgressFunction progress_lines(unsigned ranks)
{
    using Clock = std::chrono::steady_clock;
    struct State {
        Clock::time_point last = Clock::now();
    };
    auto state = std::make_shared<State>();
    return [state, ranks](const pcm::ProgressUpdate& update) {
        constexpr std::chrono::seconds between(5);
        if (Clock::now() - state->last < between) return true;
        state->last = Clock::now();
        std::fprintf(stderr, "%s: %.0f %%, %u ranks\n", std::string(update.stage).c_str(), 100 * update.fraction,
                     ranks);
        return true;
    };
}

}  // namespace

int main(int argc, char** argv)
{
    int level = 0;
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &level) != MPI_SUCCESS || level < MPI_THREAD_SERIALIZED) {
        std::fputs("pcmlab-mpi: this MPI does not let threads take turns (MPI_THREAD_SERIALIZED)\n", stderr);
        return 1;
    }
    int code = 1;
    {
        MpiTeam team;
        std::unique_ptr<Silence> silence;
        if (team.rank() != 0) silence = std::make_unique<Silence>();
        bool quiet = false;
        for (int a = 1; a < argc; ++a)
            for (const char* word : {"-q", "--quiet", "--json"}) quiet = quiet || std::strcmp(argv[a], word) == 0;
        const auto set_up = [&](pcm::ops::Context& context, const std::vector<std::string>& words) {
            if (silence) silence->end_for_errors();
            context.team = &team;
            context.words = words;
            context.progress = {};
            if (team.rank() == 0 && !quiet) context.progress = progress_lines(team.size());
        };
        bool answered = false;
        std::vector<pcm::cli::Command> commands;
        for (const char* name : operations) commands.push_back(command_of(name, set_up, answered));
        code = is_refused(argc, argv) ? 2 : pcm::cli::run_program("pcmlab-mpi", help, commands, argc, argv);
        if (answered && std::getenv("PCM_MPI_REPORT"))
            std::fprintf(stderr, "rank %u: %llu bytes to neighbours, peak memory %llu bytes\n", team.rank(),
                         static_cast<unsigned long long>(team.bytes_exchanged()),
                         static_cast<unsigned long long>(pcm::peak_memory_bytes()));
        // The others wait for this one, or fail in the same way.
        if (code == 1 && !answered) MPI_Abort(MPI_COMM_WORLD, code);
    }
    MPI_Finalize();
    return code;
}
