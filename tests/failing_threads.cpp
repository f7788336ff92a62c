#include "tests/failing_threads.h"

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <limits>

namespace {

std::atomic<int> allowed_threads{std::numeric_limits<int>::max()}, refused_threads{0};

using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);

Create system_create()
{
    void* const found = dlsym(RTLD_NEXT, "pthread_create");
    Create create;
    std::memcpy(&create, &found, sizeof create);
    return create;
}

}  // namespace

// Takes the place of the system's, for the C++ library too.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) noexcept
{
    static const Create create = system_create();
    if (allowed_threads.fetch_sub(1) <= 0) {
        ++refused_threads;
        return EAGAIN;
    }
    return create(thread, attributes, start, argument);
}

namespace pcm::test {

FailingThreads::FailingThreads(int allowed)
{
    refused_threads = 0;
    allowed_threads = allowed;
}
FailingThreads::~FailingThreads() { allowed_threads = std::numeric_limits<int>::max(); }
int FailingThreads::refused() const { return refused_threads; }

}  // namespace pcm::test
