#include "pcm/system/environment.h"

#include <cstdlib>

namespace pcm {

std::string environment(const char* name)
{
    const char* const value = std::getenv(name);
    return value ? value : "";
}

}  // namespace pcm
