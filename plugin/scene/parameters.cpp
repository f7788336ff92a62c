#include "plugin/scene/parameters.h"

#include "pcm/system/error.h"

#include <algorithm>

namespace pcm::host {

namespace {

[[noreturn]] void refuse(const QString& name, const char* what)
{
    throw Error(ErrorCode::invalid_argument, {}, "the parameter '" + name.toStdString() + "' " + what);
}

}  // namespace

const Parameter* Parameters::find(const QString& name) const
{
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const Parameter& p) { return p.name == name; });
    return found == list_.end() ? nullptr : &*found;
}

const QVariant& Parameters::value_of(const QString& name, QMetaType::Type type) const
{
    const Parameter* const parameter = find(name);
    if (!parameter) refuse(name, "is missing");
    if (parameter->value.userType() != type) refuse(name, "has a value of another type than it takes");
    return parameter->value;
}

bool Parameters::flag(const QString& name) const { return value_of(name, QMetaType::Bool).toBool(); }
int Parameters::whole(const QString& name) const { return value_of(name, QMetaType::Int).toInt(); }
float Parameters::real(const QString& name) const { return value_of(name, QMetaType::Float).toFloat(); }
QString Parameters::text(const QString& name) const { return value_of(name, QMetaType::QString).toString(); }
QColor Parameters::colour(const QString& name) const { return value_of(name, QMetaType::QColor).value<QColor>(); }

void Parameters::set(const QString& name, const QVariant& value)
{
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const Parameter& p) { return p.name == name; });
    if (found == list_.end()) refuse(name, "is missing");
    found->value = value;
}

double decimal_of(float value)
{
    // The fewest digits that read back as the float are what was typed; nine always do.
    for (int digits = 1; digits < 9; ++digits)
        if (const QString text = QString::number(static_cast<double>(value), 'g', digits); text.toFloat() == value)
            return text.toDouble();
    return static_cast<double>(value);
}

}  // namespace pcm::host
