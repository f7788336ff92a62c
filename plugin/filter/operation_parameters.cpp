#include "plugin/filter/operation_parameters.h"

#include "pcm/system/text.h"
#include "plugin/filter/filter_paths.h"
#include "plugin/filter/server_script.h"
#include "plugin/scene/text.h"

#include <QRegularExpression>

namespace pcm::host {

namespace {

using ops::Argument;
using ops::ValueKind;

constexpr int megabyte_bits = 20;

// In dialogs: the tree of the current layer, or another.
bool is_tree(const Argument& argument)
{
    return argument.kind() == ValueKind::tree || argument.kind() == ValueKind::cloud;
}

// The number that means none.
int none_value(const Argument& argument)
{
    return argument.kind() == ValueKind::whole && !argument.is_automatic() ? -1 : 0;
}

QString dialog_value(const Argument& argument)
{
    return QString::fromStdString(argument.dialog_default().empty() ? argument.default_text()
                                                                    : argument.dialog_default());
}

// Dialogs ask for an optional number by a number, of which one means none, or by a text, which may be empty.
bool has_none_value(const Argument& argument)
{
    return argument.is_optional() && !argument.is_text_in_dialogs() && argument.dialog_default().empty();
}

QString quoted_default(const Argument& argument)
{
    if (is_tree(argument)) return "Empty, the default: the tree that the current layer shows.";
    if (argument.is_spacing_in_dialogs())
        return "Default: that of the finest level of detail of the current layer's cloud, rounded; " +
               dialog_value(argument) + " where there is none.";
    const QString value = dialog_value(argument);
    if (!argument.without().empty() && value.isEmpty())
        return "Default: " + QString::fromStdString(argument.without()) + ".";
    if ((argument.kind() == ValueKind::output || argument.kind() == ValueKind::output_tree) &&
        argument.without().empty())
        return "A dialog proposes a name; scripts have no default.";
    if (argument.kind() == ValueKind::choice) {
        for (const ops::Choice& choice : argument.choices())
            if (choice.name == argument.default_text() || argument.default_text().empty())
                return "Default " + QString::fromStdString(choice.label).toLower() + ".";
    }
    return value.isEmpty() ? "No default." : "Default " + value + ".";
}

QString tooltip_of(const Argument& argument)
{
    QString text = QString::fromStdString(argument.help());
    if (!argument.unit().empty()) text += ", in " + QString::fromStdString(argument.unit());
    if (argument.kind() == ValueKind::bytes) text += ", in megabytes";
    if (has_none_value(argument) && (argument.kind() == ValueKind::real || argument.kind() == ValueKind::whole))
        text += QString("; %1: %2").arg(none_value(argument)).arg(argument.is_automatic() ? "automatic" : "none");
    if (argument.is_list() && !is_tree(argument)) text += "; several are separated by semicolons";
    if (!text.endsWith('.')) text += ".";
    return text + " " + quoted_default(argument);
}

std::string label_of(const Argument& argument)
{
    if (argument.kind() == ValueKind::bytes) return argument.label() + " (MB)";
    return argument.unit().empty() || argument.unit() == "source units"
               ? argument.label()
               : argument.label() + " (" + argument.unit() + ")";
}

int megabytes_of(const std::string& size)
{
    std::string word = size;
    ops::bytes_fault(word);
    return static_cast<int>(std::stoull(word) >> megabyte_bits);
}

// What an empty field of text means.
QString meaning_of_empty(const Argument& argument)
{
    return is_tree(argument) ? QString("the current layer") : QString::fromStdString(argument.without());
}

void add_parameter(const Argument& argument, Parameters& parameters)
{
    const QString name = QString::fromStdString(argument.script_name()),
                  label = QString::fromStdString(label_of(argument)), tip = tooltip_of(argument),
                  value = dialog_value(argument);
    if (argument.is_text_in_dialogs()) {
        parameters.add({name, value, label, tip, {}, meaning_of_empty(argument)});
        return;
    }
    switch (argument.kind()) {
        case ValueKind::flag:
            parameters.add({name, value == "on", label, tip});
            return;
        case ValueKind::whole:
            parameters.add({name, has_none_value(argument) ? none_value(argument) : value.toInt(), label, tip});
            return;
        case ValueKind::real:
            parameters.add({name,
                            has_none_value(argument) ? 0.0f : value.toFloat(),
                            label,
                            tip,
                            {},
                            {},
                            argument.is_spacing_in_dialogs()});
            return;
        case ValueKind::bytes:
            parameters.add({name, megabytes_of(argument.default_text()), label, tip});
            return;
        case ValueKind::choice: {
            QStringList labels;
            int at = 0;
            for (const ops::Choice& choice : argument.choices()) {
                if (choice.name == value.toStdString()) at = labels.size();
                labels << QString::fromStdString(choice.label);
            }
            parameters.add({name, at, label, tip, labels});
            return;
        }
        default:
            parameters.add({name, value, label, tip, {}, meaning_of_empty(argument)});
    }
}

std::vector<std::string> split(const QString& text, const char* separators)
{
    std::vector<std::string> words;
    for (const QString& part : text.split(QRegularExpression(separators), Qt::SkipEmptyParts))
        if (!part.trimmed().isEmpty()) words.push_back(part.trimmed().toStdString());
    return words;
}

// The words of a field of text.
std::vector<std::string> words_of(const Argument& argument, const QString& text)
{
    switch (argument.kind()) {
        case ValueKind::numbers:
            return split(text, "[\\s,;]+");
        case ValueKind::words:
            return split(text, "[,;]");
        case ValueKind::texts:
            return split(text, ";");
        case ValueKind::inputs:
        case ValueKind::outputs:
        case ValueKind::trees: {
            std::vector<std::string> paths;
            for (const auto& path : split_paths(text)) paths.push_back(path.string());
            return paths;
        }
        case ValueKind::file:
        case ValueKind::output:
            if (text.trimmed().isEmpty()) return {};
            return {absolute_path(text).string()};
        case ValueKind::output_tree:
            if (text.trimmed().isEmpty()) return {};
            return {as_tree(absolute_path(text)).string()};
        default:
            return text.trimmed().isEmpty() ? std::vector<std::string>{} : std::vector<std::string>{text.toStdString()};
    }
}

std::vector<std::string> choice_of(const Argument& argument, int index)
{
    const auto& choices = argument.choices();
    if (index < 0 || static_cast<std::size_t>(index) >= choices.size())
        throw ops::ArgumentError("'" + argument.label() + "' is " + std::to_string(index) + "; it must be 0 to " +
                                 std::to_string(choices.size() - 1));
    return {choices[static_cast<std::size_t>(index)].name};
}

// For scripts of earlier versions, which lack the parameter.
void set_dialog_default(Argument& argument, const std::string& called)
{
    if (argument.dialog_default().empty()) return;
    if (argument.kind() == ValueKind::flag)
        argument.set(true);
    else
        argument.set({argument.dialog_default()}, called);
}

// Scripts may name what dialogs do not show, such as a library that is not installed: choosing it is an error then.
bool is_in_dialogs(const Argument& argument)
{
    return argument.is_in(ops::Face::dialog) && (argument.is_shown() || is_server());
}

void set(Argument& argument, const FilterRun& run)
{
    const Parameters& parameters = run.parameters;
    const QString name = QString::fromStdString(argument.script_name());
    const std::string called = "'" + argument.label() + "'";
    if (is_tree(argument)) {
        argument.set({tree_of(parameters, run.scene).string()}, called);
        return;
    }
    if (!parameters.has(name)) {
        set_dialog_default(argument, called);
        return;
    }
    if (argument.is_text_in_dialogs()) {
        argument.set(words_of(argument, parameters.text(name)), called);
        return;
    }
    switch (argument.kind()) {
        case ValueKind::flag:
            argument.set(parameters.flag(name));
            return;
        case ValueKind::whole: {
            const int value = parameters.whole(name);
            if (has_none_value(argument) && (value == none_value(argument) || (value < 0 && !argument.is_automatic())))
                return;
            argument.set({std::to_string(value)}, called);
            return;
        }
        case ValueKind::real: {
            const double value = decimal_of(parameters.real(name));
            if (value == 0 && has_none_value(argument)) return;
            argument.set({exact(value)}, called);
            return;
        }
        case ValueKind::bytes:
            argument.set({std::to_string(parameters.whole(name)) + "M"}, called);
            return;
        case ValueKind::choice:
            argument.set(choice_of(argument, parameters.whole(name)), called);
            return;
        default:
            argument.set(words_of(argument, parameters.text(name)), called);
    }
}

}  // namespace

void add_parameters(const ops::Arguments& arguments, Parameters& parameters)
{
    for (const bool advanced : {false, true})
        for (const Argument& argument : arguments.list())
            if (is_in_dialogs(argument) && argument.is_advanced() == advanced) add_parameter(argument, parameters);
}

void set_arguments(ops::Arguments& arguments, const FilterRun& run)
{
    std::string missing;
    for (Argument& argument : arguments.list()) {
        if (!is_in_dialogs(argument)) continue;
        set(argument, run);
        if (!run.parameters.has(QString::fromStdString(argument.script_name())))
            missing += (missing.empty() ? "" : ", ") + argument.script_name();
    }
    if (!missing.empty())
        run.log("The script does not have these parameters, which keep their defaults: " + missing + ".");
}

}  // namespace pcm::host
