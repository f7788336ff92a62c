// The range of a colour ramp, changed with the mouse on its legend: the upper half of the bar drags the upper end, the
// lower half the lower one; a double click asks for numbers; a right click takes the automatic range again.
#pragma once

#include "plugin/overlay/legend.h"

#include <QPoint>

#include <optional>

class QMouseEvent;
class QWidget;

namespace pcm::host {

// The range that dragging makes of `range`: the end that was taken at `from` is at the value at `to`, heights in the
// bar from 0 (its top) to 1; beyond these the range widens evenly. Rounded to a few digits of its width; the ends keep
// a hundredth of `range` between them.
ValueRange dragged_range(const ValueRange& range, double from, double to);

class LegendEdit {
public:
    struct Change {
        QString range;  // LOW:HIGH; empty: automatic
    };
    // What the event does to the range, if it is for the legend's bar; `taken` is set to whether it is. `bars`: those
    // of the legends that are drawn. A double click shows a dialog of `window`.
    std::optional<Change> take(const QMouseEvent& event, const std::vector<LegendPicture::Bar>& bars, QWidget* window,
                               bool& taken);

private:
    struct Drag {
        LegendPicture::Bar bar;
        QPoint from;
    };
    std::optional<Drag> drag_;
    bool pressed_ = false;  // another button, or the second click
};

}  // namespace pcm::host
