#include "pcm/cli/usage.h"

#include "pcm/cli/common.h"
#include "pcm/cli/completion.h"
#include "pcm/ops/operation.h"

#include <algorithm>

namespace pcm::cli {
namespace {

const Command& command_of(const std::string& name, const std::vector<Command>& commands)
{
    const auto found =
        std::find_if(commands.begin(), commands.end(), [&](const Command& command) { return command.name == name; });
    if (found == commands.end()) throw UsageError("there is no command '" + name + "'");
    return *found;
}

// Every command is a row of the table.
const ops::Row& row_of(const Command& command) { return *ops::find_operation(command.name); }

// Text of a manual page: without HTML, and with the characters escaped that roff interprets.
std::string roff(const std::string& text)
{
    std::string out;
    bool in_tag = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (text.compare(i, 4, "<br>") == 0) out += ' ';
        if (c == '<') in_tag = true;
        if (!in_tag) {
            if (c == '\\' || c == '-') out += '\\';
            if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
            out += c;
        }
        if (c == '>') in_tag = false;
    }
    return out;
}

std::string option_of(const ops::Argument& argument)
{
    if (argument.is_positional()) return "\\fI" + roff(argument.key()) + "\\fR";
    std::string text = argument.letter() ? std::string("\\fB\\-") + argument.letter() + "\\fR, " : "";
    text += "\\fB" + roff("--" + argument.option_name()) + "\\fR";
    if (argument.kind() != ops::ValueKind::flag) text += " \\fI" + roff(ops::name_of(argument.kind())) + "\\fR";
    return text;
}

constexpr const char* exit_status =
    ".SH EXIT STATUS\n0 done; 1 failed, nothing was changed; 2 the command line makes no sense; 3 done, with a "
    "warning; "
    "130 cancelled.\n";

std::string manual_page(const Command& command)
{
    std::string page =
        ".TH " + roff("pcmlab-" + command.name) + " 1 \"\" \"pcmlab " + ops::version() + "\" \"Point clouds\"\n";
    page += ".SH NAME\n" + roff("pcmlab-" + command.name) + " \\- " + roff(command.help) + "\n";
    page += ".SH SYNOPSIS\n\\fBpcmlab " + roff(command.name) + "\\fR [\\fIoptions\\fR]";
    const ops::Row& row = row_of(command);
    const auto operation = row.make();
    const auto& arguments = operation->arguments().list();
    for (const ops::Argument& argument : arguments)
        if (argument.is_positional()) page += " " + option_of(argument);
    page += "\n.SH DESCRIPTION\n" + roff(ops::description_of(row)) + "\n.SH OPTIONS\n";
    for (const ops::Argument& argument : arguments) {
        if (!argument.is_in(ops::Face::command) || !argument.is_shown()) continue;
        page += ".TP\n" + option_of(argument) + "\n" + roff(argument.command_help()) + ".\n";
    }
    page +=
        ".TP\n\\fB\\-\\-json\\fR\nPrint one JSON object instead of text.\n.TP\n\\fB\\-q\\fR, \\fB\\-\\-quiet\\fR\nShow "
        "no "
        "progress.\n.SH JSON\n";
    for (const std::vector<ops::ResultKey>& keys : {row.results, ops::head_keys()})
        for (const ops::ResultKey& key : keys)
            page += ".TP\n\\fB" + roff(key.key) + "\\fR (" + roff(key.type) + (*key.unit ? ", " + roff(key.unit) : "") +
                    ")\n" + roff(key.help) + ".\n";
    return page + exit_status;
}

// The page of the program itself, which leads to those of its commands.
std::string manual_page_of_all(const std::vector<Command>& commands)
{
    std::string page =
        std::string(".TH pcmlab 1 \"\" \"pcmlab ") + ops::version() +
        "\" \"Point clouds\"\n.SH NAME\npcmlab \\- point clouds larger than memory\n"
        ".SH SYNOPSIS\n\\fBpcmlab\\fR \\fIcommand\\fR [\\fIoptions\\fR]\n.SH DESCRIPTION\n"
        "Builds trees of levels of detail from files of points, and works on all points of a tree in bounded "
        "memory.\n.SH COMMANDS\n";
    for (const Command& command : commands)
        page += ".TP\n\\fB" + roff("pcmlab-" + command.name) + "\\fR(1)\n" + roff(command.help) + ".\n";
    return page +
           ".TP\n\\fBpcmlab help\\fR [\\fIcommand\\fR]\nList the commands, or the options of one.\n"
           ".TP\n\\fBpcmlab manual\\fR\nOpen the manual.\n.TP\n\\fBpcmlab \\-\\-version\\fR\nPrint the version.\n" +
           exit_status;
}

}  // namespace

std::optional<std::string> usage_text(const std::vector<std::string>& words, const std::vector<Command>& commands)
{
    if (words.size() < 2 || words[0] != "help") return std::nullopt;
    const std::string third = words.size() > 2 ? words[2] : "";
    if (words[1] == "--man")
        return third.empty() ? manual_page_of_all(commands) : manual_page(command_of(third, commands));
    if (words[1] == "--completion") return completion_for(third, commands);
    if (words[1] != "--json") return std::nullopt;
    if (!third.empty()) return text_of(ops::usage_of(row_of(command_of(third, commands))));
    Json all{{"version", ops::version()}, {"commands", Json::array()}};
    for (const Command& command : commands) all["commands"].push_back(ops::usage_of(row_of(command)));
    return text_of(all);
}

}  // namespace pcm::cli
