#include "pcm/system/progress.h"

#include "pcm/system/error.h"

namespace pcm {

void run_last_step(Outcome& outcome, const std::function<void()>& step)
{
    try {
        step();
    } catch (const Error& error) {
        if (!error.is_done()) throw;
        outcome.warnings.emplace_back(error.what());
    }
}

}  // namespace pcm
