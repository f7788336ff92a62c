// What the colours of a cloud mean, for people: a bar of the ramp with values, or the names of classes. No OpenGL here.
#pragma once

#include "pcm/cloud/metadata.h"
#include "pcm/gl/renderer.h"

#include <QColor>
#include <QImage>
#include <QRect>
#include <QString>
#include <QStringList>

#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace pcm::host {

struct Legend {
    struct Row {
        unsigned number;  // of the class
        QColor colour;
        QString name;
        bool hidden;  // its points are not shown
    };
    QString title;              // with the unit: "Height (m)"
    QString low, middle, high;  // values at the ramp's beginning, middle and end; empty for classes
    ColourRamp ramp = ColourRamp::viridis;
    std::vector<Row> rows;  // of classes that occur, ascending
    QStringList layers;     // whose colours these are
};

// Of a cloud as it was drawn; nothing for colours without a scale. `hidden`: the classes that the user hides.
std::optional<Legend> legend_of(const CloudReport& report, const std::vector<Metadata>& metadata,
                                const std::set<unsigned>& hidden);

// Adds the legend of a layer. One that says the same as an earlier one is added to that.
void add_legend(std::vector<Legend>& legends, Legend legend, const QString& layer);

// With as many digits as distinguish values of a range of this width.
QString value_text(double value, double width);

// As text, for observers: title, then values or classes.
QStringList lines_of(const Legend& legend);

// The legends one below the other, on a half transparent ground. Those beyond `most_height` are left out. In pixels of
// the screen, `ratio` of which are one of Qt's; the rectangles of classes are in Qt's.
struct LegendPicture {
    QImage image;
    std::vector<std::pair<QRect, unsigned>> classes;
};
LegendPicture draw_legends(const std::vector<Legend>& legends, int most_height, double ratio);

}  // namespace pcm::host
