#include "pcm/system/free_memory.h"

#include <cstdlib>  // defines __GLIBC__

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace pcm {

void return_free_memory() noexcept
{
#if defined(__GLIBC__)
    ::malloc_trim(0);
#endif
}

}  // namespace pcm
