#include "plugin/filter/result_parameters.h"

#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "plugin/filter/parameters.h"
#include "plugin/scene/text.h"

#include <QRegularExpression>

namespace pcm::host {

namespace {

Error bad_parameter(const std::string& what) { return Error(ErrorCode::invalid_argument, {}, what); }

}  // namespace

double decimal_of(const RichParameterList& parameters, const char* name)
{
    // The fewest digits that read back as the float are what was typed; nine always do.
    const float value = parameters.getFloat(name);
    for (int digits = 1; digits < 9; ++digits)
        if (const QString text = QString::number(static_cast<double>(value), 'g', digits); text.toFloat() == value)
            return text.toDouble();
    return static_cast<double>(value);
}

std::optional<std::vector<double>> numbers_of(const RichParameterList& parameters, const char* name, const char* label,
                                              std::size_t count)
{
    static const QRegularExpression separators("[\\s,;]+");
    const QStringList words = parameters.getString(name).split(separators, Qt::SkipEmptyParts);
    if (words.isEmpty()) return std::nullopt;
    std::vector<double> numbers;
    for (const QString& word : words) {
        bool good = false;
        numbers.push_back(word.toDouble(&good));
        if (!good) throw bad_parameter(std::string(label) + ": '" + word.toStdString() + "' is not a number");
    }
    if (numbers.size() != count)
        throw bad_parameter(std::string(label) + " has " + std::to_string(numbers.size()) + " numbers; it takes " +
                            std::to_string(count));
    return numbers;
}

std::vector<std::string> names_of(const RichParameterList& parameters, const char* name)
{
    static const QRegularExpression separators("[,;]");
    std::vector<std::string> names;
    for (const QString& part : parameters.getString(name).split(separators, Qt::SkipEmptyParts))
        if (!part.trimmed().isEmpty()) names.push_back(part.trimmed().toStdString());
    return names;
}

}  // namespace pcm::host
