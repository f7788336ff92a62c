// Progress of a part of an operation, as progress of the whole.
#pragma once

#include "pcm/system/progress.h"

namespace pcm {

// Its fractions 0..1 become begin..end. `progress` outlives the result.
inline ProgressFunction part_of(const ProgressFunction& progress, double begin, double end)
{
    if (!progress) return {};
    return [&progress, begin, end](ProgressUpdate update) {
        update.fraction = begin + (end - begin) * update.fraction;
        update.seconds_left = -1;
        return progress(update);
    };
}

}  // namespace pcm
