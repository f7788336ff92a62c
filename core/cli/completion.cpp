#include "pcm/cli/completion.h"

#include "pcm/ops/operation.h"

#include <functional>

namespace pcm::cli {
namespace {

// In single quotes, as both shells read them.
std::string quoted(const std::string& text)
{
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

// "word:what it is", as zsh's _describe takes them.
std::string described(const std::string& word, const std::string& what)
{
    std::string text;
    for (const char c : word) text += c == ':' ? std::string("\\:") : std::string(1, c);
    return quoted(text + ":" + what);
}

void for_each_option(const Command& command, const std::function<void(const ops::Argument&)>& visit)
{
    const auto operation = ops::find_operation(command.name)->make();  // every command is a row of the table
    for (const ops::Argument& argument : operation->arguments().list())
        if (argument.is_in(ops::Face::command) && argument.is_shown() &&
            (!argument.is_positional() || argument.letter()))
            visit(argument);
}

// "'outliers --method') BEFORE'statistical robust radius'AFTER ;;", a line for each option that takes one of some
// words.
std::string choice_cases(const std::vector<Command>& commands, const std::string& before, const std::string& after)
{
    std::string cases;
    for (const Command& command : commands)
        for_each_option(command, [&](const ops::Argument& argument) {
            if (argument.choices().empty()) return;
            std::string words;
            for (const ops::Choice& choice : argument.choices()) words += (words.empty() ? "" : " ") + choice.name;
            cases +=
                "        '" + command.name + " --" + argument.option_name() + "') " + before + words + after + " ;;\n";
        });
    return cases;
}

std::string for_bash(const std::vector<Command>& commands)
{
    std::string names, cases;
    for (const Command& command : commands) {
        names += command.name + " ";
        std::string options = "--help --json --quiet";
        for_each_option(command, [&](const ops::Argument& argument) { options += " --" + argument.option_name(); });
        cases += "        " + command.name + ") words='" + options + "' ;;\n";
    }
    return "# Completion of pcmlab, for bash: source it, or put it into bash-completion's folder.\n"
           "_pcmlab() {\n    local word=${COMP_WORDS[COMP_CWORD]} words=''\n"
           "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        COMPREPLY=($(compgen -W '" +
           names + "help manual' -- \"$word\"))\n        return\n    fi\n" +
           "    case \"${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD-1]}\" in\n" + choice_cases(commands, "words='", "'") +
           "    esac\n    if [ -n \"$words\" ]; then\n        COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
           "        return\n    fi\n    case ${COMP_WORDS[1]} in\n" +
           cases + "        help) words='" + names +
           "' ;;\n    esac\n    case $word in\n        -*) COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
           "        *) [ \"${COMP_WORDS[1]}\" != help ] || COMPREPLY=($(compgen -W \"$words\" -- \"$word\")) ;;\n"
           "    esac\n}\ncomplete -o default -F _pcmlab pcmlab\n";
}

std::string for_zsh(const std::vector<Command>& commands)
{
    std::string names, cases;
    for (const Command& command : commands) {
        names += "        " + described(command.name, command.help) + "\n";
        cases += "        " + command.name + ") described=(" + described("--help", "Show the options") + " " +
                 described("--json", "Print one JSON object instead of text") + " " +
                 described("--quiet", "Show no progress");
        for_each_option(command, [&](const ops::Argument& argument) {
            cases += "\n            " + described("--" + argument.option_name(), argument.command_help());
        });
        cases += ") ;;\n";
    }
    return "#compdef pcmlab\n# Completion of pcmlab, for zsh: put it as _pcmlab into a folder of $fpath.\n"
           "_pcmlab() {\n    local -a names described\n    names=(\n" +
           names +
           "    )\n    if (( CURRENT == 2 )); then\n        names+=('help:Show the options of a command' 'manual:Open "
           "the manual')\n"
           "        _describe command names\n        return\n    fi\n"
           "    if [[ $words[2] == help ]]; then\n        _describe command names\n        return\n    fi\n"
           "    case \"$words[2] $words[CURRENT-1]\" in\n" +
           choice_cases(commands, "compadd -- ", "; return") +
           "    esac\n    if [[ $PREFIX != -* ]]; then\n        _files\n        return\n    fi\n    case $words[2] "
           "in\n" +
           cases + "    esac\n    _describe -o option described\n}\n_pcmlab \"$@\"\n";
}

}  // namespace

std::string completion_for(const std::string& shell, const std::vector<Command>& commands)
{
    if (shell == "bash") return for_bash(commands);
    if (shell == "zsh") return for_zsh(commands);
    throw UsageError("there is no completion for '" + shell + "': bash or zsh");
}

}  // namespace pcm::cli
