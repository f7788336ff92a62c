#include "pcm/cli/opengl_program.h"

#include "pcm/system/error.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace pcm::cli {

void start_opengl_program(std::vector<std::string> words)
{
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw Error::from_errno(error.value(), "/proc/self/exe", "finding the path of pcmlab");
    const std::filesystem::path program = self.parent_path() / "pcmlab-render";
    std::string name = "pcmlab";
    std::vector<char*> arguments{name.data()};
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    const int error_number = errno;
    if (error_number == ENOENT)
        throw Error(ErrorCode::not_found, program, "this program, which uses OpenGL for pcmlab, is missing",
                    "it is built where OpenGL, GLEW, EGL and libpng are available, and installed next to pcmlab");
    throw Error::from_errno(error_number, program, "starting the program");
}

}  // namespace pcm::cli
