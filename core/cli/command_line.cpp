#include "pcm/cli/command_line.h"

#include "pcm/cli/common.h"
#include "pcm/ops/result.h"
#include "pcm/ops/values.h"
#include "pcm/system/error.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <new>
#include <utility>

namespace pcm::cli {

void Options::flag(const std::string& names, bool& variable, const std::string& help)
{
    command_.add_flag(names, variable, help);
}

namespace {

std::string type_of(const ops::Argument& argument)
{
    if (!argument.choices().empty()) {
        std::string all;
        for (const ops::Choice& choice : argument.choices()) all += (all.empty() ? "" : "|") + choice.name;
        return all;
    }
    switch (argument.kind()) {
        case ops::ValueKind::bytes:
            return "SIZE";
        case ops::ValueKind::step:
            return "VALUES";
        case ops::ValueKind::whole:
        case ops::ValueKind::real:
        case ops::ValueKind::numbers: {
            const std::string limits = ops::brief_text_of(argument.allowed());
            return limits.empty() ? "NUMBER" : "NUMBER (" + limits + ")";
        }
        default:
            return "TEXT";
    }
}

void expect_values(CLI::Option& option, const ops::Argument& argument)
{
    const ops::ValueKind kind = argument.kind();
    const auto least = static_cast<int>(argument.least_count()), most = static_cast<int>(argument.count());
    if (most > 0 && least < most)
        option.expected(least, most);
    else if (most > 0 || !argument.is_list())
        option.expected(std::max(most, 1))->allow_extra_args(false);  // so that files may follow
    // A list has one value behind each name: "--new a --new b", never "--new a b".
    if ((kind == ops::ValueKind::words || kind == ops::ValueKind::texts || kind == ops::ValueKind::outputs) &&
        !argument.is_positional())
        option.allow_extra_args(false);
    if (kind == ops::ValueKind::step) option.allow_extra_args(false)->trigger_on_parse();  // steps keep their order
    if (kind == ops::ValueKind::words || kind == ops::ValueKind::numbers) option.delimiter(',');
}

// An empty word is most often a shell's variable that is not set: without a value, `delete TREE -o "$COPY"` would
// change the tree itself, and `--region "$REGION"` take all points.
std::string word_fault(const ops::Argument& argument, std::string& word)
{
    return word.empty() ? "the value is empty; leave the option out, or give a value" : argument.fault(word);
}

}  // namespace

void Options::argument(ops::Argument& argument)
{
    const std::string names = argument.option_names(), name = "--" + argument.option_name();
    CLI::Option* option = nullptr;
    if (argument.kind() == ops::ValueKind::flag) {
        const bool on = argument.default_text() == "off";
        option = command_.add_flag_callback(
            names, [&argument, on] { argument.set(on); }, argument.command_help());
        if (argument.is_switched_off()) {  // the name of a flag that is on is accepted too
            std::string key = argument.key();
            std::replace(key.begin(), key.end(), '_', '-');
            command_.add_flag("--" + key, "")->group("")->excludes(option);
        }
    } else {
        const auto set = [&argument, name](const std::vector<std::string>& words) { argument.set(words, name); };
        option = command_.add_option_function<std::vector<std::string>>(names, set, argument.command_help());
        option->transform(CLI::Validator([&argument](std::string& word) { return word_fault(argument, word); }, ""));
        expect_values(*option, argument);
        option->type_name(type_of(argument));
        if (argument.is_required()) option->required();
    }
    if (!argument.group().empty()) option->group(argument.group());
    // Messages about values have no name of an option without a group, so only the help leaves options out.
    const bool is_left_out = argument.is_advanced() && brief_help_;
    if (is_left_out && argument.is_shown()) ++left_out_of_help_;
    if (is_left_out || !argument.is_shown()) option->group("");
}

namespace {

struct Runnable {
    const CLI::App* app;
    Run run;
};

// The message for a command line with words that belong to no option.
std::string unexpected(const CLI::App& command)
{
    const std::vector<std::string> words = command.remaining();
    const auto option =
        std::find_if(words.begin(), words.end(), [](const std::string& word) { return word[0] == '-'; });
    if (option == words.end()) return "'" + words.front() + "' is one word too many";
    const std::string name = option->substr(0, option->find('='));
    std::vector<std::string> names;
    for (const CLI::Option* known : command.get_options())
        for (const std::string& long_name : known->get_lnames()) names.push_back("--" + long_name);
    return "there is no option " + name + ops::perhaps(name, names);
}

// The first option among the words of a command line that has too few or too many values.
std::string wrong_number_of_values(const CLI::App& command, const std::vector<std::string>& words,
                                   const std::string& otherwise)
{
    const auto fault_of = [](const CLI::Option& option) -> std::string {
        const auto given = static_cast<int>(option.results().size());
        const int least = option.get_items_expected_min(), most = option.get_items_expected_max();
        if (most == 0 || (given >= least && given <= most)) return "";  // a flag takes none
        if (most == 1) return option.get_name() + (given == 0 ? " needs a value" : " takes one value");
        if (least == 1 && given == 0) return option.get_name() + " needs a value";
        std::string takes = std::to_string(least);
        if (most > least) takes += most < 10000 ? " to " + std::to_string(most) : " or more";
        return option.get_name() + " takes " + takes + " values, and got " + std::to_string(given);
    };
    for (const std::string& word : words) {
        const CLI::Option* const option =
            word.size() > 1 && word[0] == '-' ? command.get_option_no_throw(word.substr(0, word.find('='))) : nullptr;
        const std::string fault = option ? fault_of(*option) : "";
        if (!fault.empty()) return fault;
    }
    const CLI::Option* const last = words.empty() ? nullptr : command.get_option_no_throw(words.back());
    if (last && last->get_items_expected_min() > 0) return words.back() + " needs a value";
    return otherwise;
}

// With --json what fails is an answer too; the text still goes to the error output.
bool answers_in_json = false;

bool has_json_flag(const std::vector<std::string>& words)
{
    return std::find(words.begin(), words.end(), "--json") != words.end();
}

int refuse_usage(const CLI::App& command, const std::string& what)
{
    if (answers_in_json) print_json(ops::json_of_error(UsageError(what)));
    const CLI::App* const parent = command.get_parent();  // null for the program itself
    std::fprintf(stderr, "%s%s: %s\nRun with --help for more information.\n",
                 parent ? (parent->get_name() + " ").c_str() : "", command.get_name().c_str(), what.c_str());
    return 2;
}

bool is_number_list(const CLI::Option* option)
{
    return option && option->get_items_expected_max() > 1 && option->get_type_name().rfind("NUMBER", 0) == 0;
}

// The parser takes every word after the name of a list as its value. What follows a list of numbers and is not a number
// is moved to the end, behind "--": "fit --at 1 2 3 scan.pct" is "fit --at 1 2 3 -- scan.pct".
std::vector<std::string> end_lists(const CLI::App& command, const std::vector<std::string>& words)
{
    if (std::find(words.begin(), words.end(), "--") != words.end()) return words;
    std::vector<std::string> kept, moved;
    const CLI::Option* list = nullptr;
    int numbers = 0;
    bool ended = false;
    for (const std::string& word : words) {
        std::string number = word;
        const bool is_number = ops::number_fault(number, {}).empty();
        if (word.size() > 1 && word[0] == '-' && !is_number) {
            const CLI::Option* const option = command.get_option_no_throw(word);
            list = is_number_list(option) ? option : nullptr;
            numbers = 0;
            ended = false;
        } else if (list) {
            ended = ended || (!is_number && numbers >= list->get_items_expected_min());
            ++numbers;
        }
        (list && ended ? moved : kept).push_back(word);
    }
    if (moved.empty()) return words;
    kept.push_back("--");
    kept.insert(kept.end(), moved.begin(), moved.end());
    return kept;
}

const CLI::App* command_of(const std::vector<Runnable>& commands, const std::vector<std::string>& words)
{
    const auto named = std::find_if(commands.begin(), commands.end(),
                                    [&](const Runnable& c) { return c.app->get_name() == words[0]; });
    return named == commands.end() ? nullptr : named->app;
}

// What may be given by its place or by its name comes first where it is given by its name, so that no other word takes
// its place: "merge a.pct b.pct -o c.pct" is "merge -o c.pct a.pct b.pct".
std::vector<std::string> named_places_first(const CLI::App& command, std::vector<std::string> words)
{
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_positional() || option->get_snames().empty()) continue;
        const std::string name = "--" + option->get_lnames().front(), letter = "-" + option->get_snames().front();
        const auto end = std::find(words.begin(), words.end(), "--");
        const auto at = std::find_if(words.begin() + 1, end, [&](const std::string& word) {
            return word == name || word == letter || word.rfind(name + "=", 0) == 0 ||
                   (word.rfind(letter, 0) == 0 && word.size() > letter.size());
        });
        const bool is_alone = at != end && (*at == name || *at == letter);
        if (at == end || (is_alone && at + 1 == end)) continue;  // the parser says what is missing
        std::rotate(words.begin() + 1, at, at + (is_alone ? 2 : 1));
    }
    return words;
}

