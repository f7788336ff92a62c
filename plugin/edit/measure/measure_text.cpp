#include "plugin/edit/measure/measure_text.h"

#include "pcm/system/text.h"

#include <QStringList>

#include <cmath>

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
    constexpr double noise = 1e-6;  // of a step
    constexpr int most_decimals = 17;
    QStringList texts;
    for (const double value : point.position) {
        QString text = QString::fromStdString(exact(value));
        for (int decimals = 0; point.grid_step > 0 && decimals < most_decimals; ++decimals) {
            const QString shorter = QString::number(value, 'f', decimals);
            if (!(std::abs(shorter.toDouble() - value) <= noise * point.grid_step)) continue;
            if (shorter.size() < text.size()) text = shorter;
            break;
        }
        texts << text;
    }
    return texts.join(' ');
}

QString value_of(const Measure& measure, const std::string& unit)
{
    if (measure.kind == MeasureKind::point && measure.points.size() == 1) return coordinates_of(measure.points.front());
    return QString::fromStdString(label_of(measure, unit));
}

}  // namespace pcm::host
