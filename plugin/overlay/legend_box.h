// The legends of a view, in its upper right corner, and clicks on them.
#pragma once

#include "plugin/overlay/legend.h"

#include <QPoint>
#include <QSize>

#include <optional>
#include <vector>

namespace pcm::host {

class LegendBox {
public:
    // Draws the legends into the current framebuffer of a compatibility context, over what is there; depth is not
    // written. `view` is the view's size in Qt's pixels, `ratio` of which are one of them on the screen. Leaves the GL
    // state as it was. None: nothing is drawn. `corner`: place of the framebuffer in the picture, pixels of the screen.
    void draw(const std::vector<LayerLegend>& legends, const QSize& view, double ratio, const QPoint& corner = {});

    // The class whose row is at this place of the view.
    std::optional<unsigned> class_at(const QPoint& place) const;
    // The bars of the ramps, in the view's pixels.
    std::vector<LegendPicture::Bar> bars() const;

private:
    LegendPicture picture_;
    QPoint corner_;  // the box's, Qt's pixels
};

}  // namespace pcm::host
