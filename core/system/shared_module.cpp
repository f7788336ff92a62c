#include "pcm/system/shared_module.h"

#include <dlfcn.h>
#include <filesystem>
#include <vector>

namespace pcm {
namespace {

// The folders of this code and of the program, those where an install of it has its modules, and where the system
// looks.
std::vector<std::filesystem::path> places(const std::string& name)
{
    std::vector<std::filesystem::path> all, codes;
    Dl_info here{};
    if (dladdr(reinterpret_cast<const void*>(&places), &here) && here.dli_fname) codes.emplace_back(here.dli_fname);
    codes.emplace_back("/proc/self/exe");  // this code may be in a library of the program's, in another folder
    for (const std::filesystem::path& code : codes) {
        if (!code.has_parent_path()) continue;  // a program that was started by its name alone
        std::error_code ignored;
        const auto folder = std::filesystem::weakly_canonical(code, ignored).parent_path();
        all.push_back(folder / name);
        all.push_back(folder / PCM_MODULES_FROM_PROGRAM / name);
    }
    all.emplace_back(std::filesystem::path(PCM_MODULES) / name);
    all.emplace_back(name);
    return all;
}

}  // namespace

bool has_shared_module(const std::string& file)
{
    for (const auto& place : places(file)) {
        std::error_code ignored;
        if (place.has_parent_path() && std::filesystem::exists(place, ignored)) return true;
    }
    return false;
}

SharedModule load_shared_module(const std::string& file, const char* symbol, std::uint32_t version)
{
    SharedModule result;
    for (const auto& place : places(file)) {
        std::error_code ignored;
        if (place.has_parent_path() && !std::filesystem::exists(place, ignored)) continue;
        void* library = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!library) {
            // The reason why an existing file cannot be loaded is more useful than that no other place has one.
            if (result.missing.empty() || place.has_parent_path()) result.missing = dlerror();
            continue;
        }
        const auto entry = reinterpret_cast<const void* (*)()>(dlsym(library, symbol));
        const void* functions = entry ? entry() : nullptr;
        if (functions && *static_cast<const std::uint32_t*>(functions) == version) return {functions, {}};
        result.missing = place.string() + " belongs to another version of this library";
    }
    return result;
}

}  // namespace pcm
