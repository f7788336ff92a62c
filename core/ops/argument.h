// One argument of an operation: its name, what people read about it, which values it takes, and where its value goes.
//
// An operation declares its arguments once (operation.h). The command line, MeshLab's dialogs and scripts, the usage as
// JSON, man pages and completion are made of them, so that names, defaults and limits cannot differ between them.
#pragma once

#include "pcm/ops/values.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace pcm::ops {

// Arguments that make no sense as given, or together. The command line exits with its code for usage.
class ArgumentError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// What a value is. A face offers an input of this kind.
enum class ValueKind : std::uint8_t {
    flag,
    whole,        // a whole number
    real,         // a number
    bytes,        // a size with a unit: 512M
    text,         //
    choice,       // one of a few names
    words,        // names, any number of them, separated by commas
    texts,        // any number of texts, each after its own option
    numbers,      // some numbers: x y z
    file,         // an existing file
    output,       // a file or folder to write
    outputs,      // files to write, each after its own option
    output_tree,  // a tree to write; dialogs add the extension
    tree,         // a tree folder, or a file in it; in a window the current layer's where it is empty
    trees,        // several of these
    inputs,       // files, folders of files, trees
    cloud,        // the same; in dialogs one tree, the current layer's where it is empty
    step,  // values of another operation in one word, "16,3" (shared/step.h); any number, each after its own option
};
const char* name_of(ValueKind kind);  // "whole"

struct Choice {
    std::string name;   // on the command line: "statistical"
    std::string label;  // in dialogs: "Statistical"
};

// One of a few values of an enumeration, by their place in the list of choices.
struct ChoiceVariable {
    std::function<std::size_t()> get;
    std::function<void(std::size_t)> set;
};

// A step of a chain as it is given: the name of an operation, which is the argument's key, and its values.
struct Step {
    std::string operation, values;
};

// Where an operation is called, which decides the names of arguments in messages.
enum class Face : std::uint8_t { command, dialog };

// Where the value goes. Optional variables are empty where nothing is given. Arguments may share a list of steps, which
// has them in the order in which they are set.
using Variable =
    std::variant<bool*, float*, double*, std::uint32_t*, std::uint64_t*, std::string*, std::vector<std::string>*,
                 std::vector<double>*, std::optional<double>*, std::optional<std::uint16_t>*,
                 std::optional<std::uint32_t>*, std::optional<std::uint64_t>*, std::vector<Step>*, ChoiceVariable>;

class Argument {
public:
    Argument(std::string key, Variable variable);

    // ---- Declaration. Each returns *this.
    Argument& letter(char letter);                  // -k
    Argument& label(const std::string& label);      // in dialogs, where it is not the key in words
    Argument& help(const std::string& help);        // sentences without unit and default, which are added
    Argument& unit(const std::string& unit);        // "source units", "degrees", "s", "%"
    Argument& group(const std::string& heading);    // in the help of the command
    Argument& script(const std::string& name);      // in MeshLab's scripts, where it is not the key in camel case
    Argument& without(const std::string& meaning);  // what happens where nothing is given: "one per processor"
    // The same for a number whose variable is then 0: 0 stands for this meaning, in dialogs too.
    Argument& automatic(const std::string& meaning);
    Argument& as(ValueKind kind);  // file, output or tree for a text; inputs or trees for words
    Argument& positional();        // on the command line: by its place, and with a letter() by its name, too
    Argument& required();
    Argument& advanced();                            // for few: below the others, and in --help-all
    Argument& only(Face face);                       // other faces do not have it
    Argument& shown(bool shown);                     // else it is accepted and in no help or dialog
    Argument& on_in_dialogs();                       // for a flag: the better default where people see the picture
    Argument& in_dialogs(const std::string& value);  // what dialogs begin with, where the command has no default
    Argument& spacing_in_dialogs();  // they begin with the spacing of the cloud's finest level, where it is known
    Argument& text_in_dialogs();     // for an optional number: 0 is a value, empty is none
    Argument& also(const std::string& option);  // another name on the command line, without dashes
    // For a flag that is on: the option that switches it off, where it is not no-KEY, and its help.
    Argument& off_option(const std::string& option, const std::string& help);
    Argument& between(double least, double most);
    Argument& positive();
    Argument& not_negative();
    Argument& count(std::size_t numbers);  // for ValueKind::numbers
    Argument& count(std::size_t least, std::size_t most);
    // ValueKind::numbers only: the coordinates of points, two (in plan) or three of each.
    Argument& points(std::size_t dimensions, std::size_t least, std::size_t most);
    Argument& degrees();                            // the variable holds radians
    Argument& one_of(std::vector<Choice> choices);  // for a text or words

