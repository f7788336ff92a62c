#include "plugin/scene/measure_text.h"

#include "plugin/scene/tidy_numbers.h"

#include <QStringList>

namespace pcm::host {

QString text_of(const Measure& measure, const std::string& unit)
{
    QString text = QString::fromStdString(measure.name) + "\n";
    for (const MeasureValue& value : values_of(measure))
        text += QString::fromStdString(value.name + "\t" + text_of(value, unit)) + "\n";
    for (std::size_t i = 0; i < measure.points.size(); ++i)
        text += QString("point %1\t%2\n").arg(i + 1).arg(coordinates_of(measure.points[i]));
    return text;
}

QString coordinates_of(const MeasuredPoint& point)
{
    QStringList texts;
    for (const double value : point.position) texts << on_grid_text(value, point.grid_step);
    return texts.join(' ');
}

QString value_of(const Measure& measure, const std::string& unit)
{
    if (measure.kind == MeasureKind::point && measure.points.size() == 1) return coordinates_of(measure.points.front());
    return QString::fromStdString(label_of(measure, unit));
}

}  // namespace pcm::host
