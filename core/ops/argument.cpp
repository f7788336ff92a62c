#include "pcm/ops/argument.h"

#include "pcm/cloud/vector.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <type_traits>

namespace pcm::ops {
namespace {

template <class T>
struct ValueOf {
    using type = T;
};
template <class T>
struct ValueOf<std::optional<T>> {
    using type = T;
};

ValueKind kind_of(const Variable& variable)
{
    return std::visit(
        [](const auto& v) {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, ChoiceVariable>) {
                return ValueKind::choice;
            } else {
                using V = typename ValueOf<std::remove_pointer_t<T>>::type;
                if constexpr (std::is_same_v<V, bool>)
                    return ValueKind::flag;
                else if constexpr (std::is_same_v<V, std::string>)
                    return ValueKind::text;
                else if constexpr (std::is_same_v<V, std::vector<std::string>>)
                    return ValueKind::words;
                else if constexpr (std::is_same_v<V, std::vector<double>>)
                    return ValueKind::numbers;
                else if constexpr (std::is_same_v<V, std::vector<Step>>)
                    return ValueKind::step;
                else if constexpr (std::is_floating_point_v<V>)
                    return ValueKind::real;
                else
                    return ValueKind::whole;
            }
        },
        variable);
}

double number_of(const std::string& word)
{
    const std::size_t sign = !word.empty() && word[0] == '+';
    double value = 0;
    std::from_chars(word.data() + sign, word.data() + word.size(), value);
    return value;
}

std::uint64_t whole_of(const std::string& word)
{
    std::uint64_t value = 0;
    std::from_chars(word.data(), word.data() + word.size(), value);
    return value;
}

// A word may hold several numbers: "1 2 3".
std::vector<std::string> numbers_in(const std::string& word)
{
    std::vector<std::string> numbers;
    for (std::size_t at = 0; at <= word.size();) {
        const std::size_t end = std::min(word.find_first_of(" ,", at), word.size());
        if (end > at) numbers.push_back(word.substr(at, end - at));
        at = end + 1;
    }
    if (numbers.empty()) numbers.push_back(word);
    return numbers;
}

// The shortest decimal number that is this float: 0.1, not 0.1000000015.
std::string text_of_float(float value)
{
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string text_of_bytes(std::uint64_t bytes)
{
    static constexpr const char* units[] = {"", "K", "M", "G", "T"};
    std::size_t unit = 0;
    while (unit < 4 && bytes >= 1024 && bytes % 1024 == 0) bytes /= 1024, ++unit;
    return std::to_string(bytes) + units[unit];
}

}  // namespace

const char* name_of(ValueKind kind)
{
    static constexpr const char* names[] = {"flag",        "whole", "real",    "bytes",  "text",   "choice",
                                            "words",       "texts", "numbers", "file",   "output", "outputs",
                                            "output_tree", "tree",  "trees",   "inputs", "cloud",  "step"};
    return names[static_cast<std::size_t>(kind)];
}

Argument::Argument(std::string key, Variable variable)
    : key_(std::move(key)), kind_(kind_of(variable)), variable_(std::move(variable))
{
    if (bool* const* flag = std::get_if<bool*>(&variable_)) default_on_ = **flag;
    allowed_.whole = kind_ == ValueKind::whole;
    label_ = key_;
    std::replace(label_.begin(), label_.end(), '_', ' ');
    if (!label_.empty()) label_[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label_[0])));
}

Argument& Argument::letter(char letter) { return letter_ = letter, *this; }
Argument& Argument::label(const std::string& label) { return label_ = label, *this; }
Argument& Argument::help(const std::string& help) { return help_ = help, *this; }
Argument& Argument::unit(const std::string& unit) { return unit_ = unit, *this; }
Argument& Argument::group(const std::string& heading) { return group_ = heading, *this; }
Argument& Argument::script(const std::string& name) { return script_ = name, *this; }
Argument& Argument::without(const std::string& meaning) { return without_ = meaning, *this; }
Argument& Argument::automatic(const std::string& meaning) { return automatic_ = true, without(meaning); }
Argument& Argument::as(ValueKind kind)
{
    allowed_.whole = kind == ValueKind::whole;
    return kind_ = kind, *this;
}
Argument& Argument::positional() { return positional_ = true, *this; }
Argument& Argument::required() { return required_ = true, *this; }
Argument& Argument::advanced() { return advanced_ = true, *this; }
Argument& Argument::positive() { return allowed_.least = 0, allowed_.above_least = true, *this; }
Argument& Argument::not_negative() { return allowed_.least = 0, *this; }
Argument& Argument::only(Face face) { return only_ = face, *this; }
Argument& Argument::shown(bool shown) { return shown_ = shown, *this; }
Argument& Argument::on_in_dialogs() { return in_dialogs("on"); }
Argument& Argument::in_dialogs(const std::string& value) { return dialog_default_ = value, *this; }
Argument& Argument::spacing_in_dialogs() { return spacing_in_dialogs_ = true, *this; }
Argument& Argument::text_in_dialogs() { return text_in_dialogs_ = true, *this; }
Argument& Argument::also(const std::string& option) { return also_ = option, *this; }
Argument& Argument::off_option(const std::string& option, const std::string& help)
{
    return off_option_ = option, off_help_ = help, *this;
}
Argument& Argument::count(std::size_t numbers) { return count(numbers, numbers); }
Argument& Argument::count(std::size_t least, std::size_t most)
{
    return least_count_ = least, most_count_ = most, *this;
}
Argument& Argument::points(std::size_t dimensions, std::size_t least, std::size_t most)
{
    return dimensions_ = dimensions, count(dimensions * least, dimensions * most);
}
Argument& Argument::one_of(std::vector<Choice> choices) { return choices_ = std::move(choices), *this; }

