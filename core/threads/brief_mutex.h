// A mutex for critical sections of some ten nanoseconds. A thread that finds it taken spins, then yields, and only then
// sleeps: with more threads than processors a mutex of the system spends its time on putting threads to sleep and
// waking them.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace pcm {

class BriefMutex {
public:
    bool try_lock() { return !taken_.exchange(true, std::memory_order_acquire); }
    void lock()
    {
        // The pauses get longer: so one processor takes the lock many times in a row, and its cache line does not move
        // back and forth.
        for (unsigned tries = 0; !try_lock(); ++tries) {
            if (tries < 6)
                for (unsigned i = 0; i < (32u << tries); ++i) pause();
            else if (tries < 64)
                std::this_thread::yield();
            else
                std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
    }
    void unlock() { taken_.store(false, std::memory_order_release); }

private:
    static void pause()
    {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#endif
    }
    std::atomic<bool> taken_{false};
};

}  // namespace pcm
