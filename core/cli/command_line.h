// The command line: arguments and flags of commands, their help, and exit codes.
//
// command_line.cpp is the only source that includes CLI11. Its inline functions would be most of the compile time of
// every command.
#pragma once

#include "pcm/ops/argument.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace pcm::cli {

// The command line makes no sense: exit code 2, with the message and a hint at --help.
using UsageError = ops::ArgumentError;

// What one command accepts. The variables are written while the command line is parsed, and keep their values where
// nothing is given. They must live until the command has run.
class Options {
public:
    // `words`: the command line, from the command's name on. `brief_help`: it asks for the help, without the advanced
    // arguments.
    Options(CLI::App& command, std::vector<std::string> words, bool brief_help)
        : command_(command), words_(std::move(words)), brief_help_(brief_help)
    {
    }

    // `names` between commas: "-q,--quiet". Sets the variable to true.
    void flag(const std::string& names, bool& variable, const std::string& help);
    // An argument of the table of operations, which gets its value.
    void argument(ops::Argument& argument);
    const std::vector<std::string>& words() const { return words_; }
    int left_out_of_help() const { return left_out_of_help_; }

private:
    CLI::App& command_;
    std::vector<std::string> words_;
    bool brief_help_;
    int left_out_of_help_ = 0;
};

// What a command does once its command line is parsed; returns the exit code.
using Run = std::function<int()>;

struct Command {
    std::string name;
    std::string help;  // one line
    // Declares the options and returns what is to be done with them.
    std::function<Run(Options& options)> add;
    std::string limits{};  // below all of its options: what it does not take, and why; may be empty
};

// The exit code of a command whose result is in place, but a later step failed: it must not be repeated.
inline constexpr int done_with_warnings = 3;

// The main function of a program with commands. Parses, runs the command, and reports errors on stderr. Exit codes: 0
// success; 1 failure; 2 usage error; 3 done, but with a warning on stderr (done_with_warnings); 130 cancelled. A file
// that grows beyond the limit of the system (RLIMIT_FSIZE) is an error and does not end the process. "help COMMAND",
// which is "COMMAND --help-all", and --version are accepted too, and where no command or an unknown one is given, the
// commands are listed.
int run_program(const char* name, const char* help, const std::vector<Command>& commands, int argc, char** argv);

}  // namespace pcm::cli