Argument& Argument::between(double least, double most)
{
    allowed_.least = least;
    allowed_.most = most;
    return *this;
}

Argument& Argument::degrees()
{
    scale_ = pi / 180;
    unit_ = "degrees";
    return *this;
}

bool Argument::is_list() const
{
    switch (kind_) {
        case ValueKind::words:
        case ValueKind::texts:
        case ValueKind::outputs:
        case ValueKind::trees:
        case ValueKind::inputs:
        case ValueKind::cloud:
        case ValueKind::step:
            return true;
        default:
            return false;
    }
}

bool Argument::is_optional() const
{
    if (required_ || kind_ == ValueKind::flag || kind_ == ValueKind::choice) return false;
    if (automatic_) return true;
    return std::visit(
        [](const auto& v) {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, ChoiceVariable>)
                return false;
            else
                return !std::is_arithmetic_v<std::remove_pointer_t<T>>;
        },
        variable_);
}

std::string Argument::option_name() const
{
    std::string name = key_;
    std::replace(name.begin(), name.end(), '_', '-');
    if (!is_switched_off()) return name;
    return off_option_.empty() ? "no-" + name : off_option_;
}

std::string Argument::option_names() const
{
    if (positional_ && !letter_) return key_;
    return (letter_ ? std::string("-") + letter_ + "," : "") + "--" + option_name() +
           (also_.empty() ? "" : ",--" + also_) + (positional_ ? "," + key_ : "");
}

std::string Argument::script_name() const
{
    if (!script_.empty()) return script_;
    std::string name;
    bool begins = true;
    for (const char c : key_) {
        if (c != '_') name += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        begins = c == '_';
    }
    return name;
}

std::string Argument::default_text() const
{
    if (automatic_) return "";
    return std::visit(
        [&](const auto& v) -> std::string {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, ChoiceVariable>)
                return choices_.at(v.get()).name;
            else if constexpr (std::is_same_v<T, bool*>)
                return default_on_ ? "on" : "off";
            else if constexpr (std::is_same_v<T, float*>)
                return text_of_float(static_cast<float>(*v / scale_));
            else if constexpr (std::is_same_v<T, double*>)
                return short_text(*v / scale_);
            else if constexpr (std::is_same_v<T, std::uint64_t*> || std::is_same_v<T, std::uint32_t*>)
                return kind_ == ValueKind::bytes ? text_of_bytes(*v) : std::to_string(*v);
            else if constexpr (std::is_same_v<T, std::string*>)
                return *v;
            else if constexpr (std::is_same_v<T, std::vector<double>*>) {
                std::string text;
                for (const double value : *v) text += (text.empty() ? "" : " ") + short_text(value / scale_);
                return text;
            } else
                return "";
        },
        variable_);
}

std::string Argument::command_help() const
{
    if (is_switched_off() && !off_help_.empty()) return off_help_;
    if (kind_ == ValueKind::flag) return default_on_ ? "Leave out: " + help_ : help_;
    const std::string value = default_text();
    std::string aside = unit_;
    if (!required_ && !without_.empty())
        aside += (aside.empty() ? "default: " : "; default: ") + without_;
    else if (!required_ && !value.empty())
        aside += (aside.empty() ? "default " : "; default ") + value;
    return aside.empty() ? help_ : help_ + " (" + aside + ")";
}

