// Options, exit codes and help, on commands of the test's own.

#include "pcm/cli/common.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <new>
#include <optional>
#include <stdexcept>

namespace pcm::cli {
namespace {

struct Given {
    std::string word, mode = "fast";
    std::vector<std::string> files, names;
    std::vector<double> box, place;
    float size = 2;
    double factor = 1;
    std::uint32_t threads = 0;
    std::uint64_t memory = 7, points = 3;
    std::optional<std::uint16_t> level;
    std::optional<std::uint32_t> rare;
    std::optional<std::uint32_t> decimals;
    std::optional<std::uint64_t> lines;
    std::optional<double> angle;
    bool overwrite = false;
    std::vector<std::string> words;  // words of the command line
};
Given given;
Run work = [] { return 0; };

Run add_all(Options& options)
{
    using ops::ValueKind;
    given = {};
    static std::optional<ops::Arguments> arguments;
    ops::Arguments& all = arguments.emplace();
    all.add("word", given.word).positional().required().help("A word");
    all.add("files", given.files).as(ValueKind::inputs).positional().help("Files");
    all.add("names", given.names).as(ValueKind::texts).help("Names");
    all.add("box", given.box).count(2, 4).help("Box");
    all.add("place", given.place).count(3).help("Place");
    all.add("size", given.size).between(0.5, 10).help("Size");
    all.add("factor", given.factor).positive().help("Factor");
    all.add("threads", given.threads).letter('t').between(1, 8).help("Threads");
    all.add("memory", given.memory).letter('m').as(ValueKind::bytes).help("Memory");
    all.add("points", given.points).help("Points");
    all.add("level", given.level).group("Which points").help("Level");
    all.add("decimals", given.decimals).help("Decimals");
    all.add("lines", given.lines).help("Lines");
    all.add("angle", given.angle).help("Angle");
    all.add("mode", given.mode).as(ValueKind::choice).one_of({{"fast", "Fast"}, {"even", "Even"}}).help("Mode");
    all.add("overwrite", given.overwrite).help("Overwrite");
    all.add("rare", given.rare).between(1, 4).advanced().help("For few");
    all.add("hidden", given.overwrite).shown(false).help("Not in the help");
    for (ops::Argument& argument : all.list()) options.argument(argument);
    given.words = options.words();
    return work;
}

Run add_other(Options&)
{
    return [] { return 3; };
}

struct Result {
    int code = -1;
    std::string out, err;
};

Result captured(int (*run)(int, char**), std::vector<std::string> words)
{
    words.insert(words.begin(), "program");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    Result result;
    result.code = run(static_cast<int>(words.size()), arguments.data());
    result.out = testing::internal::GetCapturedStdout();
    result.err = testing::internal::GetCapturedStderr();
    return result;
}

// A program with commands.
int run_many(int argc, char** argv)
{
    const std::vector<Command> commands = {
        {"all", "Every kind of option", add_all},
        {"other", "Another command", add_other},
    };
    return run_program("many", "Many things", commands, argc, argv);
}
Result many(const std::vector<std::string>& words) { return captured(run_many, words); }

// Its command that takes every kind of option.
Result one(std::vector<std::string> words)
{
    words.insert(words.begin(), "all");
    return many(words);
}

TEST(CommandLine, VariablesTakeWhatIsGiven)
{
    const Result result = one({"w",  "a",        "b",    "--names",     "x",       "--names",  "y",          "--box",
                               "1",  "2.5",      "-3",   "--size",      "0.5",     "--factor", "1e-3",       "-t",
                               "8",  "--memory", "2K",   "--points",    "0",       "--level",  "65535",      "--angle",
                               "-1", "--mode",   "even", "--overwrite", "--lines", "0",        "--decimals", "4"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(given.word, "w");
    EXPECT_EQ(given.files, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(given.names, (std::vector<std::string>{"x", "y"}));
    EXPECT_EQ(given.box, (std::vector<double>{1, 2.5, -3}));
    EXPECT_EQ(given.size, 0.5f);
    EXPECT_EQ(given.factor, 1e-3);
    EXPECT_EQ(given.threads, 8u);
    EXPECT_EQ(given.memory, 2048u);
    EXPECT_EQ(given.points, 0u);
    EXPECT_EQ(given.level, 65535);
    EXPECT_EQ(given.lines, 0u);
    EXPECT_EQ(given.decimals, 4u);
    EXPECT_EQ(given.angle, -1.0);
    EXPECT_EQ(given.mode, "even");
    EXPECT_TRUE(given.overwrite);
}

// What a shell makes of a variable that is not set: taken as nothing given, `-o ""` would change the input itself.
TEST(CommandLine, EmptyValuesAreRefused)
{
    using Words = std::vector<std::string>;
    for (const Words& words : {Words{""}, Words{"w", ""}, Words{"w", "--names", ""}, Words{"w", "--threads", ""},
                               Words{"w", "--mode", ""}}) {
        const Result result = one(words);
        EXPECT_EQ(result.code, 2) << testing::PrintToString(words);
        EXPECT_NE(result.err.find("empty"), std::string::npos) << testing::PrintToString(words) << result.err;
    }
}

// Files may stand behind numbers, however many these are.
TEST(CommandLine, AListOfNumbersEndsAtAWordThatIsNone)
{
    using Words = std::vector<std::string>;
    using Numbers = std::vector<double>;
    for (const Words& words :
         {Words{"--place", "1", "-2", "3", "w", "a", "7"}, Words{"--place", "1", "-2", "3", "--", "w", "a", "7"},
          Words{"--box", "4", "5", "--place", "1", "-2", "3", "w", "a", "7"}}) {
        const Result result = one(words);
        EXPECT_EQ(result.code, 0) << result.err;
        EXPECT_EQ(given.place, (Numbers{1, -2, 3}));
        EXPECT_EQ(given.word, "w");
        EXPECT_EQ(given.files, (Words{"a", "7"}));
    }
    for (const Words& words : {Words{"all", "--box", "1", "-2.5", "w", "a", "7"},
                               Words{"all", "--box", "1", "-2.5", "w", "a", "7", "--size", "3"},
                               Words{"all", "--size", "3", "w", "--box", "1", "-2.5", "a", "7", "-t", "2"}}) {
        EXPECT_EQ(many(words).code, 0);
        EXPECT_EQ(given.box, (Numbers{1, -2.5}));
        EXPECT_EQ(given.word, "w");
        EXPECT_EQ(given.files, (Words{"a", "7"}));
    }
    EXPECT_NE(one({"w", "--box", "1", "a"}).err.find("'a' is not a number"), std::string::npos);
    EXPECT_NE(one({"w", "--place", "1", "2", "a"}).err.find("'a' is not a number"), std::string::npos);
}

TEST(CommandLine, WhatIsNotGivenKeepsItsValue)
{
    EXPECT_EQ(one({"w"}).code, 0);
    EXPECT_EQ(given.mode, "fast");
    EXPECT_EQ(given.memory, 7u);
    EXPECT_TRUE(given.files.empty() && given.box.empty());
    EXPECT_FALSE(given.level || given.lines || given.decimals || given.angle || given.overwrite);
}

TEST(CommandLine, UsageErrorsAreExitCodeTwoAndNameTheOption)
{
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
        {{}, "word is required"},
        {{"w", "--nonsense"}, "many all: there is no option --nonsense\n"},
        {{"w", "--nams", "x", "y"}, "many all: there is no option --nams; perhaps --names\n"},
        {{"w", "--over=3"}, "many all: there is no option --over; perhaps --overwrite\n"},
        {{"w", "--box", "1"}, "many all: --box takes 2 to 4 values, and got 1\n"},
        {{"w", "--overwrite", "--box", "1"}, "many all: --box takes 2 to 4 values, and got 1\n"},
        {{"w", "--box"}, "many all: --box takes 2 to 4 values, and got 0\n"},
        {{"w", "--angle"}, "many all: --angle needs a value\n"},
        {{"w", "--angle", "3", "--names"}, "many all: --names needs a value\n"},
        {{"w", "--box", "1", "x"}, "many all: --box: 'x' is not a number\n"},
        {{"w", "--size", "0.4"}, "many all: --size: '0.4' is not a number from 0.5 to 10\n"},
        {{"w", "--size", "abc"}, "many all: --size: 'abc' is not a number from 0.5 to 10\n"},
        {{"w", "--factor", "0"}, "many all: --factor: '0' is not a number greater than 0\n"},
        {{"w", "--threads", "9"}, "many all: --threads: '9' is not a whole number from 1 to 8\n"},
        {{"w", "--memory", "2Q"}, "many all: --memory: '2Q' is not a size"},
        {{"w", "--points", "1.5"}, "many all: --points: '1.5' is not a whole number\n"},
        {{"w", "--level", "65536"}, "many all: --level: '65536' is too large; 65535 is the largest\n"},
        {{"w", "--angle", "x"}, "many all: --angle: 'x' is not a number\n"},
        {{"w", "--angle", "1", "--mode", "slow"}, "--mode: 'slow' is not fast or even"},
    };
    for (const auto& [words, message] : mistakes) {
        const Result result = one(words);
        EXPECT_EQ(result.code, 2) << message;
        EXPECT_NE(result.err.find(message), std::string::npos) << message << ": " << result.err;
        EXPECT_NE(result.err.find("--help"), std::string::npos) << result.err;
    }
    // One value each: the second is taken as a file.
    EXPECT_EQ(one({"w", "--names", "x", "y"}).code, 0);
    EXPECT_EQ(given.files, (std::vector<std::string>{"y"}));
}

Result ends_with(const Run& run)
{
    work = run;
    const Result result = one({"w"});
    work = [] { return 0; };
    return result;
}

TEST(CommandLine, ExitCodesOfTheWork)
{
    EXPECT_EQ(ends_with([] { return 1; }).code, 1);
    EXPECT_EQ(ends_with([]() -> int { throw Error(ErrorCode::cancelled, {}, "stopped"); }).code, 130);
    const Result failed = ends_with([]() -> int { throw Error(ErrorCode::io, "a.las", "it broke", "mend it"); });
    EXPECT_EQ(failed.code, 1);
    EXPECT_EQ(failed.err, "pcmlab: a.las: it broke (mend it)\n");
    EXPECT_EQ(ends_with([]() -> int { throw std::bad_alloc(); }).err, "pcmlab: out of memory\n");
    EXPECT_EQ(ends_with([]() -> int { throw std::runtime_error("odd"); }).err, "pcmlab: odd\n");
    const Result usage = ends_with([]() -> int { throw UsageError("word: too short"); });
    EXPECT_EQ(usage.code, 2);
    EXPECT_EQ(usage.err, "many all: word: too short\nRun with --help for more information.\n");
}

// A terminal in place of stderr. What was written to it, as text.
class Terminal {
public:
    Terminal()
    {
        if (openpty(&master_, &slave_, nullptr, nullptr, nullptr) != 0) throw std::runtime_error("no terminal");
        before_ = dup(STDERR_FILENO);
        dup2(slave_, STDERR_FILENO);
    }
    ~Terminal()
    {
        restore();
        close(master_);
    }
    std::string text()
    {
        restore();
        std::string all;
        std::array<char, 4096> buffer;
        for (ssize_t n; (n = read(master_, buffer.data(), buffer.size())) > 0;)
            all.append(buffer.data(), static_cast<std::size_t>(n));
        return all;
    }

private:
    void restore()
    {
        if (before_ < 0) return;
        std::fflush(stderr);
        dup2(before_, STDERR_FILENO);
        close(before_);
        close(slave_);  // reading ends then
        before_ = -1;
    }
    int master_ = -1, slave_ = -1, before_ = -1;
};

int run_one()
{
    std::string words[] = {"program", "all", "w"};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    return run_many(3, arguments);
}

TEST(CommandLine, AnErrorBehindTheProgressStandsOnALineOfItsOwn)
{
    const auto fail = []() -> int {
        console_progress({})({"Reading points", 0.5});
        throw Error(ErrorCode::cancelled, {}, "cancelled");
    };
    Terminal terminal;
    work = fail;
    EXPECT_EQ(run_one(), 130);
    const std::string shown = terminal.text();
    EXPECT_NE(shown.find("Reading points"), std::string::npos) << shown;
    EXPECT_NE(shown.find("\npcmlab: cancelled\r\n"), std::string::npos) << shown;
    // Where no progress is shown, nothing but the message.
    EXPECT_EQ(ends_with(fail).err, "pcmlab: cancelled\n");
    work = [] { return 0; };
}

TEST(CommandLine, AfterTheProgressHasEndedNoLineIsLeftOut)
{
    Terminal terminal;
    work = []() -> int {
        console_progress({})({"Reading points", 0.5});
        end_progress({});
        throw Error(ErrorCode::io, {}, "it broke");
    };
    EXPECT_EQ(run_one(), 1);
    work = [] { return 0; };
    const std::string shown = terminal.text();
    EXPECT_NE(shown.find("\rpcmlab: it broke\r\n"), std::string::npos) << shown;
}

TEST(CommandLine, HelpShowsOptionsTheirGroupsAndDefaults)
{
    const Result help = one({"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_TRUE(help.err.empty());
    for (const char* part :
         {"Every kind of option", "word TEXT REQUIRED", "-t,--threads NUMBER (1 to 8)", "--size NUMBER (0.5 to 10)",
          "Size (default 2)", "Which points:", "--mode fast|even", "--box NUMBER x 2"})
        EXPECT_NE(help.out.find(part), std::string::npos) << part << " is not in\n" << help.out;
    EXPECT_EQ(help.out.find("--hidden"), std::string::npos) << help.out;
    EXPECT_EQ(one({"w", "--hidden"}).code, 0);
}

TEST(CommandLine, HelpLeavesOutWhatFewNeedAndTellsWhereItIs)
{
    const std::string footer = "1 more option: many all --help-all";
    const std::string brief = many({"all", "--help"}).out, whole = many({"all", "--help-all"}).out;
    EXPECT_EQ(brief.find("--rare"), std::string::npos) << brief;
    EXPECT_NE(brief.find("\n\n" + footer), std::string::npos) << brief;
    EXPECT_NE(whole.find("--rare"), std::string::npos) << whole;
    EXPECT_EQ(whole.find("more option"), std::string::npos) << whole;
    for (const std::string& text : {brief, whole}) EXPECT_EQ(text.find("\n\n\n"), std::string::npos) << text;
    EXPECT_EQ(many({"all", "w", "--rare", "2"}).code, 0);
    EXPECT_EQ(given.rare, 2u);
    EXPECT_NE(many({"all", "w", "--rare", "9"}).err.find("--rare"), std::string::npos);
}

TEST(CommandLine, CommandsOfAProgram)
{
    EXPECT_EQ(many({"all", "w"}).code, 0);
    EXPECT_EQ(given.word, "w");
    EXPECT_EQ(many({"other"}).code, 3);
    const Result help = many({"--help"});
    EXPECT_EQ(help.code, 0);
    for (const char* part : {"Many things", "all", "Every kind of option", "other", "Another command"})
        EXPECT_NE(help.out.find(part), std::string::npos) << part;
    const Result of_one = many({"all", "--help"});
    EXPECT_EQ(of_one.code, 0);
    EXPECT_NE(of_one.out.find("Usage: many all"), std::string::npos) << of_one.out;
}

TEST(CommandLine, HelpOfACommandInBothSpellings)
{
    EXPECT_EQ(many({"help", "all"}).out, many({"all", "--help-all"}).out);
    EXPECT_EQ(many({"help", "all"}).code, 0);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"help"}, {"help", "--help"}, {"help", "help"}}) {
        EXPECT_EQ(many(words).out, many({"--help"}).out);
        EXPECT_EQ(many(words).code, 0);
    }
    EXPECT_EQ(many({"help", "nothing"}).code, 2);
}

TEST(CommandLine, WithoutAKnownCommandTheCommandsAreListed)
{
    const std::string list =
        "\n\nCommands:\n  all    Every kind of option\n  other  Another command\n\n"
        "'many help COMMAND' shows the options of a command.\n";
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
        {{}, "many: a command is missing\nMany things"},
        {{""}, "many: there is no command ''"},
        {{"unknown"}, "many: there is no command 'unknown'"},
        {{"ohter", "w"}, "many: there is no command 'ohter'; perhaps other"},
        {{"otter"}, "many: there is no command 'otter'; perhaps other"},
        {{"oth"}, "many: there is no command 'oth'; perhaps other"},
        {{"al"}, "many: there is no command 'al'; perhaps all"},
        {{"help", "ohterr"}, "many: there is no command 'ohterr'"},
    };
    for (const auto& [words, message] : mistakes) {
        const Result result = many(words);
        EXPECT_EQ(result.code, 2) << message;
        EXPECT_EQ(result.err, message + list);
        EXPECT_EQ(result.out, "");
    }
}

TEST(CommandLine, TheVersion)
{
    const Result result = many({"--version"});
    EXPECT_EQ(result.code, 0);
    EXPECT_EQ(result.out, std::string("many ") + PCM_VERSION + "\n");
    EXPECT_EQ(result.err, "");
}

TEST(CommandLine, ACommandHasTheWordsForAProgramThatItStarts)
{
    const std::vector<std::string> words{"all", "w", "--mode", "even", "-m", "2K", "--", "--names"};
    EXPECT_EQ(many(words).code, 0);
    EXPECT_EQ(given.words, words);
}

}  // namespace
}  // namespace pcm::cli
