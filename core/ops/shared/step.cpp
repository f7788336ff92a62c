#include "pcm/ops/shared/step.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace pcm::ops {
namespace {

// The chain decides these itself.
bool is_of_the_chain(const Argument& argument)
{
    for (const char* const key : {"input", "tree", "output", "in_place", "overwrite"})
        if (argument.key() == key) return true;
    return !argument.is_in(Face::command);
}

std::string as_key(std::string name)
{
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

bool is_name(const std::string& word)
{
    const auto belongs = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    };
    return !word.empty() && word[0] >= 'a' && std::all_of(word.begin(), word.end(), belongs);
}

std::vector<std::string> words_between_commas(const std::string& text)
{
    std::vector<std::string> words;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        words.push_back(text.substr(at, comma - at));
        at = comma + 1;
    }
    return words;
}

bool is_written(ValueKind kind)  // a text, which may have commas in it
{
    return kind == ValueKind::text || kind == ValueKind::texts || kind == ValueKind::file;
}

class StepReader {
public:
    StepReader(const Row& row, Operation& operation) : row_(row), arguments_(operation.arguments()) {}

    void read(const std::string& values)
    {
        for (const std::string& word : words_between_commas(values)) read_word(word);
        finish();
        for (const Argument& argument : arguments_.list())
            if (argument.is_required() && !argument.is_given() && !is_of_the_chain(argument))
                throw ArgumentError(argument.key() + " is needed");
    }

private:
    void read_word(const std::string& word)
    {
        if (word.empty()) throw ArgumentError("a value is missing: it takes " + takes());
        const std::size_t equals = word.find('=');
        if (equals != std::string::npos) {
            if (Argument* const named = find(word.substr(0, equals))) {
                open(*named, word.substr(equals + 1));
                is_named_ = true;
                return;
            }
        } else if (set_flag(word)) {
            return;
        }
        if (takes_more(word)) return;
        if (is_named_ || next_ == row_.step.size() || !is_value_of(*arguments_.find(row_.step[next_]), word))
            refuse(word);
        open(*arguments_.find(row_.step[next_++]), word);
    }

    void open(Argument& argument, const std::string& word)
    {
        finish();
        if (argument.is_given() && !argument.is_list()) throw ArgumentError(argument.key() + " is given twice");
        if (argument.kind() == ValueKind::flag) throw ArgumentError(argument.key() + " takes no value");
        argument_ = &argument;
        words_ = {word};
    }

    void finish()
    {
        if (!argument_) return;
        for (std::string& word : words_)
            if (const std::string fault = argument_->fault(word); !fault.empty())
                throw ArgumentError(argument_->key() + ": " + fault);
        argument_->set(words_, argument_->key());
        argument_ = nullptr;
    }

    // What follows a value and is not the beginning of another one belongs to it, where it is a list or a text.
    bool takes_more(const std::string& word)
    {
        if (!argument_) return false;
        const ValueKind kind = argument_->kind();
        if (kind == ValueKind::numbers || kind == ValueKind::words) {
            if (argument_->count() > 0 && words_.size() == argument_->count()) return false;
            words_.push_back(word);
            return true;
        }
        if (!is_written(kind) || (!is_named_ && next_ < row_.step.size())) return false;
        words_.back() += "," + word;
        return true;
    }

    static bool is_value_of(const Argument& argument, const std::string& word)
    {
        return is_written(argument.kind()) || word.find('=') == std::string::npos;
    }

    bool set_flag(const std::string& word)
    {
        for (Argument& argument : arguments_.list()) {
            if (argument.kind() != ValueKind::flag || is_of_the_chain(argument)) continue;
            const bool on = argument.key() == as_key(word);
            if (!on && !(argument.is_switched_off() && argument.option_name() == word)) continue;
            finish();
            argument.set(on);
            is_named_ = true;
            return true;
        }
        return false;
    }

    Argument* find(const std::string& name)
    {
        Argument* const argument = arguments_.find(as_key(name));
        return argument && !is_of_the_chain(*argument) ? argument : nullptr;
    }

    std::string takes() const { return step_arguments(row_) + ", then NAME=VALUE"; }

    [[noreturn]] void refuse(const std::string& word) const
    {
        const std::size_t equals = word.find('=');
        const std::string name = word.substr(0, equals);
        if ((equals != std::string::npos || next_ == row_.step.size()) && is_name(name)) {
            std::vector<std::string> names;
            for (const Argument& argument : arguments_.list())
                if (!is_of_the_chain(argument)) names.push_back(argument.key());
            throw ArgumentError("it has no argument '" + name + "'" + perhaps(name, names));
        }
        throw ArgumentError("'" + word + "' is one value too many: it takes " + takes());
    }

    const Row& row_;
    Arguments& arguments_;
    Argument* argument_ = nullptr;    // the one that is being read
    std::vector<std::string> words_;  // its values
    std::size_t next_ = 0;            // in row_.step
    bool is_named_ = false;           // a name has been given: values without one have an end
};

}  // namespace

void set_step(const Row& row, Operation& operation, const std::string& values)
{
    StepReader(row, operation).read(values);
}

std::string step_arguments(const Row& row)
{
    std::string text;
    for (const std::string& key : row.step) text += (text.empty() ? "" : ",") + key;
    return text;
}

Argument& input_of_step(Operation& operation)
{
    Arguments& arguments = operation.arguments();
    Argument* const input = arguments.find("input");
    return input ? *input : *arguments.find("tree");
}

Argument* output_of_step(Operation& operation) { return operation.arguments().find("output"); }

bool writes_new_cloud(Operation& operation)
{
    const Argument* const output = output_of_step(operation);
    return output && (input_of_step(operation).kind() == ValueKind::cloud || output->is_required());
}

}  // namespace pcm::ops
