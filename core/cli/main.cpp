// The pcmlab command; commands.cpp lists what it can do.
#include "pcm/cli/commands.h"
#include "pcm/cli/manual.h"
#include "pcm/cli/usage.h"

#include <cstdio>
#include <cstring>

namespace {

// "help --json" and the like, before the command line is parsed. Returns the exit code; nothing: it is another line.
std::optional<int> print_usage(int argc, char** argv)
{
    try {
        const auto text = pcm::cli::usage_text({argv + 1, argv + argc}, pcm::cli::commands());
        if (!text) return std::nullopt;
        return std::fputs(text->c_str(), stdout) < 0 ? 1 : 0;
    } catch (const pcm::cli::UsageError& error) {
        std::fprintf(stderr, "pcmlab: %s\n", error.what());
        return 2;
    }
}

}  // namespace

int main(int argc, char** argv)
{
    if (argc == 2 && std::strcmp(argv[1], "manual") == 0) return pcm::cli::show_manual();
    if (const auto code = print_usage(argc, argv)) return *code;
    return pcm::cli::run_program(
        "pcmlab",
        "Point clouds larger than memory. Begin with 'pcmlab build SCAN.laz'; 'pcmlab manual' opens the manual",
        pcm::cli::commands(), argc, argv);
}