std::string Argument::fault(std::string& word) const
{
    switch (kind_) {
        case ValueKind::bytes:
            return bytes_fault(word);
        case ValueKind::real:
            return number_fault(word, allowed_);
        case ValueKind::numbers:
            for (const std::string& number : numbers_in(word))
                if (std::string out = number_fault(number, allowed_); !out.empty()) return out;
            return "";
        case ValueKind::whole: {
            const std::uint64_t most = std::visit(
                [](const auto& v) -> std::uint64_t {
                    using T = std::decay_t<decltype(v)>;
                    if constexpr (std::is_pointer_v<T>) {
                        using V = typename ValueOf<std::remove_pointer_t<T>>::type;
                        if constexpr (std::is_integral_v<V>) return std::numeric_limits<V>::max();
                    }
                    return std::numeric_limits<std::uint64_t>::max();
                },
                variable_);
            if (allowed_.least || allowed_.most)
                if (std::string out = number_fault(word, allowed_); !out.empty()) return out;
            return allowed_.least && *allowed_.least < 0 ? "" : whole_fault(word, most);
        }
        default:
            break;
    }
    if (choices_.empty()) return "";
    std::vector<std::string> names;
    for (const Choice& choice : choices_) names.push_back(choice.name);
    return choice_fault(word, names);
}

std::uint64_t Argument::whole() const
{
    const auto* const narrow = std::get_if<std::uint32_t*>(&variable_);
    return narrow ? **narrow : *std::get<std::uint64_t*>(variable_);
}

void Argument::set(bool on)
{
    given_ = on != default_on_;
    **std::get_if<bool*>(&variable_) = on;
}

void Argument::set(const std::vector<std::string>& words, const std::string& name)
{
    if (words.empty() && required_) throw ArgumentError(name + " is needed");
    if (words.empty()) return;
    std::vector<std::string> checked;
    for (const std::string& word : words) {
        const std::vector<std::string> parts =
            kind_ == ValueKind::numbers ? numbers_in(word) : std::vector<std::string>{word};
        checked.insert(checked.end(), parts.begin(), parts.end());
    }
    for (std::string& word : checked)
        if (const std::string what = fault(word); !what.empty()) throw ArgumentError(name + ": " + what);
    if (const std::string what = count_fault(checked.size()); !what.empty()) throw ArgumentError(name + what);
    if (!is_list() && kind_ != ValueKind::numbers && words.size() > 1) throw ArgumentError(name + " takes one value");
    given_ = true;
    write(checked);
}

std::string Argument::count_fault(std::size_t numbers) const
{
    const bool few = numbers<least_count_, many = most_count_> 0 && numbers > most_count_;
    if (dimensions_ == 0) {
        if (!few && !many) return {};
        return " takes " + std::to_string(least_count_) +
               (most_count_ > least_count_ ? " to " + std::to_string(most_count_) : "") + " numbers, and got " +
               std::to_string(numbers);
    }
    if (!few && !many && numbers % dimensions_ == 0) return {};
    const std::size_t least = least_count_ / dimensions_;
    const std::string points = many        ? "at most " + std::to_string(most_count_ / dimensions_) + " points"
                               : least > 1 ? "at least " + std::to_string(least) + " points"
                                           : "each point";
    return std::string(" takes ") + (dimensions_ == 2 ? "x y" : "x y z") + " of " + points + ", not " +
           std::to_string(numbers) + " numbers";
}

void Argument::write(const std::vector<std::string>& words)
{
    std::visit(
        [&](const auto& v) {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, ChoiceVariable>) {
                const auto named = [&](const Choice& choice) { return choice.name == words[0]; };
                v.set(
                    static_cast<std::size_t>(std::find_if(choices_.begin(), choices_.end(), named) - choices_.begin()));
            } else {
                using V = typename ValueOf<std::remove_pointer_t<T>>::type;
                if constexpr (std::is_same_v<V, bool>)
                    *v = words[0] == "on" || words[0] == "true";
                else if constexpr (std::is_same_v<V, std::string>)
                    *v = words[0];
                else if constexpr (std::is_same_v<V, std::vector<std::string>>)
                    *v = words;
                else if constexpr (std::is_same_v<V, std::vector<double>>) {
                    v->clear();
                    for (const std::string& word : words) v->push_back(number_of(word) * scale_);
                } else if constexpr (std::is_same_v<V, std::vector<Step>>) {
                    for (const std::string& word : words) v->push_back({key_, word});
                } else if constexpr (std::is_floating_point_v<V>)
                    *v = static_cast<V>(number_of(words[0]) * scale_);
                else
                    *v = static_cast<V>(whole_of(words[0]));
            }
        },
        variable_);
}

Argument* Arguments::find(const std::string& key)
{
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const Argument& a) { return a.key() == key; });
    return found == list_.end() ? nullptr : &*found;
}

const Argument* Arguments::find(const std::string& key) const { return const_cast<Arguments*>(this)->find(key); }

bool Arguments::given(const std::string& key) const
{
    const Argument* const argument = find(key);
    if (!argument) throw std::logic_error("no argument " + key + " is declared");
    return argument->is_given();
}

}  // namespace pcm::ops
