// A system that gives no further thread.
#pragma once

#include <pthread.h>

#include <cstddef>
#include <stdexcept>

namespace pcm::test {

// While it lives, every start of a thread in this process fails as it does where the system has no more of them: with
// std::system_error. The default stack gets larger than the address space.
class NoMoreThreads {
public:
    NoMoreThreads()
    {
        if (pthread_getattr_default_np(&before_) != 0) throw std::runtime_error("no default attributes of threads");
        pthread_attr_t huge;
        pthread_attr_init(&huge);
        if (pthread_attr_setstacksize(&huge, std::size_t{1} << 50) != 0 || pthread_setattr_default_np(&huge) != 0)
            throw std::runtime_error("the default stack of threads cannot be set");
        pthread_attr_destroy(&huge);
    }
    ~NoMoreThreads()
    {
        pthread_setattr_default_np(&before_);
        pthread_attr_destroy(&before_);
    }
    NoMoreThreads(const NoMoreThreads&) = delete;
    NoMoreThreads& operator=(const NoMoreThreads&) = delete;

private:
    pthread_attr_t before_;
};

}  // namespace pcm::test
