// The legends of the layers of a view, as a picture. No OpenGL here.
#pragma once

#include "pcm/gl/draw/legend.h"

#include <QImage>
#include <QRect>
#include <QString>
#include <QStringList>

#include <utility>
#include <vector>

namespace pcm::host {

struct LayerLegend {
    Legend legend;
    QStringList layers;  // layers with these colours
};

// Adds the legend of a layer. One that says the same as an earlier one is added to that.
void add_legend(std::vector<LayerLegend>& legends, Legend legend, const QString& layer);

// As text, for observers.
QStringList lines_of(const std::vector<LayerLegend>& legends);

// The legends one below the other, on a half transparent ground. Those beyond `most_height` are left out. In pixels of
// the screen, `ratio` of which are one of Qt's; the rectangles of classes and of ramps are in Qt's.
struct LegendPicture {
    struct Bar {
        QRect place;  // with the values next to it
        ValueRange range;
    };
    QImage image;
    std::vector<std::pair<QRect, unsigned>> classes;
    std::vector<Bar> bars;
};
LegendPicture draw_legends(const std::vector<LayerLegend>& legends, int most_height, double ratio);

}  // namespace pcm::host
