// Which fault of a build with many faults is at work: the number in the environment variable PCM_CHOSEN_FAULT, -1 for
// none. Not PCM_FAULT: tests that start a process whose calls fail set that (tests/faults.h), and the process has the
// fault in its code, too.
// packaging/mutate includes this header in the sources that it breaks.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>

#include <cstdlib>

namespace pcm_faults {

// Where PCM_FAULTS_REACHED names a file, the byte of each fault whose code is executed becomes 1, in this process or in
// one that it starts.
struct Chosen {
    static constexpr int room = 1 << 16;
    int fault = -1;
    unsigned char* reached = nullptr;

    Chosen()
    {
        if (const char* number = std::getenv("PCM_CHOSEN_FAULT")) fault = std::atoi(number);
        if (const char* path = std::getenv("PCM_FAULTS_REACHED")) {
            void* const bytes =
                ::mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_SHARED, ::open(path, O_RDWR | O_CLOEXEC), 0);
            if (bytes != MAP_FAILED) reached = static_cast<unsigned char*>(bytes);
        }
    }
};

inline Chosen chosen __attribute__((init_priority(101)));  // before constants that are computed at the start

}  // namespace pcm_faults

// Does not compile where a constant is needed: that fault has to be built alone.
inline bool pcm_fault(int number)
{
    if (__builtin_expect(pcm_faults::chosen.reached != nullptr, 0)) pcm_faults::chosen.reached[number] = 1;
    return pcm_faults::chosen.fault == number;
}

// For functions that are constexpr: no fault is at work where the compiler evaluates them.
constexpr bool pcm_fault_at_run_time(int number)
{
    return __builtin_is_constant_evaluated() ? false : pcm_fault(number);
}
