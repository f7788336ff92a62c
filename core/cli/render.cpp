#include "pcm/cli/render.h"

#include "pcm/system/error.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

namespace pcm::cli {
namespace {

[[noreturn]] void start(char** arguments)
{
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw Error::from_errno(error.value(), "/proc/self/exe", "finding the path of pcmlab");
    const std::filesystem::path program = self.parent_path() / "pcmlab-render";
    ::execv(program.c_str(), arguments);
    const int error_number = errno;
    if (error_number == ENOENT)
        throw Error(ErrorCode::not_found, program, "this program, which uses OpenGL for pcmlab, is missing",
                    "it is built where OpenGL, GLEW, EGL and libpng are available, and installed next to pcmlab");
    throw Error::from_errno(error_number, program, "starting the program");
}

}  // namespace

void start_render(char** arguments) { start(arguments); }

void start_gpu_radii(const GpuRadii& radii)
{
    std::vector<std::string> words{"radii",
                                   "--neighbours",
                                   std::to_string(radii.neighbours),
                                   "--memory",
                                   std::to_string(radii.memory),
                                   "--video-memory",
                                   std::to_string(radii.video_memory)};
    if (!radii.target.copy.empty()) words.push_back("--output=" + radii.target.copy.string());
    if (radii.target.in_place) words.emplace_back("--in-place");
    if (radii.target.overwrite) words.emplace_back("--overwrite");
    if (radii.json) words.emplace_back("--json");
    if (radii.quiet) words.emplace_back("--quiet");
    words.emplace_back("--");
    words.push_back(radii.tree);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    start(arguments.data());
}

}  // namespace pcm::cli
