// Decides when drawing a picture is given up: not while anything changes, however slow the machine is.
#pragma once

#include <cstdint>
#include <string>

namespace pcm::cli {

// What has been drawn and loaded so far, after a frame.
struct DrawingProgress {
    std::uint64_t points_drawn = 0, uploaded_bytes = 0, loaded_bytes = 0;
    // Sum over all frames so far. It grows while a picture is drawn behind the one that is shown, whose number of
    // points does not change meanwhile.
    std::uint64_t points_added = 0;
    std::uint64_t chunks_missing = 0;  // wanted, and not in video memory
    std::uint64_t refused = 0;         // uploads for which video memory had no room
    std::uint64_t frames = 0;
};

class Standstill {
public:
    static constexpr double longest = 60;           // seconds without any change
    static constexpr double longest_reading = 600;  // the same while chunks are being read: a disk may sleep, or be far
    // A frame can take long on a slow machine: this number of frames is awaited in any case.
    static constexpr std::uint64_t least_frames = 20;

    // `seconds` on a clock that never goes back. Throws Error(io), with the cause, when nothing has changed for too
    // long. To be called after every frame, by one thread.
    void look(const DrawingProgress& now, double seconds);

private:
    DrawingProgress last_{};  // at the last change
    double since_ = 0;
    bool begun_ = false;
};

}  // namespace pcm::cli
