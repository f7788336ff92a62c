#include "plugin/filter/result_parameters.h"

namespace pcm::host {

double decimal_of(const RichParameterList& parameters, const char* name)
{
    // The fewest digits that read back as the float are what was typed; nine always do.
    const float value = parameters.getFloat(name);
    for (int digits = 1; digits < 9; ++digits)
        if (const QString text = QString::number(static_cast<double>(value), 'g', digits); text.toFloat() == value)
            return text.toDouble();
    return static_cast<double>(value);
}

}  // namespace pcm::host
