#include "pcm/cli/standstill.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

namespace pcm::cli {

void Standstill::look(const DrawingProgress& now, double seconds)
{
    const bool changed = !begun_ || now.points_drawn != last_.points_drawn || now.points_added != last_.points_added ||
                         now.uploaded_bytes != last_.uploaded_bytes || now.loaded_bytes != last_.loaded_bytes ||
                         now.chunks_missing != last_.chunks_missing;
    if (changed) {
        begun_ = true;
        last_ = now;
        since_ = seconds;
        return;
    }
    const double still = seconds - since_;
    if (still <= longest || now.frames - last_.frames < least_frames) return;
    const auto give_up = [&](const std::string& why, const std::string& hint) {
        throw Error(ErrorCode::io, {},
                    "the picture is not complete: nothing has changed for " + time_text(still) + ", " + why, hint);
    };
    if (now.refused > last_.refused)
        give_up("and video memory has no room for a chunk that is needed", "give more with --l1");
    if (now.chunks_missing == 0) give_up("though all chunks are loaded", "try another driver, or --until target");
    if (still > longest_reading)
        give_up("and " + grouped(now.chunks_missing) + " chunks have not arrived from the disk",
                "look whether the disk of the tree answers, and render again");
}

}  // namespace pcm::cli
