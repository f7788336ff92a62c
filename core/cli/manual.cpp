#include "pcm/cli/manual.h"

#include "pcm/system/environment.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <system_error>

namespace pcm::cli {
namespace {

namespace fs = std::filesystem;

// Installed, next to the folder of programs; or in the build folder, where target manual makes it.
fs::path first_page()
{
    std::error_code error;
    const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
    if (error) return {};
    for (const char* folder : {"share/doc/pcmlab/manual", "manual"}) {
        const fs::path page = programs.parent_path() / folder / "index.html";
        if (fs::is_regular_file(page, error)) return page;
    }
    return {};
}

bool is_set(const char* name) { return !environment(name).empty(); }

// Does not wait for the browser, which may be this process's child for hours.
void open_in_browser(const fs::path& page)
{
    const pid_t child = ::fork();
    if (child == 0) {
        if (::fork() == 0) {
            ::execlp("xdg-open", "xdg-open", page.c_str(), static_cast<char*>(nullptr));
            std::fprintf(stderr, "pcmlab: no browser was opened: xdg-open is not there (Debian: xdg-utils)\n");
        }
        ::_exit(0);
    }
    if (child > 0) ::waitpid(child, nullptr, 0);
}

}  // namespace

int show_manual()
{
    const fs::path page = first_page();
    if (page.empty()) {
        std::fprintf(stderr,
                     "pcmlab: the manual is not installed: install python3-markdown, then: cmake --build build/release "
                     "--target manual; sudo cmake --install build/release --component manual\n");
        return 1;
    }
    if (std::printf("%s\n", page.c_str()) < 0 || std::fflush(stdout) != 0) return 1;
    if (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")) open_in_browser(page);
    return 0;
}

}  // namespace pcm::cli
