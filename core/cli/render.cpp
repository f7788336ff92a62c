// Starts pcmlab-render, a program of its own, so that pcmlab itself needs no OpenGL.
#include "pcm/system/error.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace pcm::cli {

void start_render(char** arguments)
{
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw Error::from_errno(error.value(), "/proc/self/exe", "finding the path of pcmlab");
    const std::filesystem::path program = self.parent_path() / "pcmlab-render";
    ::execv(program.c_str(), arguments);
    const int error_number = errno;
    if (error_number == ENOENT)
        throw Error(ErrorCode::not_found, program, "this program, which renders for pcmlab, is missing",
                    "it is built where OpenGL, GLEW, EGL and libpng are available, and installed next to pcmlab");
    throw Error::from_errno(error_number, program, "starting the program");
}

}  // namespace pcm::cli
