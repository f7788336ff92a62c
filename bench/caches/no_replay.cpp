// In builds that cannot draw offscreen.
#include "bench/caches/modes.h"

#include <stdexcept>

namespace pcm::bench {
namespace {
constexpr const char* reason = "this program was built without OpenGL (PCM_WITH_GL), EGL or libpng";
}

std::string gl_renderer(std::string& why)
{
    why = reason;
    return {};
}

void measure_replay(const Settings&, Row&) { throw std::runtime_error(reason); }

void put_l1_defaults(Row&) {}

}  // namespace pcm::bench