int parse_and_run(CLI::App& app, const std::vector<Runnable>& commands, std::vector<std::string> words)
{
    const auto parsed = [&] {
        const auto at =
            std::find_if(commands.begin(), commands.end(), [](const Runnable& c) { return c.app->parsed(); });
        return at == commands.end() ? nullptr : &*at;
    };
    const auto command = [&]() -> const CLI::App& { return parsed() ? *parsed()->app : app; };
    const std::vector<std::string> given = words;
    try {
        if (const CLI::App* const named = words.empty() ? nullptr : command_of(commands, words))
            words = end_lists(*named, named_places_first(*named, std::move(words)));
        std::reverse(words.begin(), words.end());  // as CLI11 takes them
        app.parse(std::move(words));
        return parsed() ? parsed()->run() : 0;
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ExtrasError&) {
        return refuse_usage(command(), unexpected(command()));
    } catch (const CLI::ArgumentMismatch& error) {
        return refuse_usage(command(), wrong_number_of_values(command(), given, error.what()));
    } catch (const CLI::ParseError& error) {
        return refuse_usage(command(), error.what());
    } catch (const UsageError& error) {
        return refuse_usage(command(), error.what());
    }
}

void print_error(const std::exception& error)
{
    leave_progress_line();
    if (answers_in_json) print_json(ops::json_of_error(error));
}

