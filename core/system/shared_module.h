// Parts of the library that are shared objects of their own, since they need libraries that most users do without. They
// are loaded when they are chosen, and stay loaded until the process ends.
#pragma once

#include <cstdint>
#include <string>

namespace pcm {

struct SharedModule {
    const void* functions = nullptr;  // what the symbol returned; null: the module cannot be used
    std::string missing;              // why it cannot
};

// Loads `file` ("libpcm_NAME.so") from the folder of this code, from where an install of it has its libraries, or from
// where the system looks. `symbol` is a function without parameters that returns a pointer to a structure; the first
// member of the structure is a std::uint32_t, which has to be `version`. Any number of threads. Never throws because of
// what is missing. Callers keep the result: each call looks at the disk again.
SharedModule load_shared_module(const std::string& file, const char* symbol, std::uint32_t version);

// Whether the file is in the folder of this code or of an install's libraries, without loading it: cheap, and for
// what is only shown.
bool has_shared_module(const std::string& file);

}  // namespace pcm
