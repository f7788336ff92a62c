// The measure that is being made. Clicks give its points in their order, though the answers of picks come late: a place
// is kept for each click until its pick is answered.
#pragma once

#include "pcm/measure/measure.h"

#include <QString>

#include <cstddef>
#include <optional>
#include <vector>

namespace pcm::host {

class Draft {
public:
    explicit Draft(MeasureKind kind = MeasureKind::distance) : kind_(kind) {}

    MeasureKind kind() const { return kind_; }
    bool empty() const { return clicks_.empty(); }
    // The measure takes no more points than it has.
    bool is_full() const { return clicks_.size() >= point_numbers(kind_).most; }
    // The points that are known, in the order of the clicks; also those that may still change.
    std::vector<MeasuredPoint> points() const;

    // A click. Returns the number by which answers name it; nothing if the measure takes no more points.
    std::optional<int> click();
    // `final`: it will not change.
    void answer(int click, const MeasuredPoint& point, bool final);
    // There is no point under the click. A measure that had been ended waits for more points if too few are left.
    void miss(int click);
    // Removes the last click; returns false if there is none.
    bool take_back();
    // No more points follow. Returns why that cannot be, or nothing.
    QString end();
    // All of its points are known and no more can follow.
    bool complete() const;
    void clear();
    // More points may follow, in place of the last one where the measure takes no more than it has.
    void reopen();

private:
    struct Click {
        int number;
        std::optional<MeasuredPoint> point;
        bool final = false;
    };
    Click* find(int number);

    MeasureKind kind_;
    std::vector<Click> clicks_;
    int next_ = 0;
    bool ended_ = false;
};

// What the panel calls the kind: "Distance", "Point to plane".
QString title_of(MeasureKind kind);
// What to do for a measure of this kind: "Click two or more points; ...".
QString hint_of(MeasureKind kind);

}  // namespace pcm::host