int report_errors(const Run& run)
{
    std::signal(SIGXFSZ, SIG_IGN);  // writing fails with EFBIG then
    try {
        return run();
    } catch (const Error& error) {
        print_error(error);
        std::fprintf(stderr, error.is_done() ? "pcmlab: warning: %s\n" : "pcmlab: %s\n", error.what());
        if (error.is_done()) return done_with_warnings;
        return error.code() == ErrorCode::cancelled ? 130 : 1;
    } catch (const std::bad_alloc& error) {
        print_error(error);
        std::fputs("pcmlab: out of memory\n", stderr);
    } catch (const std::exception& error) {
        print_error(error);
        std::fprintf(stderr, "pcmlab: %s\n", error.what());
    }
    return 1;
}

std::string unknown_command(const std::string& word, const std::vector<Command>& commands)
{
    std::vector<std::string> names;
    for (const Command& command : commands) names.push_back(command.name);
    return "there is no command '" + word + "'" + ops::perhaps(word, names);
}

std::string list_of(const char* name, const std::vector<Command>& commands)
{
    std::size_t width = 0;
    for (const Command& command : commands) width = std::max(width, command.name.size());
    std::string text = "Commands:\n";
    for (const Command& command : commands)
        text += "  " + command.name + std::string(width + 2 - command.name.size(), ' ') + command.help + "\n";
    return text + "\n'" + name + " help COMMAND' shows the options of a command.\n";
}

// Without a command, or with an unknown one: lists the commands, as an error.
int refuse_command(const char* name, const std::string& what, const std::vector<Command>& commands)
{
    std::fprintf(stderr, "%s: %s\n\n%s", name, what.c_str(), list_of(name, commands).c_str());
    return 2;
}

constexpr const char* help_all = "--help-all";

// "help NAME" is "NAME --help-all", "help" alone is "--help".
std::vector<std::string> words_of(int argc, char** argv)
{
    std::vector<std::string> words(argv + 1, argv + argc);
    if (words.empty() || words[0] != "help") return words;
    if (words.size() == 1 || words[1] == "help" || words[1] == "--help") return {"--help"};
    return {words[1], help_all};
}

// What the help of a command left out, and where it is.
std::string footer_of(const std::string& program, const Command& command, const Options& options)
{
    const int count = options.left_out_of_help();
    if (count == 0) return command.limits;
    return std::to_string(count) + (count == 1 ? " more option: " : " more options: ") + program + " " + command.name +
           " " + help_all;
}

// Groups of options with one empty line between them.
class CompactHelp : public CLI::Formatter {
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override
    {
        std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
        for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
        return text;
    }
};

// The command line from the command's name on: options of the program may stand before it.
std::vector<std::string> words_from(const std::string& name, const std::vector<std::string>& words)
{
    return {std::find(words.begin(), words.end(), name), words.end()};
}

}  // namespace

int run_program(const char* name, const char* help, const std::vector<Command>& commands, int argc, char** argv)
{
    return report_errors([&] {
        std::vector<std::string> words = words_of(argc, argv);
        answers_in_json = has_json_flag(words);
        const auto has = [&](const char* word) { return std::find(words.begin(), words.end(), word) != words.end(); };
        const bool brief_help = (has("--help") || has("-h")) && !has(help_all);
        std::replace(words.begin(), words.end(), std::string(help_all),
                     std::string("--help"));  // as the parser knows it
        if (words.empty()) return refuse_command(name, std::string("a command is missing\n") + help, commands);
        CLI::App app{help, name};
        app.set_version_flag("--version", std::string(name) + " " PCM_VERSION);
        app.require_subcommand(1);
        app.formatter(std::make_shared<CompactHelp>());  // inherited by the commands
        std::vector<Runnable> runnable;
        bool known = words[0][0] == '-';
        for (const Command& command : commands) {
            known = known || command.name == words[0];
            CLI::App* const subcommand = app.add_subcommand(command.name, command.help);
            Options options(*subcommand, words_from(command.name, words), brief_help);
            runnable.push_back({subcommand, command.add(options)});
            subcommand->footer(footer_of(name, command, options));
        }
        app.footer(std::string("'") + name + " help COMMAND' shows the options of a command.");
        if (!known) return refuse_command(name, unknown_command(words[0], commands), commands);
        return parse_and_run(app, runnable, words);
    });
}

}  // namespace pcm::cli
