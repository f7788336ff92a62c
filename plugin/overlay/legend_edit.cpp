#include "plugin/overlay/legend_edit.h"

#include <QInputDialog>
#include <QMouseEvent>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcm::host {

namespace {

constexpr double digits_of_width = 500;  // a value is rounded to about this part of the range
constexpr double least_width = 0.01;

double value_at(const ValueRange& range, double height)
{
    const double place = 1 - height;
    if (place >= 0 && place <= 1) return range.value_at(place);
    return range.low + place * (range.high - range.low);
}

double rounded(double value, double width)
{
    const double step = std::pow(10, std::floor(std::log10(width / digits_of_width)));
    return std::round(value / step) * step;
}

QString text_of(const ValueRange& range)
{
    // 12 digits: those of the rounded numbers, and not those of their binary form.
    return QString::number(range.low, 'g', 12) + ":" + QString::number(range.high, 'g', 12);
}

double height_of(const LegendPicture::Bar& bar, const QPoint& place)
{
    return double(place.y() - bar.place.top()) / std::max(1, bar.place.height());
}

}  // namespace

ValueRange dragged_range(const ValueRange& range, double from, double to)
{
    const double width = range.high - range.low;
    ValueRange changed = range;
    const bool is_upper = from < 0.5;
    const double value = value_at(range, is_upper ? to - from : 1 + to - from);
    if (is_upper)
        changed.high = std::max(rounded(value, width), range.low + least_width * width);
    else
        changed.low = std::min(rounded(value, width), range.high - least_width * width);
    return changed;
}

std::optional<LegendEdit::Change> LegendEdit::take(const QMouseEvent& event,
                                                   const std::vector<LegendPicture::Bar>& bars, QWidget* window,
                                                   bool& taken)
{
    taken = drag_ || pressed_;
    if (event.type() == QEvent::MouseButtonRelease) {
        drag_.reset();
        pressed_ = false;
        return std::nullopt;
    }
    if (event.type() == QEvent::MouseMove) {
        if (!drag_ || event.pos() == drag_->from) return std::nullopt;
        const ValueRange range =
            dragged_range(drag_->bar.range, height_of(drag_->bar, drag_->from), height_of(drag_->bar, event.pos()));
        return Change{text_of(range)};
    }
    const auto bar = std::find_if(bars.begin(), bars.end(),
                                  [&](const LegendPicture::Bar& each) { return each.place.contains(event.pos()); });
    if (bar == bars.end()) return std::nullopt;
    taken = true;
    if (event.button() == Qt::RightButton) {
        pressed_ = true;
        return Change{};
    }
    if (event.button() != Qt::LeftButton) return std::nullopt;
    if (event.type() == QEvent::MouseButtonDblClick) {
        drag_.reset();
        bool good = false;
        const QString typed = QInputDialog::getText(
            window, "Colour range", "Values at the ends of the ramp, LOW:HIGH (empty: automatic):", QLineEdit::Normal,
            text_of(bar->range), &good);
        return good ? std::optional(Change{typed.simplified()}) : std::nullopt;
    }
    drag_ = Drag{*bar, event.pos()};
    return std::nullopt;
}

}  // namespace pcm::host
