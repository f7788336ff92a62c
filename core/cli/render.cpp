// `pcmlab render` is a program of its own beside this one, so that nothing else here needs OpenGL.
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
    if (error) throw Error::from_errno(error.value(), "/proc/self/exe", "finding where pcmlab is");
    const std::filesystem::path program = self.parent_path() / "pcmlab-render";
    ::execv(program.c_str(), arguments);
    const int error_number = errno;
    if (error_number == ENOENT)
        throw Error(ErrorCode::not_found, program, "this program, which draws for pcmlab, is not there",
                    "it is built where OpenGL, GLEW, EGL and libpng are, and installed beside pcmlab");
    throw Error::from_errno(error_number, program, "starting it");
}

}  // namespace pcm::cli
