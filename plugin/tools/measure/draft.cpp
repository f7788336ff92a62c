#include "plugin/tools/measure/draft.h"

#include <algorithm>

namespace pcm::host {

namespace {

const char* const ends = "Enter, a double click or the right button ends it.";

}  // namespace

std::vector<MeasuredPoint> Draft::points() const
{
    std::vector<MeasuredPoint> known;
    for (const Click& click : clicks_)
        if (click.point) known.push_back(*click.point);
    return known;
}

std::optional<int> Draft::click()
{
    if (ended_ || is_full()) return std::nullopt;
    clicks_.push_back({next_, std::nullopt, false});
    return next_++;
}

Draft::Click* Draft::find(int number)
{
    const auto found =
        std::find_if(clicks_.begin(), clicks_.end(), [number](const Click& click) { return click.number == number; });
    return found == clicks_.end() ? nullptr : &*found;
}

void Draft::answer(int number, const MeasuredPoint& point, bool final)
{
    Click* const click = find(number);
    if (!click) return;  // taken back
    click->point = point;
    click->final = final;
}

void Draft::miss(int number)
{
    if (const Click* click = find(number)) {
        clicks_.erase(clicks_.begin() + (click - clicks_.data()));
        if (clicks_.size() < point_numbers(kind_).least) ended_ = false;
    }
}

bool Draft::take_back()
{
    if (clicks_.empty()) return false;
    clicks_.pop_back();
    ended_ = false;
    return true;
}

QString Draft::end()
{
    const std::size_t least = point_numbers(kind_).least;
    if (clicks_.size() < least)
        return QString("%1: %2 of at least %3 points clicked").arg(title_of(kind_)).arg(clicks_.size()).arg(least);
    ended_ = true;
    return {};
}

bool Draft::complete() const
{
    if (clicks_.empty() || !(ended_ || is_full())) return false;
    return std::all_of(clicks_.begin(), clicks_.end(), [](const Click& click) { return click.point && click.final; });
}

void Draft::clear()
{
    clicks_.clear();
    ended_ = false;
}

void Draft::reopen()
{
    ended_ = false;
    if (is_full()) take_back();
}

QString title_of(MeasureKind kind)
{
    switch (kind) {
        case MeasureKind::point:
            return "Point";
        case MeasureKind::distance:
            return "Distance";
        case MeasureKind::height:
            return "Height";
        case MeasureKind::angle:
            return "Angle";
        case MeasureKind::area:
            return "Area";
        case MeasureKind::plane:
            return "Point to plane";
        case MeasureKind::volume:
            return "Volume";
        case MeasureKind::profile:
            return "Profile";
        case MeasureKind::surface:
            return "Point to surface";
    }
    return {};
}

QString hint_of(MeasureKind kind)
{
    switch (kind) {
        case MeasureKind::point:
            return "Click a point.";
        case MeasureKind::distance:
            return QString("Click two or more points of a line. ") + ends;
        case MeasureKind::height:
            return "Click two points: the height of the second above the first.";
        case MeasureKind::angle:
            return "Click three points: the angle at the second.";
        case MeasureKind::area:
            return QString("Click three or more corners in order. ") + ends;
        case MeasureKind::plane:
            return QString("Click the point, then three or more points of the plane. ") + ends;
        case MeasureKind::volume:
            return QString("Click the corners of the ground plan in order. ") + ends;
        case MeasureKind::profile:
            return QString("Click two or more points of the section's line. ") + ends;
        case MeasureKind::surface:
            return "Click a point.";
    }
    return {};
}

}  // namespace pcm::host