    // ---- What was declared.
    const std::string& key() const { return key_; }
    ValueKind kind() const { return kind_; }
    char letter() const { return letter_; }
    const std::string& label() const { return label_; }
    const std::string& help() const { return help_; }
    const std::string& unit() const { return unit_; }
    const std::string& group() const { return group_; }
    const std::string& without() const { return without_; }
    bool is_automatic() const { return automatic_; }
    bool is_shown() const { return shown_; }
    const std::string& dialog_default() const { return dialog_default_; }  // empty: that of the command line
    bool is_spacing_in_dialogs() const { return spacing_in_dialogs_; }
    bool is_text_in_dialogs() const { return text_in_dialogs_; }
    bool is_positional() const { return positional_; }
    bool is_required() const { return required_; }
    bool is_advanced() const { return advanced_; }
    bool is_in(Face face) const { return !only_ || *only_ == face; }
    bool is_optional() const;  // nothing may be given
    bool is_list() const;      // words, texts, outputs, trees, inputs, cloud, step
    const AllowedNumbers& allowed() const { return allowed_; }
    const std::vector<Choice>& choices() const { return choices_; }
    std::size_t least_count() const { return least_count_; }
    std::size_t count() const { return most_count_; }  // at most; 0: any number

    // A flag that is on by default is switched off on the command line: --no-confidence; its own name is taken too.
    bool is_switched_off() const { return kind_ == ValueKind::flag && default_on_; }
    std::string option_name() const;   // "radius-neighbours", "no-confidence"; without dashes
    std::string option_names() const;  // "-k,--neighbours"
    std::string script_name() const;   // "RadiusNeighbours"
    std::string default_text() const;  // "16", "512M", "off", "statistical"; empty: none
    // The help with unit and default: "Number of neighbours (default 16)".
    std::string command_help() const;

    // ---- Values. Each throws ArgumentError for what is not allowed, naming `name`.
    void set(const std::vector<std::string>& words, const std::string& name);  // empty: nothing is given
    void set(bool on);                                                         // for a flag
    // Why a word is not a value of this argument, or empty; a word may be rewritten ("1e3" as "1000").
    std::string fault(std::string& word) const;
    bool is_given() const { return given_; }
    // What is given, else the default: of a text, and of a whole number. Throws std::bad_variant_access for others.
    const std::string& text() const { return *std::get<std::string*>(variable_); }
    std::uint64_t whole() const;

private:
    std::string count_fault(std::size_t numbers) const;
    void write(const std::vector<std::string>& words);

    std::string key_, label_, help_, unit_, group_, script_, without_, dialog_default_, also_, off_option_, off_help_;
    char letter_ = 0;
    ValueKind kind_;
    bool positional_ = false, required_ = false, advanced_ = false, shown_ = true, text_in_dialogs_ = false,
         spacing_in_dialogs_ = false, given_ = false, default_on_ = false, automatic_ = false;
    std::optional<Face> only_;
    AllowedNumbers allowed_;
    std::vector<Choice> choices_;
    std::size_t least_count_ = 0, most_count_ = 0, dimensions_ = 0;
    double scale_ = 1;  // variable = value * scale
    Variable variable_;
};

// The arguments of one operation, in the order of help and dialogs. References stay valid.
class Arguments {
public:
    template <class T>
    Argument& add(const std::string& key, T& variable)
    {
        return list_.emplace_back(key, Variable(&variable));
    }
    // An enumeration whose values are those of `choices`, from 0 on.
    template <class Enum>
    Argument& choice(const std::string& key, Enum& variable, std::vector<Choice> choices)
    {
        return list_
            .emplace_back(key, ChoiceVariable{[&variable] { return static_cast<std::size_t>(variable); },
                                              [&variable](std::size_t i) { variable = static_cast<Enum>(i); }})
            .one_of(std::move(choices));
    }

    std::deque<Argument>& list() { return list_; }
    const std::deque<Argument>& list() const { return list_; }
    Argument* find(const std::string& key);
    const Argument* find(const std::string& key) const;
    bool given(const std::string& key) const;  // Throws std::logic_error for an argument that is not declared

private:
    std::deque<Argument> list_;
};

}  // namespace pcm::ops
