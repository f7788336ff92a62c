// Which backends of filters can be offered.
#pragma once

namespace pcm {

// Whether the search for neighbours by FLANN is installed; it is not loaded for that. Where it is not, choosing it is
// an error that says how it is installed.
bool offers_flann();

}  // namespace pcm
