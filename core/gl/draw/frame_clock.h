// Measures how long a frame takes on the device, without waiting for it where possible.
//
// With timer queries (OpenGL 3.3) a frame's time is known a few frames later, when the device has finished it; where
// submitting it to the driver took longer, that time counts. Without queries end() waits, and also on a software
// rasteriser: its queries omit the vertex stage, and it runs on the same processor anyway. GL thread only, one context.
#pragma once

#include "pcm/gl/draw/frame_budget.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

namespace pcm {

class FrameClock {
public:
    struct Measure {
        FrameWork work;  // as given to end()
        double milliseconds = 0;
    };

    FrameClock() = default;
    // Forces one of the two: queries, which the device must have, or waiting.
    explicit FrameClock(bool queries) : decided_(true), queries_are_used_(queries) {}

    // Around the drawing calls.
    void begin();
    void end(const FrameWork& work);
    // The latest frame whose time has become known since the last call.
    std::optional<Measure> take();
    bool waits() const { return !queries_are_used_; }

    // Deletes the queries; measurements not yet taken are lost.
    void release();

private:
    using Clock = std::chrono::steady_clock;
    struct Span {
        std::uint32_t from = 0, to = 0;  // queries
        FrameWork work;
        double handing_ms = 0;
        bool pending = false;
    };
    bool decided_ = false;
    bool queries_are_used_ = false;
    std::array<Span, 4> spans_{};
    std::size_t next_ = 0;
    bool open_ = false;  // begin() found a free span
    Clock::time_point start_{};
    std::optional<Measure> known_;
};

}  // namespace pcm
