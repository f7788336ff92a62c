// Lets the start of threads fail, as it does when a system has reached its limit of threads.
#pragma once

namespace pcm::test {

// While it lives, `allowed` more threads of this process can be started; after them pthread_create() fails with EAGAIN.
// One at a time.
class FailingThreads {
public:
    explicit FailingThreads(int allowed);
    ~FailingThreads();
    FailingThreads(const FailingThreads&) = delete;
    FailingThreads& operator=(const FailingThreads&) = delete;
    int refused() const;
};

}  // namespace pcm::test
