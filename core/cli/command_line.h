// The command line: options, flags and positional arguments of commands, their help, and exit codes.
//
// command_line.cpp is the only source that includes CLI11. Its inline functions would be most of the compile time of
// every command.
#pragma once

#include "pcm/ops/argument.h"

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pcm::cli {

// The command line makes no sense: exit code 2, with the message and a hint at --help. For what the options below
// cannot express.
using UsageError = ops::ArgumentError;

// One option of a command. A handle: copies mean the same option; valid while its Options are.
class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    Option group(const char* heading) const;  // in the help
    Option values(int count) const { return values(count, count); }
    Option values(int least, int most) const;  // that follow the option's name
    Option one_value_each() const;             // of a list: "--new a --new b", never "--new a b"
    Option shown_if(bool shown) const;         // else the help does not mention it; after group()
    Option show_default() const;               // the help shows the variable's present value

    Option excludes(Option other) const;
    Option needs(Option other) const;

    // What is accepted.
    Option one_of(const std::vector<std::string>& names) const;
    Option between(int least, int most) const;
    Option between(double least, double most) const;
    Option positive() const;
    Option bytes() const;  // a number with a unit, powers of 1024: 512M, 2G

private:
    CLI::Option* option_;
};

// What one command accepts. The variables are written while the command line is parsed; those of options that are not
// given keep their values. They must live until the command has run.
class Options {
public:
    explicit Options(CLI::App& command) : command_(command) {}

    // `names` between commas: "-o,--output". Variables: std::string, float, double, std::uint32_t, std::uint64_t,
    // std::vector of std::string and double, std::optional of double, std::uint16_t and std::uint64_t.
    template <class T>
    Option option(const std::string& names, T& variable, const std::string& help);
    // Given by its place, not by a name.
    template <class T>
    Option positional(const std::string& name, T& variable, const std::string& help);
    // Sets the variable to true.
    Option flag(const std::string& names, bool& variable, const std::string& help);
    // An argument of the table of operations, which gets its value.
    Option argument(ops::Argument& argument);

private:
    CLI::App& command_;
};

// What a command does once its command line is parsed; returns the exit code.
using Run = std::function<int()>;

struct Command {
    std::string name;
    std::string help;  // one line
    // Declares the options and returns what is to be done with them. Null for a command that has a `start`.
    std::function<Run(Options& options)> add;
    // Replaces this process by the program of the command. arguments[0] is the command's name.
    void (*start)(char** arguments) = nullptr;
};

// The exit code of a command whose result is in place, but a later step failed: it must not be repeated.
inline constexpr int done_with_warnings = 3;

// The main function of a program with commands, and of a program that is one command. Parses, runs what was asked for,
// and reports errors on stderr. Exit codes: 0 success; 1 failure; 2 usage error; 3 done, but with a warning on stderr
// (done_with_warnings); 130 cancelled. A file that grows beyond the limit of the system (RLIMIT_FSIZE) is an error and
// does not end the process. A program with commands knows "help COMMAND" and --version too, and lists its commands
// where none or an unknown one is given.
int run_program(const char* name, const char* help, const std::vector<Command>& commands, int argc, char** argv);
int run_program(const Command& command, int argc, char** argv);

}  // namespace pcm::cli
