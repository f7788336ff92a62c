#include "pcm/cli/command_line.h"

#include "pcm/system/error.h"

#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <new>
#include <optional>

namespace pcm::cli {

Option Option::required() const
{
    option_->required();
    return *this;
}

Option Option::group(const char* heading) const
{
    option_->group(heading);
    return *this;
}

Option Option::values(int least, int most) const
{
    if (least == most)
        option_->expected(least);
    else
        option_->expected(least, most);
    return *this;
}

Option Option::one_value_each() const
{
    option_->allow_extra_args(false);
    return *this;
}

Option Option::separated_by(char separator) const
{
    option_->delimiter(separator);
    return *this;
}

Option Option::show_default() const
{
    option_->capture_default_str();
    return *this;
}

Option Option::excludes(Option other) const
{
    option_->excludes(other.option_);
    return *this;
}

Option Option::needs(Option other) const
{
    option_->needs(other.option_);
    return *this;
}

Option Option::one_of(const std::vector<std::string>& names) const
{
    option_->check(CLI::IsMember(names));
    return *this;
}

Option Option::between(int least, int most) const
{
    option_->check(CLI::Range(least, most));
    return *this;
}

Option Option::between(double least, double most) const
{
    option_->check(CLI::Range(least, most));
    return *this;
}

Option Option::positive() const
{
    option_->check(CLI::PositiveNumber);
    return *this;
}

Option Option::not_negative() const
{
    option_->check(CLI::NonNegativeNumber);
    return *this;
}

Option Option::bytes() const
{
    option_->transform(CLI::AsSizeValue(false));
    return *this;
}

template <class T>
Option Options::option(const std::string& names, T& variable, const std::string& help)
{
    return Option(command_.add_option(names, variable, help));
}

template <class T>
Option Options::positional(const std::string& name, T& variable, const std::string& help)
{
    return option(name, variable, help);  // CLI11 distinguishes them by the dashes
}

template Option Options::option(const std::string&, std::string&, const std::string&);
template Option Options::option(const std::string&, float&, const std::string&);
template Option Options::option(const std::string&, double&, const std::string&);
template Option Options::option(const std::string&, std::uint32_t&, const std::string&);
template Option Options::option(const std::string&, std::uint64_t&, const std::string&);
template Option Options::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Options::option(const std::string&, std::vector<double>&, const std::string&);
template Option Options::option(const std::string&, std::optional<double>&, const std::string&);
template Option Options::option(const std::string&, std::optional<std::uint16_t>&, const std::string&);
template Option Options::option(const std::string&, std::optional<std::uint32_t>&, const std::string&);
template Option Options::option(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option Options::positional(const std::string&, std::string&, const std::string&);
template Option Options::positional(const std::string&, std::vector<std::string>&, const std::string&);

Option Options::flag(const std::string& names, bool& variable, const std::string& help)
{
    return Option(command_.add_flag(names, variable, help));
}

Option Options::off_flag(const std::string& names, bool& variable, const std::string& help)
{
    return flag("!" + names, variable, help);
}

namespace {

struct Runnable {
    const CLI::App* app;
    Run run;
};

int parse_and_run(CLI::App& app, const std::vector<Runnable>& commands, int argc, char** argv)
{
    try {
        app.parse(argc, argv);
        for (const Runnable& command : commands)
            if (command.app->parsed()) return command.run();
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;  // --help is thrown too
    } catch (const UsageError& error) {
        app.exit(CLI::ValidationError(error.what()));
        return 2;
    }
}

int report_errors(const Run& run)
{
    std::signal(SIGXFSZ, SIG_IGN);  // writing fails with EFBIG then
    try {
        return run();
    } catch (const Error& error) {
        std::fprintf(stderr, error.is_done() ? "pcmlab: warning: %s\n" : "pcmlab: %s\n", error.what());
        if (error.is_done()) return done_with_warnings;
        return error.code() == ErrorCode::cancelled ? 130 : 1;
    } catch (const std::bad_alloc&) {
        std::fputs("pcmlab: out of memory\n", stderr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "pcmlab: %s\n", error.what());
    }
    return 1;
}

// A command that is a program of its own was parsed: `start` would have replaced this process had its name come first.
Run not_first(const std::string& name)
{
    return [name]() -> int { throw UsageError("'" + name + "' must be the first argument"); };
}

}  // namespace

int run_program(const char* name, const char* help, const std::vector<Command>& commands, int argc, char** argv)
{
    return report_errors([&] {
        CLI::App app{help, name};
        app.require_subcommand(1);
        std::vector<Runnable> runnable;
        for (const Command& command : commands) {
            if (command.start && argc > 1 && command.name == argv[1]) command.start(argv + 1);
            CLI::App* const subcommand = app.add_subcommand(command.name, command.help);
            Options options(*subcommand);
            runnable.push_back({subcommand, command.start ? not_first(command.name) : command.add(options)});
        }
        return parse_and_run(app, runnable, argc, argv);
    });
}

int run_program(const Command& command, int argc, char** argv)
{
    return report_errors([&] {
        CLI::App app{command.help, command.name};
        Options options(app);
        return parse_and_run(app, {{&app, command.add(options)}}, argc, argv);
    });
}

}  // namespace pcm::cli
